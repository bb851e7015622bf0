//! A robot as the simulator builds it: joints and links that can be altered before a plant is made of
//! them.

use crate::mechanism::RestLaw;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use physics::dynamics::{Workspace, mass_matrix};
use physics::robot::{Inertia, Joint, JointKind, Limits, Link, Robot, RobotError};

/// A serial arm with the region in which it is moved.
#[derive(Debug, Clone)]
pub struct Arm {
    /// Family of robots that it comes from.
    pub family: &'static str,
    /// Moving joints, base first; `damping` and `friction` are its viscous and Coulomb friction.
    pub joints: Vec<Joint>,
    /// Middle of each joint's region of motion, rad or m.
    pub centre: Vec<f64>,
    /// Largest distance of each joint from `centre`, rad or m.
    pub reach: Vec<f64>,
    /// Speed below which the plant's sign of velocity is softened, rad/s or m/s.
    pub v_eps: Vec<f64>,
    /// Law by which the sign of friction is softened near rest, on all joints.
    pub rest: RestLaw,
    /// Inertia of a disc about the axis that is part of the link's inertia, kg·m². It turns with the motor
    /// where the joint's gear is made elastic. Zero for a link without a disc.
    pub disc: Vec<f64>,
}

impl Arm {
    /// Number of joints of the arm.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// The rigid-body model.
    ///
    /// # Errors
    /// An inertia or axis that [`Robot::new`] refuses.
    pub fn robot(&self) -> Result<Robot, RobotError> {
        Robot::new("arm", self.joints.clone())
    }

    /// Diagonal of the mass matrix in mid-region, kg·m² or kg.
    ///
    /// # Errors
    /// As [`Arm::robot`].
    pub fn inertia(&self) -> Result<Vec<f64>, RobotError> {
        let robot = self.robot()?;
        let n = robot.dof();
        let mut mass = vec![0.0; n * n];
        mass_matrix(&robot, &mut Workspace::new(&robot), &self.centre, &mut mass);
        Ok(mass.into_iter().step_by(n + 1).collect())
    }

    /// Viscous coefficient of each joint, N·m·s/rad.
    pub fn damping(&self) -> Vec<f64> {
        self.joints.iter().map(|j| j.damping).collect()
    }

    /// Coulomb coefficient of each joint, N·m.
    pub fn friction(&self) -> Vec<f64> {
        self.joints.iter().map(|j| j.friction).collect()
    }

    /// Fastest allowed speed of each joint, rad/s or m/s.
    pub fn speed(&self) -> Vec<f64> {
        self.joints.iter().map(|j| j.limits.velocity).collect()
    }

    /// Makes a disc of inertia `inertia` (kg·m²) about joint `j`'s axis part of its link.
    pub fn add_disc(&mut self, j: usize, inertia: f64) {
        let joint = &mut self.joints[j];
        joint.link.inertia.about_origin += disc(&joint.axis, inertia);
        self.disc[j] += inertia;
    }

    /// Divides joint `j` into a rotor and a new joint about the same axis. The rotor keeps the joint, most of
    /// the link's disc and a tenth of the other inertia; the new joint carries the remainder. With the new
    /// joint locked the arm moves as before.
    pub fn split_joint(&mut self, j: usize) {
        let whole = self.joints[j].link.inertia;
        let disc = disc(&self.joints[j].axis, self.disc[j]);
        let mut bare = whole;
        bare.about_origin -= disc;
        let mut rotor = scaled(&bare, 0.1);
        rotor.about_origin += disc * 0.85;
        let output = whole.plus(&scaled(&rotor, -1.0));
        self.joints[j].link.inertia = rotor;
        let mut gear = self.joints[j].clone();
        gear.name = format!("{}_gear", gear.name);
        gear.link = Link {
            name: format!("{}_output", gear.link.name),
            inertia: output,
        };
        gear.rotation = Matrix3::identity();
        gear.translation = Vector3::zeros();
        gear.damping = 0.0;
        gear.friction = 0.0;
        self.joints.insert(j + 1, gear);
    }

