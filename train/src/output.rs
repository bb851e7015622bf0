//! Files that `train` writes.

use crate::arguments::Arguments;
use crate::input::Input;
use crate::yardsticks;
use datasets::Recording;
use datasets::metrics::Row;
use model::baseline::published::{Part, Published, beside};
use model::directory::metrics::{Member, Metrics};
use model::failure::Failure;
use model::page::Subject;
use model::physics_fit::Fit;
use model::residual::{Learned, member_torques};
use std::cmp::Reverse;

/// Name of the report page in the model directory.
pub const PAGE: &str = "report.html";

/// Rows of one recording of the session.
pub fn rows(
    fit: &Fit,
    learned: Option<&Learned>,
    part: usize,
    recording: &Recording,
) -> Result<Vec<Row>, Failure> {
    let mut rows = fit.rows(part, recording)?;
    rows.extend(whole(fit, learned, part, recording)?);
    Ok(rows)
}

/// Scores of the whole model, where it has a compensator.
fn whole(
    fit: &Fit,
    learned: Option<&Learned>,
    part: usize,
    recording: &Recording,
) -> Result<Vec<Row>, Failure> {
    let (Some(learned), Some(tau)) = (learned, &recording.tau) else {
        return Ok(Vec::new());
    };
    let torque = &fit.physics[part] + &learned.torque[part];
    let qd = &fit.session.parts[part].at_samples.qd;
    let both = Row::both_scopes("physics+compensator", tau, &torque, qd)
        .map_err(|e| Failure::other(e.to_string()))?;
    Ok(both.into())
}

/// Metrics of the first training recording set and the held-out one.
pub fn metrics(
    fit: &Fit,
    learned: Option<&Learned>,
    data: &[Recording],
    heldout: Option<&Recording>,
) -> Result<Metrics, Failure> {
    let mut train = Vec::new();
    for (part, recording) in data.iter().enumerate() {
        let mut own = rows(fit, learned, part, recording)?;
        if data.len() > 1 {
            for row in &mut own {
                row.name = format!(
                    "{} [{}]",
                    row.name, fit.file.provenance.recordings[part].name
                );
            }
        }
        train.extend(own);
    }
    let members = match (learned, heldout) {
        (Some(learned), Some(recording)) => members(fit, learned, data.len(), recording)?,
        _ => Vec::new(),
    };
    let heldout = heldout
        .map(|recording| {
            let mut all = rows(fit, None, data.len(), recording)?;
            if let Some(compared) = learned.and_then(|l| l.yardsticks.as_ref()) {
                all.extend(yardsticks::rows(fit, compared, data.len(), recording)?);
            }
            all.extend(whole(fit, learned, data.len(), recording)?);
            Ok::<_, Failure>(all)
        })
        .transpose()?;
    Ok(Metrics {
        schema: model::directory::metrics::SCHEMA,
        joints: fit.file.joints.clone(),
        train,
        heldout,
        base_parameters: fit.file.base_parameters.clone(),
        diagnostics: fit.file.diagnostics.clone(),
        members,
    })
}

/// Scores of each member alone.
fn members(
    fit: &Fit,
    learned: &Learned,
    part: usize,
    recording: &Recording,
) -> Result<Vec<Member>, Failure> {
    let Some(tau) = &recording.tau else {
        return Ok(Vec::new());
    };
    let qd = &fit.session.parts[part].at_samples.qd;
    member_torques(learned, fit, part)?
        .iter()
        .enumerate()
        .map(|(member, residual)| {
            let torque = &fit.physics[part] + residual;
            let [all, moving] = Row::both_scopes("member", tau, &torque, qd)
                .map_err(|e| Failure::other(e.to_string()))?;
            Ok(Member {
                member,
                mean_nrmse: all.scores.mean_nrmse,
                mean_nrmse_moving: moving.scores.mean_nrmse,
            })
        })
        .collect()
}

/// Writes the directory: `model.json` last, so that a directory with one is whole.
pub fn write(
    arguments: &Arguments,
    learned: Option<&Learned>,
    metrics: &Metrics,
    fit: &Fit,
) -> Result<(), Failure> {
    let weights = learned.map(|l| l.bytes.as_slice());
    let urdf = model::urdf::identified(fit);
    let file = &fit.file;
    file.write(&arguments.out, metrics, weights, urdf.as_deref())?;
    if let Some((learned, compared)) = learned.and_then(|l| Some((l, l.yardsticks.as_ref()?))) {
        (compared.yardsticks).save(&arguments.out, &learned.record.sha256)?;
    }
    Ok(())
}

/// Writes the page of the held-out recording or, without one, of the longest training recording.
pub fn page(
    arguments: &Arguments,
    fit: &Fit,
    learned: Option<&Learned>,
    metrics: &Metrics,
    input: &Input,
) -> Result<(), Failure> {
    let longest = (0..input.data.len()).max_by_key(|&i| (input.data[i].len(), Reverse(i)));
    let (part, recording) = match (&input.heldout, longest) {
        (Some(heldout), _) => (input.data.len(), heldout),
        (None, Some(i)) => (i, &input.data[i]),
        (None, None) => return Ok(()),
    };
    let torque = match learned {
        Some(learned) => &fit.physics[part] + &learned.torque[part],
        None => fit.physics[part].clone(),
    };
    let rows = match &metrics.heldout {
        Some(rows) => rows.clone(),
        None => rows(fit, learned, part, recording)?,
    };
    let scored = if input.heldout.is_some() {
        "Scores and figures are of the held-out recording: nothing was fitted to its torque."
    } else {
        "No recording was held out: scores and figures are of samples that were fitted, and say nothing about new motion."
    };
    let mut notes = vec![scored.to_owned()];
    notes.extend(model::evaluation::notes(&fit.session, part, &fit.file));
    let published = published(fit, input.heldout.is_some());
    let page = model::page::page(
        &fit.file,
        &Subject {
            recording,
            motion: &fit.session.parts[part].at_samples,
            torque: &torque,
            rows: &rows,
            notes: &notes,
            published: &published,
        },
    );
    report::write_atomic(&arguments.out.join(PAGE), page.render())?;
    Ok(())
}

/// Published results beside the scores of this robot.
pub fn published(fit: &Fit, heldout: bool) -> Vec<&'static Published> {
    let part = if heldout { Part::Test } else { Part::Train };
    beside(fit.file.physics.builtin, &[part])
}
