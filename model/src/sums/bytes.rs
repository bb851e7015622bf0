//! Sums as bytes: one line of JSON, then the factors as little-endian numbers, to the last bit.

use super::{Preparation, Sums, SumsError};
use crate::sums::rows::{GROUPS, STRETCHES};
use ::identify::least_squares::Triangle;
use physics::robot::Robot;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
const SCHEMA: &str = "sums/1";

/// Description of the sums at the start of the bytes.
#[derive(Serialize, Deserialize)]
struct Head {
    schema: String,
    /// Hex digest by which the robot of the sums is recognised.
    robot: String,
    preparation: Option<Preparation>,
    recordings: usize,
    /// Range of positions of each joint; none before the first recording.
    span: Vec<Option<[f64; 2]>>,
    /// Place of each stretch, and the number of rows in the factor of each joint.
    places: Vec<(usize, Vec<usize>)>,
}

impl Sums {
    /// Sums as bytes, without the robot.
    pub fn to_bytes(&self) -> Vec<u8> {
        let known = |s: &[f64; 2]| s[0].is_finite().then_some(*s);
        let rows = |joints: &Vec<Triangle>| joints.iter().map(Triangle::rows).collect();
        let head = Head {
            schema: SCHEMA.to_owned(),
            robot: self.which.clone(),
            preparation: self.preparation,
            recordings: self.recordings,
            span: self.span.iter().map(known).collect(),
            places: self.places.iter().map(|(p, j)| (*p, rows(j))).collect(),
        };
        let mut bytes = serde_json::to_vec(&head).unwrap_or_default();
        bytes.push(b'\n');
        for triangle in self.places.values().flatten() {
            let values = triangle.values();
            bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        }
        bytes
    }

    /// Sums read back from the bytes that [`Sums::to_bytes`] wrote. The robot must be the same.
    ///
    /// # Errors
    /// Bytes of another robot, bytes cut short, or bytes not written by [`Sums::to_bytes`].
    pub fn from_bytes(robot: Robot, bytes: &[u8]) -> Result<Self, SumsError> {
        let broken = |why: &str| SumsError::Broken(why.to_owned());
        let end = bytes.iter().position(|b| *b == b'\n');
        let end = end.ok_or_else(|| broken("no first line"))?;
        let head: Head =
            serde_json::from_slice(&bytes[..end]).map_err(|e| broken(&e.to_string()))?;
        if head.schema != SCHEMA {
            return Err(broken(&format!("{} instead of {SCHEMA}", head.schema)));
        }
        let mut sums = Self::new(robot, None);
        if head.robot != sums.which {
            return Err(SumsError::OtherRobot);
        }
        let dof = sums.columns.robot.dof();
        if head.span.len() != dof {
            return Err(broken("another number of joints"));
        }
        let mut rest = bytes[end + 1..].chunks_exact(size_of::<f64>());
        let mut next = || {
            let chunk = rest.next()?;
            Some(f64::from_le_bytes(chunk.try_into().ok()?))
        };
        for (place, rows) in head.places {
            if place >= STRETCHES * GROUPS || rows.len() != dof {
                return Err(broken("a place that does not exist"));
            }
            let joints = rows.into_iter().enumerate().map(|(joint, rows)| {
                let columns = sums.columns.width(joint);
                let count = (columns + 1) * (columns + 2) / 2;
                let values: Vec<f64> = (0..count).map_while(|_| next()).collect();
                Triangle::from_values(columns, rows, &values).map_err(|e| broken(&e.to_string()))
            });
            let joints = joints.collect::<Result<_, _>>()?;
            sums.places.insert(place, joints);
        }
        if next().is_some() || !rest.remainder().is_empty() {
            return Err(broken("more bytes than factors"));
        }
        sums.preparation = head.preparation;
        sums.recordings = head.recordings;
        let unknown = [f64::INFINITY, f64::NEG_INFINITY];
        sums.span = head.span.iter().map(|s| s.unwrap_or(unknown)).collect();
        Ok(sums)
    }
}
