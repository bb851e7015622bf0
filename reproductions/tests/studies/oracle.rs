//! How near the compensator of the simulated UR5 comes to what can be known, and what its stated deviations are worth.

use tests::program::{json, program, run};

#[test]
#[ignore = "long: by hand, with --ignored"]
fn the_example_is_near_what_can_be_known() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = folder.path().join("model");
    run(program("train").arg("--quiet").arg("--out").arg(&model)).succeeded();
    let page = folder.path().join("oracle.json");
    let mut oracle = program("train");
    oracle.args(["oracle", "--quiet", "--model"]).arg(&model);
    run(oracle.arg("--json").arg(&page)).succeeded();
    let figures = json(&page);
    let all = &figures["scopes"][0];
    let mean = |of: &str| all[of]["mean_nrmse"].as_f64().expect("a figure");
    // The truth is ordered: noise, the true equations on the recorded motion, the model, its physics alone.
    assert!(mean("floor") < mean("attainable"), "{all}");
    assert!(mean("attainable") < mean("whole"), "{all}");
    assert!(mean("whole") < mean("physics"), "{all}");
    let share = all["share"]["all"].as_f64().expect("a share");
    assert!(share >= 0.6, "{all}");
    let units = &json(&model.join("model.json"))["compensator"]["validation"];
    for (joint, unit) in units.as_array().expect("units").iter().enumerate() {
        let [whole, attainable] =
            ["whole", "attainable"].map(|of| all[of]["nrmse"][joint].as_f64().expect("a figure"));
        assert!(
            unit["enabled"] == true || whole <= 1.1 * attainable,
            "{unit} {all}"
        );
    }

    let scores = folder.path().join("scores.json");
    let data = model.join("simulated/ur5-0-2/ur5-verification.parquet");
    let mut eval = program("eval");
    eval.arg("--quiet").arg("--model").arg(&model);
    run(eval.arg("--data").arg(&data).arg("--json").arg(&scores)).succeeded();
    let coverage = json(&scores)["coverage"]["all"].as_f64().expect("a share");
    assert!((0.87..=0.93).contains(&coverage), "{coverage}");
}

#[test]
fn a_model_of_a_real_robot_has_no_oracle() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let robot = physics::robot::Robot::builtin("ur5").expect("built in");
    let plan = tests::synthetic::Plan::default();
    let data = tests::synthetic::record_to(folder.path(), "train.csv", &robot, &plan);
    let out = folder.path().join("model");
    let mut train = program("train");
    train.args(["--robot", "ur5", "--physics-only", "--quiet", "--data"]);
    run(train.arg(&data).arg("--out").arg(&out)).succeeded();
    let mut oracle = program("train");
    run(oracle.args(["oracle", "--model"]).arg(&out))
        .refused(&["not a model of a simulated robot"]);
}
