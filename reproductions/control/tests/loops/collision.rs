//! Contacts with a simulated arm; the long run is the example `contacts`.

use control::collision::{Plan, contacts};
use control::model::Nominal;
use control::track::{Mode, Settings};
use identify::excitation::MotionLimits;
use trials::Protocol;

#[test]
fn contacts_are_found_and_nothing_else() {
    let machine = Protocol::Ur5.machine().unwrap().plain();
    let arm = &machine.arm;
    let limits: Vec<MotionLimits> = (0..6)
        .map(|j| MotionLimits {
            lower: arm.centre[j] - 0.5 * arm.reach[j],
            upper: arm.centre[j] + 0.5 * arm.reach[j],
            velocity: 0.5 * arm.joints[j].limits.velocity,
            acceleration: 2.0 * arm.joints[j].limits.velocity,
            jerk: f64::INFINITY,
        })
        .collect();
    let plan = Plan {
        time: 0.0,
        mode: Mode::Physics,
        calibration: 6,
        contacts: 18,
        clean: 6,
        per_hour: 0.1,
        factor: 4.0,
        seed: 3,
        settings: Settings {
            step: 1e-3,
            cycle: 1,
            crossover_hz: 5.0,
            command_delay: 1,
            additive_delay: 1,
            hold: 1.0,
            after: 0.0,
        },
    };
    let robot = arm.robot().unwrap();
    let found = contacts(&machine, &limits, || Ok(Nominal::new(&robot)), &plan).unwrap();
    for detector in &found.detectors {
        assert!(detector.share() >= 0.94, "{detector:?} {:?}", found.size);
        assert_eq!(detector.false_alarms, 0, "{detector:?}");
        assert!(detector.latency < 0.03);
    }
    // Ten times less is not to be seen: the thresholds are no lower than they have to be.
    let weak = Plan {
        factor: 0.1,
        contacts: 6,
        clean: 0,
        ..plan
    };
    let found = contacts(&machine, &limits, || Ok(Nominal::new(&robot)), &weak).unwrap();
    assert!(
        found.detectors.iter().all(|d| d.share() < 0.2),
        "{:?}",
        found.detectors
    );
}
