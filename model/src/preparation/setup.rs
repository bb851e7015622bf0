//! Setup of a robot and the options for reading its recordings, from the command line's robot and drive file.

use crate::preparation::units::{Degrees, looks_like_percent, refuse_degrees};
use crate::preparation::{torque_band, wrapped};
use datasets::read::named_joints;
use datasets::{
    Affine, ColumnMap, DeclaredFilter, Part, ReadError, ReadOptions, Recording, TorqueFilter,
    overlap, read,
};
use nalgebra::Vector3;
use physics::robot::{
    Builtin, Chains, Description, Robot, RobotError, Urdf,
    drive::{AngleUnit, Conversion, Drive},
    to_urdf,
};
use std::path::{Path, PathBuf};

/// Robot with the options for reading its recordings.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Robot with the data of its drives.
    pub robot: Robot,
    /// Drive file, if one was given.
    pub drive: Option<Drive>,
    /// Source of the robot's description; a URDF for a built-in robot.
    pub description: Description,
    /// Sampling rate of recordings without a time column, Hz.
    pub rate_hz: Option<f64>,
    /// Names of all joints in the description, of which the robot may use some.
    described: Vec<String>,
    /// Low-pass of the recorded torque that was recognised in the training recordings.
    recognised: Option<DeclaredFilter>,
}

/// Factor on the rate of recordings with a known filter up to which other recordings are taken to have it as well.
const AS_FAST: f64 = 1.25;

/// Reason why a robot or a recording cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// Robot or its drive file that cannot be used.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// Recording that cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Recording whose positions are in degrees.
    #[error(transparent)]
    Degrees(#[from] Degrees),
    /// Held-out recording that shares rows with the fitted ones.
    #[error(
        "{heldout}: of its {of} rows {rows} moving rows stand in the recordings that are fitted as well: what is measured on them says nothing; give a \
         recording of its own as --heldout"
    )]
    NotHeldOut {
        /// Name of the held-out recording.
        heldout: String,
        /// Number of rows that are in both.
        rows: usize,
        /// Number of rows of the held-out recording.
        of: usize,
    },
}

/// Refuses a held-out recording that shares rows with the fitted ones.
///
/// # Errors
/// The number of common rows, where there are any.
pub fn refuse_overlap(fitted: &[Recording], heldout: &Recording) -> Result<(), SetupError> {
    match overlap(fitted, heldout) {
        0 => Ok(()),
        rows => Err(SetupError::NotHeldOut {
            heldout: heldout.source.clone(),
            rows,
            of: heldout.len(),
        }),
    }
}

/// Parses a rate in Hz.
///
/// # Errors
/// Not a positive number.
pub fn rate(text: &str) -> Result<f64, String> {
    let rate = text.trim().parse().ok();
    rate.filter(|r: &f64| r.is_finite() && *r > 0.0)
        .ok_or_else(|| "expected a positive number in Hz".into())
}

/// Parses gravity in the base frame, m/s², from `X,Y,Z`.
///
/// # Errors
/// Not three finite numbers.
pub fn gravity(text: &str) -> Result<[f64; 3], String> {
    let parts: Vec<f64> = text
        .split(',')
        .filter_map(|part| part.trim().parse().ok())
        .filter(|value: &f64| value.is_finite())
        .collect();
    match (<[f64; 3]>::try_from(parts), text.matches(',').count()) {
        (Ok(gravity), 2) => Ok(gravity),
        _ => Err("expected three numbers in m/s², for example 0,0,-9.81".into()),
    }
}

impl Setup {
    /// Loads a robot by the name of a built-in or the path of a URDF or MJCF.
    ///
    /// # Errors
    /// No such robot, or a description or drive file that cannot be used.
    pub fn new(
        robot: &str,
        drive: Option<&Path>,
        gravity: Option<[f64; 3]>,
    ) -> Result<Self, SetupError> {
        Self::with_joints(robot, &[], drive, gravity)
    }

