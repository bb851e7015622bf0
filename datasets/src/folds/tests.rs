use super::*;
use crate::Trajectory;
use ndarray::Array2;
use proptest::prelude::*;

/// Trajectories at 50 Hz, each of so many seconds, position by trajectory and time.
fn recording(lengths: &[f64], q: impl Fn(usize, f64) -> f64) -> Recording {
    let (mut time, mut values, mut trajectories) = (Vec::new(), Vec::new(), Vec::new());
    for (k, &length) in lengths.iter().enumerate() {
        let start = time.len();
        for i in 0..=(length * 50.0) as usize {
            let t = i as f64 / 50.0;
            time.push(100.0 * k as f64 + t);
            values.push(q(k, t));
        }
        trajectories.push(Trajectory {
            label: k.to_string(),
            range: start..time.len(),
        });
    }
    let q = Array2::from_shape_vec((values.len(), 1), values).unwrap();
    Recording {
        trajectories,
        ..Recording::new("test", time, q, None)
    }
}

fn fold_of(folds: &Folds, row: usize) -> &Cell {
    let stretch = folds.rows[0].iter().find(|(r, _)| r.contains(&row));
    &folds.cells[stretch.unwrap().1]
}

#[test]
fn two_visits_of_three_repeated_motions() {
    let repeats = [(0, 3), (1, 4), (2, 5), (6, 9), (7, 10), (8, 11)];
    assert_eq!(groups(12, &repeats), vec![0..6, 6..12]);
    assert_eq!(groups(3, &[]), vec![0..1, 1..2, 2..3]);
}

#[test]
fn many_trajectories_are_never_cut() {
    let r = recording(&[4.0; 8], |k, t| (t * (1.0 + 0.3 * k as f64)).sin());
    let folds = Folds::new(&[&r], 6, 0.5);
    assert!(folds.whole && folds.count == 6);
    assert_eq!(folds.of_trajectories(&[&r])[0], [0, 1, 2, 3, 4, 5, 0, 1]);
    assert!(folds.cells.iter().all(|c| c.near.is_empty()));
}

#[test]
fn one_trajectory_is_cut_in_blocks_with_a_gap() {
    // Not periodic: a chirp.
    let r = recording(&[24.0], |_, t| (t + 0.05 * t * t).sin());
    let folds = Folds::new(&[&r], 6, 0.5);
    assert!(!folds.whole && folds.count == 6);
    // Blocks of 4 s; 3.8 s is block 0 and within half a second of block 1.
    assert_eq!(
        *fold_of(&folds, 100),
        Cell {
            fold: 0,
            near: vec![]
        }
    );
    assert_eq!(
        *fold_of(&folds, 190),
        Cell {
            fold: 0,
            near: vec![1]
        }
    );
    assert_eq!(
        *fold_of(&folds, 210),
        Cell {
            fold: 1,
            near: vec![0]
        }
    );
    // No row within the gap of what is tested is fitted.
    for fold in 0..6 {
        let fitted: Vec<usize> = folds.fitted(fold).collect();
        for (rows, cell) in &folds.rows[0] {
            if !fitted.contains(cell) {
                continue;
            }
            let block = r.time[0] + 4.0 * fold as f64;
            for row in rows.clone() {
                let t = r.time[row];
                assert!(
                    t <= block - 0.5 + 1e-9 || t >= block + 4.5 - 1e-9,
                    "{t} {fold}"
                );
            }
        }
    }
}

#[test]
fn periods_of_one_motion_are_cut_at_the_same_phases() {
    let tau = std::f64::consts::TAU;
    // Five periods of 6 s: the same phase is in the same fold in each.
    let r = recording(&[30.0], |_, t| {
        (t / 6.0 * tau).sin() + 0.4 * (t / 2.0 * tau).cos()
    });
    assert!((period(&r, 0..r.len()).unwrap() - 6.0).abs() < 0.05);
    let folds = Folds::new(&[&r], 6, 0.5);
    for row in 0..r.len() - 300 {
        // Away from the cuts, which a thinned period places to a few samples.
        if !(5..45).contains(&(row % 50)) {
            continue;
        }
        assert_eq!(
            fold_of(&folds, row).fold,
            fold_of(&folds, row + 300).fold,
            "{row}"
        );
    }
}

