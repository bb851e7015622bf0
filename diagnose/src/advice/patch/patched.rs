//! The corrected robot that a patch writes.

use super::bodies::nearest;
use crate::advice::code;
use crate::catalogue::Parameter;
use crate::catalogue::effect::Effect;
use crate::catalogue::info::{Correction, Info};
use crate::motion::scene::Scale;
use crate::schema::{Cause, Moved};
use crate::search::find::Findings;
use crate::settings::SaidSettings;
use crate::simulator::NominalModel;
use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};
use physics::robot::{Inertia, Load, PARAMETERS_PER_LINK, Robot, RobotError, to_urdf};

/// Density assumed for a load, kg/m³: that of water, between plastics and metals. It gives a size to a load
/// whose inertia the recording does not show.
const LOAD_DENSITY: f64 = 1000.0;

/// Corrected robot with load, tilt and causes.
pub(super) struct Patched<'a> {
    /// Robot with its load: possible inertials, friction, rotor inertia.
    pub(super) robot: Robot,
    /// Robot with causes and tilt, without the load.
    pub(super) unloaded: Robot,
    /// Load found at the robot; none without one.
    pub(super) load: Option<Load>,
    /// Rotation vector by which the base is tilted, rad.
    pub(super) tilt: Vector3<f64>,
    pub(super) causes: &'a [Cause],
}

/// Corrected robot with and without its load.
pub struct Parts {
    /// Corrected robot with its load.
    pub whole: Robot,
    /// Corrected robot without its load.
    pub unloaded: Robot,
    /// Load found at the robot; none without one.
    pub load: Option<Load>,
}

impl Parts {
    /// Puts the written inertial parameters into the causes and into the parameters that moved, so that page and file agree.
    /// What is written as given, but for `said`'s bounds, is no longer told.
    pub fn told(
        &self,
        given: &Robot,
        said: &SaidSettings,
        causes: &mut [Cause],
        moved: &mut Vec<Moved>,
    ) {
        let labels = self.unloaded.parameter_names();
        let (before, values) = (given.parameters(), self.unloaded.parameters());
        let joints = self.unloaded.joint_names();
        for m in &mut *moved {
            let joint = joints.iter().position(|name| *name == m.joint);
            let label = joint.map(|j| format!("{}{}", m.name, j + 1));
            let place = labels.iter().position(|l| Some(l) == label.as_ref());
            m.value = place.map_or(m.value, |at| values[at]);
            m.deviations = (m.value - m.given).abs() / m.std;
        }
        moved.retain(|m| m.deviations > said.moved);
        moved.sort_by(|a, b| b.deviations.total_cmp(&a.deviations));
        let load = self.load.as_ref().map(|l| l.inertia.parameters());
        for cause in causes {
            for (k, p) in cause.parameters.iter_mut().enumerate() {
                let written = match cause.effect.info().correction {
                    Some(Correction::Links) => {
                        let place = labels.iter().position(|label| *label == p.name);
                        place.map(|at| values[at])
                    }
                    // Mass and centre are the fitted ones.
                    Some(Correction::Load) if p.name.starts_with("inertia_") => load.map(|l| l[k]),
                    _ => None,
                };
                p.value = written.unwrap_or(p.value);
            }
            if cause.effect.info().correction == Some(Correction::Links) {
                let moves = |p: &Parameter| {
                    let Some(at) = labels.iter().position(|label| *label == p.name) else {
                        return true;
                    };
                    let change = values[at] - before[at];
                    said.is_changed(before[at], change, p.std.unwrap_or(0.0))
                };
                if cause.parameters.iter().any(moves) {
                    cause.parameters.retain(moves);
                }
            }
        }
    }
}

