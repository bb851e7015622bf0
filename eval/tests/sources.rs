//! The committed table is what the command prints.

use std::process::Command;

#[test]
fn the_page_is_what_the_command_prints() {
    let out = Command::new(env!("CARGO_BIN_EXE_eval"))
        .arg("--sources")
        .output()
        .expect("eval runs");
    assert!(out.status.success());
    let printed = String::from_utf8(out.stdout).expect("text");
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/sources.md");
    let committed = std::fs::read_to_string(page).expect("docs/sources.md is there");
    assert!(
        printed == committed,
        "docs/sources.md is not what eval --sources prints; run: eval --sources > docs/sources.md"
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
