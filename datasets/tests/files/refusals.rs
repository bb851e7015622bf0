//! Every way in which a file is refused: place, problem and advice.

use datasets::{Part, Problem, ReadError, ReadOptions, Recording, TorqueFilter, read, write};
use ndarray::Array2;
use std::fmt::Write as _;
use std::path::Path;

/// A small two-joint recording as CSV lines; `edit` changes them.
fn csv(edit: impl FnOnce(&mut Vec<String>)) -> String {
    let mut lines = vec!["time,trajectory,q1,q2,tau1,tau2".to_owned()];
    for i in 0..40 {
        let t = f64::from(i) * 0.01;
        lines.push(format!("{t},a,{},{},1.5,{}", t.sin(), t.cos(), 2.0 * t));
    }
    edit(&mut lines);
    lines.join("\n") + "\n"
}

fn options() -> ReadOptions {
    ReadOptions::for_robot(2)
}

fn read_text(text: &str) -> Result<Recording, ReadError> {
    read_as("run.csv", text.as_bytes(), &options())
}

fn read_as(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Recording, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read(&path, options)
}

/// The refusal of a file; its message names the file and says what to do.
fn refused(text: &str) -> ReadError {
    let error = read_text(text).unwrap_err();
    let message = error.to_string();
    assert!(
        message.contains("run.csv") && message.ends_with('.'),
        "{message}"
    );
    println!("{message}");
    error
}

#[test]
fn a_good_file_is_read() {
    let r = read_text(&csv(|_| {})).unwrap();
    assert_eq!((r.len(), r.dof(), r.trajectories.len()), (40, 2, 1));
    // With a byte-order mark, blanks, other columns and Windows line ends as well.
    let text = csv(|l| {
        l[0] = "\u{feff} time ,trajectory,q1,q2,tau1, tau2,comment".into();
        l[1..].iter_mut().for_each(|l| l.push_str(", free text "));
    });
    let again = read_text(&text.replace('\n', "\r\n")).unwrap();
    assert_eq!(again.q, r.q);
}

#[test]
fn missing_column() {
    let e = refused(&csv(|l| l[0] = "time,trajectory,q1,q2,tau1,torque2".into()));
    assert!(
        matches!(e.problem, Problem::MissingColumn { ref missing, .. } if **missing == *"tau2")
    );
    let e = refused(&csv(|l| l[0] = "when,trajectory,q1,q2,tau1,tau2".into()));
    assert!(
        matches!(e.problem, Problem::MissingColumn { ref missing, .. } if **missing == *"time")
    );
    let e = refused("a damaged head\n1\n2\n");
    assert!(matches!(e.problem, Problem::MissingColumn { .. }));
}

#[test]
fn torque_may_be_missing_for_prediction_alone() {
    let text = csv(|l| l[0] = "time,trajectory,q1,q2,x,y".into());
    let e = refused(&text);
    assert!(matches!(e.problem, Problem::NoTorque { .. }));
    assert!(e.to_string().contains("residyn replay"), "{e}");
    let o = ReadOptions {
        torque_needed: false,
        ..options()
    };
    assert!(
        read_as("run.csv", text.as_bytes(), &o)
            .unwrap()
            .tau
            .is_none()
    );
}

#[test]
fn wrong_number_of_joints() {
    for dof in [1, 3] {
        let o = ReadOptions::for_robot(dof);
        let e = read_as("run.csv", csv(|_| {}).as_bytes(), &o).unwrap_err();
        assert!(
            matches!(&e.problem, Problem::WrongDof { expected, found: 2, .. } if *expected == dof),
            "{e}"
        );
    }
}

#[test]
fn a_model_has_its_own_joints_which_no_option_chooses() {
    let o = ReadOptions {
        joints: ["base", "elbow", "wrist"].map(str::to_owned).to_vec(),
        stored_model: true,
        ..ReadOptions::for_robot(3)
    };
    let e = read_as("run.csv", csv(|_| {}).as_bytes(), &o).unwrap_err();
    let text = e.to_string();
    let said = "has columns for 2 joints (q1, q2), the model has 3 (base, elbow, wrist)";
    assert!(text.contains(said) && !text.contains("--joints"), "{text}");
}

#[test]
fn values_that_are_no_numbers_are_named_by_row_line_and_column() {
    for (cell, expected) in [("NaN", "NaN"), ("inf", "inf"), ("-Infinity", "-inf")] {
        let e = refused(&csv(|l| l[5] = format!("0.04,a,{cell},1,1,1")));
        assert_eq!(
            (e.row, e.line, e.column.as_deref()),
            (Some(5), Some(6), Some("q1"))
        );
        assert!(matches!(e.problem, Problem::NotFinite(v) if v.to_string() == expected));
    }
    // Line ends of Windows, and blank lines, count as an editor counts them.
    let bad = csv(|l| l[5] = "0.04,a,NaN,1,1,1".into());
    for (text, line) in [
        (bad.replace('\n', "\r\n"), 6),
        (bad.replacen('\n', "\n\n", 3), 9),
        (bad.replacen('\n', "\r\n\r\n", 3), 9),
    ] {
        let e = refused(&text);
        assert_eq!((e.row, e.line), (Some(5), Some(line)), "{text}");
    }
    let e = refused(&csv(|l| l[7] = "0.06,a,1,1,1,1.2.3".into()));
    assert_eq!((e.row, e.column.as_deref()), (Some(7), Some("tau2")));
    assert!(matches!(e.problem, Problem::NotANumber(ref s) if s == "1.2.3"));
    let e = refused(&csv(|l| l[7] = "0.06,a,,1,1,1".into()));
    assert!(matches!(e.problem, Problem::MissingValue));
}

