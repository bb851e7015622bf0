//! The robot that really moves in a sealed case, under a drive of its own.

use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Robot, RobotError};
use plant::arm::Arm;
use plant::build::Build;
use plant::mechanism::{GearMesh, Instant, Mechanism, Ripple, Stribeck, StribeckKind, soft_sign};
use plant::reference::{Command, Session};

/// Integration step of the plant, s.
const STEP: f64 = 2.5e-4;

/// Time under the drive before a trajectory is recorded, s: at rest, then led into the motion.
const BEFORE: f64 = 2.0;

/// Length of a trajectory, s.
pub(super) const LENGTH: f64 = 12.0;

/// Farthest that a joint may be from its command, rad (m). A case with a joint beyond that is discarded.
const FARTHEST: f64 = 1.5;

/// Further mechanism that only some robots have, on some joint.
#[derive(Debug, Clone)]
pub enum Extra {
    /// Boundary friction of a starting joint.
    Stribeck(Stribeck),
    /// Friction that grows with the load of a gear's mesh.
    Mesh(GearMesh),
    /// Torque of magnets that repeats over the position (detents).
    Detent(Ripple),
    /// Belt with slack behind the motor: half of the slack, rad, and its stiffness, N·m/rad.
    Belt {
        /// Index of the joint whose motor drives the belt.
        joint: usize,
        /// Half of the slack of the belt, rad.
        half: f64,
        /// Stiffness of the tight belt, N·m/rad.
        stiffness: f64,
    },
    /// Winding whose torque saturates: it bends down towards a largest torque, N·m.
    Winding {
        /// Index of the joint whose motor has the winding.
        joint: usize,
        /// Torque that the winding saturates at, N·m.
        torque: f64,
    },
}

/// Numbers of the real robot on which its motion depends.
#[derive(Debug, Clone)]
pub struct Real {
    /// Bodies and friction of the robot.
    pub arm: Arm,
    /// Rotor inertias that no description counts, kg·m².
    pub armature: Vec<f64>,
    /// Gain of each drive on the position error, N·m/rad.
    pub kp: Vec<f64>,
    /// Gain of each drive on the velocity error, N·m·s/rad.
    pub kd: Vec<f64>,
    /// Whether the drives are sent velocities, too.
    pub rates: bool,
    /// Largest torque of each drive, N·m.
    pub limit: Vec<f64>,
    /// Delay of the commands on the bus to each joint, s.
    pub late: Vec<f64>,
    /// Part of the stated model's gravity that the drive adds.
    pub gravity_compensation: f64,
    /// Bodies of the model that the drive knows.
    pub stated: Robot,
    /// Error of each encoder's zero, rad.
    pub zero: Vec<f64>,
    /// Further mechanisms that only some robots have.
    pub extras: Vec<Extra>,
}

/// Commands and true positions at the stamps of one trajectory, rows × joints.
#[derive(Debug, Clone)]
pub struct Moved {
    /// Commanded positions, rad (m).
    pub q_ref: Array2<f64>,
    /// Commanded velocities, rad/s (m/s).
    pub qd_ref: Array2<f64>,
    /// Positions as a perfect encoder would count them.
    pub q: Array2<f64>,
    /// Whether some drive's torque reached its limit.
    pub cut: bool,
}

