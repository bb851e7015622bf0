//! `--config FILE`: the same answer as the options on the command line, and refusals in one line.

use datasets::write;
use physics::robot::Robot;
use tests::program::{program, run};
use tests::synthetic::{Plan, record};

#[test]
fn options_of_a_file_are_those_of_the_command_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let data = folder.path().join("monday.csv");
    write(&record(&robot, &Plan::default()), &data).expect("a file");
    let file = folder.path().join("residyn.toml");
    let shared = format!("robot = 'ur5'\ndata = ['{}']\n", data.display());
    let own = "[train]\ncheck-only = true\n[diagnose]\nfast = true\n";
    std::fs::write(&file, format!("{shared}{own}")).expect("a file");
    let said = |words: &[&str]| {
        let mut train = program("train");
        train.args(words).arg("--json");
        run(&mut train).succeeded().out.clone()
    };
    let (path, data) = (file.to_string_lossy(), data.to_string_lossy());
    let by_file = said(&["--config", &path]);
    assert!(!by_file.is_empty());
    assert_eq!(
        by_file,
        said(&["--robot", "ur5", "--check-only", "--data", &data])
    );
    // The command line wins.
    let mut train = program("train");
    train.args(["--config", &path, "--data", "friday.csv"]);
    let ended = run(&mut train);
    assert_eq!(ended.status, 2);
    assert!(ended.err.contains("friday.csv"), "{}", ended.err);
    std::fs::write(&file, "datas = 'monday.csv'").expect("a file");
    let mut train = program("train");
    let ended = run(train.args(["--config", &path]));
    assert_eq!(ended.status, 2);
    assert!(ended.err.contains("did you mean `data`?"), "{}", ended.err);
    assert_eq!(ended.err.lines().count(), 1, "{}", ended.err);
}
