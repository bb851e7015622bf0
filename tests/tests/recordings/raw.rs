//! Raw recordings of robots that nobody filtered: the default `train --physics-only` beside plain weighted least
//! squares in twenty lines of Python (base parameters, viscous, tanh(q̇/0.02), offset and rotor inertia on motion
//! low-passed at 8–10 Hz, scored against the raw torque).

use datasets::{ReadOptions, read, write};
use std::path::{Path, PathBuf};
use tests::program::{json, mean_nrmse, program, run};
use tests::shared::shared;

/// Robot and what least squares reaches on its `test.csv`.
const ROBOTS: [(&str, f64); 3] = [("panda", 0.109), ("ur10", 0.145), ("xmate", 0.309)];

/// Held-out mean NRMSE of the default physics.
fn physics(folder: &Path, robot: &Path, data: &[&Path], heldout: &Path) -> f64 {
    let out = folder.join("model");
    let mut train = program("train");
    train.arg("--robot").arg(robot).arg("--data").args(data);
    train.arg("--heldout").arg(heldout).arg("--out").arg(&out);
    run(train.args(["--physics-only", "--quiet"])).succeeded();
    mean_nrmse(
        &json(&out.join("metrics.json")),
        "heldout",
        "physics",
        "all",
    )
}

#[test]
fn better_than_plain_least_squares() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut product = 1.0;
    for (robot, plain) in ROBOTS {
        let Some(data) = shared(&format!("data/{robot}")) else {
            return;
        };
        let urdf = data.join("robot.urdf");
        let (train, test) = (data.join("train.csv"), data.join("test.csv"));
        let found = physics(folder.path(), &urdf, &[&train], &test);
        let [first, rest] = another_split(folder.path(), &train, &test);
        let other = physics(folder.path(), &urdf, &[&rest, &test], &first);
        println!(
            "{robot}: {found:.4}, plain least squares {plain}, ratio {:.3}; first 40 % as test {other:.4}",
            found / plain
        );
        assert!(
            found <= plain,
            "{robot}: {found}, plain least squares {plain}"
        );
        product *= found / plain;
    }
    let mean = product.cbrt();
    println!("geometric mean of the ratios {mean:.3}");
    assert!(mean <= 0.95, "geometric mean {mean}");
}

/// The first 40 % of a recording that goes on in `test`, and the rest of `train`.
fn another_split(folder: &Path, train: &Path, test: &Path) -> [PathBuf; 2] {
    let recording =
        |path: &Path| read(path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let (train, test) = (recording(train), recording(test));
    let cut = (train.len() + test.len()) * 2 / 5;
    let names = ["first.csv", "rest.csv"].map(|name| folder.join(name));
    for (name, rows) in names.iter().zip([0..cut, cut..train.len()]) {
        write(&train.stretches(&[(0, rows)]), name).expect("writable");
    }
    names
}
