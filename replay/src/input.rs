//! Input of a diagnosis: the simulator as given, from a robot and its drive file, and prepared recordings.

use crate::arm::{Arm, Integral, Servo};
use crate::check::Unusable;
use crate::command::Interpolation;
use crate::given::Given;
use crate::parameter::{Kind, Parameter};
use crate::tracks::{Replayed, prepare};
use datasets::recording::Invalid;
use datasets::{Part, Recording};
use model::preparation::setup::{Setup, SetupError};
use physics::robot::drive::{Controller, ControllerKind, Drive, Interpolation as Filled, Key};
use physics::robot::{Actuator, Description, Robot, RobotError};
use std::path::{Path, PathBuf};

/// First guess of an unknown proportional gain, N·m/rad per kg·m² of the inertia that the joint moves. It is a natural
/// frequency of 5 Hz, as arms under position control have.
const STIFFNESS: f64 = 1000.0;

/// Reason why the input cannot be diagnosed.
#[derive(Debug, thiserror::Error)]
pub enum InputError {
    /// Robot, drive file or recording that cannot be read.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// Description whose actuators cannot be read.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// Recording that cannot be replayed.
    #[error(transparent)]
    Unusable(#[from] Unusable),
    /// Recording whose tables do not belong together.
    #[error("{source_name}: {invalid}")]
    Invalid {
        /// Source of the recording.
        source_name: String,
        /// First fault of its tables.
        invalid: Invalid,
    },
    /// Recording with another number of joints than the robot.
    #[error("{source_name}: has {found} joints, the robot has {expected}")]
    Joints {
        /// Source of the recording.
        source_name: String,
        /// Number of joints of the recording.
        found: usize,
        /// Number of joints of the robot.
        expected: usize,
    },
    /// Robot without any statement about the controller of its drives.
    #[error(
        "{robot} says nothing of the drives' controller; write it into a drive file and give that by --drive:\n\n{block}"
    )]
    NoController {
        /// Name of the robot.
        robot: String,
        /// Text of the block `[controller]` that the user can complete.
        block: String,
    },
    /// Actuator of the MJCF that is no position servo.
    #[error(
        "joint {joint} is driven by {law}, which is no position servo; say by [controller] in a drive file how its torque \
         follows from its command"
    )]
    Law {
        /// Name of the joint.
        joint: String,
        /// Control law of the actuator, in words.
        law: String,
    },
}

/// Robot to diagnose: its description, and the simulator as given.
#[derive(Debug)]
pub struct Subject {
    /// Robot, description and drive file, with the columns and units of its recordings.
    pub setup: Setup,
    /// Simulator as given, with the drives of the drive file or else of the description.
    pub given: Given,
}

impl Subject {
    /// Reads the description of `robot` (path or built-in name) and the drive file. `joints` empty: all of the
    /// description.
    ///
    /// # Errors
    /// Files that cannot be used, or that do not describe the controller.
    pub fn read(
        robot: &str,
        joints: &[String],
        drive: Option<&Path>,
        gravity: Option<[f64; 3]>,
    ) -> Result<Self, InputError> {
        Self::new(Setup::with_joints(robot, joints, drive, gravity)?)
    }

    /// Subject of a robot in memory whose drives the block `[controller]` of `drive` describes.
    ///
    /// # Errors
    /// A drive file that does not fit the robot, or that does not describe the controller.
    pub fn of(robot: Robot, drive: Drive) -> Result<Self, InputError> {
        Self::new(Setup::driven(robot, Some(drive))?)
    }

    /// Subject of a setup: the drives are those of its drive file, or else of its description.
    fn new(setup: Setup) -> Result<Self, InputError> {
        let controller = setup.drive.as_ref().and_then(|d| d.controller.as_ref());
        let mut given = match controller {
            Some(controller) => by_block(&setup, controller),
            None => by_actuators(&setup)?,
        };
        given
            .notes
            .extend(setup.robot.findings().iter().map(ToString::to_string));
        given.notes.extend(setup.robot.notes().iter().cloned());
        Ok(Self { setup, given })
    }

    /// Reads recordings for one purpose: to be fitted or held out.
    ///
    /// # Errors
    /// Recording that cannot be read.
    pub fn recordings(&self, paths: &[PathBuf], part: Part) -> Result<Vec<Recording>, InputError> {
        let read = |path: &PathBuf| self.recording(path, part);
        paths.iter().map(read).collect()
    }

    /// Reads a recording for one purpose: to be fitted or held out.
    ///
    /// # Errors
    /// Recording that cannot be read.
    pub fn recording(&self, path: &Path, part: Part) -> Result<Recording, InputError> {
        Ok(self.setup.read_one(path, part, false)?)
    }