    /// Loads a robot with the joints that form it, where its description has more: see [`Description::load`].
    ///
    /// # Errors
    /// As [`Setup::new`], or joints that make no chain.
    pub fn with_joints(
        robot: &str,
        joints: &[String],
        drive: Option<&Path>,
        gravity: Option<[f64; 3]>,
    ) -> Result<Self, SetupError> {
        let (mut loaded, description) = Robot::load(robot, joints)?;
        if let Some(g) = gravity {
            loaded = loaded.with_gravity(Vector3::from(g));
        }
        let mut setup = Self::of(loaded, drive)?;
        if let Some(description) = description {
            setup.described = description.chains()?.joints;
            setup.description = description;
        }
        Ok(setup)
    }

    /// Loads a robot for recordings. Where no joints are given, they are those that the recordings' columns
    /// name, or those of the one chain with as many joints as there are columns.
    ///
    /// # Errors
    /// As [`Setup::with_joints`], or joints of more than one chain.
    pub fn for_recordings(
        robot: &str,
        joints: &[String],
        drive: Option<&Path>,
        gravity: Option<[f64; 3]>,
        recordings: &[PathBuf],
    ) -> Result<Self, SetupError> {
        let load = |joints: &[String]| Self::with_joints(robot, joints, drive, gravity);
        let usual = load(joints);
        let chosen = joints.iter().any(|j| !j.contains('='));
        let file = usual
            .as_ref()
            .map_or(true, |s| s.robot.which_builtin().is_none());
        let Some(first) = recordings.first().filter(|_| !chosen && file) else {
            return usual;
        };
        let chains = match Chains::load(robot) {
            Ok(chains) => chains,
            Err(_) => return usual,
        };
        let with = |names: &[String]| load(&[names, joints].concat());
        let named = named_joints(first, &chains.joints);
        let own = usual.as_ref().map(|s| s.robot.joint_names()).ok();
        if !named.is_empty() && own.as_ref() != Some(&named) {
            let exact = with(&named);
            // A gripper's column beside the arm's is none of the chain.
            let within = |chain: &Vec<String>| chain.iter().all(|j| named.contains(j));
            return match (exact, own.filter(within)) {
                (Err(_), Some(_)) => usual,
                (exact, _) => exact,
            };
        }
        if let Err(SetupError::Robot(error)) = &usual
            && several(error)
        {
            let count = columns(first, drive.is_none());
            let mut fits = chains.chains.iter().filter(|c| Some(c.len()) == count);
            if let (Some(chain), None) = (fits.next(), fits.next()) {
                return with(chain);
            }
        }
        usual
    }

    /// Setup of a robot that is loaded already.
    ///
    /// # Errors
    /// A drive file that cannot be used.
    pub fn of(robot: Robot, drive: Option<&Path>) -> Result<Self, SetupError> {
        let drive = drive
            .map(|path| Drive::from_file(path, &robot))
            .transpose()?;
        Self::driven(robot, drive)
    }

    /// Setup of a robot and a drive file that are loaded already.
    ///
    /// # Errors
    /// A drive file that does not fit the robot.
    pub fn driven(robot: Robot, drive: Option<Drive>) -> Result<Self, SetupError> {
        let robot = match &drive {
            Some(drive) => drive.apply(robot)?,
            None => robot,
        };
        Ok(Self {
            description: Description::Urdf(Urdf::new(to_urdf(&robot), &[])?),
            robot,
            drive,
            rate_hz: None,
            described: Vec::new(),
            recognised: None,
        })
    }

    /// Options for reading this robot's recordings.
    ///
    /// # Errors
    /// A drive file that cannot convert torque.
    pub fn read_options(&self, part: Part, torque_needed: bool) -> Result<ReadOptions, SetupError> {
        let mut options = if self.robot.which_builtin() == Some(Builtin::Kr300) {
            ReadOptions::kr300(part)
        } else {
            ReadOptions {
                part,
                ..ReadOptions::for_robot(self.robot.dof())
            }
        };
        options.torque_needed = torque_needed;
        options.rate_hz = self.rate_hz;
        options.described.clone_from(&self.described);
        options.joints = self
            .robot
            .joints()
            .iter()
            .map(|joint| joint.name.clone())
            .collect();
        options.torque_filter = options.torque_filter.or(self.recognised);
        if let Some(drive) = &self.drive {
            options.columns = column_map(drive, &self.robot)?;
            if let Some(f) = drive.torque_filter {
                let filter = TorqueFilter {
                    order: f.order,
                    cutoff_hz: f.cutoff_hz,
                    ripple_db: f.ripple_db,
                    recognised: false,
                };
                options.torque_filter = Some(filter.always());
            }
        }
        Ok(options)
    }

