//! Design of trajectories from the options of the command line.

use crate::arguments::{Arguments, Method, Wanted};
use crate::columns::extras;
use crate::failure;
use crate::limits::Given;
use identify::base::BaseParameters;
use identify::excitation::model_free::{self, DURATION, TRAJECTORIES};
use identify::excitation::{
    BaseRows, Bounds, Excitation, ExcitationError, Found, Goal, MotionLimits, Rest, Room,
    SearchOptions, Separation, Series, SineOptions, Stack, ToolRoom, model_free as random,
    optimise, sines, stack,
};
use model::failure::Failure;
use physics::robot::Robot;

/// Length of a Fourier series, s: 0.08 Hz, with five harmonics 0.4 Hz, the highest frequency of Han et al.
const PERIOD: f64 = 12.5;
/// Number of trajectories where a criterion chooses them.
const CHOSEN: usize = 3;
/// Highest frequency of random motions, Hz (KR300 benchmark, section 2.1).
const RANDOM_HZ: f64 = 1.0;
/// Rows of a trajectory: so many per period of its highest frequency, between two bounds. A Fourier series of five harmonics has the
/// hundred of Han et al.
const ROWS_PER_PERIOD: f64 = 20.0;
const ROWS: (usize, usize) = (100, 600);
/// Random starts of a search, and motions that a draw of sines counts as: its rows are many, and it has nothing to improve.
const STARTS: usize = 40;
const PER_DRAW: usize = 20;

/// Trajectories and how they were found.
pub struct Designed {
    /// Trajectories in the order of choice.
    pub trajectories: Vec<Series>,
    /// Cost of all trajectories up to each, and the cost at the start of its search; empty where no criterion was used.
    pub costs: Vec<[f64; 2]>,
    /// Number of motions that were evaluated.
    pub evaluations: usize,
    /// Notes on the design for the user.
    pub notes: Vec<String>,
}

/// Designs the motion that the command line asks for.
pub fn design(
    robot: &Robot,
    given: &Given,
    noise: &[f64],
    arguments: &Arguments,
) -> Result<Designed, Failure> {
    check(arguments)?;
    let other = other(robot, arguments)?;
    let names = robot.joint_names();
    let refused = |e: ExcitationError| failure::of(&e, &names);
    let mut bounds = Bounds {
        limits: given
            .limits
            .iter()
            .map(|l| l.share(arguments.share))
            .collect::<Vec<MotionLimits>>(),
        rest: arguments.rest.unwrap_or(match arguments.method {
            Method::ModelFree => Rest::Jerk,
            Method::Fourier | Method::Sines => Rest::Acceleration,
        }),
        home: given.home.clone(),
        tool: (!given.regions.is_empty())
            .then(|| ToolRoom::new(robot, &given.limits, given.tool, given.regions.clone())),
    };
    let extras = extras(&arguments.columns);
    let base = BaseParameters::of_robot(robot, &extras);
    let goal = |samples: usize| -> Result<Box<dyn Goal + '_>, ExcitationError> {
        Ok(match arguments.criterion {
            Wanted::Parameters(criterion) => Box::new(Excitation::new(
                BaseRows::new(robot, &base, &extras),
                criterion,
                noise.to_vec(),
                samples,
            )?),
            Wanted::Separation => {
                let other = other.as_ref().expect("the command line was checked");
                Box::new(Separation::new([robot, other], noise.to_vec(), samples)?)
            }
        })
    };
    let count = arguments.trajectories;
    let (seed, evaluations) = (arguments.seed, arguments.evaluations);
    match arguments.method {
        Method::Fourier => {
            let period = arguments.period.unwrap_or(PERIOD);
            whole_samples(period, arguments.rate)?;
            let highest = arguments.harmonics as f64 / period;
            if let Some(most) = arguments.max_hz.filter(|most| highest > *most) {
                return Err(Failure::input(
                    format!(
                        "{} harmonics of {period} s reach {highest:.3} Hz, above --max-hz {most}",
                        arguments.harmonics
                    ),
                    format!(
                        "Give at most --harmonics {:.0}, or --period {:.1} or more.",
                        (most * period).floor(),
                        arguments.harmonics as f64 / most
                    ),
                ));
            }
            let harmonics: Vec<usize> = (1..=arguments.harmonics).collect();
            let room = Room::new(bounds, period, &harmonics, seed).map_err(refused)?;
            let mut goal = goal(rows(highest, period)).map_err(refused)?;
            let search = |goal: &dyn Goal, seed: u64| {
                let options = SearchOptions {
                    starts: STARTS.min(evaluations),
                    evaluations,
                    seed,
                };
                optimise(&room, &options, |t| goal.cost(t))
            };
            let wanted = count.unwrap_or(CHOSEN);
            let stacked = stack(goal.as_mut(), wanted, seed, search).map_err(refused)?;
            Ok(chosen(stacked, wanted))
        }
        Method::Sines => {
            if let Some(period) = arguments.period {
                whole_samples(period, arguments.rate)?;
            }
            let options = SineOptions {
                duration: arguments.period,
                highest_hz: arguments.max_hz,
                draws: evaluations.div_ceil(PER_DRAW),
                seed,
                ..SineOptions::default()
            };
            // Lengths follow from the limits, so that the first draw says how many rows there are.
            let one = SineOptions {
                draws: 1,
                ..options.clone()
            };
            let first = sines(&bounds, &one, |_| Ok(0.0))
                .map_err(refused)?
                .trajectory;
            let fastest =
                first.pulsation.iter().copied().fold(0.0, f64::max) / std::f64::consts::TAU;
            let mut goal = goal(rows(fastest, first.duration)).map_err(refused)?;
            let search = |goal: &dyn Goal, seed: u64| -> Result<Found, ExcitationError> {
                let own = SineOptions {
                    seed,
                    ..options.clone()
                };
                sines(&bounds, &own, |t| goal.cost(t))
            };
            let wanted = count.unwrap_or(CHOSEN);
            let stacked = stack(goal.as_mut(), wanted, seed, search).map_err(refused)?;
            Ok(chosen(stacked, wanted))
        }
        Method::ModelFree => {
            let period = arguments.period.unwrap_or(DURATION);
            whole_samples(period, arguments.rate)?;
            if bounds.home.is_none() {
                bounds.home = Some(bounds.anchor(seed).map_err(refused)?);
            }
            let most = arguments.max_hz.unwrap_or(RANDOM_HZ);
            let harmonics = model_free::harmonics((most * period) as usize);
            let room = Room::new(bounds, period, &harmonics, seed).map_err(refused)?;
            let count = count.unwrap_or(TRAJECTORIES);
            // Far apart, so that neighbouring seeds share no trajectory.
            let seeds = (0..count as u64).map(|k| seed.wrapping_mul(1_000_003).wrapping_add(k));
            Ok(Designed {
                trajectories: seeds.map(|seed| random(&room, seed)).collect(),
                costs: Vec::new(),
                evaluations: 0,
                notes: Vec::new(),
            })
        }
    }
}

