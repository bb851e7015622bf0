//! Corrected simulator as files: the model with its drives, and the values for other simulators.

mod changes;

use crate::arm::Arm;
use crate::command::Interpolation;
use crate::given::Given;
use model::preparation::setup::Setup;
use physics::robot::{Changed, Description, DriveEdit, Robot, RobotError};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Reason why the corrected simulator cannot be turned into files.
#[derive(Debug, thiserror::Error)]
pub enum PatchError {
    /// Corrected robot that is invalid, or that the description's format cannot hold.
    #[error("the corrected model cannot be written: {0}")]
    Robot(#[from] RobotError),
}

/// Files of a corrected simulator.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Path and text of each file, the model first.
    pub files: Vec<(PathBuf, String)>,
    /// Corrections in words that the model's format has no place for.
    pub left_out: Vec<String>,
    /// What the files change, by joint: "forearm: kp 150 → 120". It is empty where the model is as given.
    pub changes: Vec<String>,
}

/// Files of the corrected arm `arm`: the description with its values, a drive file, and the values for Isaac Lab and Newton.
/// `out` is the path of the description, and the others are named after it. `whole` has every cause, also what no file
/// holds. Nothing is written here.
///
/// # Errors
/// Corrected robot that the format cannot hold.
pub fn patch(
    setup: &Setup,
    given: &Given,
    [arm, whole]: [&Arm; 2],
    out: &Path,
) -> Result<Patch, PatchError> {
    let robot = corrected(arm)?;
    let mut left_out = Vec::new();
    let mut changes = changes::changes(given, arm);
    let mut files = match &setup.description {
        Description::Mjcf(mjcf) => {
            let edits = edits(arm, mjcf)?;
            let late: Vec<bool> = edits.iter().map(|e| e.delay.is_none()).collect();
            left_out.extend(outside(given, [arm, whole], &late));
            let edited = mjcf.with_drives(&robot, &arm.zero, &edits)?;
            changes.extend(changes::held_at_rest(arm));
            left_out.extend(edited.left_out().iter().cloned());
            edited.files(out)?
        }
        Description::Urdf(urdf) => {
            left_out.extend(outside(given, [arm, whole], &vec![true; arm.dof()]));
            left_out.extend(outside_urdf(arm));
            vec![(out.to_owned(), urdf.with(&Changed::of(&robot))?)]
        }
    };
    // A URDF has no place for them; an MJCF holds them as `armature`.
    let rotors = matches!(setup.description, Description::Urdf(_));
    files.extend(tables(given, arm, rotors, out));
    Ok(Patch {
        files,
        left_out,
        changes,
    })
}

/// Files of the simulator as given: the description with no number changed, and its drives for other simulators.
///
/// # Errors
/// As for [`patch`].
pub fn unchanged(setup: &Setup, given: &Given, out: &Path) -> Result<Patch, PatchError> {
    let same = Changed::of(&setup.robot);
    let (mut files, rotors) = match &setup.description {
        Description::Mjcf(mjcf) => (mjcf.with(&same)?.files(out)?, false),
        Description::Urdf(urdf) => (vec![(out.to_owned(), urdf.with(&same)?)], true),
    };
    files.extend(tables(given, &given.arm, rotors, out));
    Ok(Patch {
        files,
        left_out: Vec::new(),
        changes: Vec::new(),
    })
}

/// Drive file, and the values for Isaac Lab and Newton, with their paths beside `out`.
fn tables(given: &Given, arm: &Arm, rotors: bool, out: &Path) -> [(PathBuf, String); 3] {
    let beside = |ending: &str| out.with_extension(ending);
    [
        (beside("drive.toml"), drive_file(given, arm, rotors)),
        (beside("isaaclab.py"), isaac_lab(arm)),
        (beside("newton.json"), newton(arm)),
    ]
}

/// Robot with the arm's rigid bodies, viscous and Coulomb friction, and rotor inertia.
fn corrected(arm: &Arm) -> Result<Robot, RobotError> {
    let each =
        |f: fn(&crate::arm::Joint) -> f64| -> Vec<f64> { arm.joints.iter().map(f).collect() };
    arm.robot
        .clone()
        .with_friction(&each(|j| j.damping), &each(|j| j.coulomb))?
        .with_rotor_inertia(&each(|j| j.armature))
}

