//! Sealed cases as a diagnosis meets them.

use physics::robot::Robot;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use trials::cases::{
    CaseSpec, GENERATOR, Kind, Sensors, draw, draw_hard, draw_only, generate, generate_with,
    write_all,
};

fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(path) = open.pop() {
        for entry in std::fs::read_dir(&path).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.insert(
                    path.strip_prefix(folder).unwrap().to_owned(),
                    std::fs::read(&path).unwrap(),
                );
            }
        }
    }
    found
}

/// The answers but for the time that they took.
fn without_seconds(bytes: &[u8]) -> String {
    let text = String::from_utf8(bytes.to_vec()).unwrap();
    text.lines()
        .filter(|l| !l.contains("\"seconds\""))
        .collect()
}

#[test]
fn threads_do_not_change_a_byte() {
    let specs: Vec<CaseSpec> = (0..4).map(|i| draw(i, 3)).collect();
    let write = |threads: usize| {
        let folder = tempfile::tempdir().unwrap();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| write_all(&specs, 3, Sensors::default(), folder.path(), |_, _| {}))
            .unwrap();
        files(folder.path())
    };
    let (one, two) = (write(1), write(2));
    assert_eq!(
        one.keys().collect::<Vec<_>>(),
        two.keys().collect::<Vec<_>>()
    );
    assert_eq!(one.len(), 16);
    for (path, bytes) in &one {
        if path.extension().is_some_and(|e| e == "json") {
            assert_eq!(without_seconds(bytes), without_seconds(&two[path]));
        } else {
            assert!(*bytes == two[path], "{}", path.display());
        }
    }
}

#[test]
fn every_kind_can_be_made_and_keeps_its_promises() {
    // The first case of each kind in the round.
    let mut specs: BTreeMap<&str, CaseSpec> = BTreeMap::new();
    for i in 0..trials::cases::ROUND {
        let spec = draw(i, 21);
        specs.entry(spec.kind.name()).or_insert(spec);
    }
    // One of each effect, none, two and outside.
    assert_eq!(specs.len(), trials::cases::EFFECTS.len() + 3);
    specs
        .into_values()
        .collect::<Vec<_>>()
        .into_par_iter()
        .for_each(|spec| {
            let case = generate(&spec, 21).unwrap();
            let (truth, name) = (&case.truth, spec.kind.name());
            let robot = Robot::from_urdf_str(&case.urdf).unwrap();
            assert_eq!(robot.dof(), truth.joints);
            assert_eq!((case.train.len(), case.test.len()), (30000, 15000));
            assert_eq!(
                (case.train.trajectories.len(), case.test.trajectories.len()),
                (8, 4)
            );
            case.train.validate().unwrap();
            case.test.validate().unwrap();
            assert_eq!(
                truth.effects.len(),
                match spec.kind {
                    Kind::None => 0,
                    Kind::Two => 2,
                    _ => 1,
                }
            );
            for effect in &truth.effects {
                assert!(effect.share >= 0.03, "{name}: {}", effect.share);
                assert!(
                    effect.share_after_reidentification <= effect.share * 1.2,
                    "{name}"
                );
            }
            // The true plant with the effect explains the recording; without it, worse.
            let oracle = &truth.oracle.mean_nrmse;
            let [given, without, with, floor] = [
                oracle.as_given,
                oracle.without_effect,
                oracle.with_effect,
                oracle.noise_floor,
            ]
            .map(|mean| mean.expect("the joints move"));
            assert!(with < 0.11, "{name}: {with}");
            if spec.kind != Kind::None {
                assert!(without > with, "{name}: {oracle:?}");
                assert!(given > 1.15 * with, "{name}: {oracle:?}");
            }
            assert!((0.004..0.03).contains(&floor), "{name}");
            for (noise, torque) in truth.noise_rms.iter().zip(&truth.torque_rms) {
                assert!(
                    (0.0045..0.022).contains(&(noise / torque)),
                    "{name}: {}",
                    noise / torque
                );
            }
        });
}

/// What the simulation notes is inverse dynamics of the true motion and friction, wherever joints slide: in a case
/// without effect nothing else is left.
#[test]
fn without_effect_torque_is_that_of_the_plant() {
    let spec = CaseSpec {
        index: 5,
        kind: Kind::None,
        hard: false,
        without: None,
        generator: 1,
    };
    let truth = generate(&spec, 8).unwrap().truth;
    for (left, torque) in truth.effect_rms.iter().zip(&truth.torque_rms) {
        assert!(left / torque < 0.02, "{left} of {torque}");
    }
}

