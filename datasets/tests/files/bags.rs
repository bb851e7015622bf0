//! Bags that the reference packages wrote (`fixtures/bags/make.py`): values, order by name, and each way to be wrong.

use datasets::read::{Format, TopicSummary, planned_trajectories, read_bytes, topics};
use datasets::{Problem, ReadError, ReadOptions, Recording, read};
use std::path::{Path, PathBuf};

const MESSAGES: usize = 48;

fn path(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    folder.join("tests/fixtures/bags").join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(path(name)).unwrap()
}

fn arm() -> ReadOptions {
    ReadOptions {
        joints: vec!["shoulder".into(), "elbow".into()],
        ..ReadOptions::for_robot(2)
    }
}

/// The arm with these keys of a drive file's table of columns.
fn named(keys: &[(&str, &str)]) -> ReadOptions {
    let mut options = arm();
    let keys = keys.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned()));
    options.columns.names.extend(keys);
    options
}

fn refused(bytes: &[u8], options: &ReadOptions) -> ReadError {
    read_bytes(bytes, Format::Bag, Path::new("run.mcap"), options).unwrap_err()
}

/// Position, velocity and effort as the script wrote them.
fn written(joint: usize, i: usize) -> [f64; 3] {
    let (j, i, wave) = (joint as f64, i as f64, (i % 7) as f64);
    [j + i / 128.0, j - i / 256.0, 10.0 * j + wave / 8.0]
}

/// Checks every value; `order` names the joint of each column.
fn holds(r: &Recording, order: [usize; 2]) {
    assert_eq!((r.len(), r.dof(), r.trajectories.len()), (MESSAGES, 2, 1));
    for i in 0..MESSAGES {
        assert!((r.time[i] - 0.01 * i as f64).abs() < 1e-12, "row {i}");
        for (column, joint) in order.into_iter().enumerate() {
            let at = [i, column];
            let found = [
                r.q[at],
                r.qd.as_ref().unwrap()[at],
                r.tau.as_ref().unwrap()[at],
            ];
            assert_eq!(found, written(joint, i), "row {i}, joint {joint}");
        }
    }
    r.validate().unwrap();
}

#[test]
fn values_by_name_from_every_container() {
    for name in [
        "zstd.mcap",
        "lz4.mcap",
        "big_endian.mcap",
        "unchunked.mcap",
        "mcap_ros2.mcap",
        "rosbag2_mcap",
        "rosbag2_db3",
        "rosbag2_db3/rosbag2_db3.db3",
    ] {
        let r = read(&path(name), &arm()).unwrap_or_else(|e| panic!("{e}"));
        holds(&r, [0, 1]);
        assert!(r.notes.is_empty(), "{name}: {:?}", r.notes);
    }
    let turned = ReadOptions {
        joints: vec!["elbow".into(), "shoulder".into()],
        ..arm()
    };
    holds(&read(&path("zstd.mcap"), &turned).unwrap(), [1, 0]);
    // The robot's own names are others: the drive file gives the recording's.
    let mut mapped = named(&[("joint1", "shoulder"), ("joint2", "elbow")]);
    mapped.joints = vec!["a1".into(), "a2".into()];
    holds(&read(&path("zstd.mcap"), &mapped).unwrap(), [0, 1]);
}

#[test]
fn without_names_the_order_of_the_first_message_is_taken_and_said() {
    for dof in [None, Some(2)] {
        let options = ReadOptions {
            dof,
            ..ReadOptions::default()
        };
        let r = read(&path("arm.mcap"), &options).unwrap();
        holds(&r, [1, 0]);
        if dof.is_some() {
            assert!(r.notes[0].contains("elbow, shoulder"), "{:?}", r.notes);
        }
    }
    // A gripper makes it a question which joints are the robot's.
    let e = read(&path("zstd.mcap"), &ReadOptions::for_robot(2)).unwrap_err();
    assert!(matches!(
        e.problem,
        Problem::WrongDof {
            expected: 2,
            found: 3,
            ..
        }
    ));
}

#[test]
fn messages_without_stamp_have_the_time_of_the_log() {
    let r = read(&path("unstamped.mcap"), &arm()).unwrap();
    holds(&r, [0, 1]);
    assert!(r.notes[0].contains("that of the log"), "{:?}", r.notes);
}

#[test]
fn vendor_messages_by_topic_field_and_element() {
    let keys = [
        ("q1", "/motors:motors.q[1]"),
        ("q2", "/motors:motors.q[3]"),
        ("tau1", "motors.current[1]"),
        ("tau2", "motors.current[3]"),
        ("time", "stamp_us"),
    ];
    let mut options = named(&keys);
    options.columns.time_scale = Some(1e-6);
    let r = read(&path("motors.mcap"), &options).unwrap_or_else(|e| panic!("{e}"));
    assert!(r.qd.is_none() && r.notes.is_empty(), "{:?}", r.notes);
    assert_eq!(r.len(), MESSAGES);
    for i in 0..MESSAGES {
        assert!((r.time[i] - 0.01 * i as f64).abs() < 1e-9);
        for joint in 0..2 {
            let [q, _, tau] = written(joint, i);
            let found = [r.q[[i, joint]], r.tau.as_ref().unwrap()[[i, joint]]];
            assert_eq!(found, [q, tau], "row {i}");
        }
    }
}

