//! `joint_elasticity` and `backlash` where the link's own encoder was recorded. Then the link's departure from
//! its motor is measured, and so is its change of the torque. The departure itself decides between the two, and
//! gives the size ([`flanks`]).
//!
//! On a recording without that encoder the columns are those of the transmission with the sizes found.

mod flanks;

use super::candidate::{Bound, Candidate, Column, Quantity, Size};
use super::effect::Effect;
use super::joint_elasticity::{ROUNDING, compliant, own_inertia};
use super::transmission::{Gap, Spring, recorded};
use super::unit::Unit;

use crate::motion::frame::Frame;
use crate::motion::motor::Band;
use crate::motion::scene::Scene;
use flanks::{Flanks, Rows, flanks};
use ndarray::{Array1, Array2};

/// Change of the torque by the departure, relative to the joint's, below which the gear counts as stiff.
const STIFF: f64 = 0.006;
/// Evidence of a departure that follows the torque, nats.
const WITNESSED: f64 = 40.0;
/// Parts of the joint's inertia that turn with the motor, tried beside the one found from the torque.
const ROTORS: [f64; 3] = [0.0, 0.25, 0.45];
/// Damping ratios of a simulated gear. The ringing time is known worst, and wrong ringing is worse than none.
const DAMPING: [f64; 4] = [0.06, 0.15, 0.35, 0.7];
/// Least deflection beyond the flanks, over that between them, for a stiffness of a gap's flanks. A smaller one
/// is hidden by the rows' band.
const TOLD: f64 = 0.3;

/// Finding of a joint's link encoder about its gear.
#[derive(Clone, Debug)]
pub enum Link {
    /// Unknown: no link encoder was recorded, or it shows its own noise.
    Unknown,
    /// Stiff: the link follows the motor.
    Stiff,
    /// Compliant: the gear gives way, with the flanks found.
    Gives(Gear),
}

/// A gear found from the departure of its link.
#[derive(Clone, Debug)]
pub struct Gear {
    flanks: Flanks,
    /// Parts of the joint's inertia that may turn with the motor.
    rotors: Vec<f64>,
}

/// Finding of each joint's link encoder; `weight` of the fitted rows, shape (rows, joints).
pub fn links(scene: &Scene, frame: &Frame, weight: &Array2<f64>) -> Vec<Link> {
    let of = |j: usize| link(scene, frame, weight, j).unwrap_or(Link::Unknown);
    (0..scene.dof()).map(of).collect()
}

fn link(scene: &Scene, frame: &Frame, weight: &Array2<f64>, joint: usize) -> Option<Link> {
    let [departure, rate, _] = scene.departed(joint, Band::Rows)?;
    let middle = departure.mean()?;
    let change = recorded(scene, joint, Band::Rows, 0.0, middle)?;
    let all = || 0..frame.rows.len();
    let change = frame.reduce(all(), &[&change.column(joint).to_owned()]);
    if change[0].std(0.0) < STIFF * scene.scale.torque[joint] {
        return Some(Link::Stiff);
    }
    let own = scene.robot.parameters();
    let first = physics::robot::PARAMETERS_PER_LINK * joint;
    let own = own[first..].first_chunk()?;
    let m = scene.motion;
    let fine = [
        departure.to_owned(),
        rate.to_owned(),
        m.qd.column(joint).to_owned(),
        scene.sign.column(joint).to_owned(),
        m.qdd.column(joint).to_owned(),
        scene.torque_of_link(joint, own).column(joint).to_owned(),
        m.q.column(joint).mapv(f64::sin),
        m.q.column(joint).mapv(f64::cos),
    ];
    // As late as the torque.
    let late = |x: &Array1<f64>| match &scene.scale.channel {
        Some(channel) => channel.recorded(m, joint, x.view()),
        None => x.clone(),
    };
    let fine = fine.each_ref().map(late);
    let reduced = frame.reduce(all(), &fine.each_ref());
    let [departure, rate, qd, sign, qdd, own, sine, cosine] = reduced.try_into().ok()?;
    let rows = Rows {
        motor: [
            qd.to_vec(),
            sign.to_vec(),
            qdd.to_vec(),
            vec![1.0; frame.len()],
        ],
        turn: [sine.to_vec(), cosine.to_vec()],
        departure: departure.to_vec(),
        rate: rate.to_vec(),
        own: own.to_vec(),
        torque: frame.thin(&frame.tau.column(joint).to_vec()).to_vec(),
        counts: weight.column(joint).iter().map(|w| *w > 0.0).collect(),
        trajectories: frame.rows.clone(),
        rate_hz: frame.row_rate(),
    };
    let found = flanks(rows)?;
    let share = (found.inertia / own_inertia(scene, joint)).clamp(0.0, 0.8);
    let told = (found.inertia > 0.0).then_some(share);
    Some(Link::Gives(Gear {
        flanks: found,
        rotors: told.into_iter().chain(ROTORS).collect(),
    }))
}