    /// Prepares recordings to be replayed together; none where there is no recording.
    ///
    /// # Errors
    /// Recording that cannot be replayed.
    pub fn prepared(&self, recordings: &[Recording]) -> Result<Option<Replayed>, InputError> {
        let mut out: Option<Replayed> = None;
        let mut first = 0;
        for recording in recordings {
            self.fits(recording)?;
            let lags = self.given.lags(recording.qd_ref.is_some());
            let replayed = prepare(recording, self.given.interpolation, first, &lags)?;
            first += recording.trajectories.len();
            match &mut out {
                Some(all) => all.join(replayed),
                None => out = Some(replayed),
            }
        }
        Ok(out)
    }

    /// Refuses a recording that is not of this robot, or that has no sample. Readers refuse such files before.
    fn fits(&self, recording: &Recording) -> Result<(), InputError> {
        let source_name = || recording.source.clone();
        let (found, expected) = (recording.dof(), self.setup.robot.dof());
        if found != expected {
            return Err(InputError::Joints {
                source_name: source_name(),
                found,
                expected,
            });
        }
        recording.validate().map_err(|invalid| InputError::Invalid {
            source_name: source_name(),
            invalid,
        })
    }
}

/// Drive without gains, limits and delays.
fn idle() -> Servo {
    Servo {
        kp: 0.0,
        kd: 0.0,
        ki: 0.0,
        integral: Integral::None,
        back_emf: 0.0,
        drive_limit: f64::INFINITY,
        limit: f64::INFINITY,
        delay: 0.0,
        lag: 0.0,
        offset: 0.0,
    }
}

/// Simulator with the drives that the block `[controller]` of the drive file describes.
fn by_block(setup: &Setup, block: &Controller) -> Given {
    let robot = &setup.robot;
    let n = robot.dof();
    let values = |key: Key| block.values(key, n);
    let start: Vec<f64> = starts(robot);
    let mut servos = vec![idle(); n];
    let mut tolerances = Vec::new();
    let mut free = Vec::new();
    let mut set =
        |key: Key, kind: Kind, start: &dyn Fn(usize) -> f64, put: &mut dyn FnMut(usize, f64)| {
            let given = values(key);
            for j in 0..n {
                let parameter = Parameter::new(kind, j);
                if block.is_free(key) {
                    free.push(parameter);
                } else if given.is_some() && block.tolerance(key) > 0.0 {
                    tolerances.push((parameter, block.tolerance(key)));
                }
                match &given {
                    Some(given) => put(j, given[j]),
                    None if block.is_free(key) => put(j, start(j)),
                    None => {}
                }
            }
        };
    let zero = |_: usize| 0.0;
    let gain = |j: usize| start[j];
    // Critical damping for the first guess of the gain.
    let damped = |j: usize| 2.0 * start[j] / STIFFNESS.sqrt();
    match block.kind {
        ControllerKind::Pd | ControllerKind::Pid => {
            set(Key::Kp, Kind::Gain, &gain, &mut |j, v| servos[j].kp = v);
            set(Key::Kd, Kind::ServoDamping, &damped, &mut |j, v| {
                servos[j].kd = v
            });
            set(Key::Ki, Kind::Integral, &gain, &mut |j, v| {
                servos[j].ki = v;
                servos[j].integral = Integral::Position;
            });
        }
        ControllerKind::Cascade => {
            // Gains of the cascade: torque = kp_velocity (kp e + e_v) + …, so that kp·kp_velocity acts on the position
            // error.
            set(Key::KpVelocity, Kind::ServoDamping, &damped, &mut |j, v| {
                servos[j].kd = v
            });
            let velocity: Vec<f64> = (0..n).map(|j| servos[j].kd).collect();
            let position = |_: usize| STIFFNESS.sqrt();
            set(Key::Kp, Kind::Gain, &position, &mut |j, v| {
                servos[j].kp = v * velocity[j]
            });
            set(Key::KiVelocity, Kind::Integral, &gain, &mut |j, v| {
                servos[j].ki = v;
                servos[j].integral = Integral::Velocity;
            });
        }
        ControllerKind::DcServo => {
            set(Key::TorquePerError, Kind::Gain, &gain, &mut |j, v| {
                servos[j].kp = v
            });
            set(Key::BackEmf, Kind::Damping, &zero, &mut |j, v| {
                servos[j].back_emf = v
            });
            // First guess: full voltage at a position error of 0.1 rad.
            set(
                Key::Voltage,
                Kind::DriveLimit,
                &|j| 0.1 * start[j],
                &mut |j, v| servos[j].drive_limit = v,
            );
        }
    }
    set(Key::Limit, Kind::Limit, &|j| 0.2 * start[j], &mut |j, v| {
        servos[j].limit = v
    });
    set(Key::Delay, Kind::CommonDelay, &zero, &mut |j, v| {
        servos[j].delay = v
    });
    // Common delay: a free or tolerated delay is one parameter for all joints.
    free.retain(|p| p.kind != Kind::CommonDelay || p.joint == 0);
    tolerances.retain(|(p, _)| p.kind != Kind::CommonDelay || p.joint == 0);
    // Part of the delays that all joints share: it becomes the common delay.
    let common = servos.iter().map(|s| s.delay).fold(f64::INFINITY, f64::min);
    servos.iter_mut().for_each(|s| s.delay -= common);
    let mut arm = Arm::new(robot.clone(), servos);
    arm.delay = common;
    let mut notes = Vec::new();
    match block.gravity_compensation.known() {
        Some(on) => arm.gravity_compensation = f64::from(u8::from(on)),
        None => {
            free.push(Parameter::new(Kind::GravityCompensation, 0));
            notes.push(
                "whether the drives compensate gravity is not known, and is fitted".to_owned(),
            );
        }
    }
    Given {
        arm,
        stated: tolerances.iter().all(|(p, _)| p.kind == Kind::CommonDelay)
            && free
                .iter()
                .all(|p| !matches!(p.kind, Kind::Gain | Kind::ServoDamping)),
        tolerances,
        free,
        interpolation: match block.interpolation {
            Filled::Hold => Interpolation::Hold,
            Filled::Linear => Interpolation::Linear,
        },
        controller: block.kind.name(),
        notes,
        unlimited: Vec::new(),
        earlier: None,
    }
}

