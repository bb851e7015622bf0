//! Simulate, identify, score: one small run for each machine, and one for each way in which a recording can be poor.

use datasets::Recording;
use machines::description::{BUILTIN, Description};
use machines::identification::{Identified, Settings, identify};
use machines::plant::{Options, simulate};
use machines::prediction::{Scores, predict, score};
use machines::reasons::{self, Kind, Reason};
use machines::store::MachineFile;
use machines::{Machine, MachineError};

/// Quarter of the default rate: the Delta's plant differentiates energies.
fn options() -> Options {
    Options {
        rate: 250.0,
        ..Options::default()
    }
}

fn description(name: &str, model: usize) -> Description {
    let mut description = Description::load(name).expect("built in");
    description.dynamic_model = model;
    description
}

struct Run {
    identified: Identified,
    reasons: Vec<Reason>,
    scores: Scores,
}

fn run(name: &str, plant: usize, model: usize, options: &Options) -> Run {
    let [training, heldout] = simulate(&description(name, plant), options).expect("simulates");
    judged(name, model, &training, &heldout)
}

fn judged(name: &str, model: usize, training: &Recording, heldout: &Recording) -> Run {
    let machine = Machine::new(description(name, model)).expect("a machine");
    let identified = identify(machine, training, &Settings::default()).expect("identifies");
    let reasons = reasons::find(&identified, training).expect("finds reasons");
    let file = MachineFile::of(&identified, reasons.clone(), None);
    let prediction = predict(&file, heldout).expect("predicts");
    let scores = score(&file, heldout, &prediction).expect("scores");
    Run {
        identified,
        reasons,
        scores,
    }
}

impl Run {
    fn value(&self, name: &str) -> f64 {
        let parameters = self.identified.machine.parameters();
        let at = parameters.iter().position(|p| p.name == name).expect(name);
        self.identified.estimate.values[at]
    }

    /// Held-out RMSE over RMS torque of every axis is at most `limit`, and the identification succeeded.
    fn is_good(&self, limit: f64) {
        assert!(self.identified.success(), "{:?}", self.identified.axes);
        for (axis, error) in self.scores.joints.iter().zip(&self.scores.relative_rms) {
            let error = error.expect("every axis has torque");
            assert!(error < limit, "{axis}: {error}");
        }
        println!("{:?}", self.scores.relative_rms);
    }

    fn has(&self, kind: Kind, axis: Option<usize>) -> bool {
        self.reasons
            .iter()
            .any(|r| r.kind == kind && r.axis == axis)
    }
}

fn near(value: f64, truth: f64, tolerance: f64) {
    assert!(
        (value - truth).abs() < tolerance * truth.abs(),
        "{value} instead of {truth}"
    );
}

#[test]
fn the_three_rotary_axes() {
    let simple = run("rotary_axis", 1, 1, &options());
    simple.is_good(0.03);
    // Two masses of 3 kg at 0.15 m, rotor 0.08 kg·m².
    near(simple.value("inertia"), 0.08 + 6.0 * 0.0225, 0.01);
    run("rotary_axis", 2, 2, &options()).is_good(0.03);
    let vertical = run("rotary_axis", 3, 3, &options());
    vertical.is_good(0.03);
    let moment = 9.806_65 * (2.5 * 0.35 + 1.5 * 0.12 * 2.6_f64.cos());
    near(vertical.value("gravity_cos"), moment, 0.01);
    let numbered = vertical
        .identified
        .machine
        .model()
        .numbered(&vertical.identified.estimate.values);
    assert_eq!(numbered.len(), 4);
    near(numbered[1], 0.35 * 0.35, 1e-12);
}

