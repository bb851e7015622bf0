//! A low-passed torque is known by its empty stop band, a raw one never.

use datasets::{Recording, TorqueFilter, stop_band};
use ndarray::Array2;
use signal::{filter, sos};

const RATE: f64 = 100.0;

/// Two joints that swing: weight, Coulomb friction and, as a sensor has it, noise.
fn recording(noise: f64, through: Option<TorqueFilter>) -> Recording {
    let rows = 6000;
    let time: Vec<f64> = (0..rows).map(|i| f64::from(i) / RATE).collect();
    let phase = |t: f64, j: usize| 1.3 * t * (1.0 + 0.37 * j as f64) + 0.8 * (0.31 * t).sin();
    let n = time.len();
    let q = Array2::from_shape_fn((n, 2), |(i, j)| phase(time[i], j).sin());
    let mut state = 1_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut tau = Array2::from_shape_fn((n, 2), |(i, j)| {
        let turn = phase(time[i], j);
        40.0 * turn.sin().cos() + 8.0 * turn.cos().signum() + noise * random()
    });
    if let Some(f) = through {
        let sections = sos::chebyshev1(f.order, f.ripple_db, f.cutoff_hz, RATE).unwrap();
        for mut column in tau.columns_mut() {
            let smooth = filter::filtfilt(&sections, &column.to_vec());
            column.assign(&ndarray::Array1::from(smooth));
        }
    }
    Recording::new("made", time, q, Some(tau))
}

#[test]
fn a_filtered_torque_shows_its_filter() {
    for cutoff_hz in [2.0, 5.0] {
        let filter = TorqueFilter {
            cutoff_hz,
            ..TorqueFilter::KR300
        };
        let found = stop_band::candidates(&[recording(0.5, Some(filter))]);
        let best = found.first().expect("recognised");
        let ratio = best.half_power_hz() / filter.half_power_hz();
        assert!((ratio - 1.0).abs() < 0.05, "{best:?}");
        assert!(
            found.iter().any(|f| f.order == filter.order) && best.recognised,
            "{found:?}"
        );
    }
}

#[test]
fn a_raw_torque_shows_none() {
    for noise in [0.5, 0.05, 0.0] {
        assert_eq!(stop_band::candidates(&[recording(noise, None)]), []);
    }
    let mut without = recording(0.5, None);
    without.tau = None;
    assert_eq!(stop_band::candidates(&[without]), []);
    assert_eq!(stop_band::candidates(&[]), []);
}
