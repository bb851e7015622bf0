//! Simulated robots whose parameters are known: the iterative identification finds them, within the deviations
//! that it states.
//!
//! The robots are simulated in closed loop with encoder counts and torque noise. What is compared is what the
//! torque can reveal: base parameters, and friction where the plant has no other effects than the model. (The
//! UR5 protocol of `trials` adds effects that the paper's model lacks, so no truth is comparable there.)

use datasets::Recording;
use datasets::prepare::{PrepareOptions, prepare};
use identify::base::{BaseParameters, Extra};
use identify::feasible::{Constraints, Feasibility, Nominal};
use identify::iterative::{
    Identification, IterativeOptions, Physical, PowerLaw, Problem, identify,
};
use nalgebra::Matrix4;
use ndarray::{Array1, Array2};
use physics::dynamics::{Workspace, regressor};
use physics::robot::Robot;
use plant::arm::Arm;
use plant::control::{Controller, Sensing};
use plant::reference::{Command, Multisine, Pace, Segment, Session};
use plant::run::{Clock, run};
use plant::{Friction, Plant};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;
use std::f64::consts::TAU;
use trials::protocols::Protocol;

const EXTRAS: [Extra; 4] = [
    Extra::RotorInertia,
    Extra::Viscous,
    Extra::Coulomb,
    Extra::Offset,
];

/// An identification problem with its answer.
struct Known {
    base: BaseParameters,
    problem: Problem,
    /// Joint velocities, samples × N.
    velocity: Array2<f64>,
    /// Base parameters.
    truth: Vec<f64>,
}

impl Known {
    /// Viscous friction goes with |q̇|^α; `truth`: standard parameters, then [`EXTRAS`].
    fn new(robot: &Robot, recording: &Recording, alpha: &[f64], truth: &[f64]) -> Self {
        let n = robot.dof();
        let motion = prepare(recording, &PrepareOptions::default())
            .expect("long enough")
            .at_samples;
        let base = BaseParameters::of_robot(robot, &EXTRAS);
        let mut workspace = Workspace::new(robot);
        let mut rows = Array2::zeros((motion.len() * n, base.len()));
        let mut y = vec![0.0; n * 10 * n];
        for k in 0..motion.len() {
            let row = |table: &Array2<f64>| table.row(k).to_vec();
            let (q, qd, qdd) = (row(&motion.q), row(&motion.qd), row(&motion.qdd));
            regressor(robot, &mut workspace, &q, &qd, &qdd, &mut y);
            for joint in 0..n {
                let mut full = y[joint * 10 * n..(joint + 1) * 10 * n].to_vec();
                full.resize((10 + EXTRAS.len()) * n, 0.0);
                for (e, extra) in EXTRAS.iter().enumerate() {
                    full[(10 + e) * n + joint] = extra.value(qd[joint], qdd[joint]);
                }
                full[11 * n + joint] = qd[joint].signum() * qd[joint].abs().powf(alpha[joint]);
                for (c, &column) in base.independent().iter().enumerate() {
                    rows[(k * n + joint, c)] = full[column];
                }
            }
        }
        let tau = recording.tau.as_ref().expect("torque");
        let torque = Array1::from_iter(tau.iter().copied());
        Self {
            problem: Problem::new(rows.view(), torque.view(), n).expect("finite"),
            truth: base.base_from(truth),
            velocity: motion.qd,
            base,
        }
    }

    /// The columns of the power law.
    fn law(&self) -> PowerLaw {
        let names = self.base.base_names();
        let columns = (1..=self.problem.dof())
            .map(|j| names.iter().position(|name| *name == format!("fv{j}")))
            .collect();
        PowerLaw::new(columns, self.velocity.clone())
    }

    /// Parameters further than three stated deviations from the truth, those aside whose names start so.
    fn missed(&self, found: &Identification, aside: &[&str]) -> Vec<String> {
        let estimate = &found.estimate;
        let mut missed = Vec::new();
        for (i, name) in self.base.base_names().into_iter().enumerate() {
            let (value, std) = (estimate.parameters[i], estimate.std[i]);
            let off = (value - self.truth[i]) / std;
            if off.abs() > 3.0 && !aside.iter().any(|a| name.starts_with(a)) {
                missed.push(format!(
                    "{name} {value:.4} ± {std:.4}, truth {:.4}",
                    self.truth[i]
                ));
            }
        }
        missed
    }
}

