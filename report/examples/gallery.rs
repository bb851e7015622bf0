//! Writes a page with every kind of block and figure: `cargo run --release -p residyn-report --example gallery -- FILE.html`.

use report::figure::{Bars, HeatMap, Ink, Panel, Plot, Waterfall};
use report::{Best, Cell, Column, KeyFigure, Page, Section, Table, Tone, write_atomic};
use std::path::PathBuf;

fn main() -> Result<(), report::WriteError> {
    let path = std::env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("gallery.html"), PathBuf::from);
    let page = page();
    write_atomic(&path, page.render())?;
    print!("{}", scores().to_text());
    println!("{}", path.display());
    Ok(())
}

fn page() -> Page {
    Page::new("Gallery of a report")
        .subtitle("Every block and figure, on made-up numbers")
        .key_figure(KeyFigure::new("Verdict", "explained").tone(Tone::Good))
        .key_figure(KeyFigure::new("Mean NRMSE as given", "1.074").tone(Tone::Bad))
        .key_figure(KeyFigure::new("Mean NRMSE, all causes in place", "0.094").note("floor 0.081"))
        .key_figure(KeyFigure::new("Held-out samples", "3624").note("6 joints, 10 Hz"))
        .section(
            Section::new("Verdict")
                .paragraph("The gap is explained: two causes bring the model to the recording's own repeatability.")
                .callout(Tone::Good, "Set in the simulator", "joint_2: counterbalance 0.98 ± 0.01 of the nominal spring.")
                .callout(Tone::Warning, "Ambiguous", "The payload cannot be told from the last link's mass.")
                .callout(Tone::Bad, "Not identifiable", "joint_6 never moves.")
                .callout(Tone::Neutral, "Protocol", "Scores are taken against the recorded torque, unfiltered.")
                .figure(ladder()),
        )
        .section(
            Section::new("Scores")
                .table(scores())
                .figure(bars())
                .list(["Means are over joints.", "A joint that never moves is left out."]),
        )
        .section(Section::new("Where").figure(heat()).figures([velocity(), spectrum()]))
        .section(Section::new("Measured and predicted torque").figure(torque()))
        .section(
            Section::new("Provenance")
                .pairs([("recording", "run-17.parquet"), ("robot", "arm.urdf"), ("seed", "7")])
                .heading("Snippet")
                .code("<joint name=\"joint_2\">\n  <dynamics damping=\"12.5\" friction=\"4.1\"/>\n</joint>")
                .details(Section::new("Settings").paragraph("Cut-off 5 Hz, chosen from the data.")),
        )
        .footer("report 0.1.0")
}

fn scores() -> Table {
    let columns = (1..=6).map(|j| Column::number(format!("joint_{j}")));
    Table::new(
        std::iter::once(Column::text("model"))
            .chain(columns)
            .chain([Column::number("mean").best(Best::Lowest)]),
    )
    .caption("NRMSE on the held-out recording, all samples")
    .row(row(
        "linear_baseline",
        [0.431, 0.652, 0.533, 0.688, 0.671, 0.541],
    ))
    .row(row(
        "physics",
        [0.201, 0.352, 0.301, 0.388, 0.371, f64::NAN],
    ))
    .row(row(
        "physics+compensator",
        [0.051, 0.102, 0.083, 0.098, 0.087, 0.061],
    ))
    .emphasise_last()
}

fn row(name: &str, values: [f64; 6]) -> Vec<Cell> {
    let present: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
    let mean = present.iter().sum::<f64>() / present.len() as f64;
    std::iter::once(Cell::text(name))
        .chain(values.map(|v| Cell::number(v, 3)))
        .chain([Cell::number(mean, 3)])
        .collect()
}

fn ladder() -> report::Figure {
    Waterfall::new("How far the gap shrinks", "mean NRMSE over joints")
        .step("as_given", 1.074)
        .step("reidentified", 0.334)
        .step("counterbalance · joint_2", 0.251)
        .step("presliding_hysteresis · all joints", 0.109)
        .step("nonlinear_viscous_friction · joint_1", 0.113)
        .step("learned", 0.094)
        .floor("repeatability", 0.081)
        .draw("What is left after each step on the held-out recording; the pale part is what the step removed.")
}