#[test]
fn two_executions_of_one_motion_are_cut_alike() {
    let r = recording(&[12.0, 12.0], |_, t| (t + 0.05 * t * t).sin());
    let folds = Folds::new(&[&r], 6, 0.5);
    assert!(!folds.whole && folds.count == 6);
    for row in 0..600 {
        assert_eq!(fold_of(&folds, row), fold_of(&folds, row + 601), "{row}");
    }
}

proptest! {
    #[test]
    fn every_row_has_one_fold(
        lengths in prop::collection::vec(2.0_f64..9.0, 1..7),
        most in 1usize..8,
        gap in 0.0_f64..2.0,
    ) {
        let r = recording(&lengths, |k, t| (t * (1.0 + 0.3 * k as f64) + 0.1 * t * t).sin());
        let folds = Folds::new(&[&r], most, gap);
        let mut next = 0;
        for (rows, cell) in &folds.rows[0] {
            prop_assert_eq!(rows.start, next);
            prop_assert!(folds.cells[*cell].fold < folds.count);
            next = rows.end;
        }
        prop_assert_eq!(next, r.len());
        for fold in 0..folds.count {
            prop_assert!(folds.fitted(fold).all(|c| folds.cells[c].fold != fold));
        }
    }

    #[test]
    fn repeats_share_a_group(n in 1usize..30, pairs in prop::collection::vec((0usize..30, 0usize..30), 0..20)) {
        let pairs: Vec<_> = pairs.into_iter().filter(|&(a, b)| a < n && b < n).collect();
        let groups = groups(n, &pairs);
        for (a, b) in pairs {
            prop_assert!(groups.iter().any(|g| g.contains(&a) && g.contains(&b)));
        }
    }
}

/// A B C A B C …: six motions, each executed twice, the second time with the encoder's noise.
#[test]
fn executions_of_one_motion_are_dealt_together() {
    let r = recording(&[4.0; 12], |k, t| {
        let motion = (k % 6) as f64;
        (t * (1.0 + 0.3 * motion)).sin() + 1e-4 * (k as f64 + 37.0 * t).sin()
    });
    let motions = Motions::new(&[&r]);
    assert_eq!(motions.count, 6);
    // One visit to the robot, which is cut where visits are dealt.
    assert!(!Folds::new(&[&r], 4, 0.5).whole);
    let folds = Folds::of_motions(&[&r], 4, 0.5);
    assert!(folds.whole && folds.count == 4);
    assert!(folds.cells.iter().all(|c| c.near.is_empty()));
    let dealt = &folds.of_trajectories(&[&r])[0];
    assert_eq!(dealt[..], [0, 1, 2, 3, 0, 1, 0, 1, 2, 3, 0, 1]);
}

/// Two motions, each executed twice: both are cut, at the same places, with a gap.
#[test]
fn few_motions_are_cut_alike() {
    let r = recording(&[8.0; 4], |k, t| {
        let motion = (k % 2) as f64;
        (t * (1.0 + 0.3 * motion) + 0.05 * t * t).sin()
    });
    let folds = Folds::of_motions(&[&r], 8, 0.5);
    assert!(!folds.whole && folds.count == 8);
    for i in 0..401 {
        for k in 0..2 {
            let [first, again] = [k, k + 2].map(|k| fold_of(&folds, 401 * k + i));
            assert_eq!(first, again, "row {i}");
        }
    }
    // Blocks of 2 s; 1.8 s is within half a second of the second.
    assert_eq!(fold_of(&folds, 90).near, [1]);
    assert!(fold_of(&folds, 50).near.is_empty());
}
