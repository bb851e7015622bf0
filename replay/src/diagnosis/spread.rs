//! Standard deviations of fitted values.

use crate::arm::STEP;
use crate::catalogue::correlations;
use crate::decide::{Found, RELATIVE, STANDSTILL};
use crate::parameter::{Kind, Parameter, Scale};
use nalgebra::{DMatrix, DVector};

/// Uncertainty of the coordinates of the found fit, P free parameters.
pub(super) struct Spread {
    /// Posterior standard deviation of each coordinate, at most the prior one.
    pub(super) deviation: Vec<f64>,
    /// Prior standard deviation of each coordinate; infinite for a flat prior.
    pub(super) prior: Vec<f64>,
    /// Posterior correlation matrix, P × P.
    pub(super) correlation: DMatrix<f64>,
}

impl Spread {
    /// Uncertainty of the found fit: the deviation from the posterior covariance or from the jackknife over blocks,
    /// whichever is larger.
    pub(super) fn of(found: &Found) -> Self {
        let p = found.free.len();
        let prior: Vec<f64> = found
            .free
            .iter()
            .map(|f| f.prior.map_or(f64::INFINITY, |p| p.1))
            .collect();
        let mut precision = found.fitted.information.clone();
        for i in 0..p {
            precision[(i, i)] += prior[i].powi(-2);
        }
        let covariance = precision.clone().cholesky().map_or_else(
            || DMatrix::from_diagonal_element(p, p, f64::NAN),
            |c| c.inverse(),
        );
        let left_out = jackknife(found, &precision);
        let deviation = (0..p)
            .map(|i| {
                covariance[(i, i)]
                    .sqrt()
                    .max(left_out.as_ref().map_or(0.0, |d| d[i]))
                    .min(prior[i])
            })
            .collect();
        Self {
            deviation,
            prior,
            correlation: correlations(&covariance),
        }
    }
}

/// Jackknife standard deviation of each coordinate. The fit without a block is taken as one Newton step from the full
/// fit. None for fewer than four blocks. `precision` is the posterior precision matrix.
pub(super) fn jackknife(found: &Found, precision: &DMatrix<f64>) -> Option<Vec<f64>> {
    let blocks = &found.fitted.blocks;
    let m = blocks.len();
    if m < 4 {
        return None;
    }
    let totals = crate::fit::by_trajectory(blocks);
    let p = found.free.len();
    let mut steps: Vec<DVector<f64>> = Vec::new();
    for block in blocks {
        let total = totals.iter().find(|t| t.trajectory == block.trajectory)?;
        let mut gradient = DVector::zeros(p);
        let mut information = DMatrix::zeros(p, p);
        for (j, noise) in found.fitted.noise.iter().enumerate() {
            let variance = total.squared[j] / total.samples + noise.floor;
            let weight = 1.0 / (noise.correlation * variance);
            gradient += &block.gradient[j] * weight;
            information += &block.hessian[j] * weight;
        }
        let slopes = DVector::from_iterator(
            p,
            found.free.iter().zip(&found.fitted.x).map(|(f, x)| {
                if f.parameter.kind.scale() == Scale::Log {
                    x.exp()
                } else {
                    1.0
                }
            }),
        );
        gradient.component_mul_assign(&slopes);
        let scaled = DMatrix::from_fn(p, p, |i, k| information[(i, k)] * slopes[i] * slopes[k]);
        steps.push((precision - scaled).cholesky()?.solve(&gradient));
    }
    let mean: DVector<f64> = steps.iter().fold(DVector::zeros(p), |s, v| s + v) / m as f64;
    let factor = (m as f64 - 1.0) / m as f64;
    let square = |i: usize| steps.iter().map(|s| (s[i] - mean[i]).powi(2)).sum::<f64>();
    Some((0..p).map(|i| (factor * square(i)).sqrt()).collect())
}

/// Whether values of this kind scale with the description's masses, because they are torques per something.
pub(super) fn is_torque(kind: Kind) -> bool {
    matches!(
        kind,
        Kind::Gain
            | Kind::ServoDamping
            | Kind::Integral
            | Kind::DriveLimit
            | Kind::Limit
            | Kind::Damping
            | Kind::Coulomb
            | Kind::Stribeck
            | Kind::Armature
            | Kind::Payload(_)
    )
}

/// Standard deviation of a parameter's fitted value, in its unit, with the uncertainty of the masses. None where the
/// parameter was not fitted.
pub(super) fn deviation(found: &Found, spread: &Spread, parameter: Parameter) -> Option<f64> {
    let at = found.free.iter().position(|f| f.parameter == parameter)?;
    let value = found.fitted.arm.get(parameter);
    let own = if parameter.kind.scale() == Scale::Log {
        value * spread.deviation[at]
    } else {
        spread.deviation[at]
    };
    let masses = if is_torque(parameter.kind) {
        RELATIVE * value
    } else {
        0.0
    };
    // What two simulators' laws differ by is no part of the effect.
    let law = match parameter.kind {
        Kind::Delay | Kind::CommonDelay => STEP,
        Kind::Stribeck => STANDSTILL * found.fitted.arm.joints[parameter.joint].coulomb,
        _ => 0.0,
    };
    Some(own.hypot(masses).hypot(law))
}

/// Standard deviation of a coordinate of the payload's centre of mass, the quotient of a first moment and the mass.
pub(super) fn centre(found: &Found, spread: &Spread, moment: Parameter) -> Option<f64> {
    let at = |p: Parameter| found.free.iter().position(|f| f.parameter == p);
    let mass = Parameter::new(Kind::Payload(0), moment.joint);
    let (h, m) = (at(moment)?, at(mass)?);
    let value = found.fitted.arm.get(mass);
    let centre = found.fitted.arm.get(moment) / value;
    let (own, by_mass) = (spread.deviation[h], centre * spread.deviation[m]);
    let square = own * own - 2.0 * spread.correlation[(h, m)] * own * by_mass + by_mass * by_mass;
    Some(square.max(0.0).sqrt() / value)
}