#[test]
fn linear_axes_and_the_angle_of_the_tilted_one() {
    let horizontal = run("linear_axis", 1, 1, &options());
    horizontal.is_good(0.03);
    let tilted = run("linear_axis", 2, 2, &options());
    tilted.is_good(0.03);
    near(tilted.value("mass"), 25.0, 0.01);
    let values = &tilted.identified.estimate.values;
    let derived = tilted.identified.machine.model().derived(values);
    near(derived[0].1, 30.0, 0.03);
    assert_eq!(derived[0].2, "°");
}

#[test]
fn scara_with_three_and_four_axes() {
    run("scara4", 1, 1, &options()).is_good(0.03);
    let mut three = description("scara4", 1);
    three.axis.truncate(3);
    if let Some(motion) = &mut three.motion {
        for list in [&mut motion.start, &mut motion.target, &mut motion.frequency] {
            list.truncate(3);
        }
    }
    let [training, _] = simulate(&three, &options()).expect("simulates");
    let machine = Machine::new(three).expect("a machine");
    let identified = identify(machine, &training, &Settings::default()).expect("identifies");
    assert!(identified.success(), "{:?}", identified.axes);
}

/// The manual's model fails on coupled axes; the coupled model finds the spindle's lead of 20 mm.
#[test]
fn coupled_axes_of_a_scara() {
    let without = run("scara4", 2, 1, &options());
    assert!(
        without.has(Kind::WrongModel, Some(3)),
        "{:?}",
        without.reasons
    );
    let with = run("scara4", 2, 2, &options());
    with.is_good(0.03);
    assert!(!with.reasons.iter().any(|r| r.kind == Kind::WrongModel));
    let own = &with.identified.estimate.values[..with.identified.machine.model_parameters()];
    let derived = with.identified.machine.model().derived(own);
    near(derived[0].1, -0.02, 0.05);
}

/// Issue: at most 2 % where the plant is the model, 5 % with forearms that have a mass of their own; noise 1 %.
#[test]
fn deltas() {
    let ideal = Options {
        ideal: true,
        ..options()
    };
    run("delta3", 1, 1, &ideal).is_good(0.02);
    run("delta3", 1, 1, &options()).is_good(0.05);
    run("delta4", 1, 1, &options()).is_good(0.05);
    run("delta4", 1, 1, &ideal).is_good(0.02);
    // Forearms as rods in the model too.
    let rods = run("delta3", 1, 2, &options());
    rods.is_good(0.02);
    near(rods.value("forearm_mass"), 0.22, 0.2);
}

#[test]
fn puma_full() {
    run("puma560", 1, 1, &options()).is_good(0.05);
}

/// Slow motion: gravity and friction; the full model's motion leaves hardly a sample within the band.
#[test]
fn puma_semi_static() {
    let slow = Options {
        pace: 0.02 / 0.15,
        seconds: 150.0,
        rate: 100.0,
        ..Options::default()
    };
    // Axis 1 carries friction alone, and the sign of a slow velocity that turns round is what is left.
    run("puma560", 2, 2, &slow).is_good(0.08);
    let [fast, _] = simulate(&description("puma560", 1), &options()).expect("simulates");
    let narrow = Settings {
        ceilings: Some(vec![0.005; 6]),
        ..Settings::default()
    };
    let machine = Machine::new(description("puma560", 2)).expect("a machine");
    let Err(error) = identify(machine, &fast, &narrow) else {
        panic!("too fast for a semi-static model")
    };
    assert!(error.is_input());
    assert!(error.to_string().contains("more slowly"), "{error}");
}