    /// Reads a recording of this robot.
    ///
    /// # Errors
    /// It cannot be used, or its positions are in a unit that the drive file does not say.
    pub fn read_one(
        &self,
        path: &Path,
        part: Part,
        torque_needed: bool,
    ) -> Result<Recording, SetupError> {
        let mut recording = read(path, &self.read_options(part, torque_needed)?)?;
        refuse_degrees(&self.robot, &recording)?;
        wrapped::unwrap(&self.robot, &mut recording);
        let percent = self
            .declares_degrees()
            .then(|| looks_like_percent(&recording));
        recording.notes.extend(percent.flatten());
        Ok(recording)
    }

    /// Whether the drive file says that positions are in degrees.
    fn declares_degrees(&self) -> bool {
        let unit = self.drive.as_ref().map(|drive| drive.units.angle);
        unit == Some(AngleUnit::Deg)
    }

    /// Reads recordings of this robot.
    ///
    /// # Errors
    /// The first recording that cannot be used.
    pub fn read(
        &self,
        paths: &[PathBuf],
        part: Part,
        torque_needed: bool,
    ) -> Result<Vec<Recording>, SetupError> {
        paths
            .iter()
            .map(|path| self.read_one(path, part, torque_needed))
            .collect()
    }

    /// Reads the training recordings. A low-pass that their torque shows is used where neither they nor the
    /// drive file nor the built-in robot declare one. It then applies to these recordings and to those of their
    /// rate that are read later.
    ///
    /// # Errors
    /// The first recording that cannot be used.
    pub fn read_training(&mut self, paths: &[PathBuf]) -> Result<Vec<Recording>, SetupError> {
        let mut data = self.read(paths, Part::Train, true)?;
        if self
            .read_options(Part::Train, true)?
            .torque_filter
            .is_none()
            && let Some(filter) = torque_band::recognise(&self.robot, &data)
        {
            let fastest = data
                .iter()
                .map(|r| 1.0 / r.median_step())
                .fold(0.0, f64::max);
            self.recognised = Some(known(filter, fastest));
            data.iter_mut().for_each(|r| r.torque_filter = Some(filter));
        }
        Ok(data)
    }
}

/// Whether a description was refused because it has several chains.
fn several(error: &RobotError) -> bool {
    match error {
        RobotError::SeveralChains { .. } => true,
        RobotError::InFile { source, .. } => several(source),
        _ => false,
    }
}

/// Number of joints of a recording with numbered columns; none where it cannot be read without a drive file.
fn columns(path: &Path, plain: bool) -> Option<usize> {
    let options = ReadOptions::default();
    plain.then(|| read(path, &options).ok().map(|r| r.dof()))?
}

/// Declared filter for recordings of about `rate_hz`.
pub fn known(filter: TorqueFilter, rate_hz: f64) -> DeclaredFilter {
    DeclaredFilter {
        up_to_hz: filter.decimated().up_to_hz.max(AS_FAST * rate_hz),
        filter,
    }
}