/// The model with all fitted changes that its parameters can hold, payload and rotor inertia included. Its
/// links are possible bodies: those nearest to the description's that the data allow.
///
/// # Errors
/// The fitted parameters make no robot.
pub fn parts(
    model: &NominalModel,
    found: &Findings,
    scale: &Scale,
    causes: &[Cause],
) -> Result<Parts, RobotError> {
    let change: Vec<f64> = found.changes(|_| true).iter().map(|c| c.0).collect();
    let mut rotors = model.robot.rotor_inertia();
    let corrects = |effect: Effect, part| effect.info().correction == Some(part);
    for cause in causes
        .iter()
        .filter(|c| corrects(c.effect, Correction::Rotor))
    {
        if let Some(j) = joint(model, cause) {
            rotors[j] += number(cause, "inertia");
        }
    }
    let moved = model.moved(&change)?.with_rotor_inertia(&rotors)?;
    let n = model.robot.dof();
    let listed = causes.iter().any(|c| corrects(c.effect, Correction::Load));
    let load = load(found).filter(|_| listed);
    let given = model.sizes().joints().iter();
    let mut described: Vec<Inertia> = given.map(|j| j.link.inertia).collect();
    let mut sums: Vec<usize> = (0..n).collect();
    if let Some(load) = &load {
        described.push(*load);
        sums.push(n - 1);
    }
    let information = information(found, scale, PARAMETERS_PER_LINK * n);
    // A load is written with the mass and the centre that are said of it.
    let known = load.map(|_| n);
    let mut bodies = nearest(&described, &sums, known, &moved.parameters(), &information);
    let load = load.and_then(|_| bodies.pop()).map(|inertia| Load {
        link: n - 1,
        inertia,
    });
    let with = |bodies: &[Inertia]| {
        let parameters: Vec<f64> = bodies.iter().flat_map(Inertia::parameters).collect();
        moved.with_parameters(&parameters)
    };
    let unloaded = with(&bodies)?;
    if let Some(load) = &load {
        bodies[load.link] = bodies[load.link].plus(&load.inertia);
    }
    let whole = with(&bodies)?;
    // Friction and placements that no description holds are refused here, not when the file is read.
    Robot::from_urdf_str(&to_urdf(&whole))?;
    Ok(Parts {
        whole,
        unloaded,
        load,
    })
}

/// Load as fitted beside the last link's parameters: its mass and place, with the inertia of a ball of its mass.
fn load(found: &Findings) -> Option<Inertia> {
    let own = found.accepted.iter().find(|a| {
        found.candidates[a.candidate].effect.info().correction == Some(Correction::Load)
    })?;
    let beta: Vec<f64> = own.variables.clone().map(|i| found.tight.1[i]).collect();
    let [mass, x, y, z] = *beta.first_chunk::<4>()?;
    let radius = (3.0 * mass / (4.0 * std::f64::consts::PI * LOAD_DENSITY)).cbrt();
    (mass > 0.0).then(|| {
        let com = Vector3::new(x, y, z) / mass;
        Inertia::from_com(
            mass,
            com,
            Matrix3::identity() * (0.4 * mass * radius * radius),
        )
    })
}

/// Information matrix of the links' parameters on the fitted recording, all other coefficients fixed: Σ_j w_j
/// XᵀX with the inverse error variance w_j of joint j.
fn information(found: &Findings, scale: &Scale, count: usize) -> DMatrix<f64> {
    let (grams, fit) = (&found.grams, found.tight_fit(scale));
    let mut sum = DMatrix::zeros(count, count);
    for (j, weight) in fit.weights.iter().enumerate() {
        let places: Vec<(usize, usize)> = (0..count)
            .filter_map(|c| Some((c, grams.layout.position(j, c)?)))
            .collect();
        for &(a, pa) in &places {
            for &(b, pb) in &places {
                sum[(a, b)] += weight * grams.total[j].xx[[pa, pb]];
            }
        }
    }
    sum
}

/// File of a patch that holds an effect; none: only the table of values. `mjcf`: whether the model is an MJCF,
/// which also holds what a URDF needs a drive file for.
pub fn place(effect: Effect, mjcf: bool) -> Option<&'static str> {
    if effect.info().coded {
        return Some("generated code");
    }
    let Info {
        place, correction, ..
    } = effect.info();
    if mjcf {
        correction.map(|_| "MJCF")
    } else {
        *place
    }
}

/// Name of the file of a patch that holds a cause. None where no file has a place for its effect, or where the cause
/// depends on a quantity that no simulator has.
pub(super) fn place_of(cause: &Cause, mjcf: bool) -> Option<&'static str> {
    let coded = cause.effect.info().coded;
    place(cause.effect, mjcf).filter(|_| !coded || code::holds(cause))
}

/// Value of a cause's parameter called `name`; zero where the cause has no such parameter.
pub(super) fn number(cause: &Cause, name: &str) -> f64 {
    let found = cause.parameters.iter().find(|p| p.name == name);
    found.map_or(0.0, |p| p.value)
}

/// Index of a cause's first joint.
pub(super) fn joint(model: &NominalModel, cause: &Cause) -> Option<usize> {
    let own = cause.joints.first()?;
    model.robot.joints().iter().position(|j| j.name == *own)
}

impl Patched<'_> {
    /// Gravity in the frame of the tilted base, m/s².
    pub(super) fn gravity(&self) -> Vector3<f64> {
        Rotation3::new(-self.tilt) * self.robot.gravity()
    }
}
