//! The manual has a page for every command, and a shell completes what the programs take.

use std::path::Path;
use std::process::Command;

/// Words that bash offers for the last of `words`.
fn offered(script: &Path, words: &[&str]) -> Vec<String> {
    let (last, line) = (words.len() - 1, words.join(" "));
    let command = format!(
        "source '{}'; COMP_WORDS=({line}); COMP_CWORD={last}; _residyn residyn '{}' '{}'; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        script.display(),
        words[last],
        words[last - 1],
    );
    let done = Command::new("bash").arg("-c").arg(command).output();
    let done = done.expect("bash is there");
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(done.status.success(), "{said}");
    said.lines().map(str::to_owned).collect()
}

#[test]
fn every_command_has_a_page_and_bash_completes_it() {
    let prefix = tempfile::tempdir().expect("a folder for temporary files");
    let done = Command::new(env!("CARGO_BIN_EXE_manual"))
        .arg("--prefix")
        .arg(prefix.path())
        .output()
        .expect("it starts");
    assert!(done.status.success());
    let page = |name: &str| {
        let path = prefix.path().join("share/man/man1").join(name);
        std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    };
    for program in residyn::programs::command().get_subcommands() {
        let name = format!("residyn-{}", program.get_name());
        assert!(page(&format!("{name}.1")).contains(".SH OPTIONS"), "{name}");
        assert!(page("residyn.1").contains(program.get_name()), "{name}");
    }
    assert!(page("residyn-diagnose.1").contains("heldout"));
    assert!(page("residyn-diagnose-prove.1").contains("calibrate"));

    let script = prefix
        .path()
        .join("share/bash-completion/completions/residyn");
    assert_eq!(offered(&script, &["residyn", "diagn"]), ["diagnose"]);
    let options = offered(&script, &["residyn", "diagnose", "--held"]);
    assert_eq!(options, ["--heldout"]);
    for other in [
        "zsh/site-functions/_residyn",
        "fish/vendor_completions.d/residyn.fish",
    ] {
        let path = prefix.path().join("share").join(other);
        let text = std::fs::read_to_string(path).expect("completions");
        assert!(text.contains("heldout"), "{other}");
    }
}
