//! `residyn NAME` is the program NAME: the same help, messages and exit status.

mod compared;

use std::path::Path;
use std::process::{Command, Output};

const NAMES: &[&str] = &[
    "train",
    "eval",
    "diagnose",
    "excite",
    "payload",
    "feedforward",
    "simulate",
    #[cfg(feature = "reproductions")]
    "machine",
    #[cfg(feature = "reproductions")]
    "decoupled",
];

fn residyn(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_residyn"))
        .args(arguments)
        .output()
        .expect("it starts")
}

fn alone(name: &str, arguments: &[&str]) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_residyn")).with_file_name(name);
    assert!(
        program.is_file(),
        "{} is not there: run `cargo build --release --workspace --bins` first",
        program.display()
    );
    Command::new(program)
        .args(arguments)
        .output()
        .expect("it starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn help_is_that_of_the_program() {
    for name in NAMES {
        let own = text(&alone(name, &["--help"]).stdout);
        let called = residyn(&[name, "--help"]);
        assert_eq!(called.status.code(), Some(0));
        let called = text(&called.stdout);
        assert!(
            called.contains(&format!("Usage: residyn {name}")),
            "{called}"
        );
        assert_eq!(called.replace(&format!("residyn {name}"), name), own);
        assert_eq!(text(&residyn(&["help", name]).stdout), called);
    }
}

#[test]
fn refusals_are_those_of_the_program() {
    let nowhere: &[(&str, &[&str])] = &[
        (
            "train",
            &["--robot", "nowhere.urdf", "--data", "nowhere.csv"],
        ),
        ("eval", &["--model", "nowhere", "--data", "nowhere.csv"]),
        (
            "diagnose",
            &[
                "--robot",
                "ur5",
                "--data",
                "nowhere.csv",
                "--heldout",
                "nowhere.csv",
            ],
        ),
        ("payload", &["--model", "nowhere", "--data", "nowhere.csv"]),
        (
            "feedforward",
            &[
                "--model",
                "nowhere",
                "--trajectory",
                "nowhere.csv",
                "--out",
                "never.csv",
            ],
        ),
        #[cfg(feature = "reproductions")]
        (
            "machine",
            &["identify", "--machine", "nowhere", "--data", "nowhere.csv"],
        ),
    ];
    for (name, arguments) in nowhere {
        let own = alone(name, arguments);
        let called = residyn(&[&[*name], *arguments].concat());
        assert_eq!(own.status.code(), Some(2), "{name}: {}", text(&own.stderr));
        assert_eq!(called.status.code(), Some(2));
        let err = text(&called.stderr);
        assert_eq!(
            err.replace(&format!("residyn {name}"), name),
            text(&own.stderr)
        );
    }
}

#[test]
fn without_a_program_it_says_which_there_are() {
    let bare = residyn(&[]);
    assert_eq!(bare.status.code(), Some(2));
    let asked = residyn(&["--help"]);
    assert_eq!(asked.status.code(), Some(0));
    for name in NAMES {
        assert!(text(&asked.stdout).contains(name), "{name}");
        assert!(text(&bare.stderr).contains(name), "{name}");
    }
    let wrong = residyn(&["diagnos"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        text(&wrong.stderr).contains("'diagnose'"),
        "{}",
        text(&wrong.stderr)
    );
    for odd in [
        &["--", "train"][..],
        &["help", "nothing"],
        &["--quiet", "train"],
        &["help", "help"],
    ] {
        let code = residyn(odd).status.code();
        assert!(code == Some(2) || code == Some(0), "{odd:?}: {code:?}");
    }
    let version = text(&residyn(&["--version"]).stdout);
    assert!(version.starts_with("residyn "), "{version}");
    for name in NAMES {
        let called = text(&residyn(&[name, "--version"]).stdout);
        assert_eq!(called.replace(name, "residyn"), version);
        // The program by itself may have been built at another commit.
        let numbered = |said: &str| said.split(" (").next().map(|n| n.trim().to_owned());
        let own = text(&alone(name, &["--version"]).stdout);
        assert_eq!(numbered(&own), numbered(&called));
    }
}
