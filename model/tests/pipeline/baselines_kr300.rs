//! The baselines on the shared KR300 files, beside the paper's figures. Skipped where they are absent.

use crate::shared::shared;
use datasets::metrics::{Scope, Scores};
use datasets::{Part, ReadOptions, Recording, read};
use model::baseline::{ForwardSettings, LinearForward, LinearInverse};
use ndarray::Array2;

fn load(file: &str) -> Option<[Recording; 2]> {
    let path = shared(&format!("data/kr300/{file}"))?;
    Some([Part::Train, Part::Test].map(|p| read(&path, &ReadOptions::kr300(p)).unwrap()))
}

/// Scores over all samples, where every joint counts as moving.
fn scores(name: &str, measured: &Array2<f64>, predicted: &Array2<f64>) -> Scores {
    let moving = Array2::ones(measured.dim());
    let s = Scores::of(measured.view(), predicted.view(), moving.view(), Scope::All).unwrap();
    let joints: Vec<String> = s
        .nrmse
        .iter()
        .map(|e| format!("{:.3}", e.unwrap()))
        .collect();
    println!(
        "{name}: mean NRMSE {:.4}, mean R² {:.2} %, NRMSE {}",
        s.mean_nrmse.unwrap(),
        s.mean_r2.unwrap(),
        joints.join(" ")
    );
    s
}

#[test]
fn inverse_baseline_is_within_five_percent_of_the_shared_figure() {
    let Some([train, test]) = load("inverse_identification_without_raw_data.mat") else {
        return;
    };
    let tables = |r: &Recording| {
        let [qd, qdd, tau] = [&r.qd, &r.qdd, &r.tau].map(|t| t.clone().unwrap());
        (r.q.clone(), qd, qdd, tau)
    };
    let (q, qd, qdd, tau) = tables(&train);
    let model = LinearInverse::fit(q.view(), qd.view(), qdd.view(), tau.view()).unwrap();
    let fitted = model.predict(q.view(), qd.view(), qdd.view()).unwrap();
    scores("inverse, train (paper 0.5785 / 65.77)", &tau, &fitted);
    let (q, qd, qdd, tau) = tables(&test);
    let predicted = model.predict(q.view(), qd.view(), qdd.view()).unwrap();
    let s = scores("inverse, test (paper 0.6085 / 62.00)", &tau, &predicted);
    let relative = s.mean_nrmse.unwrap() / 0.586 - 1.0;
    assert!(relative.abs() < 0.05, "{relative}");
}

#[test]
fn forward_baseline_stands_beside_table_4() {
    let Some([train, test]) = load("forward_identification_without_raw_data.mat") else {
        return;
    };
    let start = std::time::Instant::now();
    let mut means = Vec::new();
    for feedthrough in [false, true] {
        let settings = ForwardSettings {
            feedthrough,
            ..ForwardSettings::for_joints(6)
        };
        let tau = |r: &Recording| r.tau.clone().unwrap();
        let model = LinearForward::fit(
            tau(&train).view(),
            train.q.view(),
            &train.segments(),
            &settings,
        )
        .unwrap();
        assert_eq!(model.system.order(), 12);
        for (part, r, paper) in [
            ("train", &train, "0.7745 / 39.28"),
            ("test", &test, "0.82517 / 31.14"),
        ] {
            let simulated = model.simulate(tau(r).view(), &r.segments()).unwrap();
            let name = format!("forward, {part}, feedthrough {feedthrough} (paper {paper})");
            means.push(scores(&name, &r.q, &simulated).mean_nrmse.unwrap());
        }
        println!("{:.1} s", start.elapsed().as_secs_f64());
    }
    // The same model class and protocol but for the breaks: within a tenth of the paper's figures.
    assert!((means[0] / 0.7745 - 1.0).abs() < 0.1, "train {}", means[0]);
    assert!((means[1] / 0.82517 - 1.0).abs() < 0.1, "test {}", means[1]);
    // More freedom fits the training part no worse.
    assert!(means[2] < means[0]);
}
