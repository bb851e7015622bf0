//! Region of the tool.

use super::error::ExcitationError;
use super::limits::MotionLimits;
use super::series::{Series, State};
use nalgebra::Vector3;
use physics::dynamics::link_placements;
use physics::robot::{JointKind, Robot};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A region of the base frame that the tool's point stays in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    /// Box between two corners, m.
    Box {
        /// Smallest coordinates of the box, m.
        lower: [f64; 3],
        /// Largest coordinates of the box, m.
        upper: [f64; 3],
    },
    /// Sphere about a point, m.
    Sphere {
        /// Centre of the sphere, m.
        centre: [f64; 3],
        /// Radius of the sphere, m.
        radius: f64,
    },
}

impl Region {
    /// Distance to the boundary from inside, m; negative outside. It changes by no more than the point moves.
    pub fn clearance(&self, point: &Vector3<f64>) -> f64 {
        match self {
            Self::Box { lower, upper } => (0..3)
                .map(|k| (point[k] - lower[k]).min(upper[k] - point[k]))
                .fold(f64::INFINITY, f64::min),
            Self::Sphere { centre, radius } => radius - (point - Vector3::from(*centre)).norm(),
        }
    }
}

/// Number of poses tried for one that has the tool well inside.
const POSES: usize = 4000;
/// Least step of the walk along a motion, in lengths of it: closer to the boundary than the tool moves in one counts as
/// outside.
const FINEST: f64 = 1.0 / 8192.0;
/// Number of halvings in the search for the factor that a motion is shrunk by.
const HALVINGS: usize = 12;

/// The tool's point with the regions that it stays in, all of them at once.
#[derive(Debug, Clone)]
pub struct ToolRoom<'a> {
    robot: &'a Robot,
    /// The point in the frame of the last joint, m.
    point: Vector3<f64>,
    regions: Vec<Region>,
    /// Bound of the tool's speed by each joint's, m/s per rad/s or m/s.
    reach: Vec<f64>,
}

impl<'a> ToolRoom<'a> {
    /// The point is given in the frame of the last joint, m; joints move within `limits`, base first, and nowhere else.
    pub fn new(
        robot: &'a Robot,
        limits: &[MotionLimits],
        point: [f64; 3],
        regions: Vec<Region>,
    ) -> Self {
        let point = Vector3::from(point);
        let mut beyond = point.norm();
        let mut reach = Vec::new();
        for (joint, limits) in std::iter::zip(robot.joints(), limits).rev() {
            let slides = joint.kind == JointKind::Prismatic;
            reach.push(if slides { 1.0 } else { beyond });
            let way = limits.lower.abs().max(limits.upper.abs());
            beyond += joint.translation.norm() + if slides { way } else { 0.0 };
        }
        reach.reverse();
        Self {
            robot,
            point,
            regions,
            reach,
        }
    }

    /// The tool's point in the base frame, m.
    pub fn position(&self, q: &[f64]) -> Vector3<f64> {
        let last = link_placements(self.robot, q).last();
        let last = last.expect("a robot has a joint");
        last.rotation * self.point + last.translation
    }

    /// Distance of the tool from the nearest boundary, m; negative outside.
    pub fn clearance(&self, q: &[f64]) -> f64 {
        let point = self.position(q);
        let each = self.regions.iter().map(|r| r.clearance(&point));
        each.fold(f64::INFINITY, f64::min)
    }

    /// Whether the tool stays inside during a whole run. From a point at distance d from the boundary the next
    /// point checked lies d over the tool's largest speed later, so that the check cannot miss a way out.
    pub fn holds(&self, series: &Series) -> bool {
        let speeds = series.speed_bounds();
        let speed: f64 = self.reach.iter().zip(speeds).map(|(r, v)| r * v).sum();
        let finest = FINEST * series.duration;
        let mut state = State::new(series.dof());
        let mut t = 0.0;
        loop {
            series.at(t, &mut state);
            let clearance = self.clearance(&state.q);
            if !(clearance >= speed * finest && clearance >= 0.0) {
                return false;
            }
            if t >= series.duration {
                return true;
            }
            t = (t + (clearance / speed).max(finest)).min(series.duration);
        }
    }

    /// Shrinks a motion towards `pose` until the tool stays inside; to standstill where nothing else does.
    pub fn keep(&self, series: &mut Series, pose: &[f64]) {
        if self.holds(series) {
            return;
        }
        let shrunk = |factor: f64| {
            let mut s = series.clone();
            s.shrink(pose, factor);
            s
        };
        let (mut inside, mut outside) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if self.holds(&shrunk(middle)) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        series.shrink(pose, inside);
    }

    /// A pose within the limits with the tool as far inside as of some thousand random ones.
    ///
    /// # Errors
    /// None has it inside.
    pub fn pose(&self, limits: &[MotionLimits], seed: u64) -> Result<Vec<f64>, ExcitationError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let middle: Vec<f64> = limits.iter().map(MotionLimits::middle).collect();
        let mut best = (self.clearance(&middle), middle);
        for _ in 0..POSES {
            let pose: Vec<f64> = limits
                .iter()
                .map(|l| rng.random_range(l.lower..l.upper))
                .collect();
            let clearance = self.clearance(&pose);
            if clearance > best.0 {
                best = (clearance, pose);
            }
        }
        if best.0 > 0.0 {
            Ok(best.1)
        } else {
            Err(ExcitationError::ToolNowhere)
        }
    }
}
