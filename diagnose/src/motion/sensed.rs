//! Sensors beside the motor's encoder: position of the link and temperature of the joint.
//!
//! A column that cannot be what its name says is not used, and the report gives the reason. The zero of a
//! link's encoder is an unknown constant of each joint, which has to be fitted where its departure is used.

use super::motor::Band;
use datasets::prepare::PrepareError;
use datasets::{PrepareOptions, Recording, prepare};
use ndarray::{Array1, Array2, ArrayView1, Axis};
use signal::Motion;
use signal::quantile::median;
use signal::resample::linear;
use std::ops::Range;

/// Range of motion below which a joint's sensors are not judged, rad (m).
const STILL: f64 = 1e-3;
/// Range of a link's motion over its motor's in which the link's encoder is used.
const FOLLOWS: std::ops::RangeInclusive<f64> = 0.8..=1.25;
/// Largest distance between the zeros of both encoders, rad (m).
const APART: f64 = 1.0;
/// Largest departure of a link from its motor: relative to the motion, both root mean square, and absolute
/// where the motion is small, rad (m). No gear gives way by more than both.
const DEPARTS: f64 = 0.1;
const GIVES: f64 = 0.05;
/// Plausible temperatures of a joint, °C.
const POSSIBLE: std::ops::RangeInclusive<f64> = -60.0..=200.0;
/// Range below which a temperature is not used, K.
const WARMS: f64 = 1.0;
/// Half width of the smoothing of a temperature, s. A temperature changes more slowly than the sensor steps by a
/// kelvin.
const SMOOTHED: f64 = 4.0;

/// Departure of a link from its motor, q − q_link, with two derivatives, per fine sample.
pub type Departure = [Array1<f64>; 3];

/// Signals of further sensors on the fine grid.
#[derive(Clone, Debug, Default)]
pub struct Sensed {
    /// Departure of each joint's link in both bands; empty where no link's position was recorded.
    links: Vec<Option<[Departure; 2]>>,
    /// Temperature of each joint, °C; empty where none was recorded.
    temperatures: Vec<Option<Array1<f64>>>,
    /// Joints whose sensor is not used, and the reason.
    refused: Vec<(usize, String)>,
}

impl Sensed {
    /// Signals of a recording whose motion was prepared on `fine` with the cut-off `cutoff_hz`, and whose rows
    /// have the band `band`, Hz. None where neither was recorded.
    ///
    /// # Errors
    /// As [`prepare()`].
    pub(super) fn new(
        recording: &Recording,
        fine: &Motion,
        options: &PrepareOptions,
        cutoff_hz: Option<f64>,
        band: f64,
    ) -> Result<Option<Self>, PrepareError> {
        if recording.ql.is_none() && recording.temp.is_none() {
            return Ok(None);
        }
        let mut own = Self::default();
        if let Some(ql) = &recording.ql {
            let usable: Vec<bool> = (0..recording.dof())
                .map(|j| own.take(j, link(recording.q.column(j), ql.column(j))))
                .collect();
            if usable.contains(&true) {
                own.links = links(recording, ql, &usable, options, cutoff_hz, band)?;
            }
        }
        if let Some(temp) = &recording.temp {
            let usable: Vec<bool> = (0..recording.dof())
                .map(|j| own.take(j, temperature(temp.column(j))))
                .collect();
            let of = |j: usize| usable[j].then(|| on_fine(recording, temp.column(j), fine));
            if usable.contains(&true) {
                own.temperatures = (0..recording.dof()).map(of).collect();
            }
        }
        Ok(Some(own))
    }

    /// Whether a sensor is used; notes the reason where not.
    fn take(&mut self, joint: usize, judged: Result<(), String>) -> bool {
        let usable = judged.is_ok();
        if let Err(why) = judged {
            self.refused.push((joint, why));
        }
        usable
    }

    /// Departure of a joint's link from its motor, up to a constant.
    pub fn departure(&self, joint: usize, band: Band) -> Option<&Departure> {
        let [motion, rows] = self.links.get(joint)?.as_ref()?;
        Some(match band {
            Band::Motion => motion,
            Band::Rows => rows,
        })
    }

    /// Temperature of a joint, °C.
    pub fn temperature(&self, joint: usize) -> Option<&Array1<f64>> {
        self.temperatures.get(joint)?.as_ref()
    }

    /// Joints whose sensor is not used, and the reason.
    pub fn refused(&self) -> &[(usize, String)] {
        &self.refused
    }
}