#[test]
fn a_row_with_another_number_of_cells() {
    let e = refused(&csv(|l| l[3] = "0.02,a,1,1,1".into()));
    assert_eq!((e.row, e.line), (Some(3), Some(4)));
    assert!(matches!(
        e.problem,
        Problem::RowLength {
            expected: 6,
            found: 5
        }
    ));
}

#[test]
fn time_that_stands_still_or_goes_back() {
    for t in ["0.01", "0.005"] {
        let e = refused(&csv(|l| l[3] = format!("{t},a,1,1,1,1")));
        assert_eq!((e.row, e.column.as_deref()), (Some(3), Some("time")));
        assert!(matches!(e.problem, Problem::TimeNotIncreasing { .. }));
    }
    // Over a break time may restart.
    let two = csv(|l| {
        let again: Vec<String> = l[1..].iter().map(|l| l.replace(",a,", ",b,")).collect();
        l.extend(again);
    });
    assert_eq!(read_text(&two).unwrap().trajectories.len(), 2);
}

#[test]
fn duplicate_names() {
    let e = refused(&csv(|l| l[0] = "time,trajectory,q1,q1,tau1,tau2".into()));
    assert_eq!(e.column.as_deref(), Some("q1"));
    assert!(matches!(e.problem, Problem::DuplicateColumn(2)));
}

#[test]
fn too_few_samples_and_scattered_labels() {
    let e = refused(&csv(|l| l.truncate(11)));
    assert!(matches!(e.problem, Problem::TooShort { samples: 10, .. }));
    // Rows of two trajectories mixed up: every change of label is a break.
    let e = refused(&csv(|l| {
        l.iter_mut()
            .skip(1)
            .step_by(2)
            .for_each(|l| *l = l.replace(",a,", ",b,"));
    }));
    assert!(matches!(e.problem, Problem::TooShort { samples: 1, .. }));
}

#[test]
fn empty_files_and_files_without_a_header() {
    assert!(matches!(refused("").problem, Problem::Empty));
    assert!(matches!(refused("\n\n").problem, Problem::Empty));
    assert!(matches!(
        refused("time,q1,q2,tau1,tau2\n").problem,
        Problem::Empty
    ));
    assert!(matches!(
        refused("0,1,2,3\n0.1,1,2,3\n").problem,
        Problem::NoHeader(_)
    ));
    for name in ["run.parquet", "run.npz", "run.mat"] {
        let o = ReadOptions::kr300(Part::Train);
        assert!(
            matches!(read_as(name, b"", &o).unwrap_err().problem, Problem::Empty),
            "{name}"
        );
        let e = read_as(name, b"nonsense, and more of it", &o).unwrap_err();
        assert!(matches!(e.problem, Problem::Damaged { .. }), "{e}");
    }
}

#[test]
fn unknown_formats_and_absent_files() {
    let e = read_as("run.xlsx", b"", &options()).unwrap_err();
    assert!(matches!(e.problem, Problem::UnknownFormat(ref s) if s == "xlsx"));
    let e = read_as("run.bag", b"#ROSBAG V2.0", &options()).unwrap_err();
    assert!(e.to_string().contains("rosbags-convert"), "{e}");
    let e = read(Path::new("/nowhere/run.csv"), &options()).unwrap_err();
    assert!(matches!(e.problem, Problem::Io(_)));
    let e = read_as("run.mat", b"MATLAB", &options()).unwrap_err();
    assert!(matches!(e.problem, Problem::MatNeedsKr300));
}

fn sample(filter: Option<TorqueFilter>) -> Recording {
    let n = 50;
    let time: Vec<f64> = (0..n).map(|i| f64::from(i) * 0.1).collect();
    let table =
        |s: f64| Array2::from_shape_fn((50, 2), |(i, j)| (i as f64 * 0.1 + s + j as f64).sin());
    let mut r = Recording::new("made", time, table(0.0), Some(table(1.0)));
    r.qd = Some(table(2.0));
    r.temp = Some(table(3.0));
    r.trajectories[0].range = 0..25;
    r.trajectories.push(datasets::Trajectory {
        label: "second, \"b\"".into(),
        range: 25..50,
    });
    r.torque_filter = filter;
    r
}

