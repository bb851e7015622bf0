//! The planned motion: what a plan has, and derivatives where it has none.

use crate::derive;
use datasets::Recording;
use model::failure::Failure;
use ndarray::Array2;
use signal::Motion;
use signal::spline::Spline;

/// Relative deviation of steps from their mean up to which they count as even.
///
/// Stamps in whole milliseconds or microseconds jitter by their last digit; a hundredth of a period is a tenth of what
/// a network's windows tolerate.
const EVEN: f64 = 0.01;

/// Most samples between the waypoints of a plan. A sample of a six-axis arm takes 200 bytes; a plan with more has wrong times.
const MOST: f64 = 5e6;

/// Part of a sample by which a trajectory's length may fall short of whole samples by rounding.
const ROUNDING: f64 = 1e-6;

/// Time from sample to sample, s; none where the stamps are not evenly spaced.
pub fn period(plan: &Recording) -> Option<f64> {
    let step = plan.median_step();
    let even = |w: &[f64]| (w[1] - w[0] - step).abs() <= EVEN * step;
    let mut each = plan.trajectories.iter();
    let all = each.all(|t| plan.time[t.range.clone()].windows(2).all(even));
    (all && step > 0.0).then_some(step)
}

/// The motion between waypoints, sampled `period` apart: of fifth order, with the positions, velocities and accelerations of
/// the waypoints at either end, as ros2_control's joint_trajectory_controller moves.
///
/// # Errors
/// A plan that lasts more than [`MOST`] periods.
pub fn between(waypoints: &Motion, period: f64) -> Result<Motion, Failure> {
    let n = waypoints.q.ncols();
    let (mut time, mut segments) = (Vec::new(), Vec::new());
    let mut columns: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::new());
    for segment in &waypoints.segments {
        let stamps = &waypoints.time[segment.clone()];
        let (first, last) = (stamps[0], stamps[stamps.len() - 1]);
        if last - first > MOST * period {
            return Err(Failure::input(
                format!(
                    "the plan lasts {} s, more than {MOST} samples of {period} s",
                    last - first
                ),
                "Times count from the start of a plan, in s.",
            ));
        }
        let samples = ((last - first) / period + ROUNDING).floor() as usize + 1;
        segments.push(time.len()..time.len() + samples);
        for k in 0..samples {
            let t = first + k as f64 * period;
            let after = stamps.partition_point(|s| *s <= t).min(stamps.len() - 1);
            let rows = [after.saturating_sub(1), after].map(|r| segment.start + r);
            for joint in 0..n {
                let end = |r: usize| {
                    let tables = [&waypoints.q, &waypoints.qd, &waypoints.qdd];
                    tables.map(|table| table[[r, joint]])
                };
                let times = rows.map(|r| waypoints.time[r]);
                let values = quintic(t, times, rows.map(end));
                columns.iter_mut().zip(values).for_each(|(c, v)| c.push(v));
            }
            time.push(t);
        }
    }
    let shape = (time.len(), n);
    let [q, qd, qdd] = columns.map(|c| Array2::from_shape_fn(shape, |(k, j)| c[k * n + j]));
    Ok(Motion {
        time,
        segments,
        q,
        qd,
        qdd,
    })
}

/// Position, velocity and acceleration at time `t` of the polynomial of fifth order between two ends; beyond them those
/// of the nearer end.
fn quintic(t: f64, [from, to]: [f64; 2], [a, b]: [[f64; 3]; 2]) -> [f64; 3] {
    let h = to - from;
    if t >= to || h <= 0.0 {
        return b;
    }
    if t <= from {
        return a;
    }
    // Ends in the interval's own time, from 0 to 1.
    let [a, b] = [a, b].map(|[q, v, w]| [q, v * h, w * h * h]);
    let u = (t - from) / h;
    let far = b[0] - a[0] - a[1] - 0.5 * a[2];
    let (speed, turn) = (b[1] - a[1] - a[2], b[2] - a[2]);
    let c = [
        10.0 * far - 4.0 * speed + 0.5 * turn,
        -15.0 * far + 7.0 * speed - turn,
        6.0 * far - 3.0 * speed + 0.5 * turn,
    ];
    let q = a[0] + u * (a[1] + u * (0.5 * a[2] + u * (c[0] + u * (c[1] + u * c[2]))));
    let v = a[1] + u * (a[2] + u * (3.0 * c[0] + u * (4.0 * c[1] + u * 5.0 * c[2])));
    let w = a[2] + u * (6.0 * c[0] + u * (12.0 * c[1] + u * 20.0 * c[2]));
    [q, v / h, w / (h * h)]
}