#[test]
fn reasons_are_named_from_data() {
    let good = run("delta3", 1, 1, &options());
    assert!(good.reasons.is_empty(), "{:?}", good.reasons);
    let with = |change: &dyn Fn(&mut Options)| {
        let mut changed = options();
        change(&mut changed);
        run("delta3", 1, 1, &changed)
    };
    assert!(with(&|o| o.pace = 0.05).has(Kind::TooSlow, Some(0)));
    assert!(with(&|o| o.seconds = 2.0).has(Kind::TooShort, Some(0)));
    assert!(with(&|o| o.span = 0.3).has(Kind::RegionTooSmall, Some(2)));
    assert!(with(&|o| o.limits = vec![(1, 6.0)]).has(Kind::Saturated, Some(1)));
    assert!(with(&|o| o.noise = 0.5).has(Kind::Noise, Some(0)));
    let scaled = with(&|o| o.factors = vec![(2, 0.5)]);
    assert!(
        scaled.has(Kind::TorqueFactor, Some(2)),
        "{:?}",
        scaled.reasons
    );
    let reason = scaled.reasons.iter().find(|r| r.kind == Kind::TorqueFactor);
    near(reason.expect("found above").value, 0.5, 0.1);
    let turned = with(&|o| o.factors = vec![(0, -1.0), (1, -1.0), (2, -1.0)]);
    assert!(turned.has(Kind::TorqueFactor, None), "{:?}", turned.reasons);
    let crank = run("rotary_axis", 3, 1, &options());
    assert!(!crank.identified.success());
    assert!(crank.has(Kind::WrongModel, Some(0)), "{:?}", crank.reasons);
}

#[test]
fn recordings_that_cannot_be_used_are_refused() {
    let description = description("delta3", 1);
    let [mut recording, _] = simulate(&description, &options()).expect("simulates");
    let identified = |recording: &Recording, settings: &Settings| {
        let machine = Machine::new(description.clone()).expect("a machine");
        identify(machine, recording, settings)
            .map(|_| ())
            .expect_err("refused")
    };
    let cutoff = |hz| Settings {
        filter_hz: Some(hz),
        ..Settings::default()
    };
    for hz in [130.0, -1.0, f64::NAN] {
        let error = identified(&recording, &cutoff(hz)).to_string();
        assert!(error.contains("0 and 125 Hz"), "{error}");
    }
    let mut slow = recording.clone();
    slow.time.iter_mut().for_each(|t| *t *= 10.0);
    let error = identified(&slow, &cutoff(20.0)).to_string();
    assert!(error.contains("rate of 25.0 Hz"), "{error}");
    let few = Settings {
        thresholds: Some(vec![1.0]),
        ..Settings::default()
    };
    assert!(
        identified(&recording, &few)
            .to_string()
            .contains("--threshold: 1 values for 3 axes")
    );
    // Arms that stand straight up do not meet.
    recording.q.column_mut(0).mapv_inplace(|q| q - 3.0);
    let short = Description {
        geometry: machines::description::Geometry {
            forearm: Some(0.3),
            ..description.geometry.clone()
        },
        ..description.clone()
    };
    let machine = Machine::new(short).expect("a machine");
    let error = identify(machine, &recording, &Settings::default())
        .err()
        .expect("out of reach");
    assert!(matches!(error, MachineError::OutOfReach { .. }), "{error}");
    recording.tau = None;
    let error = identified(&recording, &Settings::default());
    assert!(matches!(error, MachineError::NoTorque(_)), "{error}");
}