#[test]
#[ignore = "long: .ci/release"]
fn hard_cases_keep_their_promises() {
    let kinds = [
        "none",
        "two_same_joint",
        "contact_at_rest",
        "joint_elasticity",
        "backlash",
    ];
    let specs: Vec<CaseSpec> = kinds
        .iter()
        .map(|kind| {
            let mut all = (0..trials::cases::HARD_ROUND).map(|i| draw_hard(i, 21));
            all.find(|s| s.kind.name() == *kind).unwrap()
        })
        .collect();
    specs.into_par_iter().for_each(|spec| {
        let (case, name) = (generate(&spec, 21).unwrap(), spec.kind.name());
        let (truth, hard) = (&case.truth, case.truth.hard.as_ref().unwrap());
        assert_eq!(
            (case.train.trajectories.len(), case.test.trajectories.len()),
            (hard.train, hard.test)
        );
        case.train.validate().unwrap();
        case.test.validate().unwrap();
        assert_eq!(case.train.qd.is_some(), hard.velocity);
        let [first, last] = [0, case.train.trajectories[0].range.end - 1];
        let seconds = case.train.time[last] - case.train.time[first];
        assert!(
            (seconds - hard.duration).abs() < 0.2,
            "{name}: {seconds} of {}",
            hard.duration
        );
        assert!(
            ((last as f64) / seconds / hard.rate - 1.0).abs() < 0.02,
            "{name}"
        );
        assert!(!hard.background.is_empty(), "{name}");
        for small in &hard.background {
            let (effect, joint) = (small.effect, &small.joint);
            assert!(
                (0.004..0.061).contains(&small.share),
                "{name}: {effect} on {joint}: {}",
                small.share
            );
        }
        let joints: Vec<&str> = truth
            .effects
            .iter()
            .map(|e| e.reference_joint.as_str())
            .collect();
        match name {
            "none" => assert!(joints.is_empty()),
            "two_same_joint" => assert!(joints.len() == 2 && joints[0] == joints[1]),
            _ => assert_eq!(joints.len(), 1),
        }
        // The true plant with all that the channel does but noise explains the recording.
        let oracle = &truth.oracle.mean_nrmse;
        let [with, floor] = [oracle.with_effect, oracle.noise_floor].map(Option::unwrap);
        assert!(floor < with && with < 0.13, "{name}: {with} over {floor}");
        assert!(oracle.as_given.unwrap() > with, "{name}");
    });
}

/// Further sensors add their columns and change nothing else; the link of a gear that gives way is seen to depart from its motor.
#[test]
fn further_sensors_record_beside_the_others() {
    let spec = draw_only("joint_elasticity", 5).next().unwrap();
    let plain = generate(&spec, 5).unwrap();
    let sensors = Sensors {
        links: true,
        temperatures: true,
    };
    let mut more = generate_with(&spec, 5, sensors).unwrap();
    assert!(plain.train.ql.is_none() && plain.train.temp.is_none());
    let yields = more.truth.effects[0].reference_joint.clone();
    let ql = more.train.ql.take().unwrap();
    let apart = &more.train.q - &ql;
    let departs: Vec<f64> = apart.columns().into_iter().map(|c| c.std(0.0)).collect();
    for (j, own) in departs.iter().enumerate() {
        assert_eq!(
            *own > 2e-4,
            format!("joint{}", j + 1) == yields,
            "{departs:?}"
        );
    }
    let temp = more.train.temp.take().unwrap();
    assert!(temp.iter().all(|t| (10.0..80.0).contains(t)));
    for column in temp.columns() {
        assert!(column[column.len() - 1] > column[0] + 1.0, "gears warm up");
    }
    (more.test.ql, more.test.temp) = (None, None);
    assert_eq!((more.train, more.test), (plain.train, plain.test));
}

/// Root mean squares of each joint's torque and of its noise, N·m, as they were when there was one generator.
const FIRST_PLAIN: (&str, &[[f64; 2]]) = (
    "8550a56ac8",
    &[
        [7.45651971, 0.112609627],
        [16.2209583, 0.0927012347],
        [9.9644128, 0.0612382745],
        [2.81211027, 0.0444907808],
        [1.16512326, 0.00954790859],
        [0.858457003, 0.0127962676],
    ],
);
const FIRST_HARD: (&str, &[[f64; 2]]) = (
    "ccd4b23806",
    &[
        [3.78735254, 0.0834857704],
        [12.6126239, 0.355604016],
        [2.79831339, 0.0332541816],
        [10.3554353, 0.187924208],
        [0.944124566, 0.0215566102],
        [0.930556931, 0.0158621886],
        [0.51816447, 0.014013541],
    ],
);

/// The noise is drawn last, so that it tells of every draw before it.
#[test]
fn the_first_generator_makes_what_it_made() {
    let cases = [(draw(3, 21), FIRST_PLAIN), (draw_hard(3, 21), FIRST_HARD)];
    for (spec, (id, known)) in cases {
        let truth = generate(&spec, 21).unwrap().truth;
        assert_eq!((&truth.case[..], truth.joints), (id, known.len()));
        for (j, known) in known.iter().enumerate() {
            let found = [truth.torque_rms[j], truth.noise_rms[j]];
            for (found, known) in found.iter().zip(known) {
                assert!(
                    (found / known - 1.0).abs() < 1e-6,
                    "{id}: {found} of {known}"
                );
            }
        }
        let truth = serde_json::to_value(&truth).unwrap();
        assert!(truth.get("generator").is_none() && truth.get("repeats").is_none());
    }
}

/// The second generator: the same arm and effect, half as many motions where any is repeated.
#[test]
#[ignore = "long: .ci/release"]
fn the_second_generator_repeats_motions_in_some_cases() {
    for hard in [false, true] {
        let (mut repeated, mut same) = (0, 0);
        for index in 0.. {
            let spec = if hard {
                draw_hard(index, 31)
            } else {
                draw(index, 31)
            };
            let [first, second] = [spec, spec.by(GENERATOR)].map(|s| generate(&s, 31).unwrap());
            assert_eq!(
                (&first.id, &first.truth.kind),
                (&second.id, &second.truth.kind)
            );
            assert_eq!(second.truth.generator, GENERATOR);
            if second.truth.repeats {
                let n = second.train.trajectories.len();
                let pairs = datasets::repeats::find(&second.train);
                assert_eq!(pairs.len(), n / 2, "{}", second.id);
                repeated += 1;
            } else {
                assert_eq!(first.train, second.train);
                same += 1;
            }
            if repeated > 0 && same > 0 {
                break;
            }
        }
    }
}
