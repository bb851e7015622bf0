//! Recordings that are refused.

use super::refused::{both_refuse, eval_refuses, folder, model, recording, train_refuses, ur5};
use std::path::Path;
use tests::csv::Csv;
use tests::program::{program, run};
use tests::synthetic::{Plan, record};

#[test]
fn cells() {
    let good = recording();
    let cases = [
        (17, "tau4", "NaN", "NaN"),
        (5, "q1", "inf", "inf"),
        (601, "time", "-inf", "inf"),
        (9, "tau6", "a lot", "a lot"),
        (12, "q2", "", "missing"),
    ];
    for (row, column, value, reason) in cases {
        let place = [
            &format!("row {row}"),
            &format!("column `{column}`"),
            reason,
            &format!("line {}", row + 1),
        ];
        both_refuse(
            "spoilt.csv",
            good.clone().with(row, column, value).text(),
            &place.map(|s| s as &str),
        );
    }
}

#[test]
fn time_that_goes_back() {
    let good = recording();
    let before = good.rows[9][1].clone();
    let fragments = ["row 12", "column `time`", "trajectory `t1`", "time goes"];
    both_refuse(
        "back.csv",
        good.clone().with(12, "time", &before).text(),
        &fragments,
    );
    // Standing still is not increasing either.
    let same = good.rows[10][1].clone();
    both_refuse("still.csv", good.with(12, "time", &same).text(), &fragments);
}

#[test]
fn columns() {
    let good = recording();
    both_refuse(
        "a.csv",
        good.clone().without(&["time"]).text(),
        &["`time`", "missing"],
    );
    both_refuse(
        "b.csv",
        good.clone().without(&["q3"]).text(),
        &["`q3`", "missing"],
    );
    let joints = "5 joints (q1, q2, q3, q4, q5), the ";
    both_refuse(
        "d.csv",
        good.clone().without(&["q6", "tau6"]).text(),
        &[joints],
    );
    let mut seven = good.clone();
    for name in ["q7", "tau7"] {
        seven.header.push(name.into());
        seven.rows.iter_mut().for_each(|row| row.push("0.5".into()));
    }
    both_refuse(
        "e.csv",
        seven.text(),
        &["7 joints (q1, q2, q3, q4, q5, q6, q7), the "],
    );
    let mut twice = good;
    twice.header[3] = "q1".into();
    both_refuse("f.csv", twice.text(), &["column `q1`", "2 times"]);
}

#[test]
fn missing_torque() {
    let place = folder();
    let one = place.path().join("one.csv");
    recording().without(&["tau2"]).write(&one);
    train_refuses(&one, &[], &["one.csv", "`tau2`", "missing"]);
    let all = place.path().join("all.csv");
    let names = ["tau1", "tau2", "tau3", "tau4", "tau5", "tau6"];
    recording().without(&names).write(&all);
    train_refuses(&all, &[], &["all.csv", "`tau1`", "missing"]);
    // Without --predict there is nothing that eval could do with it.
    let mut eval = program("eval");
    eval.arg("--model").arg(model().join("model"));
    run(eval.arg("--data").arg(&all)).refused(&["all.csv", "`tau1`", "missing"]);
}

#[test]
fn damaged_files() {
    let good = recording();
    both_refuse("empty.csv", "", &["no samples"]);
    both_refuse("header.csv", good.header.join(",") + "\n", &["no samples"]);
    let body = good.text();
    let bare = good.without(&["trajectory"]).text();
    let (_, rows) = bare.split_once('\n').expect("lines");
    both_refuse("headless.csv", rows, &["no header"]);
    let (_, rows) = body.split_once('\n').expect("lines");
    both_refuse("labels.csv", rows, &["`time`", "missing"]);
    let noise: Vec<u8> = (0..4000_u32).map(|i| (i * i % 251) as u8).collect();
    both_refuse("noise.csv", &noise, &[]);
    for ending in ["parquet", "npz"] {
        both_refuse(&format!("noise.{ending}"), &noise, &["not a readable"]);
        both_refuse(&format!("empty.{ending}"), "", &[]);
    }
    both_refuse(
        "ragged.csv",
        body.replacen('\n', "\n1,2,3\n", 2),
        &["row 1", "cells"],
    );
    both_refuse(
        "short.csv",
        body.lines().take(4).collect::<Vec<_>>().join("\n"),
        &["trajectory `t1`", "3 samples"],
    );
    both_refuse("recording.xls", &body, &["`xls`", "not a known kind"]);
    both_refuse("benchmark.mat", &noise, &["KR300"]);
    let absent = Path::new("/nowhere/absent.csv");
    train_refuses(absent, &[], &["/nowhere/absent.csv", "cannot be read"]);
    eval_refuses(
        &model().join("model"),
        absent,
        &["/nowhere/absent.csv", "cannot be read"],
    );
}

