//! Noise floor: the error below which nothing can be explained, joint by joint, from the fitted recording.
//!
//! Where motions are repeated, it is the spread of their torque. Elsewhere it is the torque's noise, from the
//! spectral density just above the band of the motion, since motion hides the noise within the band. To it is
//! added the noise of q̈, which derivatives of the position carry into every prediction: position noise of the
//! density N that preparation found gives ∫(2πf)⁴ N df up to the band's edge, and the mass matrix makes torque
//! of it.

use crate::motion::frame::Frame;
use crate::motion::standing::State;
use crate::settings::MotionSettings;
use datasets::prepare::Source;
use datasets::{Recording, repeats};
use ndarray::Array2;
use physics::dynamics::{Workspace, mass_matrix};
use physics::robot::Robot;
use signal::quantile::median;
use signal::spectrum::welch;
use std::f64::consts::TAU;
use std::ops::Range;

/// Shortest stretch whose spectrum is taken, s, and the fewest periods of the band's edge in it.
const STRETCH: f64 = 0.25;
const PERIODS: f64 = 8.0;
/// Upper end of the part of the spectrum above the band that is used instead of the band, relative to the band's edge.
const EDGE: f64 = 1.6;
/// Edge of the band where there is no low-pass, relative to the sampling rate. A low-pass's edge is lowered to it.
const HIGHEST: f64 = 0.4;

/// Least root mean squared error of any model of `robot`, by joint, N·m (N). None where the recording does not show it.
pub fn floor(
    robot: &Robot,
    recording: &Recording,
    frame: &Frame,
    states: &Array2<State>,
    settings: &MotionSettings,
) -> Vec<Option<f64>> {
    let spread = repeats::repeatability(recording, &frame.samples().qd, frame.repeats());
    let repeated = |j: usize| {
        let s = spread.as_ref()?;
        s.moving[j].or(Some(s.all[j])).filter(|x| *x > 0.0)
    };
    let motion = motion_noise(robot, frame);
    (0..frame.dof())
        .map(|j| {
            let alone = || Some(noise(frame, states, j, settings)?.hypot(motion[j]));
            repeated(j).or_else(alone)
        })
        .collect()
}

/// Torque that the noise of q̈ adds to any prediction, by joint, N·m (N). Zero where accelerations are not
/// derived from position alone.
fn motion_noise(robot: &Robot, frame: &Frame) -> Vec<f64> {
    let n = frame.dof();
    let report = frame.report();
    let alone = |s: &Source| matches!(s, Source::Derived | Source::Replaced);
    let variance = |j: usize| -> Option<f64> {
        let edge = report.cutoff_hz?;
        let noise = report.noise.get(j)?.position_density;
        let derived = alone(&report.velocity[j]) && alone(&report.acceleration);
        derived.then(|| noise * TAU.powi(4) * edge.powi(5) / 5.0)
    };
    let variances: Vec<f64> = (0..n).map(|j| variance(j).unwrap_or(0.0)).collect();
    let poses = frame.samples().q.columns().into_iter();
    let middle: Vec<f64> = poses.map(|c| median(c.to_vec()).unwrap_or(0.0)).collect();
    let mut mass = vec![0.0; n * n];
    mass_matrix(robot, &mut Workspace::new(robot), &middle, &mut mass);
    let rotors = robot.rotor_inertia();
    (0..n)
        .map(|j| {
            let of = |k: usize| mass[n * j + k] + if j == k { rotors[j] } else { 0.0 };
            let sum: f64 = (0..n).map(|k| of(k).powi(2) * variances[k]).sum();
            sum.sqrt()
        })
        .collect()
}

