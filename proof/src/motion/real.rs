//! Real robot of a sealed case: the one whose motion is recorded, under drives of its own.

use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Robot, RobotError};
use plant::arm::Arm;
use plant::build::Build;
use plant::mechanism::{GearMesh, Instant, Mechanism, Ripple, Stribeck, StribeckKind, soft_sign};
use plant::reference::{Command, Session};

/// Integration step of the real robot's simulation, s.
const STEP: f64 = 2.5e-4;

/// Time under the drives before a trajectory is recorded, s. The commands are at rest first, then lead into the motion.
const BEFORE: f64 = 2.0;

/// Length of a recorded trajectory, s.
pub(super) const LENGTH: f64 = 12.0;

/// Largest distance of a joint from its command, rad (m). A case with a joint beyond it is discarded.
const FARTHEST: f64 = 1.5;

/// Further mechanism of a joint, which only some robots have.
#[derive(Debug, Clone)]
pub enum Extra {
    /// Dry friction that is higher near standstill.
    Stribeck(Stribeck),
    /// Friction that grows with the load on a gear's mesh.
    Mesh(GearMesh),
    /// Magnetic torque that repeats over the position (detent, cogging).
    Detent(Ripple),
    /// Belt with slack between motor and joint.
    Belt {
        /// Index of the joint.
        joint: usize,
        /// Half of the belt's slack, rad at the joint.
        half: f64,
        /// Stiffness of the tight belt, N·m/rad.
        stiffness: f64,
    },
    /// Motor winding whose torque saturates smoothly.
    Winding {
        /// Index of the joint.
        joint: usize,
        /// Largest torque that the winding approaches, N·m.
        torque: f64,
    },
}

/// Real robot: all values on which its motion depends. Lists have one value for each joint.
#[derive(Debug, Clone)]
pub struct Real {
    /// Bodies and friction.
    pub arm: Arm,
    /// Rotor inertias that the description lacks, reflected to the joints, kg·m².
    pub armature: Vec<f64>,
    /// Proportional gain of each drive: torque per position error, N·m/rad.
    pub kp: Vec<f64>,
    /// Derivative gain of each drive: torque per velocity error, N·m·s/rad.
    pub kd: Vec<f64>,
    /// Whether the drives also receive commanded velocities, which are then recorded.
    pub rates: bool,
    /// Limit of each drive's torque, N·m, equal in both directions.
    pub limit: Vec<f64>,
    /// Delay of the commands to each drive, s.
    pub late: Vec<f64>,
    /// Part of the stated model's gravity torque that the drives add, from 0 (none) to 1 (all).
    pub gravity_compensation: f64,
    /// Robot of the handed-out description. Drives that compensate gravity compute with it.
    pub stated: Robot,
    /// Error of each encoder's zero, rad: shown less true position.
    pub zero: Vec<f64>,
    /// Coupling: a joint, the joint that drives its transmission, too, and the turn of the first one's motor per turn of the
    /// second. What motors see and give is theirs; friction stays at the joints.
    pub coupling: Option<(usize, usize, f64)>,
    /// Further mechanisms that only some robots have.
    pub extras: Vec<Extra>,
}

/// Motion of one trajectory at the times of its samples; tables are samples × joints.
#[derive(Debug, Clone)]
pub struct Moved {
    /// Commanded positions, rad (m).
    pub q_ref: Array2<f64>,
    /// Commanded velocities, rad/s (m/s).
    pub qd_ref: Array2<f64>,
    /// Positions that the encoders show, before noise and quantisation, rad (m).
    pub q: Array2<f64>,
    /// Whether the torque of some drive reached its limit.
    pub cut: bool,
}

impl Real {
    /// Motion of the robot along the first trajectory of the session, sampled every `period` s. None where a joint does
    /// not follow its command.
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
        let mut at: Vec<f64> = (0..n).map(|j| sent[0][(0, j)] - self.zero[j]).collect();
        if let Some((joint, driver, ratio)) = self.coupling {
            at[joint] -= ratio * at[driver];
        }
        let (mut plant, axes) = self.build().plant(&at)?;
        let mut u = vec![0.0; plant.dof()];
        let (mut held, mut seen, mut turning) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let still = vec![0.0; n];
        let mut workspace = Workspace::new(&self.stated);
        for k in 0..(before + rows) * every {
            for (j, &axis) in axes.iter().enumerate() {
                seen[j] = plant.q[axis] + self.zero[j];
                turning[j] = plant.v[axis];
            }
            if let Some((joint, driver, ratio)) = self.coupling {
                seen[joint] += ratio * plant.q[axes[driver]];
                turning[joint] += ratio * plant.v[axes[driver]];
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
                    + self.kd[j] * (rate - turning[j])
                    + self.gravity_compensation * held[j];
                let wound = self.wound(j, wanted);
                out.cut |= now > BEFORE && wound.abs() > self.limit[j];
                u[axis] = wound.clamp(-self.limit[j], self.limit[j]);
            }
            if let Some((joint, driver, ratio)) = self.coupling {
                u[axes[driver]] += ratio * u[axes[joint]];
            }
            plant.step(now, STEP, &u);
        }
        Ok(Some(out))
    }

    /// Torque that joint `joint`'s winding gives where the drive asks for `wanted`, N·m.
    fn wound(&self, joint: usize, wanted: f64) -> f64 {
        let own = self.extras.iter().find_map(|e| match e {
            Extra::Winding { joint: j, torque } if *j == joint => Some(*torque),
            _ => None,
        });
        own.map_or(wanted, |torque| torque * (wanted / torque).tanh())
    }

    /// Simulation of the robot with all its mechanisms.
    fn build(&self) -> Build {
        let mut build = Build::plain(&self.arm);
        build.armature.clone_from(&self.armature);
        for extra in &self.extras {
            match extra {
                Extra::Stribeck(s) => build.add(s.clone()),
                Extra::Mesh(m) => build.add(m.clone()),
                Extra::Detent(r) => build.add(r.clone()),
                // Belts come last: they add a joint, which would shift the indices of others. Windings are part of the
                // drive.
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

    /// Dry friction of a joint that is higher near standstill by up to `size`, N·m. The law `kind` differs from the
    /// fitted one.
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

/// Belt with slack on the joint that [`Build::split`] adds between motor and link.
struct Belt {
    /// Index of the added joint.
    joint: usize,
    /// Half of the slack, rad.
    half: f64,
    /// Stiffness of the tight belt, N·m/rad.
    stiffness: f64,
    /// Damping of the tight belt, N·m·s/rad.
    damping: f64,
}

impl Belt {
    /// Stretch of the belt beyond its slack, rad, at angle `x` between motor and link.
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
