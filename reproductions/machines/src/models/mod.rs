//! Torque models that are linear in named parameters, one file each.
//!
//! The softMC manual lists the parameters of each model by number, unit and some comments (section "dynamic model
//! parameters"); its equations are pictures that our copy of the text does not hold. The equations here are derived anew;
//! the numbers of parameters agree where a file says so.

pub mod delta;
pub mod linear_axis;
pub mod puma;
pub mod rotary_axis;
pub mod scara;
mod torque_model;

pub use torque_model::{OutOfReach, Parameter, TorqueModel};

use crate::MachineError;
use crate::description::{Description, Kind};

/// The model of a description, and the description with everything in it that the model read from elsewhere.
pub(crate) fn of(
    description: Description,
) -> Result<(Box<dyn TorqueModel>, Description), MachineError> {
    let number = description.dynamic_model;
    let axes = description.axis.len();
    let geometry = &description.geometry;
    let model: Box<dyn TorqueModel> = match description.kind {
        Kind::RotaryAxis => Box::new(rotary_axis::RotaryAxis::new(number, geometry.crank)),
        Kind::LinearAxis => Box::new(linear_axis::LinearAxis::new(number)),
        Kind::Scara => Box::new(scara::Scara::new(axes, number)),
        Kind::Delta => {
            let length = |value, name| description.length(value, name);
            let shape = delta::Shape {
                offset: length(geometry.base_radius, "base_radius")?
                    - length(geometry.plate_radius, "plate_radius")?,
                arm: length(geometry.arm, "arm")?,
                forearm: length(geometry.forearm, "forearm")?,
            };
            Box::new(delta::Delta::new(shape, axes, number))
        }
        Kind::Puma => {
            let (model, robot) = puma::Puma::new(&description)?;
            let mut whole = description;
            whole.geometry.robot = Some(robot);
            return Ok((Box::new(model), whole));
        }
    };
    Ok((model, description))
}
