//! Sealed cases for the proof of `replay`: drawn at random, simulated and recorded.

use super::MotionError;
use super::effects::{OUTSIDE, SINGLES, Scene, Shape, Truth, Withheld, draw};
use super::files::{drive_file, drives, record};
use super::real::{LENGTH, Moved, Real};
use super::shown::{Information, Known, information};
use datasets::Recording;
use physics::dynamics::{Workspace, inverse_dynamics, mass_matrix};
use physics::robot::to_urdf;
use plant::arm::Arm;
use plant::families::relative;
use plant::random::log_uniform;
use plant::reference::{Command, Moves, Multisine, Pace, Segment, Session};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Least ratio of the change of motion by an effect to the tracking error, both RMS, so that a case shows the effect.
/// It holds for the effect's joint, or for some joint.
const SEEN: f64 = 0.1;

/// Sealed answer of a case: the withheld effects and the true values.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Sealed {
    /// Kind of the case: `none`, `two`, `outside`, or the name of the one effect withheld.
    pub kind: String,
    /// Name of the simulator that made the motion: `plant` or `mujoco`.
    pub simulator: String,
    /// Effects that the real robot has and the handed-out description lacks; empty in cases of the kinds `none` and
    /// `outside`.
    pub withheld: Vec<Withheld>,
    /// True gains and delay of each joint's drive.
    pub drives: Vec<Truth>,
    /// Tolerance with which the drive file states the gains: relative standard deviation.
    pub tolerance: f64,
    /// Time between two commands, s.
    pub period: f64,
    /// What the motion to fit shows of the true values, by the simulator that made it; none where it was not worked out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub information: Option<Information>,
}

/// Case of the proof: the files handed out, and the sealed answer.
pub struct Case {
    /// Description of the robot without the withheld effects, as URDF text.
    pub urdf: String,
    /// Drive file with the stated gains, as TOML text.
    pub drive: String,
    /// Recordings of the real robot: the first to fit, the second held out.
    pub recordings: [Recording; 2],
    /// Sealed answer of the case.
    pub sealed: Sealed,
}

/// Kind of the case with index `i`. Of every thirteen cases three withhold nothing, one withholds two effects, one an
/// effect outside the catalogue, and eight a single effect each.
pub fn kind(i: u64) -> &'static str {
    let slot = i % 13;
    let singles = (i / 13) * 8;
    match slot {
        0 | 5 | 10 => "none",
        3 => "two",
        8 => "outside",
        _ => {
            let before = [0, 3, 5, 8, 10].iter().filter(|&&s| s < slot).count() as u64;
            SINGLES[((singles + slot - before) % SINGLES.len() as u64) as usize]
        }
    }
}

/// Draws and simulates the case with index `i` of a seed, with at most `joints` joints. The same arguments give the
/// same case.
///
/// # Errors
/// Kind of case that no draw fulfils, or bodies that make no robot.
pub fn make(i: u64, seed: u64, joints: usize) -> Result<Case, MotionError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(1_000_003).wrapping_add(i));
    for _ in 0..60 {
        if let Some(case) = attempt(kind(i), joints, &mut rng)? {
            return Ok(case);
        }
    }
    Err(MotionError::None(i))
}