/// New gains, force limit and delay of each joint's actuator in the MJCF. It is empty for actuators without gains (motors),
/// whose gains stand in the drive file.
fn edits(arm: &Arm, mjcf: &physics::robot::Mjcf) -> Result<Vec<DriveEdit>, RobotError> {
    let actuators = mjcf.actuators()?;
    Ok(arm
        .servos
        .iter()
        .zip(actuators)
        .enumerate()
        .map(|(j, (s, actuator))| {
            let Some(actuator) = actuator.filter(|a| a.gains().is_some()) else {
                return DriveEdit::default();
            };
            let limit = s.limit.min(s.drive_limit);
            DriveEdit {
                kp: Some(s.kp),
                kv: Some(s.kd),
                force: limit.is_finite().then_some([-limit, limit]),
                // What the actuator smooths, it delays itself.
                delay: Some((arm.late(j) - actuator.lag.unwrap_or(0.0)).max(0.0)),
            }
        })
        .collect())
}

/// Corrections in words that neither the model nor its actuators can hold: command offsets, friction by load or at
/// standstill and couplings of the arm `whole`, gravity compensation, and the delays of those joints that `late` marks.
fn outside(given: &Given, [arm, whole]: [&Arm; 2], late: &[bool]) -> Vec<String> {
    let mut out = Vec::new();
    let names = arm.robot.joint_names();
    for (j, name) in names.iter().enumerate() {
        let (s, joint) = (&arm.servos[j], &whole.joints[j]);
        let mut say = |what: &str, value: f64, unit: &str| {
            if value != 0.0 {
                let line = format!("{name}: {what} {} {unit}", crate::words::number(value));
                // A part has no unit.
                out.push(line.trim_end().to_owned());
            }
        };
        if late[j] {
            say(
                "delay of commands",
                arm.late(j) - given.arm.late(j),
                "s (shift the commands)",
            );
        }
        say(
            "zero of the command",
            s.offset,
            "rad (add it to the commands)",
        );
        say("Stribeck friction", joint.stribeck, "N·m");
        say("friction per torque", joint.load, "");
        for (driver, motor) in names.iter().enumerate() {
            let ratio = whole.coupling[j * names.len() + driver];
            say(&format!("turn of its motor per turn of {motor}"), ratio, "");
        }
    }
    if arm.gravity_compensation != given.arm.gravity_compensation {
        out.push(format!(
            "gravity compensation by the drives: {:.2} of it",
            arm.gravity_compensation
        ));
    }
    out
}

/// Corrections in words that a URDF cannot hold: encoder offsets and a tilted base.
fn outside_urdf(arm: &Arm) -> Vec<String> {
    let number = crate::words::number;
    let mut out = Vec::new();
    for (name, zero) in arm.robot.joint_names().iter().zip(&arm.zero) {
        if *zero != 0.0 {
            out.push(format!(
                "{name}: zero of the encoder {} rad (add it to the recorded positions)",
                number(*zero)
            ));
        }
    }
    if arm.tilt != [0.0; 2] {
        let [x, y, z] = arm.robot.gravity().into();
        out.push(format!(
            "tilt of the base: gravity {}, {}, {} m/s² in the base frame (set it in the simulator)",
            number(x),
            number(y),
            number(z)
        ));
    }
    out
}

/// Numbers as a TOML list.
fn list(values: impl Iterator<Item = f64>) -> String {
    let words: Vec<String> = values.map(|v| format!("{v:.6}")).collect();
    format!("[{}]", words.join(", "))
}

