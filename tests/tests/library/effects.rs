//! One list of effects: the diagnosis's catalogue, the simulator's draws, the torque model's terms and the documentation agree.

use diagnose::Effect;
use model::identify::dictionary::{SessionClock, basic, candidates};
use std::collections::BTreeSet;
use trials::cases::EFFECTS;

fn catalogue() -> BTreeSet<&'static str> {
    Effect::ALL.iter().map(|e| e.name()).collect()
}

#[test]
fn every_effect_is_listed_once() {
    assert_eq!(catalogue().len(), Effect::ALL.len());
}

#[test]
fn every_effect_has_its_words() {
    for effect in Effect::ALL {
        let info = effect.info();
        assert!(!info.name.is_empty() && !info.plain.is_empty(), "{info:?}");
        assert!(info.remedy.contains("{}"), "{info:?}");
        assert!(!info.confounders.contains(&effect), "{info:?}");
    }
}

#[test]
fn the_simulator_withholds_every_effect() {
    let drawn: BTreeSet<&str> = EFFECTS.into_iter().collect();
    assert_eq!(drawn, catalogue());
}

#[test]
fn every_term_of_a_torque_model_has_a_name_in_the_catalogue() {
    let clock = SessionClock {
        start: 0.0,
        end: 7200.0,
    };
    let terms = basic().into_iter().chain(candidates(true, clock));
    for term in terms {
        assert!(catalogue().contains(term.effect()), "{}", term.label());
    }
}

#[test]
fn the_documentation_lists_them() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/formats.md");
    let text = std::fs::read_to_string(page).unwrap();
    for name in catalogue() {
        assert!(
            text.contains(&format!("`{name}`")),
            "{name} is not in docs/formats.md"
        );
    }
}
