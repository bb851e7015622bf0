//! Denavit–Hartenberg tables.
//!
//! The joint frames of the resulting robot follow this crate's convention (they turn with the joint, z along its
//! axis), which for the standard convention is not the frame that the table attaches to a link:
//! [`Convention::link_frame`] takes inertias from one to the other.

use super::JointKind;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Convention that a table follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// Rot_z(θ) Trans_z(d) Trans_x(a) Rot_x(α) (Denavit and Hartenberg; Spong).
    Standard,
    /// Rot_x(α) Trans_x(a) Rot_z(θ) Trans_z(d), a and α being those of the previous link (Craig; Khalil).
    Modified,
}

/// One row of a table. The joint's position is added to `theta` (rotation) or to `d` (translation).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Link length a, m.
    pub a: f64,
    /// Link twist α, rad.
    pub alpha: f64,
    /// Link offset d, m.
    pub d: f64,
    /// Joint angle θ at q = 0, rad.
    pub theta: f64,
    /// Kind of the joint: it turns or slides.
    pub kind: JointKind,
}

impl Row {
    /// Row of a joint that turns.
    pub fn revolute(a: f64, alpha: f64, d: f64, theta: f64) -> Self {
        Self {
            a,
            alpha,
            d,
            theta,
            kind: JointKind::Revolute,
        }
    }
}

/// A pose: orientation and origin.
pub type Pose = (Matrix3<f64>, Vector3<f64>);

/// Poses of the joint frames at q = 0, each in the previous one (the first in the base frame), for the axes
/// being z. `base` is the pose of the table's frame 0 in the base frame.
pub fn placements(convention: Convention, base: Pose, rows: &[Row]) -> Vec<Pose> {
    let mut before = base;
    rows.iter()
        .map(|row| {
            let turn = (rotation_z(row.theta), Vector3::zeros());
            let lift = (Matrix3::identity(), Vector3::z() * row.d);
            match convention {
                // A rotating joint's frame sits at frame i−1, a sliding one's at the displaced d.
                Convention::Standard => {
                    let mut placement = compose(&before, &turn);
                    if row.kind == JointKind::Prismatic {
                        placement = compose(&placement, &lift);
                    }
                    before = convention.link_frame(row);
                    placement
                }
                Convention::Modified => {
                    let link = (rotation_x(row.alpha), Vector3::x() * row.a);
                    let placement = compose(&compose(&before, &link), &compose(&turn, &lift));
                    before = (Matrix3::identity(), Vector3::zeros());
                    placement
                }
            }
        })
        .collect()
}

impl Convention {
    /// Pose, in the joint frame of this crate, of the frame that the table attaches to the link. It takes a
    /// quantity given in the table's frame, such as a centre of mass, to the joint frame.
    pub fn link_frame(self, row: &Row) -> Pose {
        match self {
            Self::Standard => {
                let d = if row.kind == JointKind::Prismatic {
                    0.0
                } else {
                    row.d
                };
                (rotation_x(row.alpha), Vector3::new(row.a, 0.0, d))
            }
            Self::Modified => (Matrix3::identity(), Vector3::zeros()),
        }
    }
}

fn compose(a: &Pose, b: &Pose) -> Pose {
    (a.0 * b.0, a.0 * b.1 + a.1)
}

fn rotation_z(angle: f64) -> Matrix3<f64> {
    let (s, c) = exact_sin_cos(angle);
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

fn rotation_x(angle: f64) -> Matrix3<f64> {
    let (s, c) = exact_sin_cos(angle);
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

/// Sine and cosine, exact at multiples of a quarter turn: tables are full of them, and a cosine of 6e-17
/// would blur which parameters are identifiable.
fn exact_sin_cos(angle: f64) -> (f64, f64) {
    let quarters = angle / FRAC_PI_2;
    if (quarters - quarters.round()).abs() > 1e-12 {
        return angle.sin_cos();
    }
    match quarters.round().rem_euclid(4.0) as u8 {
        0 => (0.0, 1.0),
        1 => (1.0, 0.0),
        2 => (0.0, -1.0),
        _ => (-1.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::link_placements;
    use crate::robot::{Inertia, Joint, Limits, Link, Robot};

    /// Two turning joints around a sliding one.
    fn rows() -> [Row; 3] {
        let slide = Row {
            kind: JointKind::Prismatic,
            ..Row::revolute(0.2, -0.7, 0.4, 0.3)
        };
        [
            Row::revolute(0.1, FRAC_PI_2, 0.5, 0.2),
            slide,
            Row::revolute(-0.3, 1.1, -0.2, -FRAC_PI_2),
        ]
    }

    fn robot(convention: Convention, rows: &[Row]) -> Robot {
        let base = (rotation_x(0.4), Vector3::new(0.0, 0.0, 1.0));
        let joints = placements(convention, base, rows)
            .into_iter()
            .zip(rows)
            .map(|((rotation, translation), row)| Joint {
                name: String::new(),
                kind: row.kind,
                axis: Vector3::z(),
                rotation,
                translation,
                limits: Limits::NONE,
                damping: 0.0,
                friction: 0.0,
                rotor_inertia: 0.0,
                gear_ratio: None,
                torque_constant: None,
                link: Link {
                    name: String::new(),
                    inertia: Inertia::from_com(1.0, Vector3::zeros(), Matrix3::identity()),
                },
            })
            .collect();
        Robot::new("table", joints).expect("a possible robot")
    }

    /// The end of the chain equals the product of the table's own matrices, with q put into θ or d.
    #[test]
    fn chain_is_the_product_of_the_tables_matrices() {
        let q = [0.7, 0.15, -1.2];
        for convention in [Convention::Standard, Convention::Modified] {
            let rows = rows();
            let mut expected = (rotation_x(0.4), Vector3::new(0.0, 0.0, 1.0));
            for (row, q) in rows.iter().zip(q) {
                let (theta, d) = match row.kind {
                    JointKind::Prismatic => (row.theta, row.d + q),
                    _ => (row.theta + q, row.d),
                };
                let turn = (rotation_z(theta), Vector3::z() * d);
                let twist = (rotation_x(row.alpha), Vector3::x() * row.a);
                let matrix = match convention {
                    Convention::Standard => compose(&turn, &twist),
                    Convention::Modified => compose(&twist, &turn),
                };
                expected = compose(&expected, &matrix);
            }
            let robot = robot(convention, &rows);
            let last = link_placements(&robot, &q).last().expect("three joints");
            let frame = convention.link_frame(&rows[2]);
            let found = compose(&(last.rotation, last.translation), &frame);
            assert!((found.0 - expected.0).amax() < 1e-15, "{convention:?}");
            assert!((found.1 - expected.1).amax() < 1e-15, "{convention:?}");
        }
    }
}
