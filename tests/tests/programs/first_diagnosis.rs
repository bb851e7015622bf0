//! The first diagnosis that README and docs/start.md show is what the program says.

use std::path::Path;
use tests::program::{json, program, run};

/// Lines that a page shows of the program's answer, those left out aside.
fn shown(page: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(page);
    let text = std::fs::read_to_string(path).expect("a page of the repository");
    let first = "The gap is explained";
    let from = text.lines().skip_while(|l| !l.trim().starts_with(first));
    let lines = from.take_while(|l| !l.trim().is_empty() && !l.starts_with("```"));
    let lines = lines.map(|l| l.trim().to_owned()).filter(|l| l != "…");
    lines.collect()
}

/// Whether two lines are the same, their numbers to 3 %: processors round differently.
fn alike(a: &str, b: &str) -> bool {
    let words = |line: &str| -> Vec<String> {
        let parted = line.replace(['–', '(', ')', ',', ';'], " ");
        parted.split_whitespace().map(String::from).collect()
    };
    let same = |(a, b): (&String, &String)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 0.03 * a.abs().max(b.abs()),
        _ => a == b,
    };
    let (a, b) = (words(a), words(b));
    a.len() == b.len() && a.iter().zip(&b).all(same)
}

#[test]
fn the_pages_show_what_the_program_says_of_a_withheld_stribeck_force() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut simulate = program("residyn");
    simulate.args(["simulate", "cases", "--only", "stribeck_friction"]);
    simulate.args(["--cases", "1", "--seed", "3", "--out"]);
    run(simulate.arg(folder.path().join("sim"))).succeeded();
    let only = |of: &str| {
        let mut all = std::fs::read_dir(folder.path().join("sim").join(of)).expect("a folder");
        all.next().expect("one case").expect("a path").path()
    };
    let mut diagnose = program("residyn");
    diagnose.current_dir(only("cases"));
    diagnose.args(["diagnose", "--robot", "robot.urdf"]);
    diagnose.args(["--data", "train.parquet", "--heldout", "test.parquet"]);
    diagnose.args(["--html", "gap.html", "--patch", "corrected.urdf"]);
    diagnose.args(["--json", "gap.json"]);
    let said = run(&mut diagnose).succeeded().out.clone();

    // What was withheld, and nothing beside it.
    let report = json(&only("cases").join("gap.json"));
    let causes = report["causes"].as_array().expect("a list");
    assert_eq!(causes.len(), 1, "{causes:?}");
    assert_eq!(causes[0]["effect"], "stribeck_friction");
    assert_eq!(causes[0]["joints"], serde_json::json!(["joint2"]));
    let truth = &json(&only("truth"))["effects"][0]["parameters"]["stribeck"];
    let truth = truth.as_f64().expect("a force");
    let found = &causes[0]["parameters"][0];
    assert_eq!(found["name"], "stribeck");
    let found = found["value"].as_f64().expect("a force");
    assert!((found / truth - 1.0).abs() < 0.1, "{found} for {truth} N·m");

    for page in ["README.md", "docs/start.md"] {
        let shown = shown(page);
        assert!(shown.len() >= 4, "{page}: {shown:?}");
        for line in &shown {
            let printed = said.lines().any(|l| alike(line, l.trim()));
            assert!(printed, "{page} shows\n{line}\nof\n{said}");
        }
    }
}
