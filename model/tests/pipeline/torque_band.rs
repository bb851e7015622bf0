//! The low-pass of real recordings is recognised from their training torque, and none of raw ones.

use crate::shared::shared;
use model::preparation::setup::Setup;

/// Filter that a training file of the shared data shows: half-power frequency, Hz. None where the data are absent.
fn half_power_hz(robot: &str, file: &str) -> Option<Option<f64>> {
    let folder = shared(&format!("data/{robot}"))?;
    let urdf = folder.join("robot.urdf");
    let mut setup = Setup::new(&urdf.to_string_lossy(), None, None).unwrap();
    let data = setup.read_training(&[folder.join(file)]).unwrap();
    Some(data[0].torque_filter.map(|f| f.half_power_hz()))
}

#[test]
fn the_filters_of_kr300_and_ur10() {
    // Zero-phase Chebyshev of order 4, 2 Hz, 0.2 dB: the paper's listing.
    if let Some(found) = half_power_hz("kr300", "train.parquet") {
        let published = datasets::TorqueFilter::KR300.half_power_hz();
        assert!((found.unwrap() / published - 1.0).abs() < 0.03, "{found:?}");
    }
    if let Some(found) = half_power_hz("ur10", "train.csv") {
        assert!((1.5..2.5).contains(&found.unwrap()), "{found:?}");
    }
}

#[test]
fn raw_recordings_have_none() {
    for (robot, file) in [
        ("panda", "train.csv"),
        ("xmate", "train.csv"),
        ("ur10e", "20_02_10-30sec_12harm.csv"),
    ] {
        if let Some(found) = half_power_hz(robot, file) {
            assert_eq!(found, None, "{robot}");
        }
    }
}