/// Case of a kind from one draw of robot, motions and effects. None where the robot does not follow its commands, or
/// does not show the effect.
fn attempt(kind: &str, joints: usize, rng: &mut ChaCha8Rng) -> Result<Option<Case>, MotionError> {
    let mut arm = relative(rng);
    while arm.dof() > joints {
        arm = relative(rng);
    }
    let n = arm.dof();
    let inertia = felt(&arm)?;
    let stated = arm.robot()?;
    let kd_share = rng.random_range(0.5..1.2);
    let omega: Vec<f64> = (0..n).map(|_| TAU * log_uniform(rng, 1.5, 5.0)).collect();
    let mut nominal = Real {
        armature: vec![0.0; n],
        kp: (0..n).map(|j| inertia[j] * omega[j] * omega[j]).collect(),
        kd: (0..n)
            .map(|j| 2.0 * kd_share * inertia[j] * omega[j])
            .collect(),
        rates: rng.random_bool(0.4),
        limit: vec![f64::INFINITY; n],
        late: vec![0.0; n],
        gravity_compensation: if rng.random_bool(0.3) { 1.0 } else { 0.0 },
        stated,
        zero: vec![0.0; n],
        coupling: None,
        extras: Vec::new(),
        arm,
    };
    if kind == "gravity_compensation" {
        nominal.gravity_compensation = 0.0;
    }
    let period = 1.0 / [50.0, 100.0, 200.0, 500.0][rng.random_range(0..4)];
    let sessions = sessions(&nominal, rng);
    let torque = demand(&nominal, &sessions[..2])?;
    nominal.limit = torque.iter().map(|t| 3.0 * t).collect();
    let tolerance = [0.0, 0.1, 0.3][rng.random_range(0..3)];
    // Real robot without the withheld effects: its gains differ from the stated ones within the tolerance.
    let mut base = nominal.clone();
    for gain in base.kp.iter_mut().chain(&mut base.kd) {
        let z: f64 = StandardNormal.sample(rng);
        *gain *= (tolerance * z.clamp(-2.0, 2.0)).exp();
    }
    let scene = Scene {
        real: &base,
        stated: &nominal,
        torque: &torque,
        tolerance,
        period,
    };
    let names: Vec<&'static str> = match kind {
        "none" => Vec::new(),
        "two" => {
            let first = rng.random_range(0..SINGLES.len());
            vec![
                SINGLES[first],
                SINGLES[(first + rng.random_range(1..SINGLES.len())) % SINGLES.len()],
            ]
        }
        "outside" => vec![OUTSIDE[rng.random_range(0..OUTSIDE.len())]],
        one => vec![
            SINGLES
                .into_iter()
                .find(|s| *s == one)
                .unwrap_or(SINGLES[0]),
        ],
    };
    let (mut real, mut withheld) = (base.clone(), Vec::new());
    if names.is_empty()
        && moved(&base, &sessions[..2], period)?.is_none_or(|all| all.iter().any(|m| m.cut))
    {
        return Ok(None);
    }
    for name in names {
        let Some(shape) = draw(name, &scene, rng) else {
            return Ok(None);
        };
        let Some((next, own)) = sized(&shape, &base, &real, &sessions[..2], period)? else {
            return Ok(None);
        };
        real = next;
        withheld.push(own);
    }
    let mut moved = Vec::new();
    for session in &sessions {
        let Some(m) = real.run(session, period)? else {
            return Ok(None);
        };
        moved.push(m);
    }
    let outside = kind == "outside";
    let (train, sigma) = record(&moved[..2], period, real.rates, rng)?;
    let (test, _) = record(&moved[2..], period, real.rates, rng)?;
    let known = Known {
        tolerance,
        period,
        sigma,
    };
    let information = information(&real, &sessions[..2], &moved[..2], &withheld, known)?;
    Ok(Some(Case {
        urdf: to_urdf(&nominal.arm.robot()?),
        drive: drive_file(&nominal, tolerance, period),
        recordings: [train, test],
        sealed: Sealed {
            kind: kind.to_owned(),
            simulator: "plant".to_owned(),
            withheld: if outside { Vec::new() } else { withheld },
            drives: drives(&real),
            tolerance,
            period,
            information,
        },
    }))
}

/// Inertia that each joint's drive is tuned to, kg·m²: geometric mean of that with all other joints held and with all
/// free.
fn felt(arm: &Arm) -> Result<Vec<f64>, MotionError> {
    let robot = arm.robot()?;
    let n = robot.dof();
    let mut mass = vec![0.0; n * n];
    mass_matrix(&robot, &mut Workspace::new(&robot), &arm.centre, &mut mass);
    let mass = nalgebra::DMatrix::from_row_slice(n, n, &mass);
    let inverse = mass
        .clone()
        .try_inverse()
        .unwrap_or_else(|| mass.map(f64::recip));
    Ok((0..n)
        .map(|j| (mass[(j, j)] / inverse[(j, j)]).sqrt())
        .collect())
}

