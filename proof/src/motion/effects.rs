//! Effects that a case withholds, each as a change of the robot that really moves.

use super::real::{Extra, Real};
use nalgebra::Vector3;
use physics::robot::{Inertia, RobotError};
use plant::arm::scaled;
use plant::mechanism::{GearMesh, Ripple, StribeckKind};
use plant::random::unit_vector;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Names of the effects that are withheld one at a time. `joint_delay` appears as `command_delay` of a joint in the
/// report.
pub const SINGLES: [&str; 15] = [
    "servo_gain",
    "servo_damping",
    "command_delay",
    "joint_delay",
    "effort_limit",
    "gravity_compensation",
    "friction_parameters",
    "stribeck_friction",
    "load_dependent_friction",
    "rotor_inertia",
    "encoder_offset",
    "payload",
    "base_tilt",
    "link_parameters",
    "joint_coupling",
];

/// Names of effects that are outside the catalogue, so that the report can only call them unknown.
pub const OUTSIDE: [&str; 3] = ["detent", "winding", "slack_belt"];

/// True value of a parameter of the real robot.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Truth {
    /// Name of the parameter in the report.
    pub name: String,
    /// Name of the joint; none for a parameter of the whole arm.
    pub joint: Option<String>,
    /// True value, in the parameter's unit.
    pub value: f64,
}

/// Effect that the real robot has and the handed-out description lacks.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Withheld {
    /// Name of the effect in the report.
    pub effect: String,
    /// Name of the joint; none for an effect of the whole arm.
    pub joint: Option<String>,
    /// Name of the joint whose motor turns the effect's joint, too; none but for a coupling.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub driver: Option<String>,
    /// Parameters that the effect changes, with their true values.
    pub parameters: Vec<Truth>,
}

/// Effect at a joint or on the whole arm, whose size is still open.
pub struct Shape {
    /// Name of the effect, one of [`SINGLES`] or [`OUTSIDE`].
    name: &'static str,
    /// Index of the joint; none for the whole arm.
    joint: Option<usize>,
    /// Change of the robot that makes the effect.
    change: Box<Change>,
}

/// Function that gives a robot the effect in a relative size (1 is the common one). It returns names and true values of
/// the changed parameters.
type Change = dyn Fn(&mut Real, f64) -> Result<Vec<(&'static str, f64)>, RobotError>;

impl Shape {
    /// Robot `real` with the effect in a relative size (1 is the common one), and the sealed answer for it.
    ///
    /// # Errors
    /// Bodies that make no robot.
    pub fn put(&self, real: &Real, size: f64) -> Result<(Real, Withheld), RobotError> {
        let mut out = real.clone();
        let values = (self.change)(&mut out, size)?;
        let joint = self.joint.map(|j| real.arm.joints[j].name.clone());
        let effect = if self.name == "joint_delay" {
            "command_delay"
        } else {
            self.name
        };
        let parameters = values
            .into_iter()
            .map(|(name, value)| Truth {
                name: name.to_owned(),
                joint: joint.clone(),
                value,
            })
            .collect();
        let withheld = Withheld {
            effect: effect.to_owned(),
            joint,
            driver: out
                .coupling
                .filter(|_| self.name == "joint_coupling")
                .map(|(_, driver, _)| real.arm.joints[driver].name.clone()),
            parameters,
        };
        Ok((out, withheld))
    }

    /// Index of the effect's joint; none for the whole arm.
    pub fn joint(&self) -> Option<usize> {
        self.joint
    }
}

/// Facts of a case on which the draw of an effect depends.
pub struct Scene<'a> {
    /// Robot without the effect.
    pub real: &'a Real,
    /// Robot as the handed-out description and drive file state it, with gains within their tolerance of the true ones.
    pub stated: &'a Real,
    /// Largest torque of each joint along the commanded motions of the case, N·m.
    pub torque: &'a [f64],
    /// Relative tolerance of the stated gains.
    pub tolerance: f64,
    /// Time between two commands, s.
    pub period: f64,
}

