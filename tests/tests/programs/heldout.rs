//! What a held-out recording may be, and what is said of one beyond what was taught.

use physics::robot::Robot;
use tests::csv::Csv;
use tests::program::{program, run};
use tests::synthetic::{Plan, record, record_to};

#[test]
fn what_is_fitted_scores_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let data = record_to(folder.path(), "a.csv", &robot, &Plan::default());
    let whole = record(&robot, &Plan::default());
    let part = folder.path().join("part.parquet");
    datasets::write(&whole.select(&[1]), &part).expect("writable");
    // The same in another format, with fewer digits and names of another style.
    let mut rounded = Csv::of(&whole);
    for cell in rounded.rows.iter_mut().flat_map(|row| &mut row[..]) {
        if let Ok(value) = cell.parse::<f64>() {
            *cell = format!("{value:.4}");
        }
    }
    for name in &mut rounded.header {
        *name = name.replace("tau", "effort_").replace('q', "position_");
    }
    let copy = folder.path().join("other.csv");
    rounded.write(&copy);
    for heldout in [&data, &part, &copy] {
        let mut train = program("train");
        train.args(["--robot", "ur5", "--basic", "--physics-only", "--data"]);
        train.arg(&data).arg("--out").arg(folder.path().join("out"));
        run(train.arg("--heldout").arg(heldout))
            .refused(&["rows stand in the recordings", "fitted"]);
    }
    let model = folder.path().join("model");
    let mut train = program("train");
    train.args(["--robot", "ur5", "--basic", "--physics-only", "--data"]);
    run(train.arg(&data).arg("--out").arg(&model)).succeeded();
    let new = record_to(
        folder.path(),
        "new.csv",
        &robot,
        &Plan {
            seed: 7,
            ..Plan::default()
        },
    );
    for (scored, fitted) in [(&data, true), (&part, true), (&copy, true), (&new, false)] {
        let mut eval = program("eval");
        let said = run(eval.arg("--model").arg(&model).arg("--data").arg(scored));
        let said = said
            .succeeded()
            .out
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ");
        assert_eq!(
            said.contains("fitted on rows of this recording (a.csv)"),
            fitted,
            "{said}"
        );
    }
}

#[test]
fn a_faster_motion_lies_outside_what_was_taught() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let data = record_to(folder.path(), "slow.csv", &robot, &Plan::default());
    let other = Plan {
        seed: 5,
        ..Plan::default()
    };
    let said = |size: f64, speed: f64| {
        let mut made = record(&robot, &other);
        made.time.iter_mut().for_each(|t| *t /= speed);
        made.q *= size;
        made.qd = made.qd.map(|v| v * size * speed);
        made.qdd = made.qdd.map(|a| a * size * speed * speed);
        let heldout = folder.path().join(format!("{size}-{speed}.parquet"));
        datasets::write(&made, &heldout).expect("writable");
        let mut train = program("train");
        train
            .args(["--robot", "ur5", "--physics-only", "--data"])
            .arg(&data);
        train.arg("--out").arg(folder.path().join("out"));
        run(train.arg("--heldout").arg(heldout))
            .succeeded()
            .out
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
    };
    let (outside, simple) = ("outside what was taught", "keeps simple friction");
    let fast = said(1.0, 3.0);
    assert!(fast.contains(outside) && fast.contains(simple), "{fast}");
    // Friction follows the speed: three times the acceleration at the same speeds changes none of its shapes.
    let sharp = said(1.0 / 3.0, 3.0);
    assert!(
        sharp.contains(outside) && !sharp.contains(simple),
        "{sharp}"
    );
    let alike = said(1.0, 1.0);
    assert!(!alike.contains("outside what was taught"), "{alike}");
}
