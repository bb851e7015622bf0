//! The robot that really moves: rigid bodies, friction and mechanisms, integrated in time.

use crate::bodies::{Bodies, Chain};
use crate::mechanism::{Instant, Mechanism, RestLaw};
use physics::robot::Robot;
use signal::cholesky;

/// Viscous and Coulomb friction of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Viscous coefficient, N·m·s/rad.
    pub viscous: f64,
    /// Coulomb torque of the joint, N·m.
    pub coulomb: f64,
    /// Speed below which the sign is softened, rad/s.
    pub v_eps: f64,
    /// Law of softening near rest.
    pub rest: RestLaw,
}

impl Friction {
    /// Torque against motion at velocity `v`.
    pub fn torque(&self, v: f64) -> f64 {
        self.viscous * v + self.coulomb * self.rest.sign(v, self.v_eps)
    }
}

/// A robot in motion.
///
/// One step from (q, v) of length h solves, for the acceleration a of the step,
/// M(q_m) a + c(q_m, v_m) + g(q_m) + R(v + h a) = u + f(q_m, …), q_m = q + h v/2, v_m = v + h a₋/2,
/// then v ← v + h a and q ← q + h (v₋ + v)/2: position Verlet for everything elastic, implicit Euler for all that
/// resists velocity, so that sticking is a fixed point and stiff friction costs no stability. The resistance R of
/// each joint is replaced by its chord through R(0) and the last guess of the end velocity, and the linear
/// system solved again until the guess stands; for friction whose slope falls with speed these chords
/// majorise its dissipation function, so the iteration cannot diverge.
pub struct Plant {
    bodies: Box<dyn Bodies>,
    armature: Vec<f64>,
    friction: Vec<Friction>,
    mechanisms: Vec<Box<dyn Mechanism>>,
    /// Indices of the mechanisms that resist each joint.
    resisting: Vec<Vec<usize>>,
    /// Positions of the joints, rad or m.
    pub q: Vec<f64>,
    /// Velocities of the joints, rad/s (m/s).
    pub v: Vec<f64>,
    /// Accelerations of the last step.
    pub a: Vec<f64>,
    load: Vec<f64>,
    /// Generalised force of each mechanism on each joint in the last step, N·m (N).
    pub exerted: Vec<f64>,
    mass: Vec<f64>,
    factor: Vec<f64>,
    bias: Vec<f64>,
    force: Vec<f64>,
    middle: Vec<f64>,
    velocity: Vec<f64>,
    end: Vec<f64>,
    chord: Vec<f64>,
    still: Vec<f64>,
    rest: Vec<f64>,
}

/// Largest number of solves of a step. Most steps take two, reversals up to ten.
const MOST_SOLVES: usize = 25;

impl Plant {
    /// A serial arm at rest at `q`. `armature`: rotor inertias seen from the joints.
    ///
    /// # Panics
    /// When the slices do not have one value per joint.
    pub fn new(
        robot: Robot,
        armature: Vec<f64>,
        friction: Vec<Friction>,
        mechanisms: Vec<Box<dyn Mechanism>>,
        q: Vec<f64>,
    ) -> Self {
        Self::of(
            Box::new(Chain::new(robot)),
            armature,
            friction,
            mechanisms,
            q,
        )
    }

    /// Bodies of any kind at rest at `q`; otherwise as [`Plant::new`].
    ///
    /// # Panics
    /// When the slices do not have one value per joint.
    pub fn of(
        bodies: Box<dyn Bodies>,
        armature: Vec<f64>,
        friction: Vec<Friction>,
        mechanisms: Vec<Box<dyn Mechanism>>,
        q: Vec<f64>,
    ) -> Self {
        let n = bodies.dof();
        assert!(armature.len() == n && friction.len() == n && q.len() == n);
        let resisting = (0..n)
            .map(|j| {
                (0..mechanisms.len())
                    .filter(|&m| mechanisms[m].joint() == Some(j))
                    .collect()
            })
            .collect();
        Self {
            bodies,
            armature,
            friction,
            resisting,
            exerted: vec![0.0; n * mechanisms.len()],
            mechanisms,
            q,
            v: vec![0.0; n],
            a: vec![0.0; n],
            load: vec![0.0; n],
            mass: vec![0.0; n * n],
            factor: vec![0.0; n * n],
            bias: vec![0.0; n],
            force: vec![0.0; n],
            middle: vec![0.0; n],
            velocity: vec![0.0; n],
            end: vec![0.0; n],
            chord: vec![0.0; n],
            still: vec![0.0; n],
            rest: vec![0.0; n],
        }
    }