/// A program in the controller's layout, a table in its recorder's columns, a file that reads back.
#[test]
fn results_in_every_layout() {
    let run = run("scara4", 1, 1, &options());
    let drive = physics::robot::drive::Drive::from_toml(
        "torque_delay = [3, 3, 4, 3]\ntorque_threshold = [120, 60, 250, 8]",
        run.identified.machine.description(),
    )
    .expect("a drive file");
    let extras = machines::program::Extras {
        date: Some("29/03/17 08:17:08"),
        drive: Some(&drive),
    };
    let text = machines::program::program(&run.identified, &extras);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[0],
        "'Dynamic parameter identification for SCARA4 succeeded!"
    );
    assert_eq!(lines[1], "'Identification date and time: 29/03/17 08:17:08");
    assert!(
        lines[2].ends_with("(maximal allowed = 50.00 %)"),
        "{}",
        lines[2]
    );
    assert!(
        lines[6].starts_with("'Moving data length: axis 1 = "),
        "{}",
        lines[6]
    );
    assert!(lines[6].contains("m/s)"), "{}", lines[6]);
    for wanted in [
        "ATTACH SCARA4",
        "SCARA4.DynamicModel = 1",
        "A3.AdditiveTorqueDelay = 4",
        "TERMINATE PROGRAM",
    ] {
        assert!(lines.contains(&wanted), "{wanted}\n{text}");
    }
    let coulomb = lines
        .iter()
        .find_map(|l| l.strip_prefix("A1.CoulombFriction = "));
    let coulomb: f64 = coulomb
        .expect("friction of axis 1")
        .parse()
        .expect("a number");
    near(coulomb, -run.value("fc1"), 1e-6);

    let table = machines::recorder::recorder(&run.identified);
    let header = table.lines().next().expect("a header");
    assert!(header.starts_with(
        "time,A1.tfbRaw,A1.pfbRaw,A1.tfb,A1.pfb,A1.vfb,A1.afb,A1.tcmd,A1.te,A2.tfbRaw"
    ));
    assert_eq!(
        table.lines().count(),
        1 + run.identified.signals.motion.len()
    );
    let row: Vec<f64> = table
        .lines()
        .nth(2000)
        .expect("a row")
        .split(',')
        .map(|v| v.parse().expect("a number"))
        .collect();
    assert_eq!(row.len(), 33);
    assert!((row[7] - row[3] - row[8]).abs() < 1e-9);

    let folder = tempfile::tempdir().expect("a folder");
    let file = MachineFile::of(&run.identified, run.reasons.clone(), Some(&drive));
    std::fs::write(folder.path().join("machine.json"), file.json()).expect("written");
    let back = MachineFile::load(folder.path()).expect("read back");
    assert_eq!(back, file);
    assert_eq!(back.additive.beyond(&run.identified.command), []);
    let broken = file.json().replace("\"fc1\"", "\"fc9\"");
    std::fs::write(folder.path().join("machine.json"), broken).expect("written");
    let error = MachineFile::load(folder.path()).expect_err("other parameters");
    assert!(
        error.to_string().contains("not those of its machine"),
        "{error}"
    );
}

/// A PUMA's file holds its robot, so that it needs nothing else.
#[test]
fn a_stored_puma_is_whole() {
    let machine = Machine::load("puma560").expect("built in");
    let robot = machine
        .description()
        .geometry
        .robot
        .clone()
        .expect("a URDF");
    assert!(robot.contains("<robot"));
    let again = Machine::new(machine.description().clone()).expect("from the URDF");
    let names = |m: &Machine| {
        m.parameters()
            .iter()
            .map(|p| p.name.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&machine), names(&again));
}

/// What a stored URDF cannot hold would be lost when the model is read again.
#[test]
fn a_puma_with_a_counterbalance_is_refused() {
    let mut description = Machine::load("puma560")
        .expect("built in")
        .description()
        .clone();
    description.geometry.robot = Some("kr300".to_owned());
    let refused = Machine::new(description).map(|_| ()).expect_err("refused");
    assert!(refused.to_string().contains("counterbalance"), "{refused}");
}

#[test]
fn same_seed_same_bytes() {
    let once = || simulate(&description("scara4", 1), &options()).expect("simulates");
    assert_eq!(once(), once());
}

/// Names that other commands refuse with the command that takes them are those of the machines without description by links.
#[test]
fn other_commands_know_the_names() {
    let here: Vec<&str> = BUILTIN
        .iter()
        .map(|b| b.0)
        .filter(|n| *n != "puma560")
        .collect();
    assert_eq!(here, physics::robot::MACHINES);
    let error = physics::robot::Robot::load("delta3", &[]).expect_err("no robot");
    assert!(
        error
            .to_string()
            .contains("machine identify --robot delta3"),
        "{error}"
    );
}
