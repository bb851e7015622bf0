//! The KR300 .mat reader on files made here: the official layout and broken ones.

use datasets::{
    Part, Problem, ReadError, ReadOptions, Recording, TorqueFilter, read::Format, read::read_bytes,
};
use std::path::Path;

/// Step of the official files in s.
const STEP: f64 = 0.1;

/// A MATLAB 5 file of uncompressed real matrices, each stored column by column.
fn mat(arrays: &[(&str, usize, usize, Vec<f64>)]) -> Vec<u8> {
    let mut bytes = vec![b' '; 124];
    bytes[..19].copy_from_slice(b"MATLAB 5.0 MAT-file");
    bytes.extend([0x00, 0x01, b'I', b'M']);
    for (name, rows, columns, values) in arrays {
        let mut body = Vec::new();
        let mut element = |kind: u32, data: &[u8]| {
            body.extend(kind.to_le_bytes());
            body.extend((data.len() as u32).to_le_bytes());
            body.extend(data);
            body.resize(body.len().next_multiple_of(8), 0);
        };
        element(6, &[6, 0, 0, 0, 0, 0, 0, 0]);
        element(
            5,
            &[
                (*rows as u32).to_le_bytes(),
                (*columns as u32).to_le_bytes(),
            ]
            .concat(),
        );
        element(1, name.as_bytes());
        element(
            9,
            &values
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect::<Vec<u8>>(),
        );
        bytes.extend(14_u32.to_le_bytes());
        bytes.extend((body.len() as u32).to_le_bytes());
        bytes.extend(body);
    }
    bytes
}

/// Position in deg of joint j: at rest, out and back within one execution of 60.588 s, at rest.
fn position(t: f64, joint: usize) -> f64 {
    let s = ((t % 60.588) - 5.0) / 50.0;
    let bump = if (0.0..1.0).contains(&s) {
        (std::f64::consts::PI * s).sin().powi(4)
    } else {
        0.0
    };
    10.0 * (joint + 1) as f64 * bump
}

type Table = (&'static str, usize, usize, Vec<f64>);

/// The forward or inverse file with three training executions and two test executions.
fn official(inverse: bool) -> Vec<Table> {
    let mut arrays = Vec::new();
    for (part, executions) in [("train", 3.0), ("test", 2.0)] {
        let n = (executions * 60.588 / STEP) as usize;
        let time: Vec<f64> = (0..n).map(|i| i as f64 * STEP).collect();
        let table = |rows: usize, f: &dyn Fn(f64, usize) -> f64| {
            time.iter()
                .flat_map(|&t| (0..rows).map(move |j| f(t, j)))
                .collect::<Vec<_>>()
        };
        let torque = table(6, &|t, j| 0.1 * position(t, j) + 1.0);
        let q = table(6, &position);
        let all = table(18, &|t, j| if j < 6 { position(t, j) } else { 0.0 });
        let name = |n: &str| -> &'static str { format!("{n}_{part}").leak() };
        arrays.push((name("time"), 1, n, time.clone()));
        arrays.push((
            name("u"),
            if inverse { 18 } else { 6 },
            n,
            if inverse { all } else { torque.clone() },
        ));
        arrays.push((name("y"), 6, n, if inverse { torque } else { q }));
    }
    arrays
}

fn read(arrays: &[Table], part: Part) -> Result<Recording, ReadError> {
    read_bytes(
        &mat(arrays),
        Format::Mat,
        Path::new("kr300.mat"),
        &ReadOptions::kr300(part),
    )
}

#[test]
fn the_official_layout_is_cut_into_executions() {
    for inverse in [false, true] {
        let arrays = official(inverse);
        let train = read(&arrays, Part::Train).unwrap();
        train.validate().unwrap();
        assert_eq!(
            train.segments(),
            [0..606, 606..1212, 1212..1817],
            "inverse: {inverse}"
        );
        assert_eq!(train.trajectories[2].label, "train02");
        assert_eq!(
            (train.qd.is_some(), train.qdd.is_some()),
            (inverse, inverse)
        );
        assert_eq!(train.torque_filter, Some(TorqueFilter::KR300));
        // Degrees and motor torque are converted.
        let (row, t) = (300, 300.0 * STEP);
        assert!((train.q[(row, 2)] - position(t, 2).to_radians()).abs() < 1e-12);
        let motor = 0.1 * position(t, 3) + 1.0;
        assert!((train.tau.as_ref().unwrap()[(row, 3)] - 221.0 * motor).abs() < 1e-9);
        // The test part goes on where the training part ends.
        let test = read(&arrays, Part::Test).unwrap();
        assert_eq!(test.trajectories.len(), 2);
        assert!((test.time[0] - train.time[1816] - STEP).abs() < 1e-9);
    }
}

#[test]
fn seams_of_the_clock_are_breaks() {
    let mut arrays = official(true);
    for v in &mut arrays[0].3[606..] {
        *v += 0.2;
    }
    for v in &mut arrays[0].3[1300..] {
        *v += 0.2;
    }
    let train = read(&arrays, Part::Train).unwrap();
    assert_eq!(train.segments(), [0..606, 606..1300, 1300..1817]);
}

#[test]
fn missing_keys_and_wrong_shapes_are_refused() {
    let without = |key: &str| {
        let kept: Vec<Table> = official(false).into_iter().filter(|a| a.0 != key).collect();
        read(&kept, Part::Test).unwrap_err()
    };
    for key in ["u_test", "y_test", "time_test", "time_train"] {
        let e = without(key);
        assert!(
            matches!(e.problem, Problem::MissingColumn { ref missing, .. } if **missing == *key),
            "{e}"
        );
    }
    let mut short = official(false);
    short[1].2 -= 1;
    let cells = 6 * short[1].2;
    short[1].3.truncate(cells);
    assert!(matches!(
        read(&short, Part::Train).unwrap_err().problem,
        Problem::Shape { .. }
    ));
    let mut narrow = official(true);
    narrow[1] = ("u_train", 12, narrow[1].2, vec![0.0; 12 * narrow[1].2]);
    assert!(matches!(
        read(&narrow, Part::Train).unwrap_err().problem,
        Problem::Shape { .. }
    ));
    let mut nan = official(false);
    nan[2].3[6 * 10 + 3] = f64::NAN;
    let e = read(&nan, Part::Train).unwrap_err();
    assert_eq!((e.row, e.column.as_deref()), (Some(11), Some("q4")));
}

#[test]
fn a_border_in_motion_is_refused() {
    let mut moving = official(false);
    for (i, v) in moving[2].3.iter_mut().enumerate() {
        *v += 2.0 * STEP * (i / 6) as f64;
    }
    let e = read(&moving, Part::Train).unwrap_err();
    assert!(
        matches!(e.problem, Problem::NotAtRest { joint: 1, .. }),
        "{e}"
    );
}