fn bars() -> report::Figure {
    let joints = (1..=6).map(|j| format!("joint_{j}"));
    let given = [0.9, 1.3, 1.0, 0.7, 0.8, 0.6].map(Some);
    let patched = [0.1, 0.2, 0.15, 0.1, 0.12].map(Some);
    let gap = [0.71, 0.65, 0.6, 0.5, 0.4, 0.3].map(|v| (v, [v - 0.06, v + 0.05]));
    Bars::new("NRMSE by joint", "NRMSE", joints)
        .series("as given", Ink::Muted, &given)
        .series("patched", Ink::Predicted, &patched)
        .series_with_intervals("gap closed", Ink::Series(2), &gap)
        .draw("Bars with intervals of 95 %; joint 6 has no figure for the patched model.")
}

fn heat() -> report::Figure {
    let regions = [
        "|v| < 0.01",
        "slow",
        "fast",
        "reversal < 1°",
        "high load",
        "first minute",
    ];
    (1..=6)
        .fold(
            HeatMap::new("Share of the gap by joint and region", regions),
            |map, j| {
                let share =
                    |r: i32| Some(0.9 / f64::from(1 + (j - 2_i32).abs() + (r - 3_i32).abs()));
                let mut values: Vec<Option<f64>> = (0..6).map(share).collect();
                if j == 6 {
                    values[2] = None;
                }
                map.row(format!("joint_{j}"), &values)
            },
        )
        .draw("Share of each joint's squared error.")
}

/// Repeatable stand-in for noise in [−1, 1].
fn noise(k: usize) -> f64 {
    2.0 * (12.9898 * k as f64)
        .sin()
        .mul_add(43_758.547, 0.0)
        .fract()
        .abs()
        - 1.0
}

fn velocity() -> report::Figure {
    let n = 4000;
    let v: Vec<f64> = (0..n).map(|k| 1.2 * (0.01 * k as f64).sin()).collect();
    let residual: Vec<f64> = (0..n)
        .map(|k| 4.0 * v[k].signum() * (-v[k].abs() / 0.15).exp() + 0.8 * noise(k))
        .collect();
    let side = |positive: bool| -> (Vec<f64>, Vec<f64>) {
        let rows = (0..n).filter(|&k| (v[k] > 0.0) == positive);
        rows.map(|k| (v[k], residual[k])).unzip()
    };
    let (forward, backward) = (side(true), side(false));
    Plot::new("Residual against velocity, joint_3", "velocity / rad/s")
        .half_width()
        .panel(
            Panel::new("residual / N·m")
                .points("samples", Ink::Muted, &v, &residual)
                .binned("forward", Ink::Series(0), &forward.0, &forward.1, 25)
                .binned("backward", Ink::Series(1), &backward.0, &backward.1, 25),
        )
        .draw("Mean and standard deviation by bin: friction falls as the joint starts to slide.")
}

fn spectrum() -> report::Figure {
    let order: Vec<f64> = (1..400).map(|k| 0.1 * f64::from(k)).collect();
    let amplitude: Vec<f64> = order
        .iter()
        .enumerate()
        .map(|(k, o)| 1e-3 * (1.0 + 0.5 * noise(k)) + 0.3 * (-((o - 12.0) / 0.15).powi(2)).exp())
        .collect();
    Plot::new(
        "Order spectrum of the residual, joint_3",
        "order / 1 per turn",
    )
    .half_width()
    .panel(
        Panel::new("amplitude / N·m")
            .log()
            .line("amplitude", Ink::Residual, &order, &amplitude),
    )
    .draw("A line at an order of the joint angle is torque ripple.")
}

fn torque() -> report::Figure {
    let n = 12_000;
    let time: Vec<f64> = (0..n).map(|k| 0.005 * k as f64).collect();
    let measured: Vec<f64> = (0..n)
        .map(|k| 80.0 * (0.3 * time[k]).sin() + 25.0 * (1.7 * time[k]).cos() + noise(k))
        .collect();
    let predicted: Vec<f64> = time
        .iter()
        .map(|t| 80.0 * (0.3 * t).sin() + 24.0 * (1.7 * t).cos())
        .collect();
    let residual: Vec<f64> = std::iter::zip(&measured, &predicted)
        .map(|(m, p)| m - p)
        .collect();
    let runs = [0..5000, 5000..12_000];
    Plot::new("joint_2", "time / s")
        .panel(
            Panel::new("torque / N·m")
                .segments("measured", Ink::Measured, &time, &measured, &runs)
                .segments("predicted", Ink::Predicted, &time, &predicted, &runs),
        )
        .panel(Panel::new("residual / N·m").height(110.0).segments(
            "residual",
            Ink::Residual,
            &time,
            &residual,
            &runs,
        ))
        .draw("Two trajectories of the held-out recording.")
}