    /// Number of joints, those of transmissions included.
    pub fn dof(&self) -> usize {
        self.q.len()
    }

    /// Relative temperature of joint `j` where a mechanism has one.
    pub fn warmth(&self, j: usize) -> Option<f64> {
        self.resisting[j]
            .iter()
            .find_map(|&m| self.mechanisms[m].warmth())
    }

    /// One step of `dt` seconds from time `t` under the motor torques `u` (N·m).
    pub fn step(&mut self, t: f64, dt: f64, u: &[f64]) {
        let n = self.dof();
        for j in 0..n {
            self.middle[j] = self.q[j] + 0.5 * dt * self.v[j];
            self.velocity[j] = self.v[j] + 0.5 * dt * self.a[j];
            self.end[j] = self.v[j] + dt * self.a[j];
        }
        self.bodies.mass(&self.middle, &mut self.mass);
        self.bodies
            .bias(&self.middle, &self.velocity, &mut self.bias);
        let now = Instant {
            t: t + 0.5 * dt,
            dt,
            q: &self.middle,
            v: &self.velocity,
            a: &self.a,
            load: &self.load,
        };
        self.force.copy_from_slice(u);
        self.exerted.fill(0.0);
        for (m, exerted) in self.mechanisms.iter_mut().zip(self.exerted.chunks_mut(n)) {
            m.push(&now, exerted);
            self.force
                .iter_mut()
                .zip(exerted)
                .for_each(|(f, e)| *f += *e);
        }
        let resistance = |j: usize, v: f64| {
            let extra: f64 = self.resisting[j]
                .iter()
                .map(|&m| self.mechanisms[m].resist(&now, v))
                .sum();
            self.friction[j].torque(v) + extra
        };
        for j in 0..n {
            self.still[j] = resistance(j, 0.0);
        }
        for _ in 0..MOST_SOLVES {
            for j in 0..n {
                let floor = 1e-3 * self.friction[j].v_eps;
                let v = if self.end[j].abs() < floor {
                    floor
                } else {
                    self.end[j]
                };
                self.chord[j] = (resistance(j, v) - self.still[j]) / v;
            }
            self.factor.copy_from_slice(&self.mass);
            for j in 0..n {
                self.factor[j * n + j] += self.armature[j] + dt * self.chord[j];
                self.rest[j] =
                    self.force[j] - self.bias[j] - self.still[j] - self.chord[j] * self.v[j];
            }
            match cholesky::factor(&mut self.factor, n) {
                Some(()) => cholesky::solve(&self.factor, &mut self.rest),
                // The mass is positive definite but for a state that is not finite, which it then stays.
                None => self.rest.fill(f64::NAN),
            }
            let mut settled = true;
            for j in 0..n {
                let end = self.v[j] + dt * self.rest[j];
                let tolerance = 1e-4 * end.abs() + 1e-3 * self.friction[j].v_eps;
                settled &= (end - self.end[j]).abs() <= tolerance;
                self.end[j] = end;
            }
            if settled {
                break;
            }
        }
        for (m, exerted) in self.mechanisms.iter_mut().zip(self.exerted.chunks_mut(n)) {
            if let Some(j) = m.joint() {
                exerted[j] -= m.resist(&now, self.end[j]);
            }
            m.advance(&now, &self.end);
        }
        for (j, u) in u.iter().enumerate() {
            self.load[j] = u - self.still[j] - self.chord[j] * self.end[j];
            self.q[j] += 0.5 * dt * (self.v[j] + self.end[j]);
        }
        self.v.copy_from_slice(&self.end);
        self.a.copy_from_slice(&self.rest);
    }