impl Real {
    /// Runs a trajectory of the session, sampled every `period` s; none where the robot does not follow.
    ///
    /// # Errors
    /// Bodies that make no robot.
    pub fn run(&self, session: &Session, period: f64) -> Result<Option<Moved>, RobotError> {
        let n = self.arm.dof();
        let every = (period / STEP).round() as usize;
        let rows = (session.lengths[0] / period).round() as usize;
        let mut out = Moved {
            q_ref: Array2::zeros((rows, n)),
            qd_ref: Array2::zeros((rows, n)),
            q: Array2::zeros((rows, n)),
            cut: false,
        };
        // Commands as they are sent, from before the recording on.
        let mut command = Command::new(n);
        let before = (BEFORE / period).round() as usize;
        let mut sent = [
            Array2::zeros((before + rows, n)),
            Array2::zeros((before + rows, n)),
        ];
        for row in 0..before + rows {
            session.sample((row as f64 - before as f64) * period, &mut command);
            for j in 0..n {
                sent[0][(row, j)] = command.q[j];
                sent[1][(row, j)] = command.qd[j];
                if let Some(row) = row.checked_sub(before) {
                    out.q_ref[(row, j)] = command.q[j];
                    out.qd_ref[(row, j)] = command.qd[j];
                }
            }
        }
        let at: Vec<f64> = (0..n).map(|j| sent[0][(0, j)] - self.zero[j]).collect();
        let (mut plant, axes) = self.build().plant(&at)?;
        let mut u = vec![0.0; plant.dof()];
        let (mut held, mut seen) = (vec![0.0; n], vec![0.0; n]);
        let still = vec![0.0; n];
        let mut workspace = Workspace::new(&self.stated);
        for k in 0..(before + rows) * every {
            for (j, &axis) in axes.iter().enumerate() {
                seen[j] = plant.q[axis] + self.zero[j];
            }
            let recorded = (k / every).checked_sub(before).filter(|_| k % every == 0);
            if let Some(row) = recorded {
                for (j, seen) in seen.iter().enumerate() {
                    out.q[(row, j)] = *seen;
                    let far = (seen - out.q_ref[(row, j)]).abs();
                    if far.is_nan() || far > FARTHEST {
                        return Ok(None);
                    }
                }
            }
            if self.gravity_compensation != 0.0 {
                inverse_dynamics(
                    &self.stated,
                    &mut workspace,
                    &seen,
                    &still,
                    &still,
                    &mut held,
                );
            }
            let now = k as f64 * STEP;
            for (j, &axis) in axes.iter().enumerate() {
                let row = ((now - self.late[j]) / period + 1e-9).floor().max(0.0) as usize;
                let row = row.min(before + rows - 1);
                let rate = if self.rates { sent[1][(row, j)] } else { 0.0 };
                let wanted = self.kp[j] * (sent[0][(row, j)] - seen[j])
                    + self.kd[j] * (rate - plant.v[axis])
                    + self.gravity_compensation * held[j];
                let wound = self.wound(j, wanted);
                out.cut |= now > BEFORE && wound.abs() > self.limit[j];
                u[axis] = wound.clamp(-self.limit[j], self.limit[j]);
            }
            plant.step(now, STEP, &u);
        }
        Ok(Some(out))
    }

    /// Torque that the winding gives where `wanted` is asked for.
    fn wound(&self, joint: usize, wanted: f64) -> f64 {
        let own = self.extras.iter().find_map(|e| match e {
            Extra::Winding { joint: j, torque } if *j == joint => Some(*torque),
            _ => None,
        });
        own.map_or(wanted, |torque| torque * (wanted / torque).tanh())
    }

    fn build(&self) -> Build {
        let mut build = Build::plain(&self.arm);
        build.armature.clone_from(&self.armature);
        for extra in &self.extras {
            match extra {
                Extra::Stribeck(s) => build.add(s.clone()),
                Extra::Mesh(m) => build.add(m.clone()),
                Extra::Detent(r) => build.add(r.clone()),
                // Joints behind it would count on; it comes last.
                Extra::Belt { .. } | Extra::Winding { .. } => {}
            }
        }
        for extra in &self.extras {
            if let Extra::Belt {
                joint,
                half,
                stiffness,
            } = *extra
            {
                let critical = (stiffness * build.arm.disc[joint]).sqrt();
                let at = build.split(joint);
                build.add(Belt {
                    joint: at,
                    half,
                    stiffness,
                    damping: 0.3 * critical,
                });
            }
        }
        build
    }

    /// Boundary friction of a joint by a law other than the fitted one.
    pub fn boundary(&self, joint: usize, size: f64, v_s: f64, kind: StribeckKind) -> Extra {
        Extra::Stribeck(Stribeck {
            joint,
            size,
            v_s,
            v_eps: self.arm.v_eps[joint],
            kind,
            film: 0.0,
        })
    }
}

/// A belt with slack on the joint that [`Build::split`] adds.
struct Belt {
    joint: usize,
    half: f64,
    stiffness: f64,
    damping: f64,
}

impl Belt {
    fn stretch(&self, x: f64) -> f64 {
        x - x.clamp(-self.half, self.half)
    }
}

impl Mechanism for Belt {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        force[self.joint] -= self.stiffness * self.stretch(now.q[self.joint]);
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, now: &Instant, v: f64) -> f64 {
        let tight = f64::from(self.stretch(now.q[self.joint]) != 0.0);
        self.damping * (0.02 + tight) * v + 1e-6 * soft_sign(v, 1e-3)
    }
}
