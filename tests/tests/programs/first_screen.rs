//! What a person reads first of a training: short, narrow, and everything on demand.

use physics::robot::Robot;
use tests::program::{json, program, run};
use tests::synthetic::{Plan, record_to};

#[test]
fn training_ends_on_one_screen() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = Robot::builtin("ur5").expect("built in");
    let data = record_to(folder.path(), "train.csv", &robot, &Plan::default());
    let other = Plan {
        seed: 2,
        ..Plan::default()
    };
    let test = record_to(folder.path(), "test.csv", &robot, &other);
    let out = folder.path().join("model");
    let train = |more: &[&str]| {
        let mut train = program("train");
        train.args(["--robot", "ur5", "--physics-only", "--data"]);
        train.arg(&data).arg("--heldout").arg(&test);
        run(train.arg("--out").arg(&out).args(more))
            .succeeded()
            .out
            .clone()
    };
    let screen = train(&[]);
    assert!(screen.lines().count() <= 40, "{screen}");
    let place = folder.path().to_string_lossy().into_owned();
    for line in screen.lines().filter(|line| !line.contains(&place)) {
        assert!(line.chars().count() <= 100, "{line}");
    }
    for part in [
        "Learned:", "friction", "held-out", "physics", "mean", "report: ",
    ] {
        assert!(screen.contains(part), "no `{part}` in {screen}");
    }
    assert!(!screen.contains("Base parameters"));
    let all = train(&["--verbose"]);
    for part in [
        "Base parameters",
        "Condition numbers",
        "linear_baseline",
        "moving",
    ] {
        assert!(all.contains(part), "no `{part}` in {all}");
    }

    // The simulated links are possible bodies, so that to demand it costs a few percent of the error at most.
    let cost = &json(&out.join("model.json"))["diagnostics"]["cost"];
    let [free, possible] = ["free", "possible"].map(|k| cost[k].as_f64().expect("a number"));
    assert!(possible < 1.02 * free, "{cost}");

    let mut eval = program("eval");
    let ended = run(eval.arg("--model").arg(&out).arg("--data").arg(&test));
    let screen = &ended.succeeded().out;
    assert!(screen.lines().count() <= 40, "{screen}");
}