/// Motions of a case: two trajectories to fit and two held out. Of each two, one is a multisine and one a sequence of
/// moves with rests.
fn sessions(real: &Real, rng: &mut ChaCha8Rng) -> Vec<Session> {
    let arm = &real.arm;
    let n = arm.dof();
    (0..4)
        .map(|k| {
            let segment = if k % 2 == 0 {
                let pace = if rng.random_bool(0.7) {
                    Pace::lively()
                } else {
                    Pace::slow()
                };
                Segment::Multisine(Multisine::draw(arm, &pace, LENGTH, rng))
            } else {
                Segment::Moves(Moves::draw(arm, LENGTH, 0.6, rng))
            };
            Session::new(vec![(segment, LENGTH)], 1.0, n)
        })
        .collect()
}

/// Largest torque of each joint along the commanded motion, N·m: inverse dynamics and friction.
fn demand(real: &Real, sessions: &[Session]) -> Result<Vec<f64>, MotionError> {
    let robot = real.arm.robot()?;
    let n = robot.dof();
    let mut workspace = Workspace::new(&robot);
    let (mut most, mut tau, mut command) = (vec![0.0f64; n], vec![0.0; n], Command::new(n));
    for session in sessions {
        for k in 0..(LENGTH / 0.02) as usize {
            session.sample(0.02 * k as f64, &mut command);
            inverse_dynamics(
                &robot,
                &mut workspace,
                &command.q,
                &command.qd,
                &command.qdd,
                &mut tau,
            );
            for j in 0..n {
                let friction =
                    real.arm.joints[j].friction + real.arm.joints[j].damping * command.qd[j].abs();
                most[j] = most[j].max(tau[j].abs() + friction);
            }
        }
    }
    Ok(most)
}

/// Robot `real` with the effect, and the effect's true values. Its size is the smallest tried one that changes the
/// motion of `base` enough to be seen; none where no size does.
fn sized(
    shape: &Shape,
    base: &Real,
    real: &Real,
    sessions: &[Session],
    period: f64,
) -> Result<Option<(Real, Withheld)>, MotionError> {
    let alone = moved(base, sessions, period)?;
    // Cases in which a stated limit acts are dropped: a drive that is not tuned to its arm is no case.
    let Some(alone) = alone.filter(|all| all.iter().all(|m| !m.cut)) else {
        return Ok(None);
    };
    for size in [1.0, 1.6, 2.5] {
        let (changed, _) = shape.put(base, size)?;
        let Some(with) = moved(&changed, sessions, period)? else {
            return Ok(None);
        };
        if seen(&alone, &with, shape.joint()) >= SEEN {
            return Ok(Some(shape.put(real, size)?));
        }
    }
    Ok(None)
}

/// Motions of a robot along each session; none where it does not follow its commands.
fn moved(
    real: &Real,
    sessions: &[Session],
    period: f64,
) -> Result<Option<Vec<Moved>>, MotionError> {
    let all: Result<Option<Vec<Moved>>, _> = sessions.iter().map(|s| real.run(s, period)).collect();
    Ok(all?)
}

/// Ratio of the RMS change of motion to the RMS tracking error without the effect. It is that of `joint`, or the
/// largest over all joints.
fn seen(without: &[Moved], with: &[Moved], joint: Option<usize>) -> f64 {
    let n = without[0].q.ncols();
    let part = |j: usize| {
        let (mut change, mut departs) = (0.0, 0.0);
        for (a, b) in without.iter().zip(with) {
            for row in 0..a.q.nrows() {
                change += (a.q[(row, j)] - b.q[(row, j)]).powi(2);
                departs += (a.q[(row, j)] - a.q_ref[(row, j)]).powi(2);
            }
        }
        (change / departs).sqrt()
    };
    match joint {
        Some(j) => part(j),
        None => (0..n).map(part).fold(0.0, f64::max),
    }
}
