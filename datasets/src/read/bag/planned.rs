//! Planned motions in a bag: messages of the type trajectory_msgs/JointTrajectory.

use super::super::contained::contained;
use super::Input;
use super::definition::Number;
use super::message::{Cursor, Unreadable};
use super::source::{Channel, Sink, list};
use crate::{Problem, ReadError, Recording, Trajectory};
use ndarray::Array2;
use std::path::Path;

const KIND: &str = "trajectory_msgs/JointTrajectory";

/// Planned motion of the `joints` (names, base first) in an MCAP or SQLite file or a rosbag2 folder: a trajectory
/// for each JointTrajectory message, its times those from its start, s. None where the bag has no such topic.
/// Velocities and accelerations are read where every point has them; efforts are not read.
///
/// # Errors
/// A bag that cannot be read, several topics of the type, or a message without points or without one of the joints.
pub fn planned_trajectories(
    path: &Path,
    joints: &[String],
) -> Result<Option<Recording>, ReadError> {
    contained("bag", path, || {
        let mut plans = Plans::default();
        Input::Path(path).scan(path, &mut plans)?;
        let Some(topic) = plans.topic else {
            return Ok(None);
        };
        let fail = |problem: Problem, message: usize| problem.in_file(path).at_row(message);
        let mut time = Vec::new();
        let mut trajectories = Vec::new();
        let mut tables: [Option<Vec<f64>>; 3] = std::array::from_fn(|_| Some(Vec::new()));
        for (k, message) in plans.messages.iter().enumerate() {
            let broken = |detail: String| {
                let topic = topic.clone();
                fail(Problem::Message { topic, detail }, k)
            };
            let plan = Plan::of(message).map_err(|e| broken(e.to_string()))?;
            let order = plan.order(joints).map_err(|problem| fail(problem, k))?;
            if plan.points.is_empty() {
                return Err(broken("has no points".to_owned()));
            }
            let start = time.len();
            for (p, point) in plan.points.iter().enumerate() {
                if time[start..].last().is_some_and(|last| *last >= point.time) {
                    return Err(broken(format!(
                        "has a time at point {p} that does not grow"
                    )));
                }
                time.push(point.time);
                if point.values[0].len() != plan.names.len() {
                    return Err(broken(format!("lacks positions at point {p}")));
                }
                for (table, values) in tables.iter_mut().zip(&point.values) {
                    match table {
                        Some(table) if values.len() == plan.names.len() => {
                            table.extend(order.iter().map(|&j| values[j]));
                        }
                        other => *other = None,
                    }
                }
            }
            trajectories.push(Trajectory {
                label: k.to_string(),
                range: start..time.len(),
            });
        }
        let shape = (time.len(), joints.len());
        let [q, qd, qdd] = tables.map(|t| t.and_then(|t| Array2::from_shape_vec(shape, t).ok()));
        let Some(q) = q.filter(|_| !time.is_empty()) else {
            return Err(Problem::Empty.in_file(path));
        };
        let finite = |t: &Array2<f64>| t.iter().find(|v| !v.is_finite()).copied();
        if let Some(value) = [Some(&q), qd.as_ref(), qdd.as_ref()]
            .into_iter()
            .flatten()
            .find_map(finite)
        {
            return Err(Problem::NotFinite(value).in_file(path));
        }
        Ok(Some(Recording {
            qd,
            qdd,
            trajectories,
            ..Recording::new(&path.display().to_string(), time, q, None)
        }))
    })
}

/// Messages of the bag's only topic of trajectories.
#[derive(Default)]
struct Plans {
    topic: Option<String>,
    channels: Vec<u64>,
    messages: Vec<Vec<u8>>,
}

impl Sink for Plans {
    fn file(&mut self) {
        self.channels.clear();
    }

    fn channel(&mut self, channel: Channel) -> Result<(), Problem> {
        if channel.kind != KIND || channel.encoding != "cdr" {
            return Ok(());
        }
        match &self.topic {
            Some(other) if *other != channel.topic => {
                return Err(Problem::SeveralTopics(list([
                    other.as_str(),
                    &channel.topic,
                ])));
            }
            _ => self.topic = Some(channel.topic),
        }
        self.channels.push(channel.id);
        Ok(())
    }

    fn message(&mut self, channel: u64, _logged: i64, data: &[u8]) -> Result<(), Problem> {
        if self.channels.contains(&channel) {
            self.messages.push(data.to_owned());
        }
        Ok(())
    }
}

/// Content of one message.
struct Plan {
    names: Vec<String>,
    points: Vec<Point>,
}

/// One point: time from the start, s; positions, velocities and accelerations in the order of the message.
struct Point {
    time: f64,
    values: [Vec<f64>; 3],
}

impl Plan {
    fn of(message: &[u8]) -> Result<Self, Unreadable> {
        let mut cursor = Cursor::of(message)?;
        // The header: stamp and frame.
        cursor.values(Number::I32, 1)?;
        cursor.values(Number::U32, 1)?;
        cursor.text()?;
        let mut names = Vec::new();
        for _ in 0..cursor.count()? {
            names.push(String::from_utf8_lossy(cursor.text()?).into_owned());
        }
        let mut points = Vec::new();
        for _ in 0..cursor.count()? {
            let mut array = || {
                let count = cursor.count()?;
                cursor.values(Number::F64, count)
            };
            let values = [array()?, array()?, array()?];
            array()?;
            let (seconds, rest) = (
                cursor.values(Number::I32, 1)?,
                cursor.values(Number::U32, 1)?,
            );
            points.push(Point {
                time: seconds[0] + 1e-9 * rest[0],
                values,
            });
        }
        Ok(Self { names, points })
    }

    /// Place of each of the robot's joints among the message's.
    fn order(&self, joints: &[String]) -> Result<Vec<usize>, Problem> {
        let place = |joint: &String| {
            let place = self.names.iter().position(|name| name == joint);
            place.ok_or_else(|| Problem::MissingJoint {
                missing: joint.clone(),
                present: list(self.names.iter().map(String::as_str)),
            })
        };
        joints.iter().map(place).collect()
    }
}