/// Check that a position can be that of the joint's link; else the reason.
fn link(q: ArrayView1<f64>, ql: ArrayView1<f64>) -> Result<(), String> {
    let n = q.len() as f64;
    let (mean, mean_link) = (q.sum() / n, ql.sum() / n);
    let spread = q.std(0.0);
    let refuse = |why: String| Err(format!("ql is not used: {why}"));
    if q.iter().zip(ql).all(|(a, b)| a == b) {
        return refuse("it is q".to_owned());
    }
    if spread < STILL {
        return refuse("the joint does not move".to_owned());
    }
    if ql.std(0.0) < 1e-9 {
        return refuse("it never changes".to_owned());
    }
    let product: f64 = q
        .iter()
        .zip(ql)
        .map(|(a, b)| (a - mean) * (b - mean_link))
        .sum();
    let follows = product / n / (spread * spread);
    if !FOLLOWS.contains(&follows) {
        return refuse(format!(
            "it moves {follows:.3} times as far as q; sign, unit or gear ratio are another's"
        ));
    }
    let apart = median(q.iter().zip(ql).map(|(a, b)| a - b).collect()).unwrap_or(0.0);
    if apart.abs() > APART {
        return refuse(format!("it stands {apart:.2} rad (m) from q"));
    }
    let squares: f64 = q.iter().zip(ql).map(|(a, b)| (a - b - apart).powi(2)).sum();
    let departs = (squares / n).sqrt();
    if departs > (DEPARTS * spread).max(GIVES) {
        return refuse(format!(
            "it departs from q by {departs:.2} rad (m), which no gear does"
        ));
    }
    Ok(())
}

/// Check that a temperature is plausible and changes enough to be used; else the reason.
fn temperature(t: ArrayView1<f64>) -> Result<(), String> {
    let low = t.iter().copied().fold(f64::INFINITY, f64::min);
    let high = t.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !(POSSIBLE.contains(&low) && POSSIBLE.contains(&high)) {
        return Err(format!(
            "temp is not used: from {low:.0} to {high:.0} °C is no joint's"
        ));
    }
    if high - low < WARMS {
        return Err(format!(
            "temp is not used: it changes by {:.1} K",
            high - low
        ));
    }
    Ok(())
}

/// Departure of each joint's link from its motor, in both bands.
fn links(
    recording: &Recording,
    ql: &Array2<f64>,
    usable: &[bool],
    options: &PrepareOptions,
    cutoff_hz: Option<f64>,
    band: f64,
) -> Result<Vec<Option<[Departure; 2]>>, PrepareError> {
    let mut apart = &recording.q - ql;
    for (mut column, usable) in apart.columns_mut().into_iter().zip(usable) {
        // Around zero a spline of small numbers loses nothing.
        let middle = median(column.to_vec()).unwrap_or(0.0);
        match usable {
            true => column.mapv_inplace(|x| x - middle),
            false => column.fill(0.0),
        }
    }
    let middles: Vec<f64> = (0..usable.len())
        .map(|j| recording.q[[0, j]] - ql[[0, j]] - apart[[0, j]])
        .collect();
    let departure = Recording {
        trajectories: recording.trajectories.clone(),
        ..Recording::new(&recording.source, recording.time.clone(), apart, None)
    };
    let in_band = |cutoff_hz: Option<f64>| {
        let options = PrepareOptions {
            cutoff_hz,
            ..*options
        };
        prepare(&departure, &options).map(|p| p.fine)
    };
    let wide = cutoff_hz.map(|own| own.max(band));
    let both = [in_band(cutoff_hz)?, in_band(wide)?];
    let of = |j: usize| {
        both.each_ref().map(|m| {
            let middle = middles[j];
            [
                m.q.column(j).mapv(|x| x + middle),
                m.qd.column(j).to_owned(),
                m.qdd.column(j).to_owned(),
            ]
        })
    };
    Ok((0..usable.len())
        .map(|j| usable[j].then(|| of(j)))
        .collect())
}

/// A temperature on the fine grid, smoothed within each trajectory.
fn on_fine(recording: &Recording, t: ArrayView1<f64>, fine: &Motion) -> Array1<f64> {
    let mut out = Array1::zeros(fine.len());
    for (rows, grid) in recording.segments().into_iter().zip(&fine.segments) {
        let smooth = smoothed(&recording.time, t, &rows);
        let at = linear(&recording.time[rows], &smooth, &fine.time[grid.clone()]);
        out.slice_axis_mut(Axis(0), grid.clone().into())
            .assign(&Array1::from(at));
    }
    out
}