#[test]
fn benchmark_files_without_their_keys() {
    let place = folder();
    let kr300 = ["--robot", "kr300"];
    let data = place.path().join("other.mat");
    // A MATLAB 5 file that holds nothing but a 1 × 1 matrix called `x`.
    let mut bytes = vec![b' '; 124];
    bytes[..19].copy_from_slice(b"MATLAB 5.0 MAT-file");
    bytes.extend([0x00, 0x01, b'I', b'M']);
    let mut body: Vec<u8> = Vec::new();
    for (kind, content) in [
        (6_u32, vec![6, 0, 0, 0, 0, 0, 0, 0]),
        (5, [1_u32.to_le_bytes(), 1_u32.to_le_bytes()].concat()),
        (1, b"x".to_vec()),
        (9, 1.0_f64.to_le_bytes().to_vec()),
    ] {
        body.extend(kind.to_le_bytes());
        body.extend((content.len() as u32).to_le_bytes());
        body.extend(content);
        body.resize(body.len().next_multiple_of(8), 0);
    }
    bytes.extend(14_u32.to_le_bytes());
    bytes.extend((body.len() as u32).to_le_bytes());
    bytes.extend(body);
    std::fs::write(&data, bytes).expect("writable");
    train_refuses(
        &data,
        &kr300,
        &["other.mat", "`u_train`", "the file has: x"],
    );
    std::fs::write(&data, "nothing of MATLAB").expect("writable");
    train_refuses(&data, &kr300, &["other.mat", "not a readable MATLAB file"]);
}

/// Refused only once identification has begun; nothing is left of it either.
#[test]
fn nothing_moves() {
    let place = folder();
    let still = place.path().join("still.csv");
    let plan = Plan {
        still: (0..6).collect(),
        ..Plan::default()
    };
    Csv::of(&record(&ur5(), &plan)).write(&still);
    for extra in [
        &["--moving-only", "--physics-only"][..],
        &["--moving-only"],
        &[],
    ] {
        train_refuses(&still, extra, &["no joint moves"]);
    }
}

#[test]
fn recording_of_another_robot() {
    let place = folder();
    let data = place.path().join("five.csv");
    recording().without(&["q6", "tau6"]).write(&data);
    eval_refuses(
        &model().join("model"),
        &data,
        &["five.csv", "5 joints", "6"],
    );
}

/// One diagnosis takes its recordings as one, so their torque has to have been through the same.
#[test]
fn filters_that_differ() {
    let place = folder();
    let mut one = record(&ur5(), &Plan::default());
    let raw = place.path().join("raw.parquet");
    datasets::write(&one, &raw).expect("writable");
    one.torque_filter = Some(datasets::TorqueFilter::KR300);
    let filtered = place.path().join("filtered.parquet");
    datasets::write(&one, &filtered).expect("writable");
    let mut diagnose = program("diagnose");
    diagnose.args(["--robot", "ur5", "--data"]);
    diagnose.arg(&raw).arg(&filtered);
    let ended = run(diagnose.arg("--heldout").arg(&raw));
    ended.refused(&["filtered.parquet", "another low-pass", "raw.parquet"]);
    assert!(ended.err.contains("one at a time"), "{}", ended.err);
}
