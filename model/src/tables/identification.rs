//! Tables on the identification.

use crate::directory::ModelFile;
use crate::identify::diagnostics::{Conditioning, Diagnostics, POOR};
use crate::identify::estimators::{Estimator, EstimatorReport, Lmi};
use crate::preparation::cutoff::Tried;
use ::identify::residuals::ResidualTests;
use report::{Cell, Column, Table};

/// Table of base parameters with standard deviations and formulae.
pub fn base_parameters(file: &ModelFile) -> Table {
    let mut table = Table::new([
        Column::text("parameter"),
        Column::number("estimate"),
        Column::number("σ"),
        Column::number("σ / %"),
        Column::number("nominal"),
        Column::text("unit"),
        Column::text("formed by"),
    ]);
    for p in &file.base_parameters {
        table.push([
            Cell::text(p.name.clone()),
            Cell::significant(p.value, 4),
            Cell::significant(p.std, 2),
            match p.relative_std {
                Some(r) if r < 10.0 => Cell::number(100.0 * r, 1),
                _ => Cell::text("> 1000"),
            },
            Cell::significant(p.nominal, 4),
            Cell::text(p.unit.clone()),
            Cell::text(p.formula.clone()),
        ]);
    }
    table
}

/// Table of condition numbers of the regressor and its parts.
pub fn conditioning(c: &Conditioning) -> Table {
    let mut table = Table::new([Column::text("columns"), Column::number("condition number")]);
    for (name, value) in [
        ("all", c.whole),
        ("all, of unit norm", c.scaled),
        ("inertial: second moments, rotor inertia", c.inertial),
        ("gravity: first moments, masses", c.gravity),
        ("friction, memory, offset", c.friction),
    ] {
        let cell = value.map_or_else(Cell::missing, |v| Cell::significant(v, 3));
        table.push([Cell::text(name), cell]);
    }
    table
}

/// Table of the cut-offs of the motion's low-pass that were tried, with the basic model's error on rows left
/// out. None where the cut-off was given.
pub fn cutoffs(file: &ModelFile) -> Option<Table> {
    let choice = file.preprocessing.cutoff.as_ref()?;
    let mut table = Table::new(vec![
        Column::text("derivatives from"),
        Column::number("cut-off / Hz"),
        Column::number("mean NRMSE on rows left out"),
    ]);
    let mut push = |from: &str, tried: &Tried| {
        table.push(vec![
            Cell::text(from),
            Cell::number(tried.cutoff_hz, 2),
            Cell::number(tried.error, 4),
        ]);
    };
    choice
        .tried
        .iter()
        .for_each(|t| push("position, recorded velocity where it fits", t));
    choice
        .position_alone
        .iter()
        .for_each(|t| push("position alone", t));
    Some(table)
}

/// Table of residual tests, joint by joint.
pub fn residual_tests(joints: &[String], tests: &[Option<ResidualTests>]) -> Table {
    let mut table = Table::new([
        Column::text("joint"),
        Column::number("mean"),
        Column::number("σ / N·m"),
        Column::number("skewness"),
        Column::number("excess kurtosis"),
        Column::number("Jarque–Bera p"),
        Column::number("lag-1 correlation"),
        Column::number("Ljung–Box p"),
        Column::number("effective samples"),
        Column::number("explained by torque / %"),
        Column::number("explained by velocity / %"),
    ]);
    for (joint, tests) in joints.iter().zip(tests) {
        let Some(t) = tests else {
            let mut row = vec![Cell::text(joint.clone())];
            row.extend((0..10).map(|_| Cell::missing()));
            table.push(row);
            continue;
        };
        table.push([
            Cell::text(joint.clone()),
            Cell::significant(t.mean, 2),
            Cell::significant(t.std, 3),
            Cell::number(t.normality.skewness, 2),
            Cell::number(t.normality.excess_kurtosis, 2),
            Cell::number(t.normality.p_value, 3),
            Cell::number(t.serial.lag_one, 3),
            Cell::number(t.serial.p_value, 3),
            Cell::number(t.serial.effective_samples, 0),
            Cell::number(100.0 * t.against_fitted.explained, 1),
            Cell::number(100.0 * t.against_velocity.explained, 1),
        ]);
    }
    table
}