    /// Puts a hinge under the arm about the horizontal `axis`, `below` metres under the base's origin, with
    /// a pedestal of the given mass (kg) and radius of gyration (m).
    pub fn put_on_hinge(&mut self, axis: Vector3<f64>, below: f64, mass: f64, gyration: f64) {
        let first = &mut self.joints[0];
        first.translation.z += below;
        let hinge = Joint {
            name: "mount".to_owned(),
            kind: JointKind::Revolute,
            axis: axis.normalize(),
            rotation: Matrix3::identity(),
            translation: Vector3::new(0.0, 0.0, -below),
            limits: Limits::NONE,
            damping: 0.0,
            friction: 0.0,
            rotor_inertia: 0.0,
            gear_ratio: None,
            torque_constant: None,
            link: Link {
                name: "pedestal".to_owned(),
                inertia: Inertia::from_com(
                    mass,
                    Vector3::new(0.0, 0.0, 0.5 * below),
                    Matrix3::identity() * (mass * gyration * gyration),
                ),
            },
        };
        self.joints.insert(0, hinge);
    }

    /// Turns the whole arm about the base's origin by the rotation vector `tilt` (rad).
    pub fn tilt(&mut self, tilt: Vector3<f64>) {
        let r = *Rotation3::new(tilt).matrix();
        self.joints[0].rotation = r * self.joints[0].rotation;
        self.joints[0].translation = r * self.joints[0].translation;
    }

    /// Moves the zero of joint `j`: where its position now reads q it read q − `zero` before.
    pub fn shift_zero(&mut self, j: usize, zero: f64) {
        let joint = &mut self.joints[j];
        if joint.kind.is_rotation() {
            let back = Rotation3::from_axis_angle(&Unit::new_normalize(joint.axis), -zero);
            joint.rotation *= back.matrix();
        } else {
            joint.translation -= joint.rotation * joint.axis * zero;
        }
    }

    /// Fixes a body (in the last joint's frame) to the last link.
    pub fn attach(&mut self, body: &Inertia) {
        if let Some(last) = self.joints.last_mut() {
            last.link.inertia = last.link.inertia.plus(body);
        }
    }
}

/// Inertia of a thin disc about `axis`: half as much about its diameters.
fn disc(axis: &Vector3<f64>, inertia: f64) -> Matrix3<f64> {
    (Matrix3::identity() + axis * axis.transpose()) * (0.5 * inertia)
}

/// A body with `factor` times the density of `body`.
pub fn scaled(body: &Inertia, factor: f64) -> Inertia {
    Inertia {
        mass: body.mass * factor,
        first_moment: body.first_moment * factor,
        about_origin: body.about_origin * factor,
    }
}

/// A body like `body` with mass, centre of mass and inertia about it changed: factors on mass and inertia, and a
/// shift of the centre in m.
pub fn altered(body: &Inertia, mass: f64, shift: Vector3<f64>, inertia: f64) -> Inertia {
    Inertia::from_com(
        body.mass * mass,
        body.com() + shift,
        body.about_com() * (mass * inertia),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families;
    use physics::dynamics::inverse_dynamics;

    fn torque(arm: &Arm, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
        let robot = arm.robot().unwrap();
        let mut tau = vec![0.0; robot.dof()];
        inverse_dynamics(&robot, &mut Workspace::new(&robot), q, qd, qdd, &mut tau);
        tau
    }

    #[test]
    fn a_locked_gear_changes_nothing() {
        let mut arm = families::ur5();
        arm.add_disc(1, 0.7);
        let (q, qd, qdd) = ([0.3, -1.0, 0.8, 0.2, -0.5, 0.4], [0.5; 6], [1.0; 6]);
        let whole = torque(&arm, &q, &qd, &qdd);
        let mut split = arm.clone();
        split.split_joint(1);
        let put = |x: &[f64], v: f64| {
            let mut y = x.to_vec();
            y.insert(2, v);
            y
        };
        let parts = torque(&split, &put(&q, 0.0), &put(&qd, 0.0), &put(&qdd, 0.0));
        for (j, w) in whole.iter().enumerate() {
            let k = if j > 1 { j + 1 } else { j };
            assert!((parts[k] - w).abs() < 1e-11, "joint {j}: {} {w}", parts[k]);
        }
    }

    #[test]
    fn a_shifted_zero_is_another_position() {
        for (arm, j) in [(families::ur5(), 2), (families::scara4(), 2)] {
            let n = arm.dof();
            let (q, qd, qdd) = (vec![0.2; n], vec![0.4; n], vec![-0.7; n]);
            let mut moved = arm.clone();
            moved.shift_zero(j, 0.03);
            let mut true_q = q.clone();
            true_q[j] -= 0.03;
            let (a, b) = (
                torque(&moved, &q, &qd, &qdd),
                torque(&arm, &true_q, &qd, &qdd),
            );
            for (a, b) in a.iter().zip(&b) {
                assert!((a - b).abs() < 1e-11);
            }
        }
    }
}
