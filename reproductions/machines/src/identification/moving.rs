//! Which samples of an axis count as motion.

use super::band::Band;
use super::settings::{SHARE, SLOW};
use super::{Settings, Signals};
use crate::{Machine, MachineError};
use signal::quantile::quantile;

/// Samples that an axis needs for each of its own unknowns (two of friction and some of the model).
const LEAST: usize = 50;

/// The bands of all axes.
///
/// # Errors
/// Settings of another number of axes or that contradict themselves, or an axis with too few samples within.
pub fn bands(
    machine: &Machine,
    signals: &Signals,
    settings: &Settings,
) -> Result<Vec<Band>, MachineError> {
    let n = machine.dof();
    let semi_static = machine.model().is_semi_static();
    for (list, what) in [
        (&settings.thresholds, "--threshold"),
        (&settings.ceilings, "--ceiling"),
    ] {
        let Some(list) = list else { continue };
        if list.len() != n || list.iter().any(|v| !(v.is_finite() && *v >= 0.0)) {
            return Err(MachineError::Thresholds {
                what,
                found: list.len(),
                axes: n,
            });
        }
    }
    let mut bands = Vec::with_capacity(n);
    for (j, axis) in machine.axes().iter().enumerate() {
        let speeds: Vec<f64> = (0..signals.motion.len())
            .filter(|&row| signals.kept[row])
            .map(|row| signals.motion.qd[(row, j)].abs())
            .collect();
        let top = quantile(speeds, 0.99).unwrap_or(0.0);
        let given = |list: &Option<Vec<f64>>| list.as_ref().map(|l| l[j]);
        let band = Band {
            lower: given(&settings.thresholds).unwrap_or(SHARE * top),
            upper: semi_static.then(|| given(&settings.ceilings).unwrap_or(SLOW * axis.speed)),
        };
        let found = if top > 0.0 {
            signals.moving(j, &band).count()
        } else {
            0
        };
        if found < LEAST {
            let unit = axis.speed_unit();
            let reason = match band.upper {
                Some(upper) if top > upper => format!(
                    "{found} samples move at {:.4} to {upper:.4} {unit}, the band of the semi-static model; move it more \
                     slowly, or give other thresholds",
                    band.lower
                ),
                _ => format!(
                    "{found} samples move faster than {:.4} {unit}; move it faster or longer, or give a lower threshold",
                    band.lower
                ),
            };
            return Err(MachineError::TooFewSamples {
                axis: axis.name.clone(),
                reason,
            });
        }
        bands.push(band);
    }
    Ok(bands)
}
