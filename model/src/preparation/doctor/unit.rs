//! Unit of the torque, from the ratio of recorded to described torque (the scale) of each joint.

use super::evidence::Evidence;
use super::patient::{Patient, complaint, list, short};
use super::signal::{is_cut, is_dead};
use datasets::check::{Ailment, Complaint, Severity};
use signal::quantile::median;

/// Range of scales, recorded over described torque, that errors of the description and of a nominal torque constant
/// explain.
const USUAL: [f64; 2] = [0.75, 1.3];
/// Scale below which the torque must be in another unit.
const SMALL: f64 = 1.0 / 3.0;
/// Least part of gravity in the described torque for a joint's scale to have an upper bound.
const LOADED: f64 = 0.2;
/// Number of standard deviations by which a value must be clear of a border.
pub(super) const CLEAR: f64 = 3.0;
/// Range of the joints' largest numbers where they are per cents.
const PER_CENTS: [f64; 2] = [30.0, 400.0];
/// Largest ratio between these numbers of different joints where they are per cents.
const ALIKE: f64 = 5.0;
/// Least ratio between the scales of different joints where the numbers are per cents.
const UNLIKE: f64 = 1.6;

/// Scale of a joint with its interval, which errors of the description widen. None where these could make all of the
/// described torque.
pub(super) fn scale(evidence: &Evidence) -> Option<(f64, [f64; 2])> {
    let doubt = evidence.fitted.as_ref()?.doubt;
    if doubt >= 1.0 {
        return None;
    }
    let shown = &evidence.channel.scale;
    let (value, [low, high]) = shown.value.zip(shown.interval)?;
    let [outwards, inwards] = [1.0 / (1.0 - doubt), 1.0 / (1.0 + doubt)];
    let low = low * if low < 0.0 { outwards } else { inwards };
    let high = high * if high < 0.0 { inwards } else { outwards };
    Some((value, [low, high]))
}

/// Upper bound of a joint's scale; none where errors of the description could make all of the described torque.
fn at_most(evidence: &Evidence) -> Option<f64> {
    let fitted = evidence.fitted.as_ref()?;
    let most = fitted.scale.value.abs() + CLEAR * fitted.scale.std;
    (fitted.doubt < 1.0).then(|| most / (1.0 - fitted.doubt))
}

/// Whether gravity makes enough of a joint's described torque for the scale to have an upper bound. Noise of the
/// acceleration makes scales too small.
fn is_loaded(evidence: &Evidence) -> bool {
    let fitted = evidence.fitted.as_ref();
    fitted.is_some_and(|f| f.loaded > LOADED)
}

/// Best guess of a joint's scale without its sign; none where nothing is known of it.
fn size(evidence: &Evidence) -> Option<f64> {
    match scale(evidence) {
        Some((value, _)) => Some(value.abs()),
        None if is_small(evidence) => Some(evidence.fitted.as_ref()?.scale.value.abs()),
        None => None,
    }
    .filter(|s| *s > 0.0)
}

/// Whether a joint's scale is that of another unit; none where it is not known.
fn odd(evidence: &Evidence) -> Option<bool> {
    if is_small(evidence) {
        return Some(true);
    }
    is_outside(evidence)
}

/// Whether a joint's scale is so small that its torque must be in another unit.
fn is_small(evidence: &Evidence) -> bool {
    at_most(evidence).is_some_and(|most| most < SMALL)
}

/// Whether the whole interval of a joint's scale lies outside [`USUAL`]; none without an interval.
fn is_outside(evidence: &Evidence) -> Option<bool> {
    let (_, [a, b]) = scale(evidence)?;
    let (low, high) = if b < 0.0 { (-b, -a) } else { (a, b) };
    Some(low > USUAL[1] || high < USUAL[0])
}