/// Table of the pseudo-inertias' eigenvalues for the links of the identified URDF.
pub fn links(d: &Diagnostics) -> Table {
    let mut columns = vec![Column::text("link")];
    columns.extend((1..=4).map(|k| Column::number(format!("λ{k} / λ4"))));
    let mut table = Table::new(columns);
    for link in &d.links {
        let mut row = vec![Cell::text(link.link.clone())];
        row.extend(link.eigenvalues.iter().map(|v| Cell::significant(*v, 3)));
        table.push(row);
    }
    table
}

/// Sentences on the estimation and on anomalies.
pub fn estimator(file: &ModelFile, d: &Diagnostics) -> Vec<String> {
    let r = &d.estimator;
    let mut lines = vec![method(r)];
    let list = |values: &mut dyn Iterator<Item = String>| values.collect::<Vec<_>>().join(", ");
    if r.left_out.iter().any(|v| *v > 0.0) {
        let shares = r.left_out.iter().zip(&file.joints);
        let shares = list(&mut shares.map(|(v, j)| format!("{j} {:.1} %", 100.0 * v)));
        lines.push(format!("Rows left out as outliers: {shares}."));
    }
    if r.exponents.iter().any(Option::is_some) {
        let found = r.exponents.iter().zip(&file.joints);
        let found = found.filter_map(|(a, j)| a.map(|a| format!("{j} {a:.3}")));
        let found = list(&mut { found });
        lines.push(format!("Exponents of speed in viscous friction: {found}."));
    }
    if let Some((value, [low, high])) = file
        .preprocessing
        .torque_delay
        .and_then(|d| Some((d.value?, d.interval?)))
    {
        lines.push(format!(
            "The recorded torque is {:.1} ms ({:.1} to {:.1}) later than the motion: the fit and every score allow for it, \
             the control loop has no such delay.",
            1e3 * value,
            1e3 * low,
            1e3 * high
        ));
    }
    if !r.converged {
        lines.push(
            "The iteration stopped at its limit of rounds or steps before it settled.".to_owned(),
        );
    }
    if !d.poorly_determined.is_empty() {
        lines.push(format!(
            "Poorly determined (σ above {:.0} % of the value): {}.",
            100.0 * POOR,
            d.poorly_determined.join(", ")
        ));
    }
    if let (Some(moved), Some(cost)) = (d.moved, d.cost) {
        lines.push(format!(
            "Links of the identified URDF are possible bodies, fitted under that condition: their error on the \
             training rows is {:.2} % above the free estimate's, and base parameters differ from it by {moved:.2} \
             deviations at most.",
            100.0 * (cost.possible / cost.free - 1.0)
        ));
    }
    lines
}

fn method(r: &EstimatorReport) -> String {
    let name = match r.estimator {
        Estimator::Ols => "Ordinary least squares",
        Estimator::Wls => "Least squares, rows weighted by their joint's residual deviation",
        Estimator::Irls => "Iteratively reweighted least squares",
        Estimator::Iterative => {
            "Iterative approach (noise covariance between joints, outliers, friction exponent)"
        }
    };
    let lmi = match r.lmi {
        Lmi::Off => "",
        Lmi::Last => "; every link a possible body in the last step",
        Lmi::Every => "; every link a possible body in every step",
    };
    let prior = r.prior.as_ref();
    let prior = prior.map_or_else(String::new, |p| format!(" towards the prior ({p})"));
    let every = match r.every {
        1 => String::new(),
        k => format!("; every {k}th sample"),
    };
    format!(
        "{name}{lmi}; ridge {:.0e}{prior}{every}; {} solutions. Deviations from leaving blocks of time out.",
        r.ridge, r.solutions
    )
}