fn chosen(stacked: Stack, wanted: usize) -> Designed {
    let mut notes = Vec::new();
    if stacked.chosen.len() < wanted {
        notes.push(format!(
            "{} of {wanted} trajectories: ten further searches lowered the criterion no more",
            stacked.chosen.len()
        ));
    }
    Designed {
        trajectories: stacked.trajectories(),
        costs: stacked
            .chosen
            .iter()
            .map(|f| [f.cost, f.start_cost])
            .collect(),
        evaluations: stacked.evaluations,
        notes,
    }
}

fn rows(highest_hz: f64, seconds: f64) -> usize {
    ((ROWS_PER_PERIOD * highest_hz * seconds).round() as usize).clamp(ROWS.0, ROWS.1)
}

/// Refuses contradictory arguments.
fn check(arguments: &Arguments) -> Result<(), Failure> {
    let counts = [
        ("--trajectories", arguments.trajectories.unwrap_or(1)),
        ("--harmonics", arguments.harmonics),
        ("--repeat", arguments.repeat),
        ("--evaluations", arguments.evaluations),
    ];
    if let Some((flag, _)) = counts.iter().find(|c| c.1 == 0) {
        return Err(Failure::input(format!("{flag} must be at least 1"), ""));
    }
    if arguments.method == Method::Sines && arguments.repeat > 1 {
        return Err(Failure::input(
            "sines without whole ratios do not end where they start, so they cannot be repeated",
            "Give a longer --period instead of --repeat.",
        ));
    }
    Ok(())
}

/// The other model of a separation.
fn other(robot: &Robot, arguments: &Arguments) -> Result<Option<Robot>, Failure> {
    match (&arguments.against, arguments.criterion) {
        (Some(name), Wanted::Separation) => {
            let loaded = Robot::load(name, &arguments.joints)
                .map_err(|e| Failure::input(e.to_string(), ""))?;
            let mut other = loaded.0;
            if other.dof() != robot.dof() {
                return Err(Failure::input(
                    format!(
                        "{name} has {} joints, {} has {}",
                        other.dof(),
                        arguments.robot,
                        robot.dof()
                    ),
                    "Both models must be of one robot.",
                ));
            }
            if let Some(g) = arguments.gravity {
                other = other.with_gravity(g.into());
            }
            Ok(Some(other))
        }
        (None, Wanted::Separation) => Err(Failure::input(
            "--criterion separation needs another model of the robot",
            "Give it by --against URDF.",
        )),
        (Some(_), _) => Err(Failure::input(
            "--against is for --criterion separation alone",
            "Give --criterion separation as well.",
        )),
        (None, _) => Ok(None),
    }
}

/// Refuses a period that is not a whole number of samples: runs could not be averaged sample by sample (UR5 paper, eq.
/// 13).
fn whole_samples(period: f64, rate: f64) -> Result<(), Failure> {
    let samples = period * rate;
    if (samples - samples.round()).abs() < 1e-6 * samples.max(1.0) && samples >= 2.0 {
        return Ok(());
    }
    Err(Failure::input(
        format!(
            "a period of {period} s is {samples:.3} samples at {rate} Hz; it must be a whole number of them"
        ),
        format!(
            "Give --period {}, or another --rate.",
            samples.round().max(2.0) / rate
        ),
    ))
}
