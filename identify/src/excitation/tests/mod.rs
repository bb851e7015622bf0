mod limits;

use super::sines::repeats;
use super::*;
use crate::base::{BaseParameters, Extra};
use physics::robot::Robot;
use std::f64::consts::PI;

const LIMITS: MotionLimits = MotionLimits {
    lower: -2.0,
    upper: 1.0,
    velocity: 1.5,
    acceleration: 4.0,
    jerk: 30.0,
};
const EXTRAS: [Extra; 2] = [Extra::Viscous, Extra::Coulomb];
const NOISE: [f64; 6] = [3.0, 3.0, 2.0, 0.5, 0.5, 0.5];

fn state(trajectory: &Series, t: f64) -> State {
    let mut state = State::new(trajectory.dof());
    trajectory.at(t, &mut state);
    state
}

/// Largest excess over any limit on a grid of `points` (positive: a limit is broken).
fn excess(trajectory: &Series, limits: &[MotionLimits], points: usize) -> f64 {
    let mut most = f64::NEG_INFINITY;
    for k in 0..=points {
        let s = state(trajectory, trajectory.duration * k as f64 / points as f64);
        for (j, l) in limits.iter().enumerate() {
            let over = [
                s.q[j] - l.upper,
                l.lower - s.q[j],
                s.qd[j].abs() - l.velocity,
                s.qdd[j].abs() - l.acceleration,
                s.qddd[j].abs() - l.jerk,
            ];
            most = over.into_iter().fold(most, f64::max);
        }
    }
    most
}

fn goal(robot: &Robot, criterion: Criterion) -> Excitation<'_> {
    let base = BaseParameters::of_robot(robot, &EXTRAS);
    let rows = BaseRows::new(robot, &base, &EXTRAS);
    Excitation::new(rows, criterion, NOISE.to_vec(), 60).unwrap()
}

fn room(limits: MotionLimits) -> Room<'static> {
    Room::new(Bounds::of(vec![limits; 6]), 12.5, &[1, 2, 3, 4, 5], 1).unwrap()
}

#[test]
fn every_criterion_is_lowered_within_the_limits_whatever_the_threads() {
    let robot = Robot::builtin("ur5").unwrap();
    let options = SearchOptions {
        starts: 6,
        evaluations: 160,
        seed: 1,
    };
    for criterion in Criterion::ALL {
        let goal = goal(&robot, criterion);
        let search = || optimise(&room(LIMITS), &options, |t| goal.cost(t)).unwrap();
        let found = search();
        assert!(found.cost < found.start_cost, "{criterion:?}");
        if criterion != Criterion::DOptimal {
            assert!(found.cost < 0.8 * found.start_cost, "{criterion:?}");
        }
        assert!(excess(&found.trajectory, &[LIMITS; 6], 4000) < 1e-9);
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        assert_eq!(one.unwrap().install(search), found);
    }
}

#[test]
fn criteria_are_those_of_the_paper() {
    let robot = Robot::builtin("ur5").unwrap();
    let trajectory = model_free(&room(LIMITS), 3);
    let cost = |c| goal(&robot, c).cost(&trajectory).unwrap();
    // Noise scales rows, so that criteria on Y and on Y* differ; with equal noise they do not.
    assert_ne!(cost(Criterion::Condition), cost(Criterion::ConditionNoise));
    let base = BaseParameters::of_robot(&robot, &EXTRAS);
    let rows = BaseRows::new(&robot, &base, &EXTRAS);
    for [plain, weighted] in [
        [Criterion::Condition, Criterion::ConditionNoise],
        [Criterion::SubRegressors, Criterion::SubRegressorsNoise],
    ] {
        let even = Excitation::new(rows.clone(), weighted, vec![0.5; 6], 60).unwrap();
        let (a, b) = (cost(plain), even.cost(&trajectory).unwrap());
        assert!((a - b).abs() < 1e-6 * a, "{a} {b}");
    }
    // 10 cond(Y) alone is less than the sum.
    assert!(cost(Criterion::SubRegressors) > 10.0 * cost(Criterion::Condition));
}

