//! Planned motions with their effort, as messages of the type trajectory_msgs/JointTrajectory: in an MCAP file, or
//! as the YAML text that `ros2 topic pub` and `ros2 topic echo` share.

use super::mcap::{Channel, Mcap};
use super::{WriteError, WriteProblem, atomically};
use crate::Recording;
use ndarray::Array2;
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

const KIND: &str = "trajectory_msgs/msg/JointTrajectory";
const TOPIC: &str = "/joint_trajectory";
/// Definition of the type with the types that it contains, as ROS 2 writes it into bags.
const DEFINITION: &str = "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint[] points\n\
    ================================================================================\nMSG: std_msgs/Header\n\
    builtin_interfaces/Time stamp\nstring frame_id\n\
    ================================================================================\nMSG: builtin_interfaces/Time\n\
    int32 sec\nuint32 nanosec\n\
    ================================================================================\n\
    MSG: trajectory_msgs/JointTrajectoryPoint\nfloat64[] positions\nfloat64[] velocities\nfloat64[] accelerations\n\
    float64[] effort\nbuiltin_interfaces/Duration time_from_start\n\
    ================================================================================\nMSG: builtin_interfaces/Duration\n\
    int32 sec\nuint32 nanosec\n";

/// Writes each trajectory of a recording as a JointTrajectory of the `joints` (names, base first), its torque as
/// effort; the ending of the name (.mcap or .yaml) decides on the format. The times of a trajectory become its times from
/// start and must not be negative.
///
/// # Errors
/// An unknown ending or a failure of the disk; the file is then as it was before.
pub fn write_trajectories(
    recording: &Recording,
    joints: &[String],
    path: &Path,
) -> Result<(), WriteError> {
    let fail = |problem| WriteError {
        file: path.to_owned(),
        problem,
    };
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let bytes = match ending.to_ascii_lowercase().as_str() {
        "mcap" => mcap(recording, joints),
        "yaml" | "yml" => yaml(recording, joints).into_bytes(),
        other => return Err(fail(WriteProblem::UnknownFormat(other.to_owned()))),
    };
    atomically(path, |out| Ok(out.write_all(&bytes)?)).map_err(fail)
}

/// Tables of a point in the order of the message; those that are missing are empty there.
fn tables(recording: &Recording) -> [Option<&Array2<f64>>; 4] {
    let Recording {
        q, qd, qdd, tau, ..
    } = recording;
    [Some(q), qd.as_ref(), qdd.as_ref(), tau.as_ref()]
}

/// Whole seconds and nanoseconds of a row's time from start.
fn from_start(recording: &Recording, row: usize) -> (i64, i64) {
    let nanoseconds = (recording.time[row] * 1e9).round() as i64;
    (
        nanoseconds.div_euclid(1_000_000_000),
        nanoseconds.rem_euclid(1_000_000_000),
    )
}

fn mcap(recording: &Recording, joints: &[String]) -> Vec<u8> {
    let mut file = Mcap::new(&Channel {
        profile: "ros2",
        kind: KIND,
        language: "ros2msg",
        definition: DEFINITION,
        topic: TOPIC,
        encoding: "cdr",
    });
    for (k, trajectory) in recording.trajectories.iter().enumerate() {
        file.message(
            k as u64,
            &message(recording, joints, trajectory.range.clone()),
        );
    }
    file.finish()
}

/// One message in little-endian CDR behind its encapsulation.
fn message(recording: &Recording, joints: &[String], rows: std::ops::Range<usize>) -> Vec<u8> {
    let mut data = vec![0; 8];
    string(&mut data, "");
    count(&mut data, joints.len());
    joints.iter().for_each(|joint| string(&mut data, joint));
    count(&mut data, rows.len());
    for row in rows.clone() {
        for table in tables(recording) {
            count(&mut data, table.map_or(0, Array2::ncols));
            let Some(table) = table else { continue };
            data.resize(data.len().next_multiple_of(8), 0);
            table
                .row(row)
                .iter()
                .for_each(|v| data.extend(v.to_le_bytes()));
        }
        let (seconds, rest) = from_start(recording, row);
        data.resize(data.len().next_multiple_of(4), 0);
        data.extend((seconds as i32).to_le_bytes());
        data.extend((rest as u32).to_le_bytes());
    }
    [&[0, 1, 0, 0][..], &data].concat()
}

fn count(data: &mut Vec<u8>, count: usize) {
    data.resize(data.len().next_multiple_of(4), 0);
    data.extend((count as u32).to_le_bytes());
}

fn string(data: &mut Vec<u8>, text: &str) {
    count(data, text.len() + 1);
    data.extend(text.as_bytes());
    data.push(0);
}

fn yaml(recording: &Recording, joints: &[String]) -> String {
    let mut out = String::new();
    for trajectory in &recording.trajectories {
        if !out.is_empty() {
            out.push_str("---\n");
        }
        out.push_str("header: {stamp: {sec: 0, nanosec: 0}, frame_id: ''}\njoint_names:\n");
        for joint in joints {
            let _ = writeln!(out, "- '{}'", joint.replace('\'', "''"));
        }
        out.push_str("points:\n");
        for row in trajectory.range.clone() {
            let names = ["positions", "velocities", "accelerations", "effort"];
            for (k, (name, table)) in names.into_iter().zip(tables(recording)).enumerate() {
                let values = table.map_or_else(Vec::new, |t| {
                    t.row(row).iter().map(|v| format!("{v:?}")).collect()
                });
                let dash = if k == 0 { "- " } else { "  " };
                let _ = writeln!(out, "{dash}{name}: [{}]", values.join(", "));
            }
            let (seconds, rest) = from_start(recording, row);
            let _ = writeln!(
                out,
                "  time_from_start: {{sec: {seconds}, nanosec: {rest}}}"
            );
        }
    }
    out
}