/// Whether the common scale of the joints is certainly outside [`USUAL`]. It is their mean, weighted by precision. Its
/// deviation grows where they differ more than their intervals suggest. (Birge, "The calculation of errors by the
/// method of least squares", Physical Review 40, 1932.)
fn is_together_outside(patient: &Patient, alive: &[usize]) -> bool {
    let known: Vec<(f64, f64)> = alive
        .iter()
        .filter_map(|&j| scale(&patient.joints[j]))
        .map(|(value, [low, high])| (value, (value - low).max(high - value)))
        .filter(|(_, half)| *half > 0.0)
        .collect();
    if known.len() < 2 {
        return false;
    }
    let weights: f64 = known.iter().map(|(_, half)| half.powi(-2)).sum();
    let mean = known.iter().map(|(v, half)| v * half.powi(-2)).sum::<f64>() / weights;
    // Half widths of 95 % are two deviations.
    let square: f64 = known
        .iter()
        .map(|(v, half)| (2.0 * (v - mean) / half).powi(2))
        .sum();
    let apart = (square / (known.len() - 1) as f64).sqrt().max(1.0);
    let half = apart / weights.sqrt();
    mean > 0.0 && (mean - half > USUAL[1] || mean + half < USUAL[0])
}

/// Normal distribution of the logarithm of a quantity: its mean and standard deviation.
struct Usual(f64, f64);

impl Usual {
    /// Distribution around `middle`, in which one standard deviation is a factor of `within`.
    fn around(middle: f64, within: f64) -> Self {
        Self(middle.ln(), within.ln())
    }

    /// Log-likelihood of a value, up to a constant.
    fn likely(&self, value: f64) -> f64 {
        -0.5 * ((value.ln() - self.0) / self.1).powi(2) - self.1.ln()
    }
}

/// Figures of the torque that hint at its unit: medians over the joints, except for the peaks.
struct Shown {
    /// Torque on the link per unit of the recorded number, N·m.
    per_unit: f64,
    /// Torque at the motor per unit of the recorded number, N·m: `per_unit` over the gear ratio. None where no ratio is
    /// known.
    at_motor: Option<f64>,
    /// Current per unit of the recorded number, A: `at_motor` over the torque constant. None where no constant is
    /// known.
    per_current: Option<f64>,
    /// Largest magnitude of the recorded numbers, by joint. Per cents are alike on all joints, torques and currents are
    /// not.
    peaks: Vec<f64>,
}

/// Factor within which a data sheet and a described robot agree on a scale.
const SHEET: f64 = 1.25;
/// Log-likelihood of a unit's two figures below which no unit is named.
const NO_UNIT: f64 = -9.0;

/// Likeliest unit of the torque, by what is usual for drives of robot arms: gears of 50 to 160, 0.05 to 0.3 N·m/A,
/// currents of some A, motors of some N·m. Motions reach about nine tenths of rated values. None where no unit is
/// likely.
fn unit(shown: &Shown) -> Option<Ailment> {
    let peak = |middle: f64, within: f64| {
        let usual = Usual::around(middle, within);
        let sum: f64 = shown.peaks.iter().map(|p| usual.likely(*p)).sum();
        sum / shown.peaks.len().max(1) as f64
    };
    let motor = match shown.at_motor {
        Some(rest) => Usual::around(1.0, SHEET).likely(rest),
        None => Usual::around(90.0, 1.6).likely(shown.per_unit),
    } + peak(2.0, 4.0);
    let current = match (shown.per_current, shown.at_motor) {
        (Some(rest), _) => Usual::around(1.0, SHEET).likely(rest),
        (None, Some(constant)) => Usual::around(0.12, 2.5).likely(constant),
        (None, None) => Usual::around(10.0, 2.5).likely(shown.per_unit),
    } + peak(6.0, 4.0);
    // A rated torque may be anything: only the numbers tell.
    let rated = |whole: f64| Usual::around(1.0, 6.0).likely(1.0) + peak(0.9 * whole, 2.0);
    let all = [
        (Ailment::Motor, motor),
        (Ailment::Current, current),
        (Ailment::Percent, rated(100.0)),
        (Ailment::PerMille, rated(1000.0)),
    ];
    let best = all.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (best.1 > NO_UNIT).then_some(best.0)
}