    /// Inverse dynamics: motor torques (N·m, into `torque`) for velocities `v` and accelerations `a` at
    /// positions `q` and time `t`. States of the mechanisms advance by `dt`; those of [`Plant::step`] are
    /// unchanged.
    pub fn invert(&mut self, [t, dt]: [f64; 2], [q, v, a]: [&[f64]; 3], torque: &mut [f64]) {
        let n = self.dof();
        self.bodies.mass(q, &mut self.mass);
        self.bodies.bias(q, v, &mut self.bias);
        let rows = self.mass.chunks_exact(n).enumerate();
        for ((j, row), torque) in rows.zip(torque.iter_mut()) {
            let inertial: f64 = row.iter().zip(a).map(|(m, a)| m * a).sum();
            *torque = inertial + self.bias[j] + self.armature[j] * a[j];
        }
        let now = Instant {
            t,
            dt,
            q,
            v,
            a,
            load: &self.load,
        };
        self.force.fill(0.0);
        for m in &mut self.mechanisms {
            m.push(&now, &mut self.force);
        }
        for (j, torque) in torque.iter_mut().enumerate() {
            *torque -= self.force[j];
        }
        self.rest.copy_from_slice(torque);
        let now = Instant {
            load: &self.rest,
            ..now
        };
        for (j, torque) in torque.iter_mut().enumerate() {
            *torque += self.friction[j].torque(v[j]);
        }
        for m in &mut self.mechanisms {
            if let Some(j) = m.joint() {
                torque[j] += m.resist(&now, v[j]);
            }
            m.advance(&now, v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families;
    use physics::dynamics::{kinetic_energy, potential_energy};

    fn plant(coulomb: f64, viscous: f64) -> Plant {
        let arm = families::panda_like7();
        let friction = Friction {
            viscous,
            coulomb,
            v_eps: 0.002,
            rest: RestLaw::Root,
        };
        let q = vec![0.3, 0.5, -0.2, -1.2, 0.4, 1.5, 0.1];
        Plant::new(
            arm.robot().unwrap(),
            vec![0.0; 7],
            vec![friction; 7],
            Vec::new(),
            q,
        )
    }

    #[test]
    fn free_fall_keeps_its_energy() {
        let mut p = plant(0.0, 0.0);
        let robot = families::panda_like7().robot().unwrap();
        let energy =
            |p: &Plant| kinetic_energy(&robot, &p.q, &p.v) + potential_energy(&robot, &p.q);
        let before = energy(&p);
        let mut kinetic = 0.0f64;
        for k in 0..1000 {
            p.step(k as f64 * 5e-4, 5e-4, &[0.0; 7]);
            kinetic = kinetic.max(kinetic_energy(&robot, &p.q, &p.v));
        }
        assert!(kinetic > 5.0);
        assert!(
            (energy(&p) - before).abs() < 2e-3 * kinetic,
            "{} of {kinetic}",
            energy(&p) - before
        );
    }

    #[test]
    fn friction_takes_what_energy_loses() {
        let mut p = plant(1.0, 0.5);
        let robot = families::panda_like7().robot().unwrap();
        let energy =
            |p: &Plant| kinetic_energy(&robot, &p.q, &p.v) + potential_energy(&robot, &p.q);
        let (before, dt) = (energy(&p), 5e-4);
        let (mut lost, mut swing) = (0.0, 0.0f64);
        for k in 0..2000 {
            let v0 = p.v.clone();
            p.step(k as f64 * dt, dt, &[0.0; 7]);
            for (j, v0) in v0.iter().enumerate() {
                lost += dt * 0.5 * (v0 + p.v[j]) * p.friction[j].torque(p.v[j]);
            }
            swing = swing.max(kinetic_energy(&robot, &p.q, &p.v));
        }
        assert!(lost > 3.0, "{lost}");
        assert!(
            (before - energy(&p) - lost).abs() < 0.01 * lost,
            "{} {lost}",
            before - energy(&p)
        );
    }

    #[test]
    fn a_strong_brake_holds_the_arm_still() {
        let mut p = plant(200.0, 0.0);
        let start = p.q.clone();
        for k in 0..2000 {
            p.step(k as f64 * 5e-4, 5e-4, &[0.0; 7]);
        }
        for (a, b) in p.q.iter().zip(&start) {
            assert!((a - b).abs() < 2e-3, "{a} {b}");
        }
    }

    #[test]
    fn what_was_driven_is_found_again() {
        let mut driven = plant(1.0, 0.5);
        let mut asked = plant(1.0, 0.5);
        let dt = 2e-4;
        let mut torque = [0.0; 7];
        for k in 0..2000 {
            let t = k as f64 * dt;
            let u: Vec<f64> = (0..7).map(|j| 3.0 * (4.0 * t + j as f64).sin()).collect();
            let before = (driven.q.clone(), driven.v.clone());
            driven.step(t, dt, &u);
            // The step takes bodies at its middle and friction at its end.
            let middle = |a: &[f64], b: &[f64]| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect()
            };
            let (q, v) = (middle(&before.0, &driven.q), middle(&before.1, &driven.v));
            asked.invert([t, dt], [&q, &v, &driven.a], &mut torque);
            for j in 0..7 {
                // Slow joints apart, for there friction changes within a step.
                if v[j].abs() > 0.05 {
                    assert!(
                        (torque[j] - u[j]).abs() < 0.02,
                        "joint {j}: {} {}",
                        torque[j],
                        u[j]
                    );
                }
            }
        }
    }
}