#[test]
fn what_is_written_reads_back_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["run.csv", "run.parquet"] {
        let path = folder.path().join(name);
        let r = sample(None);
        write(&r, &path).unwrap();
        let back = read(&path, &options()).unwrap();
        assert_eq!(
            back,
            Recording {
                source: path.display().to_string(),
                ..r
            }
        );
    }
    // Nothing else is left in the folder.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn parquet_says_itself_whether_its_torque_is_filtered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.parquet");
    let mut kr300 = options();
    kr300.torque_filter = Some(TorqueFilter::KR300.decimated());
    write(&sample(None), &path).unwrap();
    assert_eq!(read(&path, &kr300).unwrap().torque_filter, None);
    write(&sample(Some(TorqueFilter::KR300)), &path).unwrap();
    assert_eq!(
        read(&path, &options()).unwrap().torque_filter,
        Some(TorqueFilter::KR300)
    );
    // CSV cannot: the robot decides, at the rate of the benchmark only.
    let path = folder.path().join("run.csv");
    write(&sample(None), &path).unwrap();
    assert_eq!(
        read(&path, &kr300).unwrap().torque_filter,
        Some(TorqueFilter::KR300)
    );
    let mut fast = sample(None);
    fast.time.iter_mut().for_each(|t| *t *= 0.1);
    write(&fast, &path).unwrap();
    assert_eq!(read(&path, &kr300).unwrap().torque_filter, None);
}

#[test]
fn a_truncated_parquet_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.parquet");
    write(&sample(None), &path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    for length in [1, 4, bytes.len() / 2, bytes.len() - 1] {
        let e = read_as("run.parquet", &bytes[..length], &options()).unwrap_err();
        assert!(
            matches!(e.problem, Problem::Damaged { .. }),
            "{length}: {e}"
        );
    }
}

#[test]
fn a_failed_write_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    std::fs::write(&path, "old").unwrap();
    assert!(write(&sample(None), &folder.path().join("run.txt")).is_err());
    assert!(write(&sample(None), &folder.path().join("absent/run.csv")).is_err());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
}

#[test]
fn a_jump_of_the_clock_is_a_break() {
    let mut text = csv(|_| {});
    for i in 0..30 {
        let _ = writeln!(text, "{},a,0,0,0,{i}", 5.0 + f64::from(i) * 0.01);
    }
    let r = read_text(&text).unwrap();
    assert_eq!(r.segments(), [0..40, 40..70]);
    assert!(r.trajectories.iter().all(|t| t.label == "a"));
}

#[test]
fn names_and_units_of_the_columns_can_be_given() {
    use datasets::{Affine, Group};
    let text = csv(|l| l[0] = "stamp,run,pos_1,pos_2,current_1,current_2".into());
    let mut o = options();
    for (key, name) in [
        ("time", "stamp"),
        ("trajectory", "run"),
        ("q", "pos_{}"),
        ("tau", "current_{}"),
    ] {
        o.columns.names.insert(key.into(), name.into());
    }
    o.columns.time_scale = Some(1e-3);
    let unit = |scale, offset| Affine { scale, offset };
    o.columns
        .units
        .insert(Group::Q, vec![unit(1.0, 0.5), unit(-1.0, 0.0)]);
    o.columns.units.insert(Group::Tau, vec![unit(12.0, 0.0)]);
    let r = read_as("run.csv", text.as_bytes(), &o).unwrap();
    assert_eq!((r.time[1], r.q[(0, 0)], r.q[(0, 1)]), (1e-5, 0.5, -1.0));
    assert_eq!(r.tau.unwrap()[(3, 0)], 18.0);
}

#[test]
fn a_text_without_header_is_read_by_the_names_of_the_drive_file() {
    let mut named = options();
    let header = "time, q1 q2 - tau1 tau2".to_owned();
    named.columns.names.insert("header".into(), header);
    for separator in [",", ";", "\t"] {
        let row = |i: usize| [0.1 * i as f64, i as f64, 2.0, 9.0, 3.0 + i as f64, 4.0];
        let line = |i: usize| row(i).map(|v| v.to_string()).join(separator);
        let text = (0..24).map(line).collect::<Vec<_>>().join("\n");
        let r = read_as("run.csv", text.as_bytes(), &named).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((r.len(), r.q[[23, 0]], r.q[[23, 1]]), (24, 23.0, 2.0));
        assert_eq!(r.tau.unwrap().row(0).to_vec(), [3.0, 4.0]);
        // A cell too few throughout, and in one row.
        let narrow = text.replace(&format!("{separator}9{separator}"), separator);
        let e = read_as("run.csv", narrow.as_bytes(), &named).unwrap_err();
        let expected = matches!(
            e.problem,
            Problem::RowLength {
                expected: 6,
                found: 5
            }
        );
        assert!(expected && e.line == Some(1), "{e}");
        let e = read_as(
            "run.csv",
            format!("{text}\n1{separator}2").as_bytes(),
            &named,
        );
        let e = e.unwrap_err();
        assert!(
            matches!(e.problem, Problem::RowLength { .. }) && e.row == Some(25),
            "{e}"
        );
    }
}
