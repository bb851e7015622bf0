//! Another torque model of the same kind of machine.

use super::{Kind, Reason};
use crate::MachineError;
use crate::identification::{AxisRows, Identified, fit};

/// The other model has to leave less than this part of an axis's residual …
const BETTER: f64 = 0.6;
/// … where that residual is more than this part of the axis's torque.
const WORTH: f64 = 0.02;

/// The model of the same kind that fits far better, where there is one. Models for slow motion and those with inertia
/// are not compared: which of the two is asked for is a choice.
pub(super) fn wrong_model(identified: &Identified) -> Result<Option<Reason>, MachineError> {
    let machine = &identified.machine;
    let own = machine.description().dynamic_model;
    let bands: Vec<_> = identified.axes.iter().map(|a| a.band.clone()).collect();
    let mut best: Option<(usize, usize, f64)> = None;
    for number in (1..=machine.description().kind.models()).filter(|n| *n != own) {
        let other = machine.with_dynamic_model(number)?;
        if other.model().is_semi_static() != machine.model().is_semi_static()
            || other.model_parameters() <= machine.model_parameters()
        {
            continue;
        }
        let rows = AxisRows::of(&other, &identified.signals, &bands)?;
        let residual = fit(&rows)?.residual;
        for (axis, left) in residual.iter().enumerate() {
            let own_left = identified.estimate.residual[axis];
            let ratio = left / own_left;
            let worth = own_left > WORTH * torque_size(identified, axis);
            if worth && ratio < BETTER && best.is_none_or(|(_, _, r)| ratio < r) {
                best = Some((number, axis, ratio));
            }
        }
    }
    Ok(best.map(|(number, axis, ratio)| Reason {
        kind: Kind::WrongModel,
        axis: Some(axis),
        value: ratio,
        message: format!(
            "with dynamic model {number} the error of {} is {ratio:.2} times as large as with model {own}; identify with \
             --dynamic-model {number}",
            machine.axes()[axis].name
        ),
    }))
}

/// RMS of an axis's filtered torque.
fn torque_size(identified: &Identified, axis: usize) -> f64 {
    let column = identified.signals.torque.column(axis);
    (column.iter().map(|t| t * t).sum::<f64>() / column.len().max(1) as f64).sqrt()
}
