//! A straight line of the tool.

use super::{Motion, Profile};
use plant::reference::Command;
use signal::spline::Spline;

/// Joint positions along a straight line, run by a profile.
pub struct Line {
    profile: Profile,
    /// Each joint over the way, m.
    joints: Vec<Spline>,
}

/// Points of the line at which the joints are computed; a quintic goes through them.
const KNOTS: usize = 161;
/// By what the splines reach beyond both ends, as a part of the line: their ends are the least exact.
const MARGIN: f64 = 0.05;

impl Line {
    /// Along `distance` metres; `inverse` gives the joints at a way along the line, going on from the last way's joints, and
    /// nothing where the tool cannot be. Ways run from a little below zero to a little beyond the distance.
    pub fn new(
        distance: f64,
        profile: Profile,
        mut inverse: impl FnMut(f64) -> Option<Vec<f64>>,
    ) -> Option<Self> {
        let way: Vec<f64> = (0..KNOTS)
            .map(|k| {
                let share = k as f64 / (KNOTS - 1) as f64;
                distance * (share * (1.0 + 2.0 * MARGIN) - MARGIN)
            })
            .collect();
        let points: Vec<Vec<f64>> = way.iter().map(|&s| inverse(s)).collect::<Option<_>>()?;
        let joints = (0..points[0].len()).map(|j| {
            let column: Vec<f64> = points.iter().map(|p| p[j]).collect();
            Spline::quintic(&way, &column).ok()
        });
        Some(Self {
            profile,
            joints: joints.collect::<Option<_>>()?,
        })
    }
}

impl Motion for Line {
    fn duration(&self) -> f64 {
        self.profile.duration()
    }

    fn at(&self, t: f64, command: &mut Command) {
        let [way, speed, acceleration] = self.profile.at(t);
        for (j, joint) in self.joints.iter().enumerate() {
            let [q, slope, bend] = joint.at(way);
            command.q[j] = q;
            command.qd[j] = slope * speed;
            command.qdd[j] = slope * acceleration + bend * speed * speed;
        }
    }
}