#[test]
fn another_topic_is_brought_to_the_clock_of_the_positions() {
    let keys = [
        ("q1", "/motors:motors.q[1]"),
        ("q2", "/motors:motors.q[3]"),
        ("tau", "/loads:load"),
    ];
    let r = read(&path("motors.mcap"), &named(&keys)).unwrap_or_else(|e| panic!("{e}"));
    // /loads runs from 2.8 ms to 237.8 ms, every 5 ms; /motors every 10 ms, without stamp.
    assert_eq!(r.len(), 23);
    for row in 0..r.len() {
        let i = row + 1;
        assert_eq!(r.q[[row, 0]], written(0, i)[0]);
        let k = (10.0 * i as f64 - 2.8) / 5.0;
        for joint in 0..2 {
            let expected = 2.0 * joint as f64 + k / 64.0;
            assert!((r.tau.as_ref().unwrap()[[row, joint]] - expected).abs() < 1e-9);
        }
    }
    let notes = r.notes.join("\n");
    assert!(
        notes.contains("`/motors` has messages without header stamp"),
        "{notes}"
    );
    assert!(notes.contains("25 messages of `/motors`"), "{notes}");
}

#[test]
fn what_is_missing_is_named_with_what_there_is() {
    let zstd = bytes("zstd.mcap");
    let says = |options: &ReadOptions, fragments: &[&str]| {
        let text = refused(&zstd, options).to_string();
        for fragment in fragments {
            assert!(text.contains(fragment), "no `{fragment}` in: {text}");
        }
        assert!(!text.contains('\n'), "{text}");
    };
    says(
        &named(&[("q", "/other")]),
        &["topic `/other`", "/joint_states (sensor_msgs/JointState)"],
    );
    says(
        &named(&[("tau", "/other:effort")]),
        &["topic `/other`", "/chatter (std_msgs/String)"],
    );
    says(&named(&[("q", "/chatter")]), &["field `position`", "data"]);
    says(
        &named(&[("tau", "current")]),
        &["field `current`", "position[], velocity[], effort[]"],
    );
    says(
        &named(&[("joint2", "wrist")]),
        &["row 1", "joint `wrist`", "shoulder, elbow, gripper"],
    );
    says(
        &named(&[("joint", "left_{}")]),
        &["joint `left_1, left_2`", "shoulder, elbow, gripper"],
    );
    says(
        &named(&[("q", "/joint_states:position[3]")]),
        &["field `position` has 3 elements"],
    );
    let e = refused(&bytes("motors.mcap"), &arm()).to_string();
    assert!(e.contains("/motors (arm_msgs/Motors)"), "{e}");
}

#[test]
fn damaged_files_are_refused_with_the_place() {
    for name in ["zstd.mcap", "lz4.mcap", "big_endian.mcap", "unchunked.mcap"] {
        let whole = bytes(name);
        for cut in (1..whole.len()).step_by(101) {
            let e = refused(&whole[..cut], &arm());
            let at = matches!(e.problem, Problem::CutOff { at } if at == cut as u64);
            assert!(at, "{name} cut at {cut}: {e}");
        }
        // In the middle of the first chunk, or of the first messages.
        let mut flipped = whole.clone();
        flipped[inside(&whole)] ^= 0x10;
        let e = refused(&flipped, &arm());
        assert!(matches!(e.problem, Problem::Damaged { .. }), "{name}: {e}");
    }
    let unknown = replaced(&bytes("zstd.mcap"), b"zstd", b"zstx");
    assert!(matches!(
        refused(&unknown, &arm()).problem,
        Problem::Compression(name) if name == "zstx"
    ));
    assert!(matches!(
        refused(b"", &arm()).problem,
        Problem::CutOff { at: 0 }
    ));
    assert!(matches!(
        refused(b"time,q1,q2\n0,1,2\n", &arm()).problem,
        Problem::Damaged { .. }
    ));
}

/// A byte of the first chunk's content, or of a message where nothing is packed.
fn inside(file: &[u8]) -> usize {
    let packed = |w: &[u8]| w == b"\x04\0\0\0zstd" || w.starts_with(b"\x03\0\0\0lz4");
    match file.windows(8).position(packed) {
        Some(compression) => compression + 60,
        None => 1500,
    }
}

fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut out = bytes.to_vec();
    let places: Vec<usize> = (0..bytes.len() - from.len())
        .filter(|&i| bytes[i..].starts_with(from))
        .collect();
    assert!(!places.is_empty());
    for place in places {
        out[place..place + to.len()].copy_from_slice(to);
    }
    out
}