/// A list of numbers of the truth, nested lists one behind the other.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().expect("a number")],
    }
}

const UR5_VISCOUS: [f64; 6] = [9.0, 10.0, 7.5, 1.25, 1.2, 1.1];
const UR5_COULOMB: [f64; 6] = [4.7, 4.9, 4.0, 0.64, 0.67, 0.72];
const UR5_NOISE: [f64; 6] = [0.6, 0.6, 0.5, 0.1, 0.1, 0.1];

/// A UR5 that is nothing but rigid bodies with viscous and Coulomb friction, on eight Fourier series at 100 Hz.
fn plain_ur5(seed: u64) -> Known {
    let robot = Robot::builtin("ur5").expect("built in");
    let mut joints = robot.joints().to_vec();
    for (j, joint) in joints.iter_mut().enumerate() {
        (joint.damping, joint.friction) = (UR5_VISCOUS[j], UR5_COULOMB[j]);
    }
    let armature: Vec<f64> = joints.iter().map(|j| j.rotor_inertia).collect();
    let arm = Arm {
        family: "ur5",
        centre: vec![0.0, -1.4, 0.8, -0.7, 0.2, 0.0],
        reach: vec![2.4, 0.95, 1.3, 1.5, 1.9, 2.6],
        v_eps: vec![0.002; 6],
        rest: plant::mechanism::RestLaw::Root,
        disc: vec![0.0; 6],
        joints,
    };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let series = (0..8).map(|_| {
        let pace = Pace::constant(0.1, 5, 0.8);
        (
            Segment::Multisine(Multisine::draw(&arm, &pace, 10.0, &mut rng)),
            10.0,
        )
    });
    let session = Session::new(series.collect(), 2.0, 6);
    let mut start = Command::new(6);
    session.sample(session.span().0, &mut start);
    let friction = (0..6).map(|j| Friction {
        viscous: UR5_VISCOUS[j],
        coulomb: UR5_COULOMB[j],
        v_eps: arm.v_eps[j],
        rest: arm.rest,
    });
    let mut plant = Plant::new(
        arm.robot().expect("a robot"),
        armature.clone(),
        friction.collect(),
        Vec::new(),
        start.q,
    );
    let sensing = Sensing {
        count: vec![TAU / f64::from(1 << 20); 6],
        velocity_noise: vec![0.0; 6],
        corner: 60.0,
    };
    let clock = Clock {
        step: 5e-4,
        control: 2,
        sample: 20,
    };
    let noise = ChaCha8Rng::from_rng(&mut rng);
    let mut controller = Controller::new(&arm, 8.0, 1e-3, sensing.clone(), noise).expect("a robot");
    let axes: Vec<usize> = (0..6).collect();
    let trace = run(&session, &mut controller, &mut plant, &axes, clock, 0.0);

    let table = |f: &mut dyn FnMut(usize, usize) -> f64| {
        Array2::from_shape_fn((trace.len(), 6), |(k, j)| f(6 * k + j, j))
    };
    let q = table(&mut |i, j| (trace.q[i] / sensing.count[j]).round() * sensing.count[j]);
    let tau = table(&mut |i, j| {
        let z: f64 = StandardNormal.sample(&mut rng);
        trace.tau[i] + UR5_NOISE[j] * z
    });
    let mut recording = Recording::new("ur5", trace.time.clone(), q, Some(tau));
    recording.trajectories = trace
        .bounds()
        .windows(2)
        .map(|w| datasets::Trajectory {
            label: w[0].to_string(),
            range: w[0]..w[1],
        })
        .collect();
    let truth = [
        robot.parameters(),
        armature,
        UR5_VISCOUS.to_vec(),
        UR5_COULOMB.to_vec(),
        vec![0.0; 6],
    ];
    Known::new(&robot, &recording, &[1.0; 6], &truth.concat())
}

