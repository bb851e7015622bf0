//! A body on the last axis of every machine, against the machine identified without it.

use machines::Machine;
use machines::description::Description;
use machines::identification::{Settings, identify};
use machines::payload::estimate;
use machines::plant::{Carried, Options, simulate};
use machines::prediction::{predict, score};
use machines::store::MachineFile;

/// A body of 1.5 kg and 0.004 kg·m² against the machine identified without it: what the model can tell of it within five stated
/// deviations (blocks of a fifth of a second are few for a deviation), and the deviation small.
#[test]
fn a_body_on_the_last_axis() {
    let carried = Carried {
        mass: 1.5,
        inertia: 0.004,
    };
    // A quarter of the default rate: the Delta's plant differentiates energies.
    let options = Options {
        rate: 250.0,
        ..Options::default()
    };
    // Machine, its model, what is told, its truth, and its largest deviation.
    type Told<'a> = (&'a str, f64, f64);
    let crank = 1.5 + 0.004 / 0.35_f64.powi(2);
    let cases: [(&str, usize, &[Told]); 9] = [
        ("rotary_axis", 1, &[("inertia", 0.004, 0.004)]),
        ("rotary_axis", 2, &[("mass", crank, 0.05)]),
        ("linear_axis", 1, &[("mass", 1.5, 0.3)]),
        ("linear_axis", 2, &[("mass", 1.5, 0.3)]),
        (
            "scara4",
            1,
            &[("mass", 1.5, 0.1), ("inertia_4", 0.004, 0.002)],
        ),
        (
            "scara4",
            2,
            &[("mass", 1.5, 0.1), ("inertia_4", 0.004, 0.002)],
        ),
        ("delta3", 1, &[("mass", 1.5, 0.05)]),
        (
            "delta4",
            1,
            &[("mass", 1.5, 0.05), ("inertia_4", 0.004, 0.001)],
        ),
        (
            "puma560",
            1,
            &[("mass", 1.5, 0.2), ("mx", 0.045, 0.02), ("mz", 0.15, 0.02)],
        ),
    ];
    for (name, model, told) in cases {
        let mut description = Description::load(name).expect("built in");
        description.dynamic_model = model;
        let [bare, _] = simulate(&description, &options).expect("simulates");
        let machine = Machine::new(description.clone()).expect("a machine");
        let identified = identify(machine, &bare, &Settings::default()).expect("identifies");
        let file = MachineFile::of(&identified, Vec::new(), None);
        let with = Options {
            carried,
            seed: 7,
            ..options.clone()
        };
        let [loaded, _] = simulate(&description, &with).expect("simulates");
        let found = estimate(&file, &loaded).expect("a body");
        for &(figure, truth, most) in told {
            let value = found.body.iter().find(|f| f.name == figure).expect(figure);
            println!(
                "{name} {model} {figure}: {} ± {} of {truth}",
                value.value, value.std
            );
            let off = (value.value - truth).abs();
            assert!(
                off < 5.0 * value.std && value.std < most,
                "{name} {model}: {value:?} of {truth}"
            );
        }
        let [without, with] = [&found.rms_without, &found.rms_with].map(|r| r.iter().sum::<f64>());
        assert!(with < without, "{name} {model}: {with} {without}");
    }
}

/// An axis that stands tells nothing of the body or of the machine, and spoils nothing of what the others tell.
#[test]
fn an_axis_that_stands() {
    let mut description = Description::load("scara4").expect("built in");
    let options = Options {
        rate: 250.0,
        ..Options::default()
    };
    let [bare, _] = simulate(&description, &options).expect("simulates");
    let machine = Machine::new(description.clone()).expect("a machine");
    let identified = identify(machine, &bare, &Settings::default()).expect("identifies");
    let file = MachineFile::of(&identified, Vec::new(), None);
    let waves = description.motion.as_mut().expect("built in");
    waves.target[3] = waves.start[3];
    let with = Options {
        carried: Carried {
            mass: 1.5,
            inertia: 0.004,
        },
        seed: 7,
        ..options
    };
    let [loaded, _] = simulate(&description, &with).expect("simulates");

    let found = estimate(&file, &loaded).expect("a body");
    let mass = found.body.iter().find(|f| f.name == "mass").expect("mass");
    println!("mass {} ± {} of 1.5", mass.value, mass.std);
    assert!((mass.value - 1.5).abs() < 5.0 * mass.std && mass.std < 0.1);
    for left in [&found.rms_without, &found.rms_with] {
        assert!(left[..3].iter().all(|rms| rms.is_finite()), "{left:?}");
        assert!(left[3].is_nan(), "{left:?}");
    }

    let prediction = predict(&file, &loaded).expect("predicts");
    let scores = score(&file, &loaded, &prediction).expect("scores");
    assert!(scores.axes[..3].iter().all(|a| a.max_relative.is_finite()));
    assert!(scores.axes[3].max_relative.is_nan() && !scores.success);
    let text = serde_json::to_string(&scores.axes[3]).expect("figures");
    assert!(text.contains("\"max_relative\":null"), "{text}");
}
