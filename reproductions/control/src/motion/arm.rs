//! A straight line of the origin of an arm's last joint frame; its orientation is free, so that no wrist stands in the way.

use super::{Line, Profile};
use nalgebra::{Matrix3, Matrix3xX, Vector3};
use physics::dynamics::{Workspace, link_placements, point_jacobian};
use physics::robot::Robot;

/// Length of the line as a part of the frame's distance from the base's vertical axis.
const SHARE: f64 = 0.6;
/// Time for the line at its full speed, s; time to that speed; time over which accelerations rise and fall.
const AT_SPEED: f64 = 0.6;
const RAMP: f64 = 0.15;
const SMOOTHING: f64 = 0.05;

/// Origin of the last joint's frame, m.
pub fn tool(robot: &Robot, q: &[f64]) -> Option<Vector3<f64>> {
    link_placements(robot, q).last().map(|p| p.translation)
}

/// A level line across the reach, whose middle is the pose `centre`, and its length in m; none where the arm cannot follow it.
pub fn line(robot: &Robot, centre: &[f64]) -> Option<(Line, f64)> {
    let middle = tool(robot, centre)?;
    let across = Vector3::new(-middle.y, middle.x, 0.0);
    let length = SHARE * across.norm();
    let across = across.try_normalize(1e-3)?;
    let speed = length / AT_SPEED;
    let profile = Profile::new(length, speed, speed / RAMP, SMOOTHING);
    let at = |way: f64| middle + across * (way - 0.5 * length);
    let mut workspace = Workspace::new(robot);
    let mut q = centre.to_vec();
    // From the middle out, so that the first knot is reached without a jump to another branch.
    for k in 1..=20 {
        reach(
            robot,
            &mut workspace,
            &at(0.5 * length * (1.0 - f64::from(k) / 20.0)),
            &mut q,
        )?;
    }
    let line = Line::new(length, profile, |way| {
        reach(robot, &mut workspace, &at(way), &mut q)?;
        Some(q.clone())
    })?;
    Some((line, length))
}

/// Newton's method from `q`, each step the smallest that does it; none where it does not arrive.
fn reach(robot: &Robot, workspace: &mut Workspace, to: &Vector3<f64>, q: &mut [f64]) -> Option<()> {
    let n = robot.dof();
    let mut jacobian = vec![0.0; 6 * n];
    for _ in 0..60 {
        let error = to - tool(robot, q)?;
        if error.norm() < 1e-11 {
            return Some(());
        }
        point_jacobian(robot, workspace, q, n - 1, &Vector3::zeros(), &mut jacobian);
        let j = Matrix3xX::from_row_slice(&jacobian[..3 * n]);
        let square: Matrix3<f64> = &j * j.transpose() + Matrix3::identity() * 1e-12;
        let step = j.transpose() * square.cholesky()?.solve(&error);
        // Steps of more than this leave the branch.
        if step.norm() > 1.0 {
            return None;
        }
        q.iter_mut().zip(step.iter()).for_each(|(q, s)| *q += s);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Motion;
    use plant::reference::Command;

    #[test]
    fn the_frame_runs_straight_at_the_profile() {
        let robot = Robot::builtin("ur5").unwrap();
        let centre = [0.0, -1.4, 0.8, -0.7, 0.2, 0.0];
        let (motion, length) = line(&robot, &centre).unwrap();
        let at = |t: f64| {
            let mut command = Command::new(6);
            motion.at(t, &mut command);
            (tool(&robot, &command.q).unwrap(), command)
        };
        let (start, end) = (at(0.0).0, at(motion.duration()).0);
        assert!(((end - start).norm() - length).abs() < 1e-7, "{length}");
        let along = (end - start).normalize();
        for k in 0..=50 {
            let t = motion.duration() * f64::from(k) / 50.0;
            let (point, command) = at(t);
            let off = (point - start) - along * (point - start).dot(&along);
            assert!(off.norm() < 1e-7, "{off:?}");
            // Velocities against differences.
            let h = 1e-5;
            let (before, after) = (at(t - h).1, at(t + h).1);
            for j in 0..6 {
                let slope = (after.q[j] - before.q[j]) / (2.0 * h);
                assert!(
                    (slope - command.qd[j]).abs() < 1e-5,
                    "{slope} {}",
                    command.qd[j]
                );
            }
        }
    }
}
