//! SCARA as a serial chain by recursive Newton–Euler, with rotors, and with the spindle's coupling where it has one.

use super::carried::Carried;
use super::mechanics::{Friction, Plant};
use nalgebra::{Matrix3, Vector3};
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Inertia, Joint, JointKind, Limits, Link, Robot};
use std::f64::consts::TAU;

/// Arms, quill, rotors.
pub(super) struct Scara {
    robot: Robot,
    axes: usize,
    /// Travel of the quill per rad of axis 4, m/rad.
    lift: f64,
    /// Force of a spring that carries part of the quill, N.
    balance: f64,
}

/// Lengths of the two arms, m.
pub const ARMS: [f64; 2] = [0.325, 0.275];

/// Rotors seen from their axes, kg·m² and kg.
const ROTORS: [f64; 4] = [0.35, 0.12, 2.0, 0.004];

impl Scara {
    /// With 3 or 4 axes; model 2 couples the third and fourth by a spindle of 20 mm lead.
    pub fn new(axes: usize, model: usize, carried: &Carried) -> Self {
        let body = |mass: f64, com: [f64; 3], [xx, yy, zz]: [f64; 3]| {
            let moments = Matrix3::from_diagonal(&Vector3::new(xx, yy, zz));
            Inertia::from_com(mass, com.into(), moments)
        };
        let joint = |name: &str, kind, translation: [f64; 3], inertia| Joint {
            name: name.to_owned(),
            kind,
            axis: Vector3::z(),
            rotation: Matrix3::identity(),
            translation: translation.into(),
            limits: Limits::NONE,
            damping: 0.0,
            friction: 0.0,
            rotor_inertia: 0.0,
            gear_ratio: None,
            torque_constant: None,
            link: Link {
                name: format!("{name}_link"),
                inertia,
            },
        };
        let turns = JointKind::Continuous;
        let quill = body(1.1, [0.0, 0.0, 0.05], [0.012, 0.012, 0.0006]);
        let tool = body(0.5, [0.0, 0.0, -0.12], [0.0008, 0.0008, 0.0018]);
        let tool = tool.plus(&body(carried.mass, [0.0, 0.0, -0.2], [carried.inertia; 3]));
        let mut joints = vec![
            joint(
                "A1",
                turns,
                [0.0, 0.0, 0.3],
                body(9.0, [0.15, 0.0, 0.0], [0.03, 0.11, 0.12]),
            ),
            joint(
                "A2",
                turns,
                [ARMS[0], 0.0, 0.05],
                body(6.5, [0.11, 0.0, 0.02], [0.02, 0.06, 0.07]),
            ),
        ];
        let slides = JointKind::Prismatic;
        if axes == 4 {
            joints.push(joint("A3", slides, [ARMS[1], 0.0, 0.0], quill));
            joints.push(joint("A4", turns, [0.0; 3], tool));
        } else {
            joints.push(joint("A3", slides, [ARMS[1], 0.0, 0.0], quill.plus(&tool)));
        }
        Self {
            robot: Robot::new("scara", joints).expect("the numbers above are valid"),
            axes,
            lift: if model == 2 && axes == 4 {
                0.02 / TAU
            } else {
                0.0
            },
            balance: 6.0,
        }
    }
}

impl Plant for Scara {
    fn torque(&self, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
        // From the drives' positions to the chain's: the quill's height is q₃ − c q₄.
        let chain = |list: &[f64]| {
            let mut list = list.to_vec();
            if self.axes == 4 {
                list[2] -= self.lift * list[3];
            }
            list
        };
        let (mut torque, mut workspace) = (vec![0.0; self.axes], Workspace::new(&self.robot));
        let (q, qd, moved) = (chain(q), chain(qd), chain(qdd));
        inverse_dynamics(&self.robot, &mut workspace, &q, &qd, &moved, &mut torque);
        torque[2] -= self.balance;
        if self.axes == 4 {
            torque[3] -= self.lift * torque[2];
        }
        for (t, (rotor, a)) in torque.iter_mut().zip(ROTORS.iter().zip(qdd)) {
            *t += rotor * a;
        }
        torque
    }

    fn friction(&self) -> Vec<Friction> {
        let all = [
            (4.0, 5.0, 0.01),
            (2.0, 3.0, 0.01),
            (30.0, 12.0, 0.0005),
            (0.03, 0.15, 0.02),
        ];
        let friction = |&(viscous, coulomb, soft)| Friction {
            viscous,
            coulomb,
            soft,
        };
        all[..self.axes].iter().map(friction).collect()
    }
}