#[test]
fn a_second_trajectory_complements_the_first() {
    let robot = Robot::builtin("ur5").unwrap();
    let mut goal = goal(&robot, Criterion::ConditionNoise);
    let room = room(LIMITS);
    let options = SearchOptions {
        starts: 4,
        evaluations: 60,
        seed: 0,
    };
    let stacked = stack(&mut goal, 3, 5, |goal, seed| {
        optimise(
            &room,
            &SearchOptions {
                seed,
                ..options.clone()
            },
            |t| goal.cost(t),
        )
    })
    .unwrap();
    let costs: Vec<f64> = stacked.chosen.iter().map(|f| f.cost).collect();
    assert_eq!(costs.len(), 3);
    assert!(costs.windows(2).all(|w| w[1] < w[0]), "{costs:?}");
    // The stack's cost is that of all rows together.
    let [first, second] = [0, 1].map(|k| &stacked.chosen[k].trajectory);
    let mut own = self::goal(&robot, Criterion::ConditionNoise);
    own.take(first).unwrap();
    assert!((own.cost(second).unwrap() - costs[1]).abs() < 1e-6 * costs[1]);
    assert_eq!(own.triangle(second).unwrap().rows(), 2 * 60 * 6);
}

#[test]
fn derivatives_are_those_of_the_position() {
    let ramped = Series {
        duration: 7.0,
        ramp: 2.0,
        offset: vec![0.2],
        pulsation: ndarray::arr2(&[[0.9, 1.7]]),
        sine: ndarray::arr2(&[[0.3, -0.1]]),
        cosine: ndarray::arr2(&[[0.05, 0.2]]),
    };
    let plain = Series {
        ramp: 0.0,
        ..ramped.clone()
    };
    for trajectory in [plain, ramped] {
        for t in [0.4, 1.3, 3.0, 5.9, 6.6] {
            let h = 1e-5;
            let [a, b, c] = [t - h, t, t + h].map(|t| state(&trajectory, t));
            let slope = |x: &[f64], y: &[f64]| (y[0] - x[0]) / (2.0 * h);
            assert!((slope(&a.q, &c.q) - b.qd[0]).abs() < 1e-8);
            assert!((slope(&a.qd, &c.qd) - b.qdd[0]).abs() < 1e-8);
            assert!((slope(&a.qdd, &c.qdd) - b.qddd[0]).abs() < 1e-7);
        }
    }
}

#[test]
fn samples_begin_and_end_at_the_ends_of_runs() {
    let room = room(LIMITS);
    let series = model_free(&room, 1);
    let motion = series.sampled(40.0, 3, 10.0);
    assert_eq!(motion.len(), 3 * 500 + 1);
    assert!((motion.time[motion.len() - 1] - 47.5).abs() < 1e-9);
    for j in 0..6 {
        let start = series.start()[j];
        for run in 0..=3 {
            assert!((motion.q[(500 * run, j)] - start).abs() < 1e-9);
            assert!(motion.qd[(500 * run, j)].abs() < 1e-9);
        }
    }
}

