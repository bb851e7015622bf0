//! LeRobot data sets, and lists in Parquet files, as `fixtures/lerobot/make.py` has written them.

use datasets::read::dataset;
use datasets::{ColumnMap, ReadError, ReadOptions, Recording, read};
use std::path::{Path, PathBuf};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fixtures/lerobot")
        .join(name)
}

/// Two joints by these names of columns, in the data set's own units.
fn with(names: &[(&str, &str)]) -> ReadOptions {
    let mut options = ReadOptions::for_robot(2);
    options.columns = ColumnMap::default();
    let own = names
        .iter()
        .map(|(k, v)| ((*k).to_owned(), (*v).to_owned()));
    options.columns.names = own.collect();
    options
}

const BY_NAME: [(&str, &str); 4] = [
    ("q1", "observation.state.shoulder.pos"),
    ("q2", "observation.state.elbow.pos"),
    ("tau1", "observation.current.shoulder.pos"),
    ("tau2", "observation.current.elbow.pos"),
];

/// What make.py wrote: position 10 e + m + i/8, current 100 m + i.
fn as_written(found: &Recording) {
    let labels: Vec<&str> = found
        .trajectories
        .iter()
        .map(|t| t.label.as_str())
        .collect();
    assert_eq!(labels, ["0", "1", "2"]);
    let tau = found.tau.as_ref().unwrap();
    for (e, trajectory) in found.trajectories.iter().enumerate() {
        assert_eq!(trajectory.range.len(), 24);
        for (i, row) in trajectory.range.clone().enumerate() {
            assert!((found.time[row] - i as f64 / 25.0).abs() < 1e-6);
            for m in 0..2 {
                assert_eq!(found.q[[row, m]], (10 * e + m) as f64 + i as f64 / 8.0);
                assert_eq!(tau[[row, m]], (100 * m + i) as f64);
            }
        }
    }
}

#[test]
fn episodes_are_trajectories_and_joints_go_by_name() {
    for version in ["v2", "v3"] {
        let found = read(&fixture(version), &with(&BY_NAME)).unwrap();
        as_written(&found);
    }
    // By number, and another motor's current.
    let mut by_number = BY_NAME;
    by_number[0].1 = "observation.state[0]";
    by_number[3].1 = "observation.current[2]";
    let found = read(&fixture("v3"), &with(&by_number)).unwrap();
    assert_eq!(found.tau.unwrap()[[5, 1]], 205.0);
}

#[test]
fn one_file_of_it_is_a_table_with_lists() {
    let mut names = BY_NAME.map(|(key, name)| {
        let motor = usize::from(name.contains("elbow"));
        let feature = name
            .split(".pos")
            .next()
            .unwrap()
            .rsplit_once('.')
            .unwrap()
            .0;
        (key, format!("{feature}[{motor}]"))
    });
    names.sort();
    let mut all: Vec<(&str, &str)> = names.iter().map(|(k, n)| (*k, n.as_str())).collect();
    all.extend([("time", "timestamp"), ("trajectory", "episode_index")]);
    as_written(&read(&fixture("v3/data/chunk-000/file-000.parquet"), &with(&all)).unwrap());
}

#[track_caller]
fn refused(error: &ReadError, words: &[&str]) {
    let text = error.to_string();
    for word in words {
        assert!(text.contains(word), "{text}");
    }
}

#[test]
fn refusals() {
    // What there is, is said.
    let error = read(&fixture("v2"), &with(&BY_NAME[..3])).unwrap_err();
    refused(
        &error,
        &["tau2", "observation.current[1]", "episode_000000.parquet"],
    );
    let lists = [
        ("q1", "q[0]"),
        ("q2", "q[1]"),
        ("tau1", "q[0]"),
        ("tau2", "q[1]"),
    ];
    let error = read(&fixture("lengths.parquet"), &with(&lists)).unwrap_err();
    refused(&error, &["another length than 2", "29"]);
    let error = read(&fixture("hole.parquet"), &with(&lists)).unwrap_err();
    refused(&error, &["18"]);
    // A folder whose description is none, or without data.
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("meta")).unwrap();
    std::fs::write(folder.path().join("meta/info.json"), "{").unwrap();
    refused(
        &read(folder.path(), &with(&BY_NAME)).unwrap_err(),
        &["info.json", "LeRobot"],
    );
    std::fs::write(folder.path().join("meta/info.json"), "{}").unwrap();
    refused(
        &read(folder.path(), &with(&BY_NAME)).unwrap_err(),
        &["data", "cannot be read"],
    );
    std::fs::create_dir(folder.path().join("data")).unwrap();
    read(folder.path(), &with(&BY_NAME)).unwrap_err();
}

#[test]
fn what_a_data_set_holds_is_listed_by_the_names_that_a_drive_file_takes() {
    for version in ["v2", "v3"] {
        let found = dataset(&fixture(version)).unwrap().unwrap();
        assert_eq!((found.rate_hz, found.episodes), (Some(25.0), None));
        let state = found
            .features
            .iter()
            .find(|f| f.name == "observation.state");
        let state = state.unwrap();
        assert_eq!(state.kind, "float32");
        assert!(state.columns.contains(&BY_NAME[0].1.to_owned()));
        assert_eq!(state.columns.len(), 3);
    }
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(dataset(folder.path()).unwrap(), None);
    let meta = folder.path().join("meta");
    std::fs::create_dir(&meta).unwrap();
    let write = |text: &str| std::fs::write(meta.join("info.json"), text).unwrap();
    write(
        r#"{"fps": 30, "total_episodes": 2, "total_frames": 60, "features": {
        "timestamp": {"dtype": "float32", "shape": [1], "names": null},
        "action": {"dtype": "float32", "shape": [2], "names": null},
        "camera": {"dtype": "video", "shape": [4, 4, 3], "names": ["height", "width", "channels"]}}}"#,
    );
    let found = dataset(folder.path()).unwrap().unwrap();
    assert_eq!((found.episodes, found.frames), (Some(2), Some(60)));
    let columns = |name: &str| {
        let own = found.features.iter().find(|f| f.name == name);
        own.unwrap().columns.clone()
    };
    assert_eq!(columns("timestamp"), ["timestamp"]);
    assert_eq!(columns("action"), ["action[0]", "action[1]"]);
    assert!(columns("camera").is_empty());
    write("{");
    let error = dataset(folder.path()).unwrap_err();
    assert!(error.to_string().contains("info.json"), "{error}");
}