#[test]
fn types_that_cannot_be_read_are_refused() {
    let motors = bytes("motors.mcap");
    let options = named(&[("q", "/motors:motors.q"), ("tau", "motors.current")]);
    let foreign = replaced(&motors, b"ros2msg", b"ros2idl");
    let e = refused(&foreign, &options).to_string();
    assert!(
        e.contains("arm_msgs/Motors") && e.contains("`ros2idl`"),
        "{e}"
    );
    let encoded = replaced(&motors, b"\x03\0\0\0cdr", b"\x03\0\0\0rdc");
    let e = refused(&encoded, &options).to_string();
    assert!(e.contains("encoded as `rdc`"), "{e}");
    // Four motors, two joints, no names.
    let e = refused(&motors, &options).to_string();
    assert!(e.contains("`motors.q` has 4 elements"), "{e}");
}

#[test]
fn empty_bags_and_empty_folders_are_refused() {
    assert!(matches!(
        refused(&bytes("empty.mcap"), &arm()).problem,
        Problem::Empty
    ));
    let folder = tempfile::tempdir().unwrap();
    let e = read(folder.path(), &arm()).unwrap_err();
    assert!(matches!(e.problem, Problem::NoBag), "{e}");
}

#[test]
fn sqlite_files_that_cannot_be_used_are_refused() {
    let whole = bytes("rosbag2_db3/rosbag2_db3.db3");
    assert_eq!(refused_or_read(&whole).unwrap().len(), MESSAGES);
    for cut in (0..whole.len()).step_by(997).filter(|&c| c > 6) {
        let e = refused_or_read(&whole[..cut]).unwrap_err();
        assert!(matches!(e.problem, Problem::CutOff { .. }), "{cut}: {e}");
    }
    let mut pages = whole.clone();
    pages[4096..]
        .iter_mut()
        .step_by(4096)
        .for_each(|kind| *kind = 0x77);
    let e = refused_or_read(&pages).unwrap_err();
    assert!(matches!(e.problem, Problem::Damaged { .. }), "{e}");
    let other = replaced(&whole, b"messages", b"massages");
    let e = refused_or_read(&other).unwrap_err();
    assert!(matches!(e.problem, Problem::NoBagTables), "{e}");
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("run.db3");
    std::fs::write(&bag, &whole).unwrap();
    std::fs::write(folder.path().join("run.db3-wal"), "more").unwrap();
    let e = read(&bag, &arm()).unwrap_err();
    assert!(matches!(e.problem, Problem::Unfinished), "{e}");
}

fn refused_or_read(bytes: &[u8]) -> Result<Recording, ReadError> {
    read_bytes(bytes, Format::Bag, Path::new("run.db3"), &arm())
}

#[test]
fn topics_are_listed() {
    let all = topics(&path("zstd.mcap")).unwrap();
    let find = |name: &str| -> &TopicSummary { all.iter().find(|t| t.topic == name).unwrap() };
    let states = find("/joint_states");
    assert_eq!(states.kind, "sensor_msgs/JointState");
    // One of the gripper alone behind every fourth.
    assert_eq!(states.messages, MESSAGES + MESSAGES / 4);
    assert!((states.rate_hz.unwrap() - 59.0 / 0.47).abs() < 1e-6);
    assert_eq!(states.joints, ["shoulder", "elbow", "gripper"]);
    assert!(states.fields.contains(&"effort[]".to_owned()));
    assert_eq!(find("/chatter").messages, 3);
    let motors = topics(&path("motors.mcap")).unwrap();
    assert!(motors[0].fields.contains(&"motors[4].q".to_owned()));
    assert!(topics(&path("empty.mcap")).unwrap().is_empty());
    let e = topics(Path::new("run.csv")).unwrap_err();
    assert!(matches!(e.problem, Problem::NoTopics));
}

/// A plan that the reference package wrote, by `make.py`.
#[test]
fn waypoints_of_a_joint_trajectory() {
    let names = ["shoulder", "elbow"].map(String::from);
    let plan = planned_trajectories(&path("trajectory.mcap"), &names);
    let plan = plan.unwrap().expect("a plan");
    let of = |by: f64| ndarray::Array2::from_shape_fn((4, 2), |(i, j)| j as f64 + i as f64 * by);
    assert_eq!(plan.time, [0.0, 0.1, 0.25, 1.5]);
    assert_eq!((plan.q, plan.qd), (of(0.125), Some(of(-0.25))));
    assert_eq!(plan.qdd, Some(of(0.5)));
    let names = ["shoulder", "wrist"].map(String::from);
    let e = planned_trajectories(&path("trajectory.mcap"), &names).unwrap_err();
    assert!(e.to_string().contains("`wrist` is missing"), "{e}");
    let none = planned_trajectories(&path("zstd.mcap"), &names).unwrap();
    assert!(none.is_none(), "joint states are no plan");
}
