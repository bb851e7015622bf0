//! `residyn report compare` on reports of each kind, and on what is none.

use super::{residyn, text};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A report of `diagnose` in which a body on two joints weighs `mass`.
fn torque(mass: f64, given: f64) -> Value {
    json!({"schema": "diagnosis/1", "joints": ["j1", "j2"], "verdict": "explained",
        "ladder": [
            {"step": "as_given", "nrmse": [given, 0.2], "mean_nrmse": (given + 0.2) / 2.0},
            {"step": "reidentified", "nrmse": [0.06, 0.06], "mean_nrmse": 0.06},
            {"step": "payload", "nrmse": [0.05, null], "mean_nrmse": 0.05},
            {"step": "repeatability", "nrmse": [0.01, 0.01], "mean_nrmse": 0.01}],
        "causes": [{"effect": "payload", "joints": ["j1", "j2"], "share_of_gap": 1.0, "gap_closed": 0.98,
            "gap_closed_interval": [0.97, 0.99], "confirmed": true,
            "parameters": [{"name": "mass", "value": mass, "std": 0.05, "unit": "kg"}]}]})
}

fn motion() -> Value {
    json!({"schema": "replay/1", "joints": ["j1"], "verdict": "partly_explained",
        "ladder": [{"step": "as_given", "unexplained": [0.9], "mean_unexplained": 0.9},
            {"step": "servo_gain", "unexplained": [0.3], "mean_unexplained": 0.3}],
        "causes": [{"effect": "servo_gain", "joints": ["j1"], "share_of_gap": 1.0, "gap_closed": 0.9,
            "gap_closed_interval": [0.8, 0.95], "confirmed": true,
            "parameters": [{"name": "kp", "joint": "j1", "given": 50.0, "value": 41.0, "std": null, "unit": "N·m/rad"}]}]})
}

fn scores(physics: f64) -> Value {
    let row = |name: &str, scope: &str, nrmse: f64| json!({"name": name, "scope": scope, "nrmse": [nrmse], "mean_nrmse": nrmse});
    json!({"schema": "eval/1", "joints": ["j1"], "samples": 9,
        "rows": [row("physics", "all", physics), row("physics", "moving", 0.5)]})
}

/// Writes reports into a folder, side by side.
fn written(folder: &Path, reports: &[(&str, String)]) -> Vec<PathBuf> {
    let write = |(name, text): &(&str, String)| {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("a temporary file");
        path
    };
    reports.iter().map(write).collect()
}

/// Exit status, standard output and standard error of a comparison.
fn compared(a: &Path, b: &Path, more: &[&str]) -> (Option<i32>, String, String) {
    let [a, b] = [a, b].map(|p| p.to_str().expect("a name in Unicode"));
    let done = residyn(&[&["report", "compare", a, b], more].concat());
    (done.status.code(), text(&done.stdout), text(&done.stderr))
}

