//! Six rotating joints: the rigid body's base parameters.

use super::{OutOfReach, Parameter, TorqueModel};
use crate::MachineError;
use crate::description::Description;
use faer::Mat;
use identify::base::{BaseParameters, Extra};
use physics::dynamics::{Workspace, regressor};
use physics::robot::{PARAMETERS_PER_LINK, Robot, STANDARD_GRAVITY, to_urdf};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

/// PUMA (manual: dynamic models 1 and 2), any serial chain of six rotating joints.
///
/// 1. Full: base parameters of the rigid bodies and rotor inertias (Gautier 1991), more than the manual's 23, which take
///    links to be symmetric.
/// 2. Semi-static: base parameters of gravity alone, in N·m; holds for slow motion.
pub struct Puma {
    robot: Robot,
    base: BaseParameters,
    semi_static: bool,
}

impl Puma {
    /// The model of a description and its robot's URDF.
    ///
    /// # Errors
    /// No robot, or one of another number or kind of joints.
    pub(crate) fn new(description: &Description) -> Result<(Self, String), MachineError> {
        let Some(given) = &description.geometry.robot else {
            return Err(description
                .wrong("needs geometry.robot: a built-in robot or the path of a URDF".to_owned()));
        };
        // A stored model holds the text itself.
        let robot = if given.trim_start().starts_with('<') {
            Robot::from_urdf_str(given)?
        } else {
            Robot::load(given, &[])?.0
        };
        let rotating = robot.joints().iter().all(|j| j.kind.is_rotation());
        if robot.dof() != 6 || !rotating {
            return Err(description.wrong(format!(
                "{} is no chain of six rotating joints; give one, or use train for other chains",
                robot.name()
            )));
        }
        // A machine's model is stored with a URDF, which holds none of these.
        let elsewhere = [
            (
                robot.gravity() != STANDARD_GRAVITY,
                "another gravity than (0, 0, -9.81) m/s²",
            ),
            (!robot.passive().is_empty(), "springs or a counterbalance"),
            (
                robot.gravity_compensation().iter().any(|c| *c != 0.0),
                "compensated gravity",
            ),
        ];
        if let Some((_, what)) = elsewhere.iter().find(|(has, _)| *has) {
            return Err(description.wrong(format!(
                "{} has {what}, which this machine's model does not know; use train",
                robot.name()
            )));
        }
        let semi_static = description.dynamic_model == 2;
        let base = if semi_static {
            gravity_parameters(&robot)
        } else {
            BaseParameters::of_robot(&robot, &[Extra::RotorInertia])
        };
        let urdf = to_urdf(&robot);
        let model = Self {
            robot,
            base,
            semi_static,
        };
        Ok((model, urdf))
    }
}

/// Base parameters of the static torque. Any states in general position serve, hence a fixed seed.
fn gravity_parameters(robot: &Robot) -> BaseParameters {
    let (n, width) = (robot.dof(), PARAMETERS_PER_LINK * robot.dof());
    let states = 2 * width;
    let mut rng = ChaCha8Rng::seed_from_u64(0x5eed);
    let mut workspace = Workspace::new(robot);
    let mut samples = Mat::zeros(states * n, width);
    let (mut y, rest) = (vec![0.0; n * width], vec![0.0; n]);
    for state in 0..states {
        let q: Vec<f64> = (0..n).map(|_| rng.random_range(-PI..PI)).collect();
        regressor(robot, &mut workspace, &q, &rest, &rest, &mut y);
        for (k, value) in y.iter().enumerate() {
            samples[(state * n + k / width, k % width)] = *value;
        }
    }
    // First moments before masses, links nearer the base first.
    let moments = (0..n).flat_map(|link| [1, 2, 3].map(|k| PARAMETERS_PER_LINK * link + k));
    let masses = (0..n).map(|link| PARAMETERS_PER_LINK * link);
    let rest = (0..width).filter(|c| c % PARAMETERS_PER_LINK > 3);
    let order: Vec<usize> = moments.chain(masses).chain(rest).collect();
    BaseParameters::from_samples(samples.as_ref(), robot.parameter_names(), &order)
}

impl TorqueModel for Puma {
    fn parameters(&self) -> Vec<Parameter> {
        let unit = |name: &str| {
            if self.semi_static {
                return "N·m";
            }
            match name.chars().next() {
                Some('I') => "kg·m²",
                _ if name.starts_with("mx") || name.starts_with("my") || name.starts_with("mz") => {
                    "kg·m"
                }
                _ => "kg",
            }
        };
        let names = self.base.base_names();
        names
            .into_iter()
            .map(|name| {
                let unit = unit(&name);
                if self.semi_static {
                    Parameter::new(format!("g·{name}"), unit)
                } else {
                    Parameter::new(name, unit)
                }
            })
            .collect()
    }

    fn rows(&self, q: &[f64], qd: &[f64], qdd: &[f64], rows: &mut [f64]) -> Result<(), OutOfReach> {
        let n = self.robot.dof();
        let rigid = PARAMETERS_PER_LINK * n;
        let mut y = vec![0.0; n * rigid];
        let mut workspace = Workspace::new(&self.robot);
        let columns = self.base.independent();
        if self.semi_static {
            let rest = vec![0.0; n];
            regressor(&self.robot, &mut workspace, q, &rest, &rest, &mut y);
        } else {
            regressor(&self.robot, &mut workspace, q, qd, qdd, &mut y);
        }
        let gravity = if self.semi_static {
            self.robot.gravity().norm()
        } else {
            1.0
        };
        for (joint, row) in rows.chunks_exact_mut(columns.len()).enumerate() {
            for (value, &column) in row.iter_mut().zip(columns) {
                *value = if column < rigid {
                    y[joint * rigid + column] / gravity
                } else if column - rigid == joint {
                    qdd[joint]
                } else {
                    0.0
                };
            }
        }
        Ok(())
    }

    fn is_semi_static(&self) -> bool {
        self.semi_static
    }

    /// The ten standard parameters in the last joint's frame; of the semi-static model mass and first moments, as weights.
    fn payload(&self, _values: &[f64]) -> Vec<(Parameter, Vec<f64>)> {
        let n = self.robot.dof();
        let (told, extra, weight) = if self.semi_static {
            (4, 0, self.robot.gravity().norm())
        } else {
            (PARAMETERS_PER_LINK, n, 1.0)
        };
        let names = [
            "mass", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz",
        ];
        let unit = |k: usize| match k {
            0 => "kg",
            1..=3 => "kg·m",
            _ => "kg·m²",
        };
        (0..told)
            .map(|k| {
                let mut all = vec![0.0; PARAMETERS_PER_LINK * n + extra];
                all[PARAMETERS_PER_LINK * (n - 1) + k] = weight;
                (Parameter::new(names[k], unit(k)), self.base.base_from(&all))
            })
            .collect()
    }
}
