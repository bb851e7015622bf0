//! Tracking of simulated arms: what a model is worth, and when.

use control::measures::Tracking;
use control::model::Nominal;
use control::motion::Fourier;
use control::motion::Motion;
use control::subject::Subject;
use control::track::{Mode, Settings, track};
use identify::excitation::MotionLimits;
use plant::reference::Command;
use trials::Protocol;
use trials::protocols::Machine;

fn motion(machine: &Machine) -> Fourier {
    let arm = &machine.arm;
    let limits = (0..arm.dof()).map(|j| MotionLimits {
        lower: arm.centre[j] - 0.5 * arm.reach[j],
        upper: arm.centre[j] + 0.5 * arm.reach[j],
        velocity: 0.5 * arm.joints[j].limits.velocity,
        acceleration: 2.0 * arm.joints[j].limits.velocity,
        jerk: f64::INFINITY,
    });
    Fourier::draw(limits.collect(), 4.0, 2).unwrap()
}

fn rms(machine: &Machine, mode: Mode, settings: &Settings) -> f64 {
    let motion = motion(machine);
    let mut begin = Command::new(machine.arm.dof());
    motion.at(0.0, &mut begin);
    let mut subject = Subject::arm(machine, &begin.q, 0.0).unwrap();
    let mut model = Nominal::new(&machine.arm.robot().unwrap());
    let trace = track(&mut subject, &mut model, mode, &motion, None, settings);
    Tracking::of(&trace, None).rms()
}

/// With the true model every step of knowledge helps: friction left to the feedback costs what it costs, and nothing is left with all.
#[test]
fn knowledge_pays() {
    let machine = Protocol::Ur5.machine().unwrap().plain();
    let settings = Settings {
        after: 0.0,
        crossover_hz: 5.0,
        ..Settings::default()
    };
    let of = |mode| rms(&machine, mode, &settings);
    let (cascade, rigid, physics) = (of(Mode::Cascade), of(Mode::Rigid), of(Mode::Physics));
    let computed = of(Mode::ComputedTorque);
    assert!(rigid < cascade, "{rigid} {cascade}");
    assert!(physics < 0.1 * rigid, "{physics} {rigid}");
    assert!(computed < 0.1 * rigid, "{computed} {rigid}");
}

/// Torque has to come when the set-point acts: cycles too early or too late cost.
#[test]
fn the_additive_torque_waits_for_the_set_point() {
    let machine = Protocol::Ur5.machine().unwrap().plain();
    let with = |additive_delay| {
        let settings = Settings {
            after: 0.0,
            crossover_hz: 5.0,
            command_delay: 5,
            additive_delay,
            ..Settings::default()
        };
        rms(&machine, Mode::Physics, &settings)
    };
    let (early, right, late) = (with(0), with(5), with(10));
    assert!(
        early > 1.3 * right && late > 1.3 * right,
        "{early} {right} {late}"
    );
}
