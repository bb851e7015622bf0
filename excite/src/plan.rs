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

/// Base parameter with the deviation that a motion allows.
#[derive(Clone, Debug, Serialize)]
pub struct Parameter {
    /// Name of the standard parameter that represents the base parameter.
    pub name: String,
    /// Standard parameters that form the base parameter, as a formula.
    pub formula: String,
    /// Value of the base parameter by the robot's description.
    pub value: f64,
    /// Standard deviation that the motion's information allows; null for a parameter without information.
    pub std: Option<f64>,
    /// Relative standard deviation, percent (UR5 paper, eq. 10); null where the value is zero.
    pub relative_percent: Option<f64>,
    /// Size from which the parameter differs from zero with 95 % confidence.
    pub shows_from: Option<f64>,
    /// Whether the described value is as large as `shows_from`.
    pub shows: bool,
}

/// Effect at one place that the motion would show.
#[derive(Clone, Debug, Serialize)]
pub struct Shown {
    /// Name of the effect in the catalogue.
    pub effect: &'static str,
    /// Names of the joints that the effect concerns.
    pub joints: Vec<String>,
    /// Indices of the joints in `joints`, from 0.
    #[serde(skip)]
    pub places: Vec<usize>,
    /// Name of the driving joint; none but for a coupling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driver: Option<String>,
    /// Name of the quantity whose size is stated.
    pub quantity: &'static str,
    /// Unit of the size `from`.
    pub unit: Unit,
    /// Least size at which the effect would be accepted; null where no plausible one would.
    pub from: Option<f64>,
    /// Torque of the effect at the size `from`, N·m.
    pub torque: Option<f64>,
    /// Shape parameters for which the effect shows first.
    pub shape: Vec<Shape>,
}

/// Effect that the plan does not judge, since it is found otherwise.
#[derive(Clone, Debug, Serialize)]
pub struct NotJudged {
    /// Name of the effect in the catalogue.
    pub effect: &'static str,
    /// Reason why the plan does not judge the effect.
    pub reason: &'static str,
}

/// Parameters and effects that a motion of a robot would show under torque noise of the given deviations, N·m per
/// sample. `progress` is called with the number of effects that are done, and of all.
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
