//! Regressors of random states, with columns beyond the rigid body.

use faer::Mat;
use physics::dynamics::{Workspace, regressor};
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Columns behind the 10 N standard ones: N of each kind, one per joint, acting on that joint alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extra {
    /// Rotor inertia, q̈; `Ia1` …
    RotorInertia,
    /// Viscous friction, q̇; `fv1` …
    Viscous,
    /// Coulomb friction, sign(q̇); `fc1` …
    Coulomb,
    /// Offset of the torque, 1; `f01` …
    Offset,
}

impl Extra {
    /// Prefix of the parameters' names.
    pub fn prefix(self) -> &'static str {
        match self {
            Self::RotorInertia => "Ia",
            Self::Viscous => "fv",
            Self::Coulomb => "fc",
            Self::Offset => "f0",
        }
    }

    /// The column's entry for a joint with velocity `qd` and acceleration `qdd`.
    pub fn value(self, qd: f64, qdd: f64) -> f64 {
        match self {
            Self::RotorInertia => qdd,
            Self::Viscous => qd,
            Self::Coulomb => {
                if qd == 0.0 {
                    0.0
                } else {
                    qd.signum()
                }
            }
            Self::Offset => 1.0,
        }
    }
}

/// Seed of the random states. Any would serve: they are in general position.
const SEED: u64 = 0x5eed;
/// Ranges of the states, chosen so that gravity, Coriolis and acceleration terms have similar sizes.
const VELOCITY: f64 = 3.0;
const ACCELERATION: f64 = 10.0;

/// Regressor rows of random states (rows × columns) and the columns' names. The states ignore the joints'
/// limits: the question is structural identifiability, not the excitation by one motion.
pub(super) fn random_samples(robot: &Robot, extras: &[Extra]) -> (Mat<f64>, Vec<String>) {
    let n = robot.dof();
    let rigid = PARAMETERS_PER_LINK * n;
    let mut names = robot.parameter_names();
    for extra in extras {
        names.extend((1..=n).map(|joint| format!("{}{joint}", extra.prefix())));
    }
    // Each state gives N rows; joint N sees only the last link, hence twice the columns in states.
    let states = 2 * names.len();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut workspace = Workspace::new(robot);
    let mut samples = Mat::zeros(states * n, names.len());
    let mut y = vec![0.0; n * rigid];
    let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for state in 0..states {
        for (i, joint) in robot.joints().iter().enumerate() {
            let range = if joint.kind.is_rotation() {
                std::f64::consts::PI
            } else {
                1.0
            };
            q[i] = rng.random_range(-range..range);
            qd[i] = rng.random_range(-VELOCITY..VELOCITY);
            qdd[i] = rng.random_range(-ACCELERATION..ACCELERATION);
        }
        regressor(robot, &mut workspace, &q, &qd, &qdd, &mut y);
        for i in 0..n {
            let row = state * n + i;
            for column in 0..rigid {
                samples[(row, column)] = y[i * rigid + column];
            }
            for (k, extra) in extras.iter().enumerate() {
                samples[(row, rigid + k * n + i)] = extra.value(qd[i], qdd[i]);
            }
        }
    }
    (samples, names)
}
