//! Reads the real recordings and example cases next to the repository, where they are there.

use crate::shared::shared;
use datasets::{Folds, Part, ReadOptions, Recording, TorqueFilter, read};

fn kr300(file: &str, part: Part) -> Option<Recording> {
    let path = shared(&format!("data/kr300/{file}"))?;
    Some(read(&path, &ReadOptions::kr300(part)).unwrap())
}

#[test]
fn kr300_parquet_has_72_executions_and_the_torque_filter() {
    let Some(train) = kr300("train.parquet", Part::Train) else {
        return;
    };
    let Some(test) = kr300("test.parquet", Part::Test) else {
        return;
    };
    assert_eq!((train.len(), train.trajectories.len()), (39_856, 66));
    assert_eq!((test.len(), test.trajectories.len()), (3_624, 6));
    for r in [&train, &test] {
        r.validate().unwrap();
        assert_eq!(r.torque_filter, Some(TorqueFilter::KR300));
        // The benchmark's last training execution is eight samples short.
        let lengths = r.trajectories.iter().map(|t| t.range.len());
        assert!(lengths.into_iter().all(|n| n == 604 || n == 596));
    }
}

/// 33 motions, of which the second executions follow all the first ones: A B C … A B C ….
#[test]
fn no_pair_of_repeats_of_a_kr300_straddles_folds() {
    let Some(train) = kr300("train.parquet", Part::Train) else {
        return;
    };
    let pairs = datasets::repeats::find(&train);
    assert_eq!(pairs.len(), 33);
    let folds = Folds::of_motions(&[&train], 8, 0.5);
    assert!(folds.whole && folds.count == 8);
    let fold = &folds.of_trajectories(&[&train])[0];
    assert!(pairs.iter().all(|&(a, b)| fold[a] == fold[b]), "{fold:?}");
}

#[test]
fn kr300_mat_files_hold_the_same_samples_as_parquet() {
    for (part, parquet) in [(Part::Train, "train.parquet"), (Part::Test, "test.parquet")] {
        let Some(reference) = kr300(parquet, part) else {
            return;
        };
        for name in ["forward", "inverse"] {
            let file = format!("{name}_identification_without_raw_data.mat");
            let Some(mat) = kr300(&file, part) else {
                return;
            };
            mat.validate().unwrap();
            assert_eq!(mat.segments(), reference.segments(), "{name} {part:?}");
            assert_eq!(mat.torque_filter, Some(TorqueFilter::KR300));
            let close = |a: &ndarray::Array2<f64>, b: &ndarray::Array2<f64>, tolerance: f64| {
                let worst = (a - b).iter().fold(0.0_f64, |w, d| w.max(d.abs()));
                assert!(worst < tolerance, "{name} {part:?}: {worst}");
            };
            close(&mat.q, &reference.q, 1e-12);
            close(
                mat.tau.as_ref().unwrap(),
                reference.tau.as_ref().unwrap(),
                1e-9,
            );
            assert_eq!(mat.qd.is_some(), name == "inverse");
            if let (Some(qd), Some(expected)) = (&mat.qd, &reference.qd) {
                close(qd, expected, 1e-12);
                close(
                    mat.qdd.as_ref().unwrap(),
                    reference.qdd.as_ref().unwrap(),
                    1e-12,
                );
            }
            // The pause between the parts is not in the .mat file: it counts one seam.
            let pause = mat.time[0] - reference.time[0];
            assert!(
                pause.abs() < if part == Part::Train { 1e-9 } else { 1.0 },
                "{pause}"
            );
            for (a, b) in mat.time.iter().zip(&reference.time) {
                assert!((a - b - pause).abs() < 1e-6, "{name} {part:?}: {a} {b}");
            }
        }
    }
}

#[test]
fn ur10e_csv_is_one_trajectory_each() {
    for (file, rows) in [
        ("20_02_10-30sec_12harm", 3038),
        ("20_02_12-50sec_12harm", 4962),
        ("20_02_19_14harm50sec", 4975),
        ("20_02_19_15harm50sec", 5001),
    ] {
        let Some(path) = shared(&format!("data/ur10e/{file}.csv")) else {
            return;
        };
        let r = read(&path, &ReadOptions::for_robot(6)).unwrap();
        r.validate().unwrap();
        assert_eq!((r.len(), r.trajectories.len()), (rows, 1), "{file}");
        assert_eq!(r.trajectories[0].label, file);
        assert!(r.qd.is_some() && r.qdd.is_none() && r.torque_filter.is_none());
    }
}

#[test]
fn example_cases_are_read() {
    let Some(cases) = shared("cases/cases") else {
        return;
    };
    let mut seen = 0;
    for case in std::fs::read_dir(cases).unwrap() {
        let case = case.unwrap().path();
        let [train, test] = ["train.parquet", "test.parquet"].map(|file| {
            let r = read(&case.join(file), &ReadOptions::default()).unwrap();
            r.validate().unwrap();
            assert!(r.tau.is_some() && r.qdd.is_none() && r.torque_filter.is_none());
            r
        });
        assert!(!train.is_empty() && !test.is_empty());
        assert_eq!(train.dof(), test.dof());
        seen += 1;
    }
    assert!(seen > 0);
}
