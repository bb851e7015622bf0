//! A small run of the proof.

use diagnose::Options;
use proof::prove::{Draw, Instead, leave_one_out, mean, prove, table};
use trials::cases::Sensors;

#[test]
#[ignore = "long: by hand, with --ignored"]
fn a_few_sealed_cases() {
    let folder = tempfile::tempdir().unwrap();
    let draw = Draw {
        cases: 6,
        seed: 11,
        hard: false,
        only: None,
        without: None,
        generator: 1,
        sensors: Sensors::default(),
    };
    let scores = prove(&draw, &Options::default(), Some(folder.path()), || ()).unwrap();
    println!("{}", table(&scores).to_text());
    let all: Vec<_> = scores.iter().collect();
    assert_eq!(mean(&all, |s| s.false_alarm), Some(0.0));
    assert!(mean(&all, |s| s.top3).unwrap() >= 0.5);
    let known: Vec<_> = all
        .iter()
        .copied()
        .filter(|s| s.kind != "outside")
        .collect();
    assert!(mean(&known, |s| s.closure).unwrap() > 0.8);
    for part in ["cases", "truth", "reports"] {
        assert_eq!(
            std::fs::read_dir(folder.path().join(part)).unwrap().count(),
            6,
            "{part}"
        );
    }
    // A run into the same folder diagnoses nothing again, and says the same.
    let again = prove(&draw, &Options::default(), Some(folder.path()), || ()).unwrap();
    assert!(scores.iter().all(|s| !s.stored) && again.iter().all(|s| s.stored));
    assert_eq!(table(&again).to_text(), table(&scores).to_text());
    for (again, first) in again.iter().zip(&scores) {
        assert_eq!(again.named, first.named);
    }
}

#[test]
#[ignore = "long: by hand, with --ignored"]
fn a_withheld_candidate_gives_no_confident_wrong_name() {
    let answers = leave_one_out(6, 11, 1, || ()).unwrap();
    assert!(!answers.is_empty());
    assert!(
        answers.iter().all(|a| a.answer != Instead::Wrong),
        "{answers:?}"
    );
}

#[test]
#[ignore = "long: by hand, with --ignored"]
fn friction_that_changes_with_position_has_its_name() {
    let draw = Draw {
        cases: 4,
        seed: 21,
        hard: false,
        only: Some("position_dependent_friction"),
        without: None,
        generator: 1,
        sensors: Sensors::default(),
    };
    let scores = prove(&draw, &Options::default(), None, || ()).unwrap();
    println!("{}", table(&scores).to_text());
    let all: Vec<_> = scores.iter().collect();
    assert!(mean(&all, |s| s.top3).unwrap() >= 0.75);
}

/// The project's own gears with play, of which the detector knows neither the flanks' law nor where the encoder's zero is.
#[test]
fn a_link_encoder_measures_play() {
    let draw = Draw {
        cases: 2,
        seed: 9101,
        hard: false,
        only: Some("backlash"),
        without: None,
        generator: 1,
        sensors: Sensors {
            links: true,
            temperatures: false,
        },
    };
    let options = Options {
        surrogates: 0,
        ..Options::default()
    };
    let scores = prove(&draw, &options, None, || ()).unwrap();
    println!("{}", table(&scores).to_text());
    let all: Vec<_> = scores.iter().collect();
    assert_eq!(mean(&all, |s| s.top3), Some(1.0));
    assert_eq!(mean(&all, |s| s.covered), Some(1.0));
    assert!(scores.iter().all(|s| s.size.unwrap() < 0.05));
}