/// Drive file with the block `[controller]` and the arm's drives as its values; with `rotors` the rotor inertias as well.
fn drive_file(given: &Given, arm: &Arm, rotors: bool) -> String {
    let s = &arm.servos;
    let mut text = String::new();
    if rotors && arm.joints.iter().any(|j| j.armature > 0.0) {
        let inertias = list(arm.joints.iter().map(|j| j.armature));
        let _ = writeln!(text, "rotor_inertia = {inertias}\n");
    }
    text.push_str("[controller]\n");
    let mut line = |key: &str, value: String| {
        let _ = writeln!(text, "{key} = {value}");
    };
    line("kind", format!("\"{}\"", given.controller));
    match given.controller {
        "dc_servo" => {
            line("torque_per_error", list(s.iter().map(|s| s.kp)));
            if s.iter().any(|s| s.back_emf > 0.0) {
                line("back_emf", list(s.iter().map(|s| s.back_emf)));
            }
            if s.iter().all(|s| s.drive_limit.is_finite()) {
                line("voltage", list(s.iter().map(|s| s.drive_limit)));
            }
        }
        "cascade" => {
            line("kp", list(s.iter().map(|s| s.kp / s.kd)));
            line("kp_velocity", list(s.iter().map(|s| s.kd)));
            if s.iter().any(|s| s.ki > 0.0) {
                line("ki_velocity", list(s.iter().map(|s| s.ki)));
            }
        }
        kind => {
            line("kp", list(s.iter().map(|s| s.kp)));
            line("kd", list(s.iter().map(|s| s.kd)));
            if kind == "pid" {
                line("ki", list(s.iter().map(|s| s.ki)));
            }
        }
    }
    if given.interpolation == Interpolation::Linear {
        line("interpolation", "\"linear\"".to_owned());
    }
    if s.iter().all(|s| s.limit.is_finite()) {
        line("limit", list(s.iter().map(|s| s.limit)));
    }
    line("delay", list((0..arm.dof()).map(|j| arm.late(j))));
    if arm.gravity_compensation == 0.0 || arm.gravity_compensation == 1.0 {
        line(
            "gravity_compensation",
            (arm.gravity_compensation == 1.0).to_string(),
        );
    }
    text
}

/// Actuators for Isaac Lab as Python text, one configuration for each joint. Delays are in seconds; the reader turns
/// them into physics steps.
fn isaac_lab(arm: &Arm) -> String {
    let mut text = String::from(
        "\"\"\"Actuators for Isaac Lab by joint. For a delay use DelayedPDActuatorCfg with round(delay / dt) steps.\"\"\"\n\n\
         from isaaclab.actuators import ImplicitActuatorCfg\n\nDELAY = {  # s\n",
    );
    let names = arm.robot.joint_names();
    for (j, name) in names.iter().enumerate() {
        let _ = writeln!(text, "    {name:?}: {:.6},", arm.late(j));
    }
    text.push_str("}\n\nACTUATORS = {\n");
    for ((name, s), j) in names.iter().zip(&arm.servos).zip(&arm.joints) {
        let limit = s.limit.min(s.drive_limit);
        let limit = if limit.is_finite() {
            format!("{limit:.6}")
        } else {
            "None".to_owned()
        };
        let _ = writeln!(
            text,
            "    {name:?}: ImplicitActuatorCfg(\n        joint_names_expr=[{name:?}],\n        stiffness={:.6},\n        damping={:.6},\n        \
             effort_limit_sim={limit},\n        armature={:.6},\n        friction={:.6},\n        viscous_friction={:.6},\n    ),",
            s.kp,
            s.kd + s.back_emf,
            j.armature,
            j.coulomb,
            j.damping
        );
    }
    text.push_str("}\n");
    text
}

/// Joint attributes for Newton as JSON text, by joint name, per radian. Newton's USD attribute for damping is per
/// degree.
fn newton(arm: &Arm) -> String {
    let mut joints = serde_json::Map::new();
    for ((name, s), j) in arm
        .robot
        .joint_names()
        .into_iter()
        .zip(&arm.servos)
        .zip(&arm.joints)
    {
        let limit = s.limit.min(s.drive_limit);
        joints.insert(
            name,
            serde_json::json!({
                "target_ke": s.kp,
                "target_kd": s.kd + s.back_emf,
                "effort_limit": limit.is_finite().then_some(limit),
                "armature": j.armature,
                "friction": j.coulomb,
                "damping": j.damping,
            }),
        );
    }
    let text = serde_json::to_string_pretty(&joints).expect("numbers and names are plain data");
    text + "\n"
}
