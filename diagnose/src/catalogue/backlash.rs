//! `backlash`: play in the transmission, q being the motor side. The link crosses the gap on its own inertia and
//! lands on the other flank ([`super::transmission`]).
//! Confounders: elasticity (no gap), presliding hysteresis (reversal of velocity, not of torque).

use super::candidate::{Bound, Candidate, Column, Quantity, Shape};
use super::effect::Effect;
use super::info::{Carried, Info, Need};
use super::reported::{Parameter, size};
use super::transmission::Gap;
use super::unit::Unit;
use crate::motion::scene::Scene;

/// Description of `backlash`: confounders, needs, remedy, rules.
pub(super) const INFO: Info = Info {
    name: "backlash",
    plain: "backlash",
    confounders: &[
        Effect::JointElasticity,
        Effect::PreslidingHysteresis,
        Effect::TimeDelay,
    ],
    vibrates: true,
    least_fraction: 0.06,
    place: Some("comment in the MJCF"),
    by_hand: second_joint,
    needs: &[Need::Reversals],
    remedy: "add a joint with this range between motor and link ({})",
    gear: true,
    carried: |_| Carried::Not,
    unwritten: "needs a joint of its own between rotor and link, which is not written",
    reported: play,
    ..Info::NEW
};

/// Half plays that are tried, rad; for prismatic joints m, where they are a tenth of these values.
const HALF_PLAYS: [f64; 6] = [2e-4, 6e-4, 1.3e-3, 2.6e-3, 5e-3, 9e-3];
/// Parts of the joint's inertia that turn with the motor. These, the landings' rounding and the bound of the
/// coefficient were chosen on two seeds of the project's own simulator, whose gears split their inertia so.
const ROTORS: [f64; 3] = [0.0, 0.25, 0.45];

/// Range of the coefficient on a play's column within which the play's size is stated.
pub const SIZED: (f64, f64) = (0.3, 2.0);

/// Evidence of blows after sign changes of the torque, nats.
const BLOWS: f64 = 40.0;

/// Candidates of a joint whose blows were found. The column need not have their timing: the coefficient on the
/// play's predicted torque is free in size. `shown` is the chance of such blows, where they name the play by
/// themselves. Then one candidate has no column, since the motor's bouncing between its flanks may be all that
/// is left, which nothing predicts.
pub fn struck(scene: &Scene, joint: usize, shown: Option<f64>) -> Vec<Candidate> {
    let mut all = candidates(scene, joint);
    for c in &mut all {
        c.bounds[0] = Bound::Positive;
        let half_play = Shape::new("half_play", c.quantities[0].factor, Unit::Rad);
        c.shape.insert(0, half_play);
        c.quantities[0] = Quantity::plain("share", Unit::One, Some(joint));
        c.evidence = BLOWS;
    }
    if shown.is_some() {
        let mut without = all[0].clone();
        without.columns.clear();
        without.bounds.clear();
        without.quantities.clear();
        without.shape.clear();
        all.push(without);
    }
    all.iter_mut().for_each(|c| c.shown = shown);
    all
}

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let dof = scene.dof();
    let unit = if scene.robot.joints()[joint].kind.is_rotation() {
        1.0
    } else {
        0.1
    };
    let mut all = Vec::new();
    for play in HALF_PLAYS {
        for rotor in ROTORS {
            let half_play = play * unit;
            let gap = Gap { half_play, rotor };
            let column = Column::whole(dof, move |s| gap.change(s, joint));
            let quantity = Quantity::scaled("half_play", Unit::Rad, Some(joint), half_play);
            all.push(
                Candidate::single(
                    Effect::Backlash,
                    joint,
                    quantity,
                    Bound::Between(SIZED.0, SIZED.1),
                    column,
                )
                .with_shape("rotor_share", rotor, Unit::One),
            );
        }
    }
    all
}

/// Joint of the play, to be added to an MJCF; its range is the half play on either side where that is known.
fn second_joint(joints: &[String], parameters: &[Parameter]) -> Option<String> {
    let range = match size(parameters, "half_play") {
        Some((play, _)) => format!("range=\"{} {play}\"", -play),
        None => "of a range that has to be measured".to_owned(),
    };
    let joint = joints.first()?;
    Some(format!(
        "at {joint}: a second joint between rotor and link, {range}"
    ))
}

/// Reduces the sizes of a cause in the report to half the play. All sizes are dropped for a play found by its blows or
/// by another sensor: its coefficient on the predicted torque is outside of [`SIZED`], and no simulator has a number
/// for it.
fn play(parameters: &mut Vec<Parameter>) {
    let (least, most) = SIZED;
    let beside = |p: &Parameter| p.name == "share" && !(least..=most).contains(&p.value);
    if parameters.iter().any(beside) {
        parameters.clear();
    }
    parameters.retain(|p| p.name != "share");
}