#[test]
fn two_diagnoses_side_by_side() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut b = torque(0.6, 0.3);
    b["causes"][0]["joints"] = json!(["j2"]);
    b["causes"].as_array_mut().expect("a list").push(json!({"effect": "backlash", "joints": ["j1"],
        "share_of_gap": 0.1, "gap_closed": 0.2, "gap_closed_interval": [-0.1, 0.3], "confirmed": false, "parameters": []}));
    let files = [
        ("a.json", torque(1.2, 0.6).to_string()),
        ("b.json", b.to_string()),
    ];
    let files = written(folder.path(), &files);
    let html = folder.path().join("both.html");
    let (code, out, err) = compared(
        &files[0],
        &files[1],
        &["--html", html.to_str().expect("a name")],
    );
    assert_eq!(code, Some(0), "{err}");
    for line in [
        "The verdict is the same: explained.",
        "The mean NRMSE, as given: 0.400 in A, 0.250 in B (−38 %); most on j1, 0.600 to 0.300.",
        "The mean NRMSE, with the causes: 0.050 in A, 0.050 in B.",
        "In both: payload on j1, j2; closes 98 % (97–99 %) in A, 98 % (97–99 %) in B. \
         Changed: mass 1.200 ± 0.050 kg in A, 0.600 ± 0.050 kg in B (−0.600 ± 0.071).",
        "Only in B: backlash on j1; closes 20 % (−10–30 %), not confirmed by the held-out recording.",
    ] {
        assert!(out.lines().any(|l| l == line), "{line}\nof\n{out}");
    }
    let page = std::fs::read_to_string(html).expect("the page");
    for part in [
        "Two runs side by side",
        "−0.600 ± 0.071",
        "a.json",
        "b.json",
        "<svg",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(
        !page.contains("src=") && !page.contains("<link"),
        "nothing outside the page"
    );

    // Sizes within their deviations are no change, and a run is the same as itself.
    let files = [
        ("c.json", torque(1.2, 0.6).to_string()),
        ("d.json", torque(1.25, 0.6).to_string()),
    ];
    let files = written(folder.path(), &files);
    let (_, out, _) = compared(&files[0], &files[1], &[]);
    assert!(
        out.contains("The sizes that both state are the same within 90 %.")
            && out.contains("+0.050 ± 0.071"),
        "{out}"
    );
    let (_, out, _) = compared(&files[0], &files[0], &[]);
    assert!(
        !out.contains("Changed") && !out.contains("Only in"),
        "{out}"
    );
}

#[test]
fn motion_and_scores_side_by_side() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let files = [
        ("motion.json", motion().to_string()),
        ("a.json", scores(0.2).to_string()),
        ("b.json", scores(0.1).to_string()),
    ];
    let files = written(folder.path(), &files);
    let (code, out, err) = compared(&files[0], &files[0], &[]);
    assert_eq!(code, Some(0), "{err}");
    assert!(
        out.contains("The mean unexplained part, as given: 0.900 in A"),
        "{out}"
    );
    assert!(out.contains("servo gain") && out.contains("41.00"), "{out}");
    let (code, out, err) = compared(&files[1], &files[2], &[]);
    assert_eq!(code, Some(0), "{err}");
    assert!(
        out.contains("The mean NRMSE, physics: 0.200 in A, 0.100 in B (−50 %)"),
        "{out}"
    );
    assert!(!out.contains("verdict") && !out.contains("0.500"), "{out}");
}

#[test]
fn what_cannot_be_compared_is_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let good = torque(1.2, 0.6);
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut value = good.clone();
        change(&mut value);
        value.to_string()
    };
    let short = changed(&|v| v["ladder"][0]["nrmse"] = json!([0.6]));
    let other = changed(&|v| v["joints"] = json!(["a", "b"]));
    let lacking = changed(&|v| {
        let cause = v["causes"][0].as_object_mut().expect("a cause");
        cause.remove("gap_closed").expect("a figure");
    });
    let files = [
        ("good.json", good.to_string()),
        ("short.json", short),
        ("other.json", other),
        ("lacking.json", lacking),
        ("motion.json", motion().to_string()),
        ("odd.json", json!({"schema": "model/1"}).to_string()),
        ("text.json", "no report".to_owned()),
    ];
    let files = written(folder.path(), &files);
    for (file, said) in [
        (&files[1], "1 values stand in as given for 2 joints"),
        (&files[2], "two runs of one robot"),
        (&files[3], "gap_closed"),
        (&files[4], "two of one program"),
        (&files[5], "\"model/1\""),
        (&files[6], "text.json: not a report"),
        (&folder.path().join("nowhere.json"), "nowhere.json"),
        (&folder.path().to_owned(), "directory"),
    ] {
        let (code, out, err) = compared(&files[0], file, &[]);
        assert_eq!(code, Some(2), "{}: {err}", file.display());
        assert!(err.contains(said) && out.is_empty(), "{said}\nof\n{err}");
        assert_eq!(err.lines().count(), 1, "{err}");
    }
    let (code, out, err) = compared(&files[0], &files[0], &["--html", "no/such/page.html"]);
    assert!(code == Some(2) && out.is_empty(), "{err}");
    assert_eq!(residyn(&["report", "compare"]).status.code(), Some(2));
}