#[test]
fn the_manuals_sines_keep_its_rules() {
    let robot = Robot::builtin("ur5").unwrap();
    let share = LIMITS.share(0.9);
    let bounds = Bounds::of(vec![share; 6]);
    let goal = goal(&robot, Criterion::Condition);
    let options = SineOptions {
        draws: 20,
        ..SineOptions::default()
    };
    let found = sines(&bounds, &options, |t| goal.cost(t)).unwrap();
    let t = &found.trajectory;
    assert!(excess(t, &bounds.limits, 20_000) < 1e-9);
    let w: Vec<f64> = t.pulsation.column(0).to_vec();
    for i in 0..6 {
        let amplitude = t.sine[(i, 0)].hypot(t.cosine[(i, 0)]);
        assert!((amplitude - share.half()).abs() < 1e-9);
        // Three periods between the ramps' middles.
        assert!(w[i] * (t.duration - t.ramp) > 3.0 * std::f64::consts::TAU - 1e-9);
        assert!(w[i] * amplitude > 0.5 * share.velocity);
        for k in 0..i {
            let ratio = w[i].max(w[k]) / w[i].min(w[k]);
            assert!((ratio - ratio.round()).abs() > 0.07, "{ratio}");
        }
    }
    assert!(!repeats(&w, t.duration - t.ramp));
    for end in [0.0, t.duration] {
        let s = state(t, end);
        assert!(
            s.qd.iter()
                .chain(&s.qdd)
                .chain(&s.qddd)
                .all(|x| x.abs() < 1e-9)
        );
    }
    let home: Vec<f64> = vec![0.3; 6];
    let at_home = Bounds {
        home: Some(home.clone()),
        ..bounds.clone()
    };
    let start = sines(&at_home, &options, |t| goal.cost(t))
        .unwrap()
        .trajectory
        .start();
    assert!(start.iter().zip(&home).all(|(a, b)| (a - b).abs() < 1e-9));
    let hurried = SineOptions {
        duration: Some(10.0),
        ..options
    };
    let refused = sines(&bounds, &hurried, |_| Ok(0.0)).unwrap_err();
    assert!(
        matches!(refused, ExcitationError::FewCycles { .. }),
        "{refused}"
    );
}

/// The manual's own example: 1, 2 and 1.2 Hz come round after five cycles of the first, 1.1, 1.3 and 1.5 Hz after eleven.
#[test]
fn repetition_is_seen() {
    let hz = |f: [f64; 3]| f.map(|f| std::f64::consts::TAU * f);
    assert!(repeats(&hz([1.0, 2.0, 1.2]), 5.1));
    assert!(!repeats(&hz([1.0, 2.0, 1.2]), 4.9));
    assert!(!repeats(&hz([1.1, 1.3, 1.5]), 9.9));
    assert!(repeats(&hz([1.1, 1.3, 1.5]), 10.1));
}

#[test]
fn the_benchmarks_motions_start_and_end_at_home_up_to_jerk() {
    let home = vec![0.1, -0.2, 0.3, 0.0, 0.0, -1.0];
    let bounds = Bounds {
        rest: Rest::Jerk,
        home: Some(home.clone()),
        ..Bounds::of(vec![LIMITS; 6])
    };
    let harmonics = model_free::harmonics(60);
    assert_eq!((harmonics.len(), harmonics[0], harmonics[9]), (10, 1, 60));
    let room = Room::new(bounds, model_free::DURATION, &harmonics, 1).unwrap();
    let all: Vec<Series> = (0..model_free::TRAJECTORIES as u64)
        .map(|seed| model_free(&room, seed))
        .collect();
    for (k, t) in all.iter().enumerate() {
        assert!(excess(t, &[LIMITS; 6], 3000) < 1e-9);
        for end in [0.0, t.duration] {
            let s = state(t, end);
            assert!(s.q.iter().zip(&home).all(|(a, b)| (a - b).abs() < 1e-9));
            let rates = s.qd.iter().chain(&s.qdd).chain(&s.qddd);
            assert!(
                rates.clone().all(|x| x.abs() < 1e-8),
                "{:?}",
                rates.collect::<Vec<_>>()
            );
        }
        assert!(all[..k].iter().all(|other| other != t));
    }
}