impl Gear {
    /// Effect of the gear (elasticity or backlash) and its sizes.
    pub fn told(&self) -> (Effect, Vec<Size>) {
        let found = &self.flanks;
        let [between, beyond] = found.parts;
        let winds = found.stiffness.map(|[value, std]| Size {
            name: "stiffness",
            value,
            std,
            unit: Unit::NewtonMetrePerRad,
        });
        let plays = found.half_gap.map(|[value, std]| Size {
            name: "half_play",
            value,
            std,
            unit: Unit::Rad,
        });
        match plays {
            Some(play) if between > beyond => {
                let winds = winds.filter(|_| beyond > TOLD * between);
                let sizes = std::iter::once(play).chain(winds);
                (Effect::Backlash, sizes.collect())
            }
            play => (
                Effect::JointElasticity,
                winds.into_iter().chain(play).collect(),
            ),
        }
    }
}

/// Candidates of a joint whose gear gives way.
pub(super) fn candidates(scene: &Scene, joint: usize, gear: &Gear) -> Vec<Candidate> {
    let found = &gear.flanks;
    let (effect, sizes) = gear.told();
    let zero = 0.5 * (found.at[0] + found.at[1]);
    let half_play = found.half_gap.map_or(0.0, |h| h[0]);
    let inertia = own_inertia(scene, joint);
    let mut all = Vec::new();
    for &rotor in &gear.rotors {
        let moved = (1.0 - rotor) * inertia;
        let springs = found.stiffness.into_iter().flat_map(|[stiffness, _]| {
            let frequency = (stiffness / moved).sqrt() / std::f64::consts::TAU;
            DAMPING.map(|damping| {
                Simulated::Spring(Spring {
                    frequency,
                    damping,
                    rotor,
                    half_play,
                })
            })
        });
        let gap = (half_play > 0.0).then_some(Simulated::Gap(Gap { half_play, rotor }));
        let seen = recorded(scene, joint, Band::Motion, rotor, zero);
        let wind_ups = found.stiffness.into_iter().flat_map(|[stiffness, _]| {
            ROUNDING.map(|r| Simulated::WindUp([1.0 / stiffness, rotor, r]))
        });
        let gears = springs.chain(wind_ups).chain(gap);
        let Some((gear, part)) = nearest(scene, joint, gears, seen) else {
            continue;
        };
        let simulated = move |s: &Scene| gear.change(s, joint) * part;
        let mut push = |column: Column| {
            let share = Quantity::plain("share", Unit::One, Some(joint));
            let bound = Bound::Between(0.4, 1.6);
            let mut one = Candidate::single(effect, joint, share, bound, column).with_shape(
                "rotor_share",
                rotor,
                Unit::One,
            );
            one.sizes.clone_from(&sizes);
            one.evidence = WITNESSED;
            all.push(one);
        };
        for band in [Band::Rows, Band::Motion] {
            push(Column::whole(scene.dof(), move |s| {
                recorded(s, joint, band, rotor, zero).unwrap_or_else(|| simulated(s))
            }));
        }
        push(Column::whole(scene.dof(), simulated));
    }
    all
}

/// A gear with the sizes found, for recordings without the link's encoder.
#[derive(Clone, Copy)]
enum Simulated {
    Spring(Spring),
    Gap(Gap),
    /// A spring without its own oscillation: compliance, rad/(N·m), the motor's part of the inertia, rounding of the torque, s.
    WindUp([f64; 3]),
}

impl Simulated {
    fn change(&self, scene: &Scene, joint: usize) -> Array2<f64> {
        match *self {
            Self::Spring(spring) => spring.change(scene, joint),
            Self::Gap(gap) => gap.change(scene, joint),
            Self::WindUp([compliance, rotor, rounding]) => {
                compliant(scene, joint, compliance, rotor, rounding)
            }
        }
    }
}

/// The one of some gears whose simulated change of the joint's torque is nearest to that by the recorded
/// departure, and the coefficient on it. An oscillation out of phase predicts nothing.
fn nearest(
    scene: &Scene,
    joint: usize,
    gears: impl Iterator<Item = Simulated>,
    seen: Option<Array2<f64>>,
) -> Option<(Simulated, f64)> {
    let seen = seen?;
    let seen = seen.column(joint);
    let told = |gear: Simulated| {
        let change = gear.change(scene, joint);
        let own = change.column(joint);
        let part = (own.dot(&seen) / own.dot(&own).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let removed = part * (2.0 * own.dot(&seen) - part * own.dot(&own));
        (removed, gear, part)
    };
    let best = gears.map(told).max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, gear, part)| (gear, part))
}