/// Noise of a joint's torque, N·m (N): its median level over stretches without a reversal.
fn noise(
    frame: &Frame,
    states: &Array2<State>,
    joint: usize,
    settings: &MotionSettings,
) -> Option<f64> {
    let rate = frame.report().rate_hz;
    let highest = HIGHEST * rate;
    let edge = frame.report().cutoff_hz.unwrap_or(highest).min(highest);
    let length = (STRETCH.max(PERIODS / edge) * rate).round() as usize;
    let tau = frame.tau.column(joint).to_vec();
    let level = |rows: Range<usize>| -> Option<f64> {
        let s = welch(&tau[rows], rate, length);
        let mean = |from: f64, to: f64| {
            let inside = s.frequency.iter().zip(&s.density);
            let (sum, n) = inside
                .filter(|(f, _)| **f > from && **f <= to)
                .fold((0.0, 0usize), |(s, n), (_, d)| (s + d, n + 1));
            (n > 0).then(|| sum / n as f64)
        };
        let (above, next) = (mean(edge, 0.5 * rate)?, mean(edge, EDGE * edge)?);
        Some((next.max(above) * edge + above * (0.5 * rate - edge)).max(0.0))
    };
    let stretches = frame.samples().segments.iter().flat_map(|s| {
        (0..s.len() / length).map(move |k| s.start + k * length..s.start + (k + 1) * length)
    });
    let (quiet, turning): (Vec<_>, Vec<_>) = stretches.partition(|r| {
        let first = states[[r.start, joint]];
        first != State::Passing && r.clone().all(|i| states[[i, joint]] == first)
    });
    let used = if quiet.len() >= settings.noise_stretches {
        quiet
    } else {
        quiet.into_iter().chain(turning).collect()
    };
    let levels: Vec<f64> = used.into_iter().filter_map(level).collect();
    median(levels).map(f64::sqrt).filter(|x| *x > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::standing::states;

    fn found(recording: &Recording, frame: &Frame) -> f64 {
        let settings = MotionSettings::default();
        let states = states(frame, &settings);
        floor(&pendulum(), recording, frame, &states, &settings)[0].unwrap()
    }

    /// A joint with 2 kg·m² about its axis.
    fn pendulum() -> Robot {
        Robot::from_urdf_str(
            r#"<robot name="p"><link name="base"/><link name="arm"><inertial><mass value="1"/>
            <inertia ixx="2" ixy="0" ixz="0" iyy="2" iyz="0" izz="2"/></inertial></link>
            <joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint></robot>"#,
        )
        .unwrap()
    }

    /// Encoder counts of 1e-4 rad: what their noise does to q̈ is measured on the prepared motion.
    #[test]
    fn the_noise_of_the_acceleration_belongs_to_the_floor() {
        let time: Vec<f64> = (0..10_000).map(|i| 0.004 * f64::from(i)).collect();
        let count = 1e-4;
        let q = Array2::from_shape_fn((time.len(), 1), |(i, _)| {
            ((2.0 * time[i]).sin() / count).round() * count
        });
        let tau = Array2::from_shape_fn((time.len(), 1), |(i, _)| -8.0 * (2.0 * time[i]).sin());
        let recording = Recording::new("r", time.clone(), q, Some(tau.clone()));
        let options = datasets::PrepareOptions::low_passed(30.0);
        let frame = Frame::new(&recording, tau, &options).unwrap();
        let samples = frame.samples();
        let qdd = samples.qdd.column(0);
        let squares = qdd.iter().zip(&samples.time);
        let squares = squares.map(|(a, t)| (a + 4.0 * (2.0 * t).sin()).powi(2));
        let measured = 2.0 * (squares.sum::<f64>() / samples.len() as f64).sqrt();
        let found = found(&recording, &frame);
        assert!(
            (found / measured - 1.0).abs() < 0.3,
            "{found}, measured {measured}"
        );
    }

    /// White noise of 0.2 N·m on 10 N·m of slow torque that jumps at every reversal.
    #[test]
    fn white_noise_is_found_under_a_moving_robot() {
        let mut state = 1u32;
        let mut uniform = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
        };
        let n = 10_000;
        let time: Vec<f64> = (0..n).map(|i| 0.004 * f64::from(i)).collect();
        let q = Array2::from_shape_fn((n as usize, 1), |(i, _)| (2.0 * time[i]).sin());
        let tau = Array2::from_shape_fn((n as usize, 1), |(i, _)| {
            let noise: f64 = (0..12).map(|_| uniform()).sum();
            10.0 * (2.0 * time[i]).sin() + 3.0 * (2.0 * time[i]).cos().signum() + 0.2 * noise
        });
        let recording = Recording::new("r", time, q, Some(tau.clone()));
        let frame =
            Frame::new(&recording, tau, &datasets::PrepareOptions::low_passed(20.0)).unwrap();
        let found = found(&recording, &frame);
        assert!((found - 0.2).abs() < 0.03, "{found}");
    }
}