/// Whether the numbers look like per cents: alike on joints whose torques differ.
fn alike(patient: &Patient, alive: &[usize]) -> bool {
    let ratio = |values: &[f64]| {
        let most = values.iter().copied().fold(0.0, f64::max);
        most / values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let peaks: Vec<f64> = alive
        .iter()
        .map(|&j| patient.joints[j].numbers.largest)
        .collect();
    let sizes: Vec<f64> = alive
        .iter()
        .filter_map(|&j| size(&patient.joints[j]))
        .collect();
    let inside = peaks
        .iter()
        .all(|p| (PER_CENTS[0]..PER_CENTS[1]).contains(p));
    inside && ratio(&peaks) < ALIKE && sizes.len() > 1 && ratio(&sizes) > UNLIKE
}

/// Complaint about a torque in another unit than N·m on the link, or about a wrong scale of single joints. Where the
/// torque is `smeared` by an undeclared filter, a scale is uncertain. Only another order of magnitude counts then.
pub(super) fn of_all(patient: &Patient, smeared: bool) -> Option<Complaint> {
    let alive: Vec<usize> = (0..patient.joints.len())
        .filter(|&j| !is_dead(&patient.joints[j]))
        .collect();
    let judged: Vec<(usize, bool)> = alive
        .iter()
        .filter_map(|&j| Some((j, odd(&patient.joints[j])?)))
        .collect();
    let mut far: Vec<usize> = judged.iter().filter(|(_, o)| *o).map(|(j, _)| *j).collect();
    // Common scale: it can be certain where that of no single joint is.
    let together = is_together_outside(patient, &alive);
    if far.is_empty() && !together {
        return None;
    }
    let several = far.len() > 1 || patient.joints.len() == 1;
    let most = together || (2 * far.len() >= judged.len() && several) || alike(patient, &alive);
    if smeared {
        let sizes = alive.iter().filter_map(|&j| size(&patient.joints[j]));
        let middle = median(sizes.collect())?;
        if !most || (SMALL..1.0 / SMALL).contains(&middle) {
            return None;
        }
    }
    // A torque that is cut is smaller than the described one. Where the scale has an interval, that decides; a bound does only without one.
    let small = |e: &Evidence| is_small(e) && is_loaded(e);
    let alone = |e: &Evidence| !is_cut(e) && is_outside(e).unwrap_or_else(|| small(e));
    far.retain(|&j| most || alone(&patient.joints[j]));
    if far.is_empty() && !most {
        return None;
    }
    Some(if most {
        of_unit(patient, &alive)
    } else {
        of_joints(patient, far)
    })
}

/// Complaint about another unit of all joints, with the unit where one is likely.
fn of_unit(patient: &Patient, alive: &[usize]) -> Complaint {
    let known: Vec<(usize, f64)> = alive
        .iter()
        .filter_map(|&j| Some((j, size(&patient.joints[j])?)))
        .collect();
    let of = |f: &dyn Fn(usize, f64) -> Option<f64>| {
        median(known.iter().filter_map(|&(j, s)| f(j, s)).collect())
    };
    let gear = |j: usize| patient.robot.joints()[j].gear_ratio;
    let constant = |j: usize| patient.robot.joints()[j].torque_constant;
    let shown = Shown {
        per_unit: of(&|_, s| Some(1.0 / s)).unwrap_or(f64::NAN),
        at_motor: of(&|j, s| Some(1.0 / (s * gear(j)?))),
        per_current: of(&|j, s| Some(1.0 / (s * gear(j)? * constant(j)?))),
        peaks: alive
            .iter()
            .map(|&j| patient.joints[j].numbers.largest)
            .collect(),
    };
    let named = unit(&shown);
    let ailment = named.unwrap_or(Ailment::Scale);
    let each: Vec<String> = known
        .iter()
        .map(|&(j, s)| format!("{} {}", patient.names(&[j]), short(s)))
        .collect();
    let means = match ailment {
        Ailment::Motor => "torque of the motors, before the gear",
        Ailment::Current => "motor current in A",
        Ailment::Percent => "per cent of a rated torque or current",
        Ailment::PerMille => "per mille of a rated torque or current",
        _ => "another unit than N·m on the link",
    };
    // Drives of neighbours are most alike.
    let nearest = |j: usize| known.iter().min_by_key(|k| k.0.abs_diff(j));
    let factors: Vec<f64> = patient
        .all()
        .iter()
        .map(|&j| 1.0 / nearest(j).map_or(1.0, |k| k.1))
        .collect();
    let guessed: Vec<usize> = patient
        .all()
        .into_iter()
        .filter(|j| known.iter().all(|k| k.0 != *j))
        .collect();
    let every =
        |f: &dyn Fn(usize) -> Option<f64>| patient.all().into_iter().all(|j| f(j).is_some());
    let (drive, advice) = match ailment {
        Ailment::Motor if every(&gear) => (
            "units.torque = \"motor\"".to_owned(),
            "the gear ratios are known already".to_owned(),
        ),
        Ailment::Current if every(&gear) && every(&constant) => (
            "units.torque = \"current\"".to_owned(),
            "gear ratios and torque constants are known already".to_owned(),
        ),
        _ => (
            list("torque_scale", &factors),
            sheet(patient, ailment, &guessed),
        ),
    };
    Complaint {
        drive: Some(drive),
        ..complaint(
            ailment,
            Severity::Severe,
            patient.all(),
            [
                format!(
                    "the numbers are another size than the described robot's torque: times {}; the largest is {} in the median of the \
                     joints",
                    each.join(", "),
                    short(median(shown.peaks.clone()).unwrap_or(0.0))
                ),
                means.to_owned(),
                advice,
            ],
        )
    }
}

/// Advice on the settings of a drive file that a data sheet gives more exactly. `guessed` are joints whose factor is a
/// neighbour's.
fn sheet(patient: &Patient, ailment: Ailment, guessed: &[usize]) -> String {
    let exact = match ailment {
        Ailment::Motor => "units.torque = \"motor\" and gear_ratio",
        Ailment::Current => "units.torque = \"current\", gear_ratio and torque_constant",
        Ailment::Percent => {
            "units.torque = \"percent\", rated_current, torque_constant and gear_ratio"
        }
        Ailment::PerMille => {
            "units.torque = \"rated\", rated_current, torque_constant and gear_ratio"
        }
        _ => "its unit",
    };
    let guess = if guessed.is_empty() {
        String::new()
    } else {
        format!(
            "; {} was not shown by this motion and has the nearest joint's",
            patient.names(guessed)
        )
    };
    format!(
        "the factors are what the described robot says, good to its masses' errors{guess}; from a data sheet, {exact} are better"
    )
}

/// Complaint about a wrong scale of the joints `far` alone.
fn of_joints(patient: &Patient, far: Vec<usize>) -> Complaint {
    let factors: Vec<f64> = patient
        .all()
        .iter()
        .map(|j| {
            let own = far.contains(j).then(|| size(&patient.joints[*j])).flatten();
            1.0 / own.unwrap_or(1.0)
        })
        .collect();
    let each = far.iter().map(|&j| {
        let evidence = &patient.joints[j];
        match scale(evidence) {
            Some((value, [low, high])) => format!(
                "{} is {} times ({} to {}) the described torque",
                patient.names(&[j]),
                short(value),
                short(low),
                short(high)
            ),
            None => format!(
                "{} is at most {} times the described torque",
                patient.names(&[j]),
                short(at_most(evidence).unwrap_or(f64::NAN))
            ),
        }
    });
    let seen = each.collect::<Vec<_>>().join("; ");
    Complaint {
        drive: Some(list("torque_scale", &factors)),
        ..complaint(
            Ailment::Scale,
            Severity::Warning,
            far,
            [
                seen,
                "a torque constant, gear ratio or unit of that joint alone, or a described mass that is far off".to_owned(),
                "compare gear ratio and torque constant with the data sheet before you take the factor".to_owned(),
            ],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Data sheets: a UR10 (101:1, 0.125 N·m/A), a KR300's motor torque (221:1), a drive's per mille.
    #[test]
    fn units_by_data_sheets() {
        let shown = |per_unit: f64, peak: f64, gear: Option<f64>| Shown {
            per_unit,
            at_motor: gear.map(|g| per_unit / g),
            per_current: None,
            peaks: vec![peak],
        };
        assert_eq!(unit(&shown(12.6, 9.0, None)), Some(Ailment::Current));
        assert_eq!(unit(&shown(12.6, 9.0, Some(101.0))), Some(Ailment::Current));
        assert_eq!(unit(&shown(221.0, 15.0, Some(221.0))), Some(Ailment::Motor));
        assert_eq!(unit(&shown(100.0, 0.6, None)), Some(Ailment::Motor));
        assert_eq!(unit(&shown(0.8, 110.0, None)), Some(Ailment::Percent));
        assert_eq!(unit(&shown(0.05, 900.0, None)), Some(Ailment::PerMille));
        assert_eq!(unit(&shown(1e6, 1e-6, None)), None);
    }
}
