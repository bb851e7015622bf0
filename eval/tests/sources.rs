//! The committed pages are what the command prints.

use std::process::Command;

fn printed(arguments: &[&str]) -> String {
    let out = Command::new(env!("CARGO_BIN_EXE_eval"))
        .arg("--sources")
        .args(arguments)
        .output()
        .expect("eval runs");
    assert!(out.status.success());
    String::from_utf8(out.stdout).expect("text")
}

#[test]
fn the_pages_are_what_the_command_prints() {
    let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs");
    let pages = [
        ("sources.md", &[][..]),
        ("sources/softmc.md", &["softmc"]),
        ("sources/kr300.md", &["kr300"]),
        ("sources/comau.md", &["comau"]),
        ("sources/ur5.md", &["ur5"]),
        ("sources/iterative.md", &["iterative"]),
    ];
    for (file, arguments) in pages {
        let committed = std::fs::read_to_string(format!("{docs}/{file}")).expect(file);
        assert!(
            printed(arguments) == committed,
            "docs/{file} is not what eval --sources prints; run: eval --sources {} > docs/{file}",
            arguments.join(" ")
        );
    }
}

#[test]
fn an_unknown_document_is_refused_with_those_that_exist() {
    let out = Command::new(env!("CARGO_BIN_EXE_eval"))
        .args(["--sources", "sofmc"])
        .output()
        .expect("eval runs");
    assert_eq!(out.status.code(), Some(2));
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(
        said.contains("softmc, kr300, comau, ur5, iterative"),
        "{said}"
    );
}

/// Without it, model and recording are still demanded.
#[test]
fn model_and_data_are_demanded_otherwise() {
    for arguments in [
        &[][..],
        &["--model", "x"],
        &["--sources", "--model", "x"],
        &["--leaderboard", "x"],
        &["--leaderboard", "--data", "x"],
    ] {
        let out = Command::new(env!("CARGO_BIN_EXE_eval"))
            .args(arguments)
            .output()
            .expect("eval runs");
        assert_eq!(out.status.code(), Some(2), "{arguments:?}");
    }
}