#[test]
fn the_tool_stays_in_its_region() {
    let robot = Robot::builtin("ur5").unwrap();
    let regions = vec![
        Region::Box {
            lower: [-0.6, -0.9, 0.1],
            upper: [0.6, 0.3, 1.2],
        },
        Region::Sphere {
            centre: [0.0, -0.4, 0.5],
            radius: 0.6,
        },
    ];
    let tool = ToolRoom::new(&robot, &[LIMITS; 6], [0.0, 0.0, 0.1], regions);
    let bounds = Bounds {
        tool: Some(tool.clone()),
        ..Bounds::of(vec![LIMITS; 6])
    };
    let room = Room::new(bounds, 12.5, &[1, 2, 3], 4).unwrap();
    for seed in 0..10 {
        let t = model_free(&room, seed);
        let mut least = f64::INFINITY;
        for k in 0..20_000 {
            let s = state(&t, t.duration * f64::from(k) / 20_000.0);
            least = least.min(tool.clearance(&s.q));
        }
        assert!(least > 0.0, "{least}");
        assert!(excess(&t, &[LIMITS; 6], 1000) < 1e-9);
        assert!(t.speed_bounds().iter().all(|v| *v > 0.0));
    }
    let nowhere = ToolRoom::new(
        &robot,
        &[LIMITS; 6],
        [0.0; 3],
        vec![Region::Sphere {
            centre: [5.0, 0.0, 0.0],
            radius: 0.5,
        }],
    );
    let bounds = Bounds {
        tool: Some(nowhere),
        ..Bounds::of(vec![LIMITS; 6])
    };
    let refused = |b| Room::new(b, 12.5, &[1, 2], 1).unwrap_err();
    assert_eq!(refused(bounds.clone()), ExcitationError::ToolNowhere);
    let at_home = Bounds {
        home: Some(vec![0.0; 6]),
        ..bounds
    };
    assert!(matches!(
        refused(at_home),
        ExcitationError::ToolOutsideAtHome { .. }
    ));
}

#[test]
fn separation_grows_with_the_difference_and_adds_up() {
    let robot = Robot::builtin("ur5").unwrap();
    let heavier = |mass: f64| {
        let mut p = robot.parameters();
        p[50] += mass;
        robot.clone().with_parameters(&p).unwrap()
    };
    let t = model_free(&room(LIMITS), 2);
    let cost = |mass: f64| {
        let other = heavier(mass);
        let goal = Separation::new([&robot, &other], vec![1.0; 6], 50).unwrap();
        goal.cost(&t).unwrap()
    };
    let (one, two) = (cost(0.5), cost(1.0));
    assert!(one < 0.0 && (two / one - 4.0).abs() < 1e-6, "{one} {two}");
    let other = heavier(0.5);
    let mut goal = Separation::new([&robot, &other], vec![1.0; 6], 50).unwrap();
    goal.take(&t).unwrap();
    assert!((goal.cost(&t).unwrap() - 2.0 * one).abs() < 1e-9 * one.abs());
}

/// A line through points: the deviations of intercept and slope by hand, and a column twice.
#[test]
fn deviations_are_those_of_least_squares() {
    use crate::least_squares::Accumulator;
    let sigma = 0.5;
    let mut rows = Accumulator::new(2);
    for x in [-1.0, 0.0, 1.0, 2.0] {
        rows.push(&[1.0, x], 0.0, 1.0 / sigma).unwrap();
    }
    let d = deviations(&rows.finish().unwrap(), 4.0);
    // XᵀX = [[4, 2], [2, 6]], its inverse [[6, −2], [−2, 4]]/20; four times the rows halve the deviation.
    let by_hand = [(6.0f64 / 20.0).sqrt(), (4.0f64 / 20.0).sqrt()].map(|s| 0.5 * sigma * s);
    assert!(
        d.iter().zip(by_hand).all(|(a, b)| (a - b).abs() < 1e-12),
        "{d:?}"
    );
    let mut twice = Accumulator::new(3);
    for x in [-1.0, 0.0, 1.0, 2.0] {
        twice.push(&[1.0, x, 2.0 * x], 0.0, 1.0).unwrap();
    }
    let d = deviations(&twice.finish().unwrap(), 1.0);
    assert!(
        d[0].is_finite() && d[1].is_infinite() && d[2].is_infinite(),
        "{d:?}"
    );
}
