//! Cases in a folder, by whatever simulator.

use crate::case::run;
use trials::cases::{draw, generate, write};

#[test]
fn cases_in_a_folder_are_diagnosed_once_and_scored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    let nothing = run(&["score", path]);
    assert_eq!(nothing.status.code(), Some(2));
    let said = String::from_utf8(nothing.stderr).unwrap();
    assert!(
        said.starts_with("error: no cases") && said.lines().count() == 1,
        "{said}"
    );
    let case = generate(&draw(0, 7), 7).unwrap();
    write(&case, folder.path()).unwrap();
    let table = |first: bool| {
        let done = run(&["score", path, "--fast"]);
        let said = String::from_utf8(done.stdout).unwrap();
        assert!(
            done.status.success() && said.contains(&case.truth.kind),
            "{said}"
        );
        let kept = said.contains("1 of the reports were there already.");
        assert_eq!(kept, !first, "{said}");
        said.split_once("truth ").unwrap().1.to_owned()
    };
    assert_eq!(table(true), table(false));
    // An answer that is none is bad input.
    std::fs::write(folder.path().join(format!("truth/{}.json", case.id)), "{").unwrap();
    std::fs::remove_dir_all(folder.path().join("reports")).unwrap();
    assert_eq!(run(&["score", path, "--fast"]).status.code(), Some(2));
}
