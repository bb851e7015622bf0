//! Section on the whiteness of the residual: tests and four plots per joint.

use super::subject::Subject;
use crate::directory::ModelFile;
use crate::identify::diagnostics;
use crate::tables;
use ::identify::residuals::{autocorrelation, normal_scores};
use report::Section;
use report::figure::{Figure, Ink, Panel, Plot};

/// Longest lag of the autocorrelation plot, samples.
const LAGS: usize = 50;
/// Number of points of the normal quantile plot.
const QUANTILES: usize = 200;

pub(super) fn section(file: &ModelFile, subject: &Subject) -> Section {
    let starts = subject.recording.starts();
    let mut tests = Vec::new();
    let (mut velocity, mut others) = (Vec::new(), Vec::new());
    for (j, name) in file.joints.iter().enumerate() {
        let Some(tau) = &subject.recording.tau else {
            continue;
        };
        let measured = tau.column(j).to_vec();
        let predicted = subject.torque.column(j).to_vec();
        let qd = subject.motion.qd.column(j).to_vec();
        tests.push(diagnostics::tests(&measured, &predicted, &qd, &starts));
        let residual: Vec<f64> = std::iter::zip(&measured, &predicted)
            .map(|(m, p)| m - p)
            .collect();
        velocity.push(against(
            name,
            "velocity / rad/s",
            "velocity",
            &qd,
            &residual,
        ));
        others.push(against(
            name,
            "fitted torque / N·m",
            "fitted torque",
            &predicted,
            &residual,
        ));
        others.push(correlated(name, &residual, &starts));
        others.push(normal(name, &residual));
    }
    Section::new("Residual")
        .paragraph("A shape over velocity is friction that the model lacks; a bare cloud is noise, or memory. “Explained” is the part of the residual's variance that its mean in 20 cells of fitted torque or velocity takes away. Residuals of a torque model are correlated in time, so that p-values vanish in long recordings; effective samples say how many independent ones know as much.")
        .table(tables::residual_tests(&file.joints, &tests).caption("Tests of this recording's residual"))
        .figures(velocity)
        .details(Section::new("Residual over fitted torque, autocorrelation and normal plot").figures(others))
}

fn against(name: &str, axis: &str, what: &str, x: &[f64], residual: &[f64]) -> Figure {
    let panel = Panel::new("residual / N·m")
        .height(160.0)
        .points("samples", Ink::Muted, x, residual)
        .binned("mean over bins", Ink::Residual, x, residual, 30);
    Plot::new(name.to_owned(), axis.to_owned())
        .half_width()
        .panel(panel)
        .draw(format!("{name}: residual over {what}"))
}

fn correlated(name: &str, residual: &[f64], starts: &[usize]) -> Figure {
    let values = autocorrelation(residual, starts, LAGS);
    let lags: Vec<f64> = (0..values.len()).map(|k| k as f64).collect();
    // White noise stays within two deviations of zero.
    let bound = 2.0 / (residual.len() as f64).sqrt();
    let (low, high) = (vec![-bound; lags.len()], vec![bound; lags.len()]);
    let panel = Panel::new("autocorrelation")
        .height(160.0)
        .band("white noise, 95 %", Ink::Muted, &lags, &low, &high)
        .line("residual", Ink::Residual, &lags, &values);
    Plot::new(name.to_owned(), "lag / samples")
        .half_width()
        .panel(panel)
        .draw(format!("{name}: autocorrelation of the residual"))
}

fn normal(name: &str, residual: &[f64]) -> Figure {
    let (scores, values) = normal_scores(residual, QUANTILES);
    let panel = Panel::new("residual / σ")
        .height(160.0)
        .line("normal", Ink::Muted, &[-3.5, 3.5], &[-3.5, 3.5])
        .points("quantiles", Ink::Residual, &scores, &values);
    Plot::new(name.to_owned(), "normal quantile")
        .half_width()
        .panel(panel)
        .draw(format!(
            "{name}: quantiles of the residual against normal ones"
        ))
}