/// First guess of each joint's proportional gain, N·m/rad, from the inertia that it moves in the middle of its range.
fn starts(robot: &physics::robot::Robot) -> Vec<f64> {
    let n = robot.dof();
    let mut workspace = physics::dynamics::Workspace::new(robot);
    let mut mass = vec![0.0; n * n];
    let middle = |l: &physics::robot::Limits| {
        if l.lower.is_finite() && l.upper.is_finite() {
            0.5 * (l.lower + l.upper)
        } else {
            0.0
        }
    };
    let q: Vec<f64> = robot.joints().iter().map(|j| middle(&j.limits)).collect();
    physics::dynamics::mass_matrix(robot, &mut workspace, &q, &mut mass);
    (0..n)
        .map(|j| STIFFNESS * (mass[j * n + j] + robot.joints()[j].rotor_inertia))
        .collect()
}

/// Simulator with the drives that the actuators of an MJCF describe.
fn by_actuators(setup: &Setup) -> Result<Given, InputError> {
    let Description::Mjcf(mjcf) = &setup.description else {
        return Err(no_controller(setup));
    };
    let actuators = mjcf.actuators()?;
    let mut servos = Vec::new();
    for (joint, actuator) in setup.robot.joints().iter().zip(&actuators) {
        let Some(actuator) = actuator else {
            return Err(no_controller(setup));
        };
        servos.push(servo(setup, &joint.name, actuator)?);
    }
    Ok(Given {
        arm: Arm::new(setup.robot.clone(), servos),
        tolerances: Vec::new(),
        free: Vec::new(),
        stated: false,
        interpolation: Interpolation::Hold,
        controller: "pd",
        notes: Vec::new(),
        unlimited: Vec::new(),
        earlier: None,
    })
}

/// Drive of a joint from its position servo in the MJCF.
fn servo(setup: &Setup, joint: &str, actuator: &Actuator) -> Result<Servo, InputError> {
    use physics::robot::ActuatorKind;
    let law = match &actuator.kind {
        ActuatorKind::Motor => return Err(no_controller(setup)),
        ActuatorKind::Velocity { .. } => "a velocity servo".to_owned(),
        ActuatorKind::Other(law) => law.clone(),
        _ => String::new(),
    };
    let Some([kp, kd]) = actuator.gains() else {
        return Err(InputError::Law {
            joint: joint.to_owned(),
            law,
        });
    };
    let limit = actuator
        .effort()
        .map_or(f64::INFINITY, |[low, high]| low.abs().max(high.abs()));
    Ok(Servo {
        kp,
        kd,
        limit,
        delay: actuator.delay.unwrap_or(0.0),
        lag: actuator.lag.unwrap_or(0.0),
        ..idle()
    })
}

/// Error for a missing controller, with the block to complete. The block is that of the recipe where the robot is
/// known.
fn no_controller(setup: &Setup) -> InputError {
    let n = setup.robot.dof();
    let list = |v: f64| format!("[{}]", vec![format!("{v}"); n].join(", "));
    let blank = || {
        format!(
            "[controller]\nkind = \"pd\"            # pd, pid, cascade, dc_servo (hobby servos)\nkp = {}   # N·m/rad, as the drive is \
             set\nkd = {}   # N·m·s/rad\ntolerance = 0.0        # relative\ngravity_compensation = \"unknown\"\n\nWhere the gains are \
             not known: kind = \"pd\", free = [\"kp\", \"kd\"].",
            list(100.0),
            list(1.0)
        )
    };
    let robot = setup.robot.name().to_owned();
    InputError::NoController {
        block: crate::known::controller(&robot, n).unwrap_or_else(blank),
        robot,
    }
}
