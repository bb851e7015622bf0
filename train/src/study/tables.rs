//! Output of the study, beside the paper's figures.

use super::results::{Report, Variant};
use report::{Best, Cell, Column, Table};

/// Table 6 of the UR5 paper, RMSE of each joint, N·m: physical model, with attention, without attention.
const PAPER_6: [(&str, [f64; 6]); 3] = [
    ("paper: physics", [3.112, 2.958, 2.633, 0.417, 0.457, 0.444]),
    (
        "paper: attention",
        [1.463, 1.671, 1.253, 0.293, 0.286, 0.265],
    ),
    (
        "paper: no attention",
        [1.670, 1.715, 1.274, 0.342, 0.326, 0.291],
    ),
];

/// Table 8 of the UR5 paper, error of each joint in percent of its largest torque: physics, and after compensation.
const PAPER_8: [(&str, [f64; 6]); 2] = [
    ("paper: physics", [7.87, 4.20, 6.55, 8.42, 9.16, 9.06]),
    ("paper: compensated", [3.85, 2.47, 3.58, 5.86, 5.78, 5.24]),
];

/// Prints the heading of the tables.
pub fn heading(report: &Report) {
    report::say!(
        "Simulated UR5, seed {}: {} of 5 folds by whole trajectories, units of {h} + {h}, at most {} epochs of {} windows; each joint trained and scored where it moves",
        report.seed,
        report.folds,
        report.epochs,
        report.windows_per_epoch,
        h = report.hidden
    );
}

/// Prints table 6, the main result.
pub fn table_6(report: &Report) {
    report::say!(
        "\nTable 6: RMSE on held-out trajectories, N·m (attainable: the plant's own equations on the recorded motion)"
    );
    let mut table = by_joint(report, "model", &report.table_6, |v| v.replace('_', " "));
    for (name, figures) in PAPER_6 {
        table.push(row(name, &figures, 3));
    }
    report::say_text!(table.to_text());
}

/// Prints the comparison of input sets.
pub fn inputs(report: &Report) {
    report::say!("\nInputs of the unit ({}), N·m", on_first(report));
    let name = |v: &&str| match *v {
        "own" => "own joint".to_owned(),
        "all" => "all joints".to_owned(),
        other => other.to_uppercase(),
    };
    report::say_text!(by_joint(report, "inputs", &report.inputs, name).to_text());
}

/// Prints the comparison of lengths of the window.
pub fn timesteps(report: &Report) {
    report::say!("\nTimestep of the window ({}), N·m", on_first(report));
    let name = |v: &usize| format!("T = {v}");
    report::say_text!(by_joint(report, "timestep", &report.timesteps, name).to_text());
}

/// Fully connected against LSTM.
pub fn nodes(report: &Report) {
    report::say!(
        "\nHidden nodes: one fully connected layer, LSTM n + n without attention (first fold, joint 1), N·m"
    );
    let mut table = Table::new([
        Column::number("nodes"),
        Column::number("fully connected").best(Best::Lowest),
        Column::number("LSTM").best(Best::Lowest),
    ]);
    for n in &report.nodes {
        table.push([
            Cell::number(n.nodes as f64, 0),
            Cell::number(n.fully_connected, 3),
            Cell::number(n.lstm, 3),
        ]);
    }
    report::say_text!(table.to_text());
}

/// Prints the results of the UR5 paper's smoothing and of its split.
pub fn papers_way(report: &Report) {
    report::say!(
        "\nThe paper's way: torque smoothed by RLOESS and scored as smoothed; every fifth sample held out, which leaks: windows of training hold what is scored (first fold, one seed), N·m"
    );
    let name = |v: &&str| match *v {
        "physics" => "physics".to_owned(),
        "smoothed_physics" => "physics, smoothed".to_owned(),
        "trajectories" => "attention, by trajectories".to_owned(),
        "smoothed_trajectories" => "attention, by trajectories, smoothed".to_owned(),
        "samples" => "attention, by samples (leaks)".to_owned(),
        _ => "attention, by samples (leaks), smoothed".to_owned(),
    };
    report::say_text!(by_joint(report, "model", &report.papers_way, name).to_text());
}

/// Prints Tables 7 and 8: relative errors.
pub fn verification(report: &Report) {
    let Some(v) = &report.table_8 else { return };
    report::say!(
        "\nTable 7: relative error of all torques (equation 27), % (paper: below 8, 8.84, 4.75)"
    );
    let mut table = Table::new([
        Column::number("identification"),
        Column::number("verification"),
        Column::number("verification, compensated"),
    ]);
    table.push([
        Cell::number(v.relative_error_identification, 2),
        Cell::number(v.relative_error, 2),
        Cell::number(v.relative_error_compensated, 2),
    ]);
    report::say_text!(table.to_text());
    report::say!("\nTable 8: verification recording, unit of the first fold");
    let percent = |rmse: &[f64]| -> Vec<f64> {
        std::iter::zip(rmse, &v.max_torque)
            .map(|(e, m)| 100.0 * e / m)
            .collect()
    };
    let mut table = header(report, "figure");
    table.push(row("largest torque / N·m", &v.max_torque, 2));
    table.push(row("physics / N·m", &v.physics, 3));
    table.push(row("compensated / N·m", &v.compensated, 3));
    table.push(row("physics / %", &percent(&v.physics), 2));
    table.push(row("compensated / %", &percent(&v.compensated), 2));
    for (name, figures) in PAPER_8 {
        table.push(row(&format!("{name} / %"), &figures, 2));
    }
    report::say_text!(table.to_text());
}

fn on_first(report: &Report) -> String {
    match report.repeats {
        1 => "first fold, one seed".to_owned(),
        n => format!("first fold, mean of {n} seeds; below each the deviation of one seed"),
    }
}

fn header(report: &Report, first: &str) -> Table {
    let joints = report.joints.iter().map(|j| Column::number(j.clone()));
    Table::new(std::iter::once(Column::text(first)).chain(joints))
}

fn row(name: &str, figures: &[f64], decimals: usize) -> Vec<Cell> {
    std::iter::once(Cell::text(name))
        .chain(figures.iter().map(|v| Cell::number(*v, decimals)))
        .collect()
}

fn by_joint<T>(
    report: &Report,
    first: &str,
    variants: &[Variant<T>],
    name: impl Fn(&T) -> String,
) -> Table {
    let mut table = header(report, first);
    for v in variants {
        table.push(row(&name(&v.value), &v.rmse, 3));
        if !v.between_seeds.is_empty() {
            table.push(row("±", &v.between_seeds, 3));
        }
    }
    table
}
