//! Checks that refuse impossible values of a joint and its link.

use super::{Doubt, Finding, Joint, RobotError};

/// Largest inertial parameter or placement of a robot (kg, m) that is accepted: products of larger ones overflow.
const LARGEST: f64 = 1e12;

/// Relative tolerance on the eigenvalues of a described inertia: published tables carry about six
/// digits.
const ROUNDING: f64 = 1e-5;

pub(super) fn check_joint(joint: &Joint) -> Result<(), RobotError> {
    if (joint.axis.norm() - 1.0).abs() > 1e-9 {
        return Err(RobotError::BadAxis {
            joint: joint.name.clone(),
            axis: joint.axis.into(),
        });
    }
    let number = |what: &str, value: f64| {
        if value.is_finite() && value >= 0.0 {
            return Ok(());
        }
        Err(RobotError::BadNumber {
            owner: joint.name.clone(),
            what: what.to_owned(),
            value,
            hint: "it must be finite and not negative".to_owned(),
        })
    };
    number("damping", joint.damping)?;
    number("friction", joint.friction)?;
    number("rotor inertia", joint.rotor_inertia)?;
    let placement = joint.rotation.iter().chain(joint.translation.iter());
    for &value in placement {
        if !value.is_finite() || value.abs() > LARGEST {
            return Err(RobotError::BadNumber {
                owner: joint.name.clone(),
                what: "origin".to_owned(),
                value,
                hint: "it must be finite and that of a robot".to_owned(),
            });
        }
    }
    Ok(())
}

/// Refuses an inertia with which the mass matrix could be indefinite; finds one that no mass distribution has.
pub(super) fn check_inertia(joint: &Joint) -> Result<Option<Finding>, RobotError> {
    let (link, inertia) = (&joint.link, &joint.link.inertia);
    let impossible = |reason: String| RobotError::ImpossibleInertia {
        link: link.name.clone(),
        joint: joint.name.clone(),
        reason,
    };
    let parameters = inertia.parameters();
    let usable = |p: &f64| p.is_finite() && p.abs() <= LARGEST;
    if let Some(bad) = parameters.iter().find(|p| !usable(p)) {
        return Err(impossible(format!("it contains {bad}")));
    }
    if inertia.mass < 0.0 {
        return Err(impossible(format!("its mass is {} kg", inertia.mass)));
    }
    if inertia.mass == 0.0 {
        return Err(RobotError::Massless {
            link: link.name.clone(),
            joint: joint.name.clone(),
        });
    }
    let principal = inertia.about_com().symmetric_eigenvalues();
    // Rounding of the parallel-axis terms counts too, hence the scale about the origin.
    let scale = inertia.about_origin.amax().max(principal.amax());
    if principal.min() < -ROUNDING * scale {
        return Err(impossible(format!(
            "a principal moment is {:.3e} kg·m², below zero",
            principal.min()
        )));
    }
    let possible = inertia.is_consistent(ROUNDING);
    Ok((!possible).then(|| Finding::of_link(Doubt::NoDistribution, joint)))
}
