//! Plan: parameters and effects that a motion would show, and their least sizes.

use crate::columns::{triangle, values};
use diagnose::{Effect, Settings, Shape, Unit, Visible, visible};
use identify::base::{BaseParameters, Extra};
use identify::excitation::{BaseRows, deviations};
use identify::least_squares::LeastSquaresError;
use physics::robot::Robot;
use serde::Serialize;
use signal::Motion;

/// Number of standard deviations that a value has to exceed to differ from zero with 95 % confidence.
const TOLD: f64 = 1.96;

/// Parameters and effects that a motion would show.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// Base parameters by least squares.
    pub parameters: Vec<Parameter>,
    /// Effects of the diagnosis.
    pub effects: Vec<Shown>,
    /// Effects whose visibility does not follow from the motion.
    pub not_judged: Vec<NotJudged>,
}

/// A base parameter.
#[derive(Clone, Debug, Serialize)]
pub struct Parameter {
    /// Name of the standard parameter that represents it.
    pub name: String,
    /// The parameters that form it.
    pub formula: String,
    /// Value by the robot's description.
    pub value: f64,
    /// Standard deviation that the motion's information allows; null where it has none.
    pub std: Option<f64>,
    /// Relative standard deviation, percent (UR5 paper, eq. 10); null where the value is zero.
    pub relative_percent: Option<f64>,
    /// Size from which the parameter differs from zero with 95 % confidence.
    pub shows_from: Option<f64>,
    /// Whether the value in the description is as large as that.
    pub shows: bool,
}

/// An effect at one place.
#[derive(Clone, Debug, Serialize)]
pub struct Shown {
    /// Name of the effect.
    pub effect: &'static str,
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Numbers of these, from zero.
    #[serde(skip)]
    pub places: Vec<usize>,
    /// Driving joint of a coupling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driver: Option<String>,
    /// Name of the quantity whose size is stated.
    pub quantity: &'static str,
    /// Unit of the size.
    pub unit: Unit,
    /// Least size that would be accepted; null where no plausible one would.
    pub from: Option<f64>,
    /// Torque at that size, N·m.
    pub torque: Option<f64>,
    /// Shape for which it shows first.
    pub shape: Vec<Shape>,
}

/// An effect that is found otherwise.
#[derive(Clone, Debug, Serialize)]
pub struct NotJudged {
    /// Name of the effect.
    pub effect: &'static str,
    /// Reason.
    pub reason: &'static str,
}

/// What a motion of a robot would show under torque noise of the given deviations, N·m per sample. `progress` is told how many
/// effects of how many have been looked at.
///
/// # Errors
/// Numbers that are not finite.
pub fn plan(
    robot: &Robot,
    base: &BaseParameters,
    extras: &[Extra],
    motion: &Motion,
    noise: &[f64],
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Plan, LeastSquaresError> {
    let rows = BaseRows::new(robot, base, extras);
    let (triangle, times) = triangle(&rows, motion, noise)?;
    let stds = deviations(&triangle, times);
    let named = base.base_names().into_iter().zip(base.formulae());
    let parameters = named
        .zip(values(robot, base, extras))
        .zip(stds)
        .map(|(((name, formula), value), std)| {
            let known = std.is_finite().then_some(std);
            Parameter {
                name,
                formula,
                value,
                std: known,
                relative_percent: known
                    .filter(|_| value != 0.0)
                    .map(|s| 100.0 * s / value.abs()),
                shows_from: known.map(|s| TOLD * s),
                shows: known.is_some_and(|s| value.abs() > TOLD * s),
            }
        })
        .collect();
    let found = visible(robot, motion, noise, &Settings::default(), progress);
    let judged: Vec<Effect> = found.iter().map(|v| v.effect).collect();
    let names = robot.joint_names();
    Ok(Plan {
        parameters,
        effects: found.into_iter().map(|v| shown(v, &names)).collect(),
        not_judged: Effect::ALL
            .into_iter()
            .filter(|e| !judged.contains(e))
            .map(|e| NotJudged {
                effect: e.name(),
                reason: e.info().unplanned,
            })
            .collect(),
    })
}

fn shown(v: Visible, names: &[String]) -> Shown {
    Shown {
        effect: v.effect.name(),
        joints: v.joints.iter().map(|&j| names[j].clone()).collect(),
        places: v.joints,
        driver: v.driver.map(|j| names[j].clone()),
        quantity: v.quantity,
        unit: v.unit,
        from: v.from,
        torque: v.torque,
        shape: v.shape,
    }
}
