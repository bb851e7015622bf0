//! Recordings in memory that no reader has checked: each fault is an error, and nothing is fitted.

use datasets::Recording;
use ndarray::Array2;
use physics::robot::{Robot, drive::Drive};
use replay::{Options, Subject, replay};

/// A UR5 whose drives are known.
fn subject() -> Subject {
    let robot = Robot::builtin("ur5").expect("built in");
    let gains = "[controller]\nkind = \"pd\"\nkp = [900, 900, 900, 90, 90, 90]\nkd = [50, 50, 50, 5, 5, 5]\n";
    let drive = Drive::from_toml(gains, &robot).expect("a drive file");
    Subject::of(robot, drive).expect("a subject")
}

/// Two seconds of `joints` joints that follow their commands late and not all the way; `phase` makes it another motion.
fn recording(joints: usize, phase: f64) -> Recording {
    let table = |late: f64, part: f64| {
        Array2::from_shape_fn((200, joints), |(row, j)| {
            let t = row as f64 / 100.0 + phase - late;
            (2.0 * t + j as f64).sin() + part * (7.0 * t).sin()
        })
    };
    let time = (0..200).map(|row| row as f64 / 100.0).collect();
    Recording {
        q_ref: Some(table(0.0, 0.3)),
        ..Recording::new("memory", time, table(0.05, 0.2), None)
    }
}

/// The refusal of these recordings.
fn refused(data: &[Recording], heldout: &Recording) -> String {
    let options = Options::default().fast(true);
    let done = replay(subject(), data, heldout, options, |_| {
        panic!("nothing is simulated")
    });
    let error = done.expect_err("a refusal");
    assert!(error.is_input());
    error.to_string()
}

#[test]
fn faults_are_refused_before_anything_is_simulated() {
    let (good, other) = (recording(6, 0.0), recording(6, 1.0));
    assert!(refused(&[], &other).contains("no recording to fit"));
    let five = recording(5, 0.0);
    assert!(refused(&[five], &other).contains("has 5 joints, the robot has 6"));
    let mut short = good.clone();
    short.q_ref = Some(Array2::zeros((5, 6)));
    assert!(refused(&[short], &other).contains("`q_ref`"));
    let mut hole = good.clone();
    hole.q[[7, 2]] = f64::NAN;
    assert!(refused(&[hole], &other).contains("not finite"));
    let mut none = good.clone();
    none.q_ref = None;
    assert!(refused(&[none], &other).contains("no commanded positions"));
    let same = refused(std::slice::from_ref(&good), &good);
    assert!(same.contains("rows stand in the recordings"), "{same}");
    let empty = Recording::new("empty", Vec::new(), Array2::zeros((0, 6)), None);
    assert!(refused(&[empty], &other).contains("empty"));
}
