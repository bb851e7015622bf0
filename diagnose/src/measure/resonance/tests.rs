//! A resonance is found at its frequency and joint, in motion and at rest; noise has none.

use super::{gamma_quantile, resonances};
use crate::motion::frame::Frame;
use crate::schema::Resonance;
use crate::settings::ResonanceSettings;
use datasets::Recording;
use ndarray::Array2;

const RATE: f64 = 100.0;

/// Two joints that move for 20 s and stand for 20 s, twice; torque by time and by whether they stand.
fn frame(torque: impl Fn(f64, bool) -> f64) -> Frame {
    let n = (80.0 * RATE) as usize;
    let time: Vec<f64> = (0..n).map(|i| i as f64 / RATE).collect();
    let moves = |t: f64| t % 40.0 < 20.0;
    let q = Array2::from_shape_fn((n, 2), |(i, j)| {
        let t = time[i] % 40.0;
        // Whole periods: the joint stands where it stops.
        if moves(t) {
            (1.0 + j as f64) * (1.0 - (std::f64::consts::TAU * 0.3 * t).cos())
        } else {
            0.0
        }
    });
    let mut seed = 7u32;
    let mut noise = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed >> 8) / f64::from(1u32 << 24) - 0.5
    };
    let tau = Array2::from_shape_fn((n, 2), |(i, j)| {
        let ring = if j == 1 {
            torque(time[i], !moves(time[i]))
        } else {
            0.0
        };
        noise() + ring
    });
    let recording = Recording::new("r.csv", time, q, Some(tau.clone()));
    Frame::new(&recording, tau, &datasets::PrepareOptions::low_passed(10.0)).unwrap()
}

fn found(frame: &Frame) -> Vec<Resonance> {
    let names = ["a".to_owned(), "b".to_owned()];
    resonances(
        frame,
        &frame.tau.clone(),
        &names,
        &ResonanceSettings::default(),
    )
}

#[test]
fn ringing_at_rest_is_found_with_its_frequency_and_joint() {
    let ring = |t: f64, stands: bool| {
        let since = t % 40.0 - 20.0;
        if stands {
            1.5 * (-since / 6.0).exp() * (std::f64::consts::TAU * 2.97 * since).sin()
        } else {
            0.0
        }
    };
    let all = found(&frame(ring));
    assert_eq!(all.len(), 1, "{all:?}");
    let r = &all[0];
    assert!((r.frequency - 2.97).abs() < 0.05, "{r:?}");
    assert!(r.at_rest && r.joints == ["b"] && r.width < 0.5, "{r:?}");
}

#[test]
fn a_peak_in_motion_is_found_and_noise_has_none() {
    let hum = |t: f64, _: bool| 0.5 * (std::f64::consts::TAU * 11.0 * t).sin();
    let all = found(&frame(hum));
    assert_eq!(all.len(), 1, "{all:?}");
    assert!(
        all[0].in_motion && (all[0].frequency - 11.0).abs() < 0.05,
        "{all:?}"
    );
    assert_eq!(found(&frame(|_, _| 0.0)), []);
}

#[test]
fn the_tail_of_one_window_is_exponential() {
    assert!((gamma_quantile(1, 1e4) - 1e4_f64.ln()).abs() < 1e-6);
    // Of two windows it is e^{−2x}(1 + 2x).
    let x = gamma_quantile(3, 1e4);
    assert!(
        ((1.0 + 2.0 * x) * (-2.0 * x).exp() - 1e-4).abs() < 1e-9,
        "{x}"
    );
}
