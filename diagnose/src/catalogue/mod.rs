//! The catalogue: one file per effect, each proposing candidates with their columns, shape grid,
//! sign constraints and units.

mod asymmetric_friction;
pub mod backlash;
pub mod base_tilt;
pub(crate) mod candidate;
pub(crate) mod choice;
mod counterbalance;
pub(crate) mod effect;
mod encoder_offset;
pub(crate) mod experiment;
mod external_contact;
mod friction_drift;
pub(crate) mod gear;
pub(crate) mod info;
mod joint_coupling;
mod joint_elasticity;
mod load_dependent_friction;
mod nonlinear_viscous_friction;
mod parameters;
pub mod position_dependent_friction;
mod presliding_hysteresis;
pub(crate) mod reported;
pub mod saturation;
mod stribeck_friction;
pub mod time_delay;
mod torque_channel;
pub mod torque_ripple;
mod transmission;
pub(crate) mod unit;

use crate::motion::scene::Scene;
use effect::Effect;
use gear::Link;
use info::Info;
use serde::{Serialize, Serializer};

pub(crate) use friction_drift::REFERENCE;

pub use candidate::{Bound, Candidate, Column, ColumnTorque, Shape, Size};
pub use parameters::base_columns;
pub use reported::Parameter;
pub use unit::Unit;

impl Effect {
    /// Description of the effect beside its columns.
    pub fn info(self) -> &'static Info {
        match self {
            Effect::LinkParameters => &parameters::LINKS,
            Effect::FrictionParameters => &parameters::FRICTION,
            Effect::Payload => &parameters::PAYLOAD,
            Effect::RotorInertia => &parameters::ROTOR,
            Effect::BaseTilt => &base_tilt::INFO,
            Effect::Counterbalance => &counterbalance::INFO,
            Effect::AsymmetricFriction => &asymmetric_friction::INFO,
            Effect::StribeckFriction => &stribeck_friction::INFO,
            Effect::NonlinearViscousFriction => &nonlinear_viscous_friction::INFO,
            Effect::LoadDependentFriction => &load_dependent_friction::INFO,
            Effect::PositionDependentFriction => &position_dependent_friction::INFO,
            Effect::PreslidingHysteresis => &presliding_hysteresis::INFO,
            Effect::FrictionDrift => &friction_drift::INFO,
            Effect::TorqueRipple => &torque_ripple::INFO,
            Effect::JointElasticity => &joint_elasticity::INFO,
            Effect::Backlash => &backlash::INFO,
            Effect::JointCoupling => &joint_coupling::INFO,
            Effect::TorqueGain => &torque_channel::GAIN,
            Effect::TorqueOffset => &torque_channel::OFFSET,
            Effect::TimeDelay => &time_delay::INFO,
            Effect::Saturation => &saturation::INFO,
            Effect::EncoderOffset => &encoder_offset::INFO,
            Effect::ExternalContact => &external_contact::INFO,
        }
    }

    /// Name of the effect in the report.
    pub fn name(self) -> &'static str {
        self.info().name
    }
}

impl Serialize for Effect {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Whether a recording separates an effect from the links of the description. Without `masses` it separates neither a
/// payload nor a torque gain. A payload has the columns of the last link, so that it also needs that link's (`tool`).
pub fn told_from_links(effect: Effect, masses: bool, tool: bool) -> bool {
    (masses || !effect.info().by_mass) && (tool || effect != Effect::Payload)
}

/// All candidates that do not depend on the residual. `links` are the findings of the joints' link encoders, where there are any.
pub fn catalogue(scene: &Scene, links: &[Link]) -> Vec<Candidate> {
    let mut all = Vec::new();
    all.extend(parameters::candidates(scene));
    all.extend(base_tilt::candidates(scene));
    all.extend(time_delay::candidates(scene));
    for joint in 0..scene.dof() {
        all.extend(time_delay::own(scene, joint));
        all.extend(torque_channel::candidates(scene, joint));
        all.extend(encoder_offset::candidates(scene, joint));
        all.extend(counterbalance::candidates(scene, joint));
        all.extend(asymmetric_friction::candidates(scene, joint));
        all.extend(stribeck_friction::candidates(scene, joint));
        all.extend(nonlinear_viscous_friction::candidates(scene, joint));
        all.extend(load_dependent_friction::candidates(scene, joint));
        all.extend(presliding_hysteresis::candidates(scene, joint));
        all.extend(friction_drift::candidates(scene, joint));
        all.extend(torque_ripple::slow(scene, joint));
        all.extend(joint_coupling::candidates(scene, joint));
        match links.get(joint) {
            Some(Link::Stiff) => {}
            Some(Link::Gives(gear)) => all.extend(gear::candidates(scene, joint, gear)),
            Some(Link::Unknown) | None => {
                all.extend(joint_elasticity::candidates(scene, joint));
                all.extend(backlash::candidates(scene, joint));
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::scene::Scale;
    use ndarray::Array2;
    use physics::robot::Robot;
    use signal::Motion;

    /// What the search evaluates column by column is what the control loop steps through.
    #[test]
    fn causal_columns_are_the_control_loops() {
        let robot = Robot::builtin("ur5").unwrap();
        let (n, dof) = (160, robot.dof());
        let table = |f: &dyn Fn(f64, f64) -> f64| {
            Array2::from_shape_fn((n, dof), |(i, j)| f(0.05 * i as f64, 1.0 + 0.3 * j as f64))
        };
        let motion = Motion {
            time: (0..n).map(|i| 0.05 * i as f64).collect(),
            q: table(&|t, w| (w * t).sin()),
            qd: table(&|t, w| w * (w * t).cos()),
            qdd: table(&|t, w| -w * w * (w * t).sin()),
            segments: vec![0..90, 90..n],
        };
        let scale = Scale {
            softness: vec![0.01; dof],
            lead: vec![0.0; dof],
            speed: vec![1.0; dof],
            range: vec![(-1.0, 1.0); dof],
            torque: vec![3.0; dof],
            session: (0.0, 8.0),
            step: 0.05,
            channel: None,
            correlation_rows: None,
        };
        let scene = Scene::new(&robot, &motion, &scale);
        let mut all = catalogue(&scene, &[]);
        all.extend(torque_ripple::candidates(1, &[17.0]));
        all.extend(position_dependent_friction::candidates(&scene, 1, &[17.0]));
        let mut compared = 0;
        let named = |c: &Candidate| -> Vec<(Effect, Column)> {
            c.columns
                .iter()
                .map(|own| (c.effect, own.clone()))
                .collect()
        };
        let columns: Vec<(Effect, Column)> = all.iter().flat_map(named).collect();
        for (effect, column) in &columns {
            if let ColumnTorque::Terms(terms) = &column.torque {
                let named = |t: &(f64, physics::effects::Term)| t.1.effect() == effect.name();
                assert!(
                    terms.iter().any(named),
                    "{effect:?} by terms of others: {terms:?}"
                );
                let joint = column.joints[0];
                let (once, stepped) = (scene.terms(joint, terms), scene.stepped(joint, terms));
                let largest = stepped.iter().fold(0.0f64, |m, x| m.max(x.abs()));
                let apart = (once - stepped).iter().fold(0.0f64, |m, x| m.max(x.abs()));
                assert!(apart <= 1e-12 * largest, "{terms:?}: {apart} of {largest}");
                compared += 1;
            }
        }
        assert!(compared > 100 * dof, "{compared}");
    }
}