/// Value at each sample of the line fitted to the samples within [`SMOOTHED`] of it.
fn smoothed(time: &[f64], t: ArrayView1<f64>, rows: &Range<usize>) -> Vec<f64> {
    let n = rows.len();
    let origin = time[rows.start];
    let mut sums = vec![[0.0; 4]];
    for i in rows.clone() {
        let (x, y) = (time[i] - origin, t[i]);
        let last = sums[sums.len() - 1];
        sums.push([last[0] + x, last[1] + y, last[2] + x * x, last[3] + x * y]);
    }
    let at = |k: usize| {
        let now = time[rows.start + k] - origin;
        let own = &time[rows.clone()];
        let a = own.partition_point(|&s| s - origin < now - SMOOTHED);
        let b = own
            .partition_point(|&s| s - origin <= now + SMOOTHED)
            .min(n);
        let count = (b - a) as f64;
        let [x, y, xx, xy] = [0, 1, 2, 3].map(|i| (sums[b][i] - sums[a][i]) / count);
        let spread = xx - x * x;
        let slope = if spread > 1e-9 {
            (xy - x * y) / spread
        } else {
            0.0
        };
        y + slope * (now - x)
    };
    (0..n).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(link: impl Fn(f64) -> f64, temp: impl Fn(f64) -> f64) -> Recording {
        let time: Vec<f64> = (0..2000).map(|i| 0.005 * f64::from(i)).collect();
        let q = Array1::from_iter(time.iter().map(|t| (1.3 * t).sin()));
        let column = |x: Array1<f64>| x.insert_axis(Axis(1));
        let mut r = Recording::new("r", time.clone(), column(q.clone()), None);
        r.ql = Some(column(q.mapv(link)));
        r.temp = Some(column(time.iter().map(|t| temp(*t)).collect()));
        r
    }

    fn sensed(recording: &Recording) -> Sensed {
        let options = PrepareOptions::low_passed(8.0);
        let fine = prepare(recording, &options).unwrap().fine;
        Sensed::new(recording, &fine, &options, Some(8.0), 25.0)
            .unwrap()
            .unwrap()
    }

    #[test]
    fn what_cannot_be_a_link_or_a_temperature_is_refused_with_a_reason() {
        let warm = |t: f64| 25.0 + t;
        for (link, why) in [
            (Box::new(|q: f64| q) as Box<dyn Fn(f64) -> f64>, "it is q"),
            (Box::new(|_| 0.3), "never changes"),
            (Box::new(|q| -q), "-1.000 times"),
            (Box::new(|q| q.to_degrees()), "57.296 times"),
            (Box::new(|q| q + 1.6), "1.60 rad"),
            (Box::new(|q| q + 0.4 * (9.0 * q).sin()), "no gear"),
        ] {
            let s = sensed(&recording(link, warm));
            assert!(s.departure(0, Band::Rows).is_none());
            assert!(s.refused()[0].1.contains(why), "{why}: {:?}", s.refused());
            assert!(s.temperature(0).is_some());
        }
        let link = |q: f64| q - 0.003 * q * q;
        for (temp, why) in [
            (Box::new(|_| 31.0) as Box<dyn Fn(f64) -> f64>, "0.0 K"),
            (Box::new(|t| 298.0 + t), "298 to 308 °C"),
        ] {
            let s = sensed(&recording(link, temp));
            assert!(s.temperature(0).is_none() && s.departure(0, Band::Motion).is_some());
            assert!(s.refused()[0].1.contains(why), "{why}: {:?}", s.refused());
        }
    }

    #[test]
    fn a_departure_has_its_derivatives_and_a_temperature_its_course() {
        let s = sensed(&recording(
            |q| q - 0.01 - 0.003 * q,
            |t| (25.0 + 0.8 * t).round(),
        ));
        assert!(s.refused().is_empty());
        let [d, v, a] = s.departure(0, Band::Rows).unwrap();
        let t = |i: usize| 0.005 * i as f64;
        for i in 400..1600 {
            assert!((d[i] - 0.01 - 0.003 * (1.3 * t(i)).sin()).abs() < 1e-6);
            assert!((v[i] - 0.0039 * (1.3 * t(i)).cos()).abs() < 1e-5);
            assert!((a[i] + 0.00507 * (1.3 * t(i)).sin()).abs() < 1e-4);
            let warm = s.temperature(0).unwrap()[i];
            assert!((warm - 25.0 - 0.8 * t(i)).abs() < 0.2, "{warm} at {i}");
        }
    }
}
