//! Laws of actuators: force as a function of the control.

use super::attributes::Attributes;
use crate::robot::RobotError;

/// Law of an actuator with the control u, its length l (gear · position) and its speed l̇.
#[derive(Clone, Debug, PartialEq)]
pub enum ActuatorKind {
    /// `<position>`: kp·(u − l) − kv·l̇.
    Position {
        /// Stiffness of the servo at the actuator, N·m/rad (N/m).
        kp: f64,
        /// Damping of the servo at the actuator, N·m·s/rad (N·s/m).
        kv: f64,
    },
    /// Servo of position by `<general>`: kp·(u − l) − kv·l̇.
    Pd {
        /// Stiffness of the servo at the actuator, N·m/rad (N/m).
        kp: f64,
        /// Damping of the servo at the actuator, N·m·s/rad (N·s/m).
        kv: f64,
    },
    /// Servo of velocity: force = kv·(u − l̇).
    Velocity {
        /// Gain on the velocity error, N·m·s/rad (N·s/m).
        kv: f64,
    },
    /// Motor: force = u.
    Motor,
    /// Law beyond these, in words.
    Other(String),
}

/// The first number of an attribute.
pub(super) fn first(a: &Attributes<'_, '_, '_>, name: &str) -> Result<Option<f64>, RobotError> {
    Ok(a.list(name)?.and_then(|list| list.first().copied()))
}

/// The law and the time constant in front of it. A negative kv is a damping ratio.
pub(super) fn law(a: &Attributes<'_, '_, '_>) -> Result<(ActuatorKind, Option<f64>), RobotError> {
    // What <position> and <general> say of gains goes over each other in the defaults.
    let kp = match a.number("kp")? {
        Some(kp) => Some(kp),
        None => first(a, "gainprm")?,
    };
    let servo_by_default = a.get("kp").is_some() || a.get("dampratio").is_some();
    match a.element.tag() {
        "motor" => Ok((ActuatorKind::Motor, None)),
        "position" => {
            let lag = a.number("timeconst")?.filter(|t| *t > 0.0);
            let (kp, kv) = (kp.unwrap_or(1.0), servo_damping(a)?.unwrap_or(0.0));
            Ok((ActuatorKind::Position { kp, kv }, lag))
        }
        "velocity" => {
            let kv = a.number("kv")?;
            // A kv in the defaults may be that of a <position>.
            let kv = kv.filter(|_| a.own("kv") || !servo_by_default);
            Ok((
                ActuatorKind::Velocity {
                    kv: kv.unwrap_or(1.0),
                },
                None,
            ))
        }
        "general" => general(a, kp.unwrap_or(1.0), servo_by_default),
        tag => Ok((ActuatorKind::Other(format!("<{tag}>")), None)),
    }
}

/// kv of a servo; less than zero is a damping ratio.
fn servo_damping(a: &Attributes<'_, '_, '_>) -> Result<Option<f64>, RobotError> {
    let (kv, ratio) = (a.number("kv")?, a.number("dampratio")?.map(|r| -r));
    let written = if a.own("kv") { kv } else { ratio.or(kv) };
    Ok(match written {
        None => a.list("biasprm")?.and_then(|b| b.get(2).map(|b| -b)),
        written => written,
    })
}

fn general(
    a: &Attributes<'_, '_, '_>,
    gain: f64,
    servo_by_default: bool,
) -> Result<(ActuatorKind, Option<f64>), RobotError> {
    let word = |name: &str, default: &str| a.get(name).unwrap_or_else(|| default.to_owned());
    let other = |what: String| Ok((ActuatorKind::Other(format!("<general> with {what}")), None));
    let lag = match word("dyntype", "none").as_str() {
        "none" => None,
        "filter" | "filterexact" => Some(first(a, "dynprm")?.unwrap_or(1.0)),
        dynamics => return other(format!("dyntype {dynamics}")),
    };
    let gains = word("gaintype", "fixed");
    if gains != "fixed" {
        return other(format!("gaintype {gains}"));
    }
    let default = if servo_by_default { "affine" } else { "none" };
    let kind = match word("biastype", default).as_str() {
        "none" => [0.0; 3],
        "affine" => {
            let mut bias = [0.0; 3];
            if servo_by_default {
                bias[1] = -gain;
                bias[2] = -servo_damping(a)?.unwrap_or(0.0);
            }
            let written = a.list("biasprm")?.unwrap_or_default();
            for (bias, value) in bias.iter_mut().zip(written) {
                *bias = value;
            }
            bias
        }
        bias => return other(format!("biastype {bias}")),
    };
    Ok((
        match kind {
            [0.0, 0.0, 0.0] if gain == 1.0 => ActuatorKind::Motor,
            [0.0, 0.0, bias] if bias == -gain && gain > 0.0 => ActuatorKind::Velocity { kv: gain },
            [0.0, bias, damping] if bias == -gain && gain != 0.0 => ActuatorKind::Pd {
                kp: gain,
                kv: -damping,
            },
            bias => {
                return other(format!("gain {gain} and bias {bias:?}"));
            }
        },
        lag,
    ))
}
