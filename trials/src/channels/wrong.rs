//! Healthy recordings against descriptions that are wrong, or whose columns are not the description's.

use super::{ChannelCase, Fault, generate};
use crate::SimulateError;
use ndarray::Axis;
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use plant::random::log_uniform;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Wrong input beside a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// Masses that are each wrong by a factor of its own.
    Masses,
    /// Masses that are all wrong by one factor.
    MassesAlike,
    /// Masses that are placeholders in the description.
    Placeholders,
    /// Columns of two joints that are exchanged.
    Columns,
    /// Description of another arm with as many joints.
    AnotherArm,
}

impl Wrong {
    /// All kinds of wrong input.
    pub const ALL: [Self; 5] = [
        Self::Masses,
        Self::MassesAlike,
        Self::Placeholders,
        Self::Columns,
        Self::AnotherArm,
    ];

    /// Name, as in JSON and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Masses => "wrong_masses",
            Self::MassesAlike => "wrong_masses_alike",
            Self::Placeholders => "placeholders",
            Self::Columns => "columns_exchanged",
            Self::AnotherArm => "another_arm",
        }
    }
}

/// Range of the factor between described and true masses in practice, in either direction.
const FACTORS: [f64; 2] = [1.3, 2.0];
/// Placeholder for a link: mass, kg, and inertia, kg·m².
const PLACEHOLDERS: [(f64, f64); 3] = [(0.01, 1e-3), (1.0, 1e-3), (1.0, 1.0)];
/// Number of other robots among which one with as many joints is looked for.
const OTHERS: u64 = 200;

/// The healthy recording at `index` of the run with this seed, and a description that does not belong to it.
///
/// # Errors
/// As [`generate`].
pub fn against(wrong: Wrong, seed: u64, index: u64) -> Result<ChannelCase, SimulateError> {
    let mut case = generate(Fault::None, seed, index)?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ index.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    rng.set_stream(wrong as u64 + 1);
    let n = case.robot.dof();
    let up = rng.random_bool(0.75);
    let mut factor = || {
        let size = log_uniform(&mut rng, FACTORS[0], FACTORS[1]);
        if up { size } else { 1.0 / size }
    };
    match wrong {
        Wrong::Masses => {
            let factors: Vec<f64> = (0..n).map(|_| factor()).collect();
            case.robot = scaled(&case.robot, &factors)?;
        }
        Wrong::MassesAlike => {
            let one = factor();
            case.robot = scaled(&case.robot, &vec![one; n])?;
        }
        Wrong::Placeholders => {
            let (mass, inertia) = PLACEHOLDERS[rng.random_range(0..PLACEHOLDERS.len())];
            let mut parameters = vec![0.0; n * PARAMETERS_PER_LINK];
            for link in parameters.chunks_mut(PARAMETERS_PER_LINK) {
                link[0] = mass;
                for (place, value) in DIAGONAL.into_iter().zip([inertia; 3]) {
                    link[place] = value;
                }
            }
            case.robot = case.robot.with_parameters(&parameters)?;
        }
        Wrong::Columns => {
            let first = rng.random_range(0..n);
            let second = (first + rng.random_range(1..n)) % n;
            let mut order: Vec<usize> = (0..n).collect();
            order.swap(first, second);
            let recording = &mut case.recording;
            recording.q = recording.q.select(Axis(1), &order);
            let tables = [&mut recording.tau, &mut recording.qd, &mut recording.qdd];
            for table in tables.into_iter().flatten() {
                *table = table.select(Axis(1), &order);
            }
        }
        Wrong::AnotherArm => {
            for other in 1..=OTHERS {
                let robot = generate(Fault::None, seed, index + 100_000 * other)?.robot;
                if robot.dof() == n {
                    case.robot = robot;
                    break;
                }
            }
        }
    }
    Ok(case)
}

/// Places of the moments of inertia among a link's parameters: mass, first moments, then xx, xy, yy, xz, yz, zz.
const DIAGONAL: [usize; 3] = [4, 6, 9];

fn scaled(robot: &Robot, factors: &[f64]) -> Result<Robot, SimulateError> {
    let mut parameters = robot.parameters();
    for (link, factor) in parameters.chunks_mut(PARAMETERS_PER_LINK).zip(factors) {
        link.iter_mut().for_each(|p| *p *= factor);
    }
    Ok(robot.with_parameters(&parameters)?)
}
