//! The planned motion: what a plan has, and derivatives where it has none.

use datasets::{PrepareOptions, Recording, prepare};
use model::failure::Failure;
use ndarray::Array2;
use signal::Motion;
use signal::spline::Spline;

/// By how much steps may differ from their mean to count as even.
///
/// Stamps in whole milliseconds or microseconds jitter by their last digit; a hundredth of a period is a tenth of what a network's
/// windows stand.
const EVEN: f64 = 0.01;

/// By how much of a sample the length of a trajectory may fall short of whole samples by rounding.
const ROUNDING: f64 = 1e-6;

/// Time from sample to sample, s.
///
/// # Errors
/// Stamps that are not evenly spaced.
pub fn period(plan: &Recording) -> Result<f64, Failure> {
    let step = plan.median_step();
    for trajectory in &plan.trajectories {
        let times = &plan.time[trajectory.range.clone()];
        let uneven = times
            .windows(2)
            .position(|w| (w[1] - w[0] - step).abs() > EVEN * step);
        if let Some(k) = uneven {
            return Err(Failure::input(
                format!(
                    "{}: samples are {step} s apart, but {} s at {} s; a loop runs at an even period",
                    plan.source,
                    times[k + 1] - times[k],
                    times[k]
                ),
                "Let the planner sample its motion at the period of the controller.",
            ));
        }
    }
    Ok(step)
}

/// The motion of a plan: its own velocities and accelerations, and derivatives of its low-passed positions where it has none.
///
/// # Errors
/// Positions that no derivative can be taken of.
pub fn motion(plan: &Recording, cutoff_hz: Option<f64>) -> Result<Motion, Failure> {
    let (qd, qdd) = match (&plan.qd, &plan.qdd) {
        (Some(qd), Some(qdd)) => (qd.clone(), qdd.clone()),
        _ => {
            let options = PrepareOptions {
                cutoff_hz,
                ..PrepareOptions::default()
            };
            let derived = prepare(plan, &options)
                .map_err(|e| Failure::input(format!("{}: {e}", plan.source), e.advice()))?
                .at_samples;
            let own =
                |own: &Option<Array2<f64>>, derived: Array2<f64>| own.clone().unwrap_or(derived);
            (own(&plan.qd, derived.qd), own(&plan.qdd, derived.qdd))
        }
    };
    Ok(Motion {
        time: plan.time.clone(),
        segments: plan.segments(),
        q: plan.q.clone(),
        qd,
        qdd,
    })
}

/// The same path at `factor` of its speed, sampled `period` apart.
pub fn slowed(motion: &Motion, factor: f64, period: f64) -> Motion {
    let n = motion.q.ncols();
    let (mut time, mut segments) = (Vec::new(), Vec::new());
    let mut columns: [Vec<Vec<f64>>; 3] = std::array::from_fn(|_| vec![Vec::new(); n]);
    for segment in &motion.segments {
        let stamps = &motion.time[segment.clone()];
        let (first, last) = (stamps[0], stamps[stamps.len() - 1]);
        let samples = ((last - first) / (factor * period) + ROUNDING).floor() as usize + 1;
        let at: Vec<f64> = (0..samples)
            .map(|k| first + k as f64 * factor * period)
            .collect();
        segments.push(time.len()..time.len() + samples);
        time.extend((0..samples).map(|k| first + k as f64 * period));
        let tables = [&motion.q, &motion.qd, &motion.qdd];
        for (power, (table, columns)) in tables.into_iter().zip(&mut columns).enumerate() {
            for (joint, column) in columns.iter_mut().enumerate() {
                let values: Vec<f64> = table.column(joint).iter().copied().collect();
                let values = &values[segment.clone()];
                // Readers refuse trajectories that are too short for a spline.
                let Ok(spline) = Spline::quintic(stamps, values) else {
                    column.extend(std::iter::repeat_n(f64::NAN, samples));
                    continue;
                };
                let scale = factor.powi(power as i32);
                let [sampled, ..] = spline.sample(&at);
                column.extend(sampled.into_iter().map(|v| v * scale));
            }
        }
    }
    let rows = time.len();
    let [q, qd, qdd] =
        columns.map(|c| Array2::from_shape_fn((rows, n), |(row, joint)| c[joint][row]));
    Motion {
        time,
        segments,
        q,
        qd,
        qdd,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One joint at sin t, a hundred samples a second.
    fn sine(rows: usize) -> Recording {
        let time: Vec<f64> = (0..rows).map(|k| k as f64 * 0.01).collect();
        let q = Array2::from_shape_fn((rows, 1), |(k, _)| time[k].sin());
        Recording::new("sine", time, q, None)
    }

    #[test]
    fn half_the_speed_by_hand() {
        let mut plan = sine(400);
        plan.qd = Some(
            plan.time
                .iter()
                .map(|t| t.cos())
                .collect::<ndarray::Array1<f64>>()
                .insert_axis(ndarray::Axis(1)),
        );
        plan.qdd = Some(plan.q.mapv(|v| -v));
        let whole = motion(&plan, None).unwrap();
        assert_eq!(whole.qdd[[3, 0]], -plan.q[[3, 0]]);
        let half = slowed(&whole, 0.5, 0.01);
        assert_eq!(half.segments.first(), Some(&(0..799)));
        for k in [0, 301, 798] {
            let t = 0.5 * half.time[k];
            let found = [half.q[[k, 0]], half.qd[[k, 0]], half.qdd[[k, 0]]];
            for (a, b) in found.iter().zip([t.sin(), 0.5 * t.cos(), -0.25 * t.sin()]) {
                assert!((a - b).abs() < 1e-9, "{k}: {a} {b}");
            }
        }
    }

    #[test]
    fn derivatives_of_positions_and_uneven_stamps() {
        let plan = sine(400);
        let derived = motion(&plan, Some(20.0)).unwrap();
        assert!((derived.qd[[200, 0]] - 2.0_f64.cos()).abs() < 1e-3);
        assert!((derived.qdd[[200, 0]] + 2.0_f64.sin()).abs() < 1e-2);
        assert!((period(&plan).unwrap() - 0.01).abs() < 1e-12);
        let mut uneven = plan;
        uneven.time[7] += 0.002;
        let refused = period(&uneven).unwrap_err();
        assert!(
            refused.status == 2 && refused.message.contains("even period"),
            "{}",
            refused.message
        );
    }
}
