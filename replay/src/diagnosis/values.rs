//! Values of causes and drives for the report, with their names and units.

use super::spread::{Spread, centre, deviation};
use crate::arm::Arm;
use crate::decide::Found;
use crate::given::Given;
use crate::parameter::{Kind, Parameter, Scale};
use crate::schema::{Controller, Value};
use physics::robot::JointKind;

/// Name and unit of a parameter in the report. `rotates`: whether its joint is rotary.
pub(super) fn named(kind: Kind, rotates: bool) -> (&'static str, &'static str) {
    let unit = |r: &'static str, t: &'static str| if rotates { r } else { t };
    match kind {
        Kind::Gain => ("kp", unit("N·m/rad", "N/m")),
        Kind::ServoDamping => ("kd", unit("N·m·s/rad", "N·s/m")),
        Kind::Integral => ("ki", unit("N·m/(rad·s)", "N/(m·s)")),
        Kind::DriveLimit => ("voltage", unit("N·m", "N")),
        Kind::Limit => ("limit", unit("N·m", "N")),
        Kind::Delay | Kind::CommonDelay => ("delay", "s"),
        Kind::Lag => ("lag", "s"),
        Kind::Offset => ("command_zero", unit("rad", "m")),
        Kind::Damping => ("viscous", unit("N·m·s/rad", "N·s/m")),
        Kind::Coulomb => ("coulomb", unit("N·m", "N")),
        Kind::Stribeck => ("stribeck", unit("N·m", "N")),
        Kind::StribeckVelocity => ("stribeck_velocity", unit("rad/s", "m/s")),
        Kind::Load => ("load", "1"),
        Kind::Armature => ("inertia", unit("kg·m²", "kg")),
        Kind::GravityCompensation => ("gain", "1"),
        Kind::Payload(0) => ("mass", "kg"),
        Kind::Payload(1) => ("com_x", "m"),
        Kind::Payload(2) => ("com_y", "m"),
        Kind::Payload(3) => ("com_z", "m"),
        Kind::Payload(_) => ("inertia", "kg·m²"),
        Kind::LinkScale => ("mass_factor", "1"),
        Kind::Tilt(0) => ("tilt_x", "rad"),
        Kind::Tilt(_) => ("tilt_y", "rad"),
        Kind::Coupling(_) => ("ratio", "1"),
        Kind::Zero => ("zero", unit("rad", "m")),
        Kind::Unknown(_) => ("unknown", unit("N·m", "N")),
    }
}

/// Given and fitted values of the parameters that these mechanisms free.
pub(super) fn values(
    given: &Given,
    found: &Found,
    spread: &Spread,
    members: &[usize],
    joints: &[String],
) -> Vec<Value> {
    let mut out = Vec::new();
    for &m in members {
        for sized in &found.mechanisms[m].parameters {
            let p = sized.parameter;
            let value = found.fitted.arm.get(p);
            // Values at their bound zero are no estimates.
            if p.kind.scale() == Scale::Positive && value <= 0.0 {
                continue;
            }
            let kind = given.arm.robot.joints()[p.joint].kind;
            let (name, unit) = named(p.kind, kind != JointKind::Prismatic);
            // Centre of mass, for the reader, from the fitted first moment.
            let mass = found.fitted.arm.payload[0];
            let shared = given.arm.shared[p.joint];
            let (value, std) = match p.kind {
                Kind::Payload(1..=3) if mass > 0.0 => (value / mass, centre(found, spread, p)),
                Kind::Payload(1..=3) => continue,
                Kind::Damping if shared > 0.0 => {
                    let drive = given.tolerance(p) * shared;
                    let std = deviation(found, spread, p).map(|v| v.hypot(drive));
                    ((value - shared).max(0.0), std)
                }
                _ => (value, deviation(found, spread, p)),
            };
            let shared = if p.kind == Kind::Damping { shared } else { 0.0 };
            let none = p.kind == given.limit() && given.is_unlimited(p.joint);
            out.push(Value {
                name,
                joint: (!p.kind.is_common()).then(|| joints[p.joint].clone()),
                given: (!none).then(|| given.arm.get(p) - shared),
                value,
                std: std.filter(|v| v.is_finite()),
                unit,
            });
        }
    }
    out
}

/// Drives of an arm for the report. Standard deviations are those of `fit`; without it they are null.
pub(super) fn controller(given: &Given, arm: &Arm, fit: Option<(&Found, &Spread)>) -> Controller {
    let n = arm.dof();
    let of = |p: Parameter| fit.and_then(|(found, spread)| deviation(found, spread, p));
    let std = |kind: Kind| -> Vec<Option<f64>> {
        (0..n)
            .map(|j| of(Parameter::new(kind, j)).filter(|v| v.is_finite()))
            .collect()
    };
    let common = of(Parameter::new(Kind::CommonDelay, 0));
    let lags = std(Kind::Lag);
    Controller {
        kind: given.controller,
        kp: arm.servos.iter().map(|s| s.kp).collect(),
        kp_std: std(Kind::Gain),
        kd: arm.servos.iter().map(|s| s.kd).collect(),
        kd_std: std(Kind::ServoDamping),
        delay: (0..n).map(|j| arm.late(j)).collect(),
        delay_std: lags.into_iter().map(|l| l.or(common)).collect(),
        limit: arm
            .servos
            .iter()
            .map(|s| s.limit.min(s.drive_limit))
            .map(|l| l.is_finite().then_some(l))
            .collect(),
        command_zero: arm.servos.iter().map(|s| s.offset).collect(),
        gravity_compensation: arm.gravity_compensation,
    }
}