/// The Foxbot with friction by a power of speed; `known`: its columns carry the true exponents. Also the exponents.
fn foxbot(seed: u64, known: bool) -> (Robot, Known, Vec<f64>) {
    let made = Protocol::FoxbotA05
        .simulate(seed, &|_| {})
        .expect("a robot");
    let robot = Robot::builtin("foxbot_a05").expect("built in");
    let keys = [
        "parameters",
        "rotor_inertia",
        "viscous",
        "coulomb",
        "offset",
    ];
    let truth: Vec<f64> = keys
        .iter()
        .flat_map(|key| numbers(&made.truth[*key]))
        .collect();
    let alpha = numbers(&made.truth["alpha"]);
    let recording = made.part("identification").expect("a part");
    let columns = if known { alpha.clone() } else { vec![1.0; 6] };
    let known = Known::new(&robot, recording, &columns, &truth);
    (robot, known, alpha)
}

#[test]
fn ur5_parameters() {
    for seed in [1, 2] {
        let mut ur5 = plain_ur5(seed);
        // 36 rigid, rotor inertia where the rigid body does not hold it already, friction and offset.
        assert!(ur5.truth.len() >= 36 + 18);
        let found = identify(&mut ur5.problem, &IterativeOptions::default()).expect("a solution");
        assert!(found.converged);
        assert_eq!(ur5.missed(&found, &[]), [""; 0], "seed {seed}");
        for (joint, noise) in UR5_NOISE.iter().enumerate() {
            let ratio = found.noise[(joint, joint)].sqrt() / noise;
            assert!((ratio - 1.0).abs() < 0.05, "noise of joint {joint}");
        }
    }
}

#[test]
fn foxbot_parameters() {
    for seed in [1, 2] {
        let (_, mut foxbot, _) = foxbot(seed, true);
        let found =
            identify(&mut foxbot.problem, &IterativeOptions::default()).expect("a solution");
        assert!(found.converged);
        assert_eq!(foxbot.missed(&found, &[]), [""; 0], "seed {seed}");
    }
}

/// The exponents are found with the parameters, from viscous friction that starts out linear.
///
/// The plant softens the sign below 0.001 rad/s, which takes a few thousandths off the exponents. Friction
/// coefficients are left aside here: their deviations are stated for the exponents found.
#[test]
fn foxbot_exponents_and_feasibility() {
    let (robot, mut foxbot, alpha) = foxbot(1, false);
    let n = robot.dof();
    // Rotor inertia, viscous and Coulomb friction and offset, as little as one knows of them beforehand.
    let extras: Vec<(f64, f64)> = [(0.2, 1.0), (5.0, 30.0), (5.0, 30.0), (0.0, 5.0)]
        .iter()
        .flat_map(|&e| vec![e; n])
        .collect();
    let feasibility = Feasibility::new(
        foxbot.base.grouping(),
        Constraints::new(n, 10 * n..13 * n),
        Nominal::of_robot(&robot, &extras),
    )
    .expect("sizes agree");
    let options = IterativeOptions {
        power_law: Some(foxbot.law()),
        physical: Physical::LastStep(&feasibility),
        ..IterativeOptions::default()
    };
    let found = identify(&mut foxbot.problem, &options).expect("a solution");
    assert!(found.converged);
    for (found, truth) in std::iter::zip(&found.exponents, &alpha) {
        assert!((found - truth).abs() < 0.015, "{found}, truth {truth}");
    }
    assert_eq!(foxbot.missed(&found, &["fc", "fv"]), [""; 0]);

    let feasible = found.feasible.expect("asked for");
    for link in feasible.standard[..10 * n].chunks_exact(10) {
        assert!(pseudo_inertia(link).symmetric_eigenvalues().min() > 0.0);
    }
    assert!(feasible.standard[10 * n..13 * n].iter().all(|x| *x > 0.0));
    // Possible, and the estimate still: no parameter had to move beyond what the data allow.
    let moved = std::iter::zip(&feasible.base, &found.estimate.parameters)
        .zip(&found.estimate.std)
        .map(|((a, b), std)| (a - b).abs() / std);
    assert!(moved.fold(0.0, f64::max) < 3.0);
}

/// Pseudo-inertia (4 × 4) of a link's parameters m, m·c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz.
fn pseudo_inertia(p: &[f64]) -> Matrix4<f64> {
    let half = (p[4] + p[6] + p[9]) / 2.0;
    #[rustfmt::skip]
    let j = Matrix4::new(
        half - p[4], -p[5],       -p[7],       p[1],
        -p[5],       half - p[6], -p[8],       p[2],
        -p[7],       -p[8],       half - p[9], p[3],
        p[1],        p[2],        p[3],        p[0],
    );
    j
}