/// Rows of a table at the waypoints, interpolated between samples `period` apart of each segment.
pub fn at_waypoints(table: &Array2<f64>, sampled: &Motion, waypoints: &Motion) -> Array2<f64> {
    let mut out = Array2::zeros(waypoints.q.dim());
    let pairs = waypoints.segments.iter().zip(&sampled.segments);
    for (own, samples) in pairs {
        let stamps = &sampled.time[samples.clone()];
        for row in own.clone() {
            let t = waypoints.time[row];
            let after = stamps.partition_point(|s| *s <= t).min(stamps.len() - 1);
            let before = after.saturating_sub(1);
            let step = stamps[after] - stamps[before];
            let part = if step > 0.0 {
                ((t - stamps[before]) / step).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let [low, high] = [before, after].map(|r| table.row(samples.start + r));
            let values = &low * (1.0 - part) + &high * part;
            out.row_mut(row).assign(&values);
        }
    }
    out
}

/// Hint where a plan's positions are too few to be differentiated.
const SPARSE: &str =
    "Give velocities and accelerations with the positions (qd1 …, qdd1 …), or more points.";

/// Motion of a plan: its own velocities and accelerations or, without these, derivatives of its positions. Accelerations come
/// from velocities where it has them.
///
/// # Errors
/// Positions of which derivatives cannot be taken.
pub fn motion(plan: &Recording) -> Result<Motion, Failure> {
    let segments = plan.segments();
    let derived = |table: &Array2<f64>| -> Result<[Array2<f64>; 2], Failure> {
        let mut out = [(); 2].map(|()| Array2::zeros(table.dim()));
        for (j, column) in table.columns().into_iter().enumerate() {
            let found = derive::derivatives(&plan.time, &segments, &column.to_vec())
                .map_err(|e| Failure::input(format!("{}: {e}", plan.source), SPARSE))?;
            for (table, values) in out.iter_mut().zip(found) {
                table.column_mut(j).assign(&ndarray::Array1::from(values));
            }
        }
        Ok(out)
    };
    let (qd, qdd) = match (&plan.qd, &plan.qdd) {
        (Some(qd), Some(qdd)) => (qd.clone(), qdd.clone()),
        (Some(qd), None) => {
            let [qdd, _] = derived(qd)?;
            (qd.clone(), qdd)
        }
        (None, own) => {
            let [qd, qdd] = derived(&plan.q)?;
            (qd, own.clone().unwrap_or(qdd))
        }
    };
    Ok(Motion {
        time: plan.time.clone(),
        segments,
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
        let whole = motion(&plan).unwrap();
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
        let derived = motion(&plan).unwrap();
        assert!((derived.qd[[200, 0]] - 2.0_f64.cos()).abs() < 1e-3);
        assert!((derived.qdd[[200, 0]] + 2.0_f64.sin()).abs() < 1e-2);
        assert!(period(&plan).is_some_and(|p| (p - 0.01).abs() < 1e-12));
        let mut uneven = plan;
        uneven.time[7] += 0.002;
        assert_eq!(period(&uneven), None);
    }

    #[test]
    fn between_waypoints_a_polynomial_of_fifth_order_is_itself() {
        // q = t⁵ − 2t³ + t, from 0 to 2 s in uneven steps.
        let q = |t: f64| {
            [
                t.powi(5) - 2.0 * t.powi(3) + t,
                5.0 * t.powi(4) - 6.0 * t * t + 1.0,
                20.0 * t.powi(3) - 12.0 * t,
            ]
        };
        let time = vec![0.0, 0.3, 1.1, 2.0];
        let table = |k: usize| Array2::from_shape_fn((4, 1), |(row, _)| q(time[row])[k]);
        let waypoints = Motion {
            segments: std::iter::once(0..4).collect(),
            q: table(0),
            qd: table(1),
            qdd: table(2),
            time: time.clone(),
        };
        let refused = between(&waypoints, 1e-7).unwrap_err();
        assert!(refused.status == 2 && refused.message.contains("lasts 2 s"));
        let fine = between(&waypoints, 0.01).unwrap();
        assert_eq!(fine.segments.first(), Some(&(0..201)));
        for (row, t) in fine.time.iter().enumerate() {
            for (found, wanted) in [&fine.q, &fine.qd, &fine.qdd].iter().zip(q(*t)) {
                assert!((found[[row, 0]] - wanted).abs() < 1e-9, "{t}");
            }
        }
        let back = at_waypoints(&fine.q, &fine, &waypoints);
        assert!((back - &waypoints.q).iter().all(|d| d.abs() < 1e-9));
    }
}