/// Map from a recording's columns to quantities in SI units: names, scales and offsets of the drive file.
///
/// # Errors
/// Drive file that cannot convert torque.
fn column_map(drive: &Drive, robot: &Robot) -> Result<ColumnMap, SetupError> {
    let affine = |list: Vec<Conversion>| -> Vec<Affine> {
        list.into_iter()
            .map(|c| Affine {
                scale: c.scale,
                offset: c.offset,
            })
            .collect()
    };
    let position = affine(drive.position_conversion(robot));
    let rate = affine(drive.rate_conversion(robot));
    let torque = affine(drive.torque_conversion(robot)?);
    Ok(ColumnMap::of_drive(
        drive.columns.clone(),
        position,
        rate,
        torque,
        drive.time_scale(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use physics::robot::Changed;

    #[test]
    fn a_name_in_a_urdf_makes_no_built_in_robot() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("arm.urdf");
        let text = to_urdf(&Robot::builtin("foxbot_a05").unwrap())
            .replace("robot name=\"foxbot_a05\"", "robot name=\"kr300\"");
        std::fs::write(&path, &text).unwrap();
        let setup = Setup::new(path.to_str().unwrap(), None, None).unwrap();
        assert_eq!(setup.robot.name(), "kr300");
        let options = setup.read_options(Part::Train, true).unwrap();
        assert!(!options.kr300 && options.torque_filter.is_none());
        // The text that a patch goes into is the user's, to the byte.
        let Description::Urdf(own) = &setup.description else {
            panic!("a URDF");
        };
        assert_eq!(own.text(), text);
        assert!(own.with(&Changed::of(&setup.robot)).is_ok());
        let options = Setup::new("kr300", None, None)
            .unwrap()
            .read_options(Part::Train, true)
            .unwrap();
        assert!(options.kr300 && options.torque_filter.is_some());
    }

    #[test]
    fn gravity_from_text() {
        assert_eq!(gravity("0,0,-9.81"), Ok([0.0, 0.0, -9.81]));
        assert_eq!(gravity("-1, 0.5, 0"), Ok([-1.0, 0.5, 0.0]));
        for wrong in ["0,0", "0,0,0,0", "0,0,x", "0,0,inf", "1,,2,3", ""] {
            assert!(gravity(wrong).is_err(), "{wrong}");
        }
    }

    /// The chain is the one that the columns name, or the one that has as many joints.
    #[test]
    fn a_recording_chooses_the_chain() {
        let body = |name: &str| {
            format!(
                "<link name=\"{name}\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.012\" izz=\"0.009\"/></inertial></link>"
            )
        };
        let joint = |name: &str, from: &str, to: &str| {
            format!(
                "{}<joint name=\"{name}\" type=\"continuous\"><parent link=\"{from}\"/><child link=\"{to}\"/><axis xyz=\"0 1 0\"/></joint>",
                body(to)
            )
        };
        let urdf = format!(
            "<robot name=\"r\"><link name=\"base\"/>{}{}{}</robot>",
            joint("arm_2", "base", "a"),
            joint("arm_1", "a", "b"),
            joint("head_pan", "base", "c"),
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.urdf");
        std::fs::write(&path, urdf).unwrap();
        let robot = path.to_str().unwrap();
        let chain = |header: &str| -> Result<String, String> {
            let file = folder.path().join("d.csv");
            let columns = header.matches(',').count();
            let row = |k: usize| {
                let cells: Vec<String> = (0..columns).map(|c| format!("{}", (k + c) % 7)).collect();
                format!("{},{}\n", 0.01 * k as f64, cells.join(","))
            };
            let rows: String = (0..40).map(row).collect();
            std::fs::write(&file, format!("{header}\n{rows}")).unwrap();
            Setup::for_recordings(robot, &[], None, None, &[file])
                .map(|s| s.robot.joint_names().join(","))
                .map_err(|e| e.to_string())
        };
        for (header, expected) in [
            ("time,q_arm_1,q_arm_2,tau_arm_1,tau_arm_2", "arm_2,arm_1"),
            ("time,head_pan.pos,head_pan.effort", "head_pan"),
            ("time,q1,q2,tau1,tau2", "arm_2,arm_1"),
            ("time,q1,tau1", "head_pan"),
        ] {
            assert_eq!(chain(header).as_deref(), Ok(expected), "{header}");
        }
        let tree = chain("time,q_arm_2,q_arm_1,q_head_pan,tau_arm_2,tau_arm_1,tau_head_pan");
        assert!(tree.unwrap_err().contains("do not lie on one chain"));
        assert!(
            chain("time,q1,q2,q3,tau1,tau2,tau3")
                .unwrap_err()
                .contains("they begin at")
        );
    }
}
