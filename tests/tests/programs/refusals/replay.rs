//! Recordings, drives and files of which no replay can be made: one line with what to do, status 2, nothing written.

use super::refused::{folder, ur5};
use datasets::Recording;
use ndarray::{Array2, s};
use std::path::Path;
use tempfile::TempDir;
use tests::program::{files, program, run};
use tests::synthetic::{Plan, record};

const DRIVE: &str = "[controller]\nkind = \"pd\"\nkp = 800\nkd = 40\n";

/// Samples by which the positions follow.
const LATE: usize = 3;

/// The UR5 under commands that its positions follow three samples late and not quite, 36 s at 100 Hz.
fn followed() -> Recording {
    let plan = Plan {
        trajectories: 1,
        seconds: 36.0,
        ..Plan::default()
    };
    let whole = record(&ur5(), &plan);
    let rows = whole.len() - LATE;
    let mut out = Recording::new(
        "followed",
        whole.time[..rows].to_vec(),
        whole.q.slice(s![..rows, ..]).mapv(|v| 0.97 * v),
        None,
    );
    out.q_ref = Some(whole.q.slice(s![LATE.., ..]).to_owned());
    out
}

fn written(folder: &TempDir, name: &str, recording: &Recording) -> std::path::PathBuf {
    let path = folder.path().join(name);
    datasets::write(recording, &path).expect("writable");
    path
}

/// `replay` refuses these files, and writes none of its own.
#[track_caller]
fn refused(data: &Path, heldout: &Path, drive: &str, fragments: &[&str]) {
    let place = folder();
    let file = data.with_file_name("drive.toml");
    std::fs::write(&file, drive).expect("writable");
    let mut replay = program("replay");
    replay.args(["--robot", "ur5", "--drive"]).arg(&file);
    replay.arg("--data").arg(data).arg("--heldout").arg(heldout);
    for (option, name) in [
        ("--json", "a.json"),
        ("--html", "a.html"),
        ("--patch", "a.urdf"),
    ] {
        replay.arg(option).arg(place.path().join(name));
    }
    run(&mut replay).refused(fragments);
    assert_eq!(files(place.path()), [], "something was written");
}

#[test]
fn commands_that_are_none_of_these_positions() {
    let place = folder();
    let heldout = written(&place, "heldout.parquet", &{
        let mut other = followed();
        other.q.mapv_inplace(|v| 0.9 * v);
        other
    });
    let of = |change: &dyn Fn(&mut Recording, &mut Array2<f64>)| {
        let mut recording = followed();
        let mut command = recording.q_ref.take().expect("it has one");
        change(&mut recording, &mut command);
        recording.q_ref = Some(command);
        written(&place, "data.parquet", &recording)
    };
    let refused = |data: &Path, fragments: &[&str]| refused(data, &heldout, DRIVE, fragments);
    let turned = |k: f64| move |_: &mut Recording, c: &mut Array2<f64>| c.mapv_inplace(|v| k * v);
    let degrees = 180.0 / std::f64::consts::PI;
    refused(
        &of(&turned(degrees)),
        &[
            "commands of joint 1",
            "degrees beside radians",
            "convert them",
        ],
    );
    refused(
        &of(&turned(1.0 / degrees)),
        &["commands of joint 1", "degrees applied twice"],
    );
    refused(
        &of(&|_, c| c.column_mut(2).mapv_inplace(|v| -v)),
        &["joint 3", "run against", "sign"],
    );
    refused(
        &of(&|_, c| {
            let [first, last] = [c.column(0).to_owned(), c.column(4).to_owned()];
            c.column_mut(0).assign(&last);
            c.column_mut(4).assign(&first);
        }),
        &["command 1 is joint 5's", "command 5 is joint 1's", "order"],
    );
    refused(
        &of(&|r, c| *c = r.q.clone()),
        &[
            "commands of joint 1 equal its positions",
            "log what was sent",
        ],
    );
    // The next state in the place of an action.
    refused(
        &of(&|r, c| {
            let later = r.q.slice(s![1.., ..]).to_owned();
            c.slice_mut(s![..-1, ..]).assign(&later);
        }),
        &["equal its positions 1 sample(s) later", "log what was sent"],
    );
    refused(
        &of(&|r, _| r.q.column_mut(1).fill(0.2)),
        &[
            "joint 2 is commanded through",
            "never changes",
            "leave the joint out",
        ],
    );
    refused(
        &of(&|r, c| {
            r.q.fill(0.2);
            c.fill(0.2);
        }),
        &["no joint moves"],
    );
    // Of another run.
    refused(
        &of(&|_, c| {
            let plan = Plan {
                trajectories: 1,
                seconds: 36.0,
                seed: 77,
                ..Plan::default()
            };
            let other = record(&ur5(), &plan).q;
            *c = other.slice(s![..c.nrows(), ..]).to_owned();
        }),
        &["positions do not go with their commands"],
    );
    let rows = |r: &Recording| r.len();
    refused(
        &of(&|r, c| {
            // Positions 1.4 s late.
            let n = rows(r);
            let late = r.q.slice(s![..n - 140, ..]).to_owned();
            r.q.slice_mut(s![140.., ..]).assign(&late);
            c.slice_mut(s![..140, ..]).fill(0.0);
        }),
        &[
            "positions follow the commands +1.4",
            "so slow",
            "shift one of the two clocks",
        ],
    );
    refused(
        &of(&|r, _| {
            // A clock that is one per cent slow.
            let q = r.q.clone();
            for row in 0..rows(r) {
                r.q.row_mut(row).assign(&q.row(row * 99 / 100));
            }
        }),
        &["clocks run apart", "+1.0"],
    );
}

#[test]
fn files_without_commands_and_drives_that_cannot_be() {
    let place = folder();
    let whole = followed();
    let data = written(&place, "data.parquet", &whole);
    let mut other = whole.clone();
    other.q.mapv_inplace(|v| 0.9 * v);
    let heldout = written(&place, "heldout.parquet", &other);
    other.q_ref = None;
    let silent = written(&place, "silent.parquet", &other);
    refused(
        &silent,
        &heldout,
        DRIVE,
        &["no commanded positions", "q_ref"],
    );
    refused(&data, &silent, DRIVE, &["no commanded positions", "q_ref"]);
    refused(&data, &data, DRIVE, &["--heldout", "among --data"]);
    let copy = place.path().join("copy.parquet");
    std::fs::copy(&data, &copy).expect("writable");
    refused(
        &data,
        &copy,
        DRIVE,
        &["rows stand in the recordings", "fitted"],
    );
    let drives = [
        ("kp = 0\nkd = 40\n", "kp is 0"),
        ("kp = 800\nkd = -1\n", "kd is -1"),
        ("kp = 1e12\nkd = 40\n", "cannot be simulated"),
        ("kp = nan\nkd = 40\n", "kp is NaN"),
        ("kp = [800, 800]\nkd = 40\n", "one per joint"),
        (
            "kp = 800\nkd = 40\ntolerance = 30\n",
            "0.3 for thirty per cent",
        ),
    ];
    for (law, fragment) in drives {
        let drive = format!("[controller]\nkind = \"pd\"\n{law}");
        refused(&data, &heldout, &drive, &[fragment]);
    }
    refused(
        &data,
        &heldout,
        "[controller]\nkind = \"pid\"\nkp = 800\nkd = 0.1\nki = 1e6\n",
        &["unstable as given"],
    );
    refused(
        &data,
        &heldout,
        "",
        &["ur5 says nothing of the drives' controller"],
    );
}
