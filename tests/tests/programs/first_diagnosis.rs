//! The first diagnosis that README and docs/start.md show is what the program says.

use std::path::Path;
use tests::program::{program, run};

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

/// The step of the biggest cause takes more away than any other, though free parameters could take a payload's place.
fn the_chart_counts_causes_as_the_words_do(report: &serde_json::Value) {
    let list = |key: &str| report[key].as_array().expect("a list").clone();
    let mean = |step: &serde_json::Value| step["mean_nrmse"].as_f64().expect("a mean");
    let (steps, causes, ladder) = (list("by_cause"), list("causes"), list("ladder"));
    assert_eq!(causes[0]["effect"], "payload");
    for (step, cause) in steps[1..].iter().zip(&causes) {
        assert_eq!(step["step"], cause["effect"]);
    }
    let falls: Vec<f64> = steps
        .windows(2)
        .map(|w| mean(&w[0]) - mean(&w[1]))
        .collect();
    assert!(falls[1..].iter().all(|f| *f < falls[0]), "{falls:?}");
    let part = falls[0] / mean(&steps[0]);
    assert!(part > 0.5, "the payload's step removes {part}");
    for (own, other) in [
        (steps.first(), ladder.first()),
        (steps.last(), ladder.last()),
    ] {
        let [own, other] = [own, other].map(|step| mean(step.expect("a step")));
        assert!((own - other).abs() < 1e-9, "{own} {other}");
    }
}

#[test]
fn the_pages_show_what_the_demo_says() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut demo = program("residyn");
    demo.current_dir(folder.path()).arg("demo");
    let said = run(&mut demo).succeeded().out.clone();
    let written = folder.path().join("residyn-demo");
    for file in ["robot.urdf", "gap.html", "corrected.urdf"] {
        assert!(written.join(file).is_file(), "{file}");
    }
    // The page's first screen: what to do, and the joints on which the payload lies.
    let page = std::fs::read_to_string(written.join("gap.html")).expect("a page");
    for part in [
        "What to do next",
        "attach a body to the last link",
        "elbow_joint: payload",
    ] {
        assert!(page.contains(part), "no {part} on the page");
    }
    // What is withheld, to a deviation of the printed one.
    let mass = said.split("mass ").nth(1).expect("a payload's mass");
    let mut words = mass.split_whitespace().filter_map(|w| w.parse().ok());
    let (mass, std): (f64, f64) = words.next().zip(words.next()).expect("mass ± deviation");
    assert!((mass - 1.2).abs() < std, "{mass} ± {std} kg for 1.2 kg");

    // The report alone on standard output, stages and words on standard error; a page that has no folder is refused before work begins.
    let mut diagnose = program("diagnose");
    diagnose
        .current_dir(&written)
        .args(["--robot", "robot.urdf"]);
    diagnose.args(["--data", "monday.parquet", "--heldout", "friday.parquet"]);
    diagnose.args(["--fast", "--json", "-"]);
    let ended = run(&mut diagnose);
    let report: serde_json::Value =
        serde_json::from_str(&ended.succeeded().out).expect("a report and nothing else");
    assert_eq!(report["schema"], "diagnosis/1");
    the_chart_counts_causes_as_the_words_do(&report);
    let ended = run(diagnose.args(["--html", "missing/page.html"]));
    assert_eq!(ended.status, 2, "{}", ended.err);
    assert!(
        ended.err.contains("missing/page.html") && ended.out.is_empty(),
        "{}",
        ended.err
    );

    for page in ["README.md", "docs/start.md"] {
        let shown = shown(page);
        assert!(shown.len() >= 2, "{page}: {shown:?}");
        for line in &shown {
            let printed = said.lines().any(|l| alike(line, l.trim()));
            assert!(printed, "{page} shows\n{line}\nof\n{said}");
        }
    }
}
