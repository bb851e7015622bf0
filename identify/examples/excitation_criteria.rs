//! Which criterion gives the best conditioned motions (Han et al., IEEE T-RO 36(5), 2020, Table II).

use identify::base::{BaseParameters, Extra};
use identify::excitation::{
    BaseRows, Bounds, Criterion, Excitation, Goal, MotionLimits, Room, SearchOptions, optimise,
    stack,
};
use identify::least_squares::SubRegressors;
use physics::robot::Robot;

/// Number of seeds; trajectories of each stack (Han et al. identify on five); motions judged for each; rows of a
/// trajectory in the search, a hundred of 1000 as in Han et al.
const SEEDS: u64 = 10;
const TRAJECTORIES: usize = 5;
const EVALUATIONS: usize = 600;
const ROWS: usize = 100;

/// Rotor inertia, viscous and Coulomb friction, offset: the Foxbot's 58 base parameters and one.
const EXTRAS: [Extra; 4] = [
    Extra::RotorInertia,
    Extra::Viscous,
    Extra::Coulomb,
    Extra::Offset,
];

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    0.5 * (values[n / 2] + values[(n - 1) / 2])
}

/// Condition numbers of Y and Y* and the sub-regressors of Y*, of stacks at equal numbers of motions judged: medians over seeds. The
/// paper's finding is that criterion 3 has the lowest cond(Y*). Minutes:
/// `cargo run --release -p residyn-identify --example excitation_criteria`.
fn main() {
    let robot = Robot::builtin("foxbot_a05").expect("built in");
    let base = BaseParameters::of_robot(&robot, &EXTRAS);
    let rows = BaseRows::new(&robot, &base, &EXTRAS);
    let limits: Vec<MotionLimits> = MotionLimits::of_robot(&robot)
        .into_iter()
        .map(|l| MotionLimits {
            acceleration: 2.0 * l.velocity,
            ..l.share(0.9)
        })
        .collect();
    // A hundredth of what each joint can give: the wrist's noise is a tenth of the shoulder's.
    let noise: Vec<f64> = robot
        .joints()
        .iter()
        .map(|j| 0.01 * j.limits.effort)
        .collect();
    let judged = |c| Excitation::new(rows.clone(), c, noise.clone(), ROWS).expect("noise is given");
    let parts = rows.parts();
    let harmonics = [1, 2, 3, 4, 5];
    println!("criterion       cond(Y)  cond(Y*)  Y*_i  Y*_g  Y*_f   (medians over {SEEDS} seeds)");
    for criterion in [
        Criterion::Condition,
        Criterion::SubRegressors,
        Criterion::SubRegressorsNoise,
    ] {
        let mut found: [Vec<f64>; 5] = Default::default();
        for seed in 0..SEEDS {
            let room = Room::new(Bounds::of(limits.clone()), 12.5, &harmonics, seed).expect("room");
            let mut goal = judged(criterion);
            let stacked = stack(&mut goal, TRAJECTORIES, 1000 * seed, |goal, seed| {
                let options = SearchOptions {
                    starts: 20,
                    evaluations: EVALUATIONS,
                    seed,
                };
                optimise(&room, &options, |t| goal.cost(t))
            })
            .expect("motions");
            let whole = |c: Criterion| {
                let mut goal = judged(c);
                let (last, first) = stacked.chosen.split_last().expect("a motion");
                for f in first {
                    goal.take(&f.trajectory).expect("numbers");
                }
                let triangle = goal.triangle(&last.trajectory).expect("numbers");
                let [i, g, f] = &parts;
                SubRegressors::of(&triangle, i, g, f).expect("numbers")
            };
            let (plain, weighted) = (
                whole(Criterion::Condition),
                whole(Criterion::ConditionNoise),
            );
            let each = [
                Some(plain.whole),
                Some(weighted.whole),
                weighted.inertial,
                weighted.gravity,
                weighted.friction,
            ];
            for (list, value) in found.iter_mut().zip(each) {
                list.push(value.unwrap_or(f64::NAN));
            }
        }
        let [y, ys, i, g, f] = found.map(median);
        println!(
            "{:14} {y:8.1}  {ys:8.1}  {i:.1}  {g:.1}  {f:.1}",
            criterion.name()
        );
    }
}