/// Draws joint and details of the effect with this name; none where this robot cannot have it.
pub fn draw(name: &'static str, scene: &Scene, rng: &mut ChaCha8Rng) -> Option<Shape> {
    let real = scene.real;
    let n = real.arm.dof();
    let j = rng.random_range(0..n);
    let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let (torque, inertia) = (scene.torque[j], real.arm.inertia().ok()?[j]);
    let usual = rng.random_range(0.7..1.4);
    let tolerance = scene.tolerance;
    let (kp, kd) = (scene.stated.kp[j], scene.stated.kd[j]);
    let period = scene.period;
    let on = |change: Box<Change>| {
        Some(Shape {
            name,
            joint: Some(j),
            change,
        })
    };
    let whole = |change: Box<Change>| {
        Some(Shape {
            name,
            joint: None,
            change,
        })
    };
    match name {
        // Change of a gain beyond the stated tolerance.
        "servo_gain" => on(Box::new(move |r, s| {
            r.kp[j] = kp * (side * (0.45 * usual * s + 2.5 * tolerance)).exp();
            Ok(vec![("kp", r.kp[j])])
        })),
        "servo_damping" if real.rates => on(Box::new(move |r, s| {
            r.kd[j] = kd * (side * (0.5 * usual * s + 2.5 * tolerance)).exp();
            Ok(vec![("kd", r.kd[j])])
        })),
        "command_delay" => whole(Box::new(move |r, s| {
            let late = (0.6 * period).max(0.012) * usual * s;
            r.late.iter_mut().for_each(|l| *l += late);
            Ok(vec![("delay", late)])
        })),
        "joint_delay" => on(Box::new(move |r, s| {
            r.late[j] += period.max(0.02) * usual * s;
            Ok(vec![("delay", r.late[j])])
        })),
        "effort_limit" => on(Box::new(move |r, s| {
            r.limit[j] = torque * (0.75 - 0.2 * usual * s).max(0.1);
            Ok(vec![("limit", r.limit[j])])
        })),
        "gravity_compensation" => whole(Box::new(move |r, s| {
            r.gravity_compensation += 0.7 * usual * s.min(1.5);
            Ok(vec![("gain", r.gravity_compensation)])
        })),
        "friction_parameters" => {
            let viscous = rng.random_bool(0.5);
            on(Box::new(move |r, s| {
                let joint = &mut r.arm.joints[j];
                joint.friction += 0.12 * torque * usual * s;
                if viscous {
                    joint.damping *= 1.0 + usual * s;
                }
                Ok(vec![
                    ("viscous", joint.damping),
                    ("coulomb", joint.friction),
                ])
            }))
        }
        "stribeck_friction" => {
            let kind = match rng.random_range(0..3) {
                0 => StribeckKind::Lorentz,
                1 => StribeckKind::HalfCosine,
                _ => StribeckKind::Film(rng.random_range(0.02..0.1)),
            };
            let v_s = real.arm.speed()[j] * rng.random_range(0.04..0.1);
            on(Box::new(move |r, s| {
                let size = 0.2 * torque * usual * s;
                let extra = r.boundary(j, size, v_s, kind);
                r.extras.push(extra);
                Ok(vec![("stribeck", size)])
            }))
        }
        "load_dependent_friction" => on(Box::new(move |r, s| {
            let loss = (0.2 * usual * s).min(0.45);
            r.extras.push(Extra::Mesh(GearMesh {
                joint: j,
                loss,
                v_eps: r.arm.v_eps[j],
            }));
            Ok(vec![("load", loss)])
        })),
        "rotor_inertia" => on(Box::new(move |r, s| {
            r.armature[j] += 0.8 * inertia * usual * s;
            Ok(vec![("inertia", r.armature[j])])
        })),
        "encoder_offset" => on(Box::new(move |r, s| {
            r.zero[j] += side * 0.05 * usual * s;
            Ok(vec![("zero", -r.zero[j])])
        })),
        "payload" => {
            let direction = unit_vector(rng);
            let mass: f64 = real.arm.joints.iter().map(|l| l.link.inertia.mass).sum();
            let last = real.arm.joints[n - 1].link.inertia;
            let reach = rng.random_range(0.03..0.12);
            whole(Box::new(move |r, s| {
                let mass = 0.08 * mass * usual * s;
                let com = last.com() + reach * direction;
                let size = nalgebra::Matrix3::identity() * (mass * 0.0016);
                r.arm.attach(&Inertia::from_com(mass, com, size));
                Ok(vec![
                    ("mass", mass),
                    ("com_x", com.x),
                    ("com_y", com.y),
                    ("com_z", com.z),
                ])
            }))
        }
        "base_tilt" => {
            let angle = rng.random_range(0.0..std::f64::consts::TAU);
            whole(Box::new(move |r, s| {
                let tilt = Vector3::new(angle.cos(), angle.sin(), 0.0) * (0.06 * usual * s);
                r.arm.tilt(tilt);
                Ok(vec![("tilt_x", tilt.x), ("tilt_y", tilt.y)])
            }))
        }
        "link_parameters" => on(Box::new(move |r, s| {
            let factor = (side * 0.35 * usual * s).exp();
            let own = &mut r.arm.joints[j].link.inertia;
            *own = scaled(own, factor);
            Ok(vec![("mass_factor", factor)])
        })),
        "joint_coupling" => {
            let driver = if j == 0 || (j + 1 < n && rng.random_bool(0.5)) {
                j + 1
            } else {
                j - 1
            };
            on(Box::new(move |r, s| {
                let ratio = side * 0.25 * usual * s;
                r.coupling = Some((j, driver, ratio));
                Ok(vec![("ratio", ratio)])
            }))
        }
        "detent" => {
            let (order, phase) = (rng.random_range(8.0..24.0), rng.random_range(0.0..6.0));
            on(Box::new(move |r, s| {
                r.extras.push(Extra::Detent(Ripple {
                    joint: j,
                    waves: vec![[order, 0.25 * torque * usual * s, phase]],
                }));
                Ok(Vec::new())
            }))
        }
        "winding" => on(Box::new(move |r, s| {
            let torque = torque * (0.8 / (usual * s));
            r.extras.push(Extra::Winding { joint: j, torque });
            Ok(Vec::new())
        })),
        "slack_belt" if real.arm.disc[j] > 0.0 => on(Box::new(move |r, s| {
            r.extras.push(Extra::Belt {
                joint: j,
                half: 0.02 * usual * s,
                stiffness: inertia * 6e3,
            });
            Ok(Vec::new())
        })),
        _ => None,
    }
}
