//! What to do next, in a few lines.

use super::cause::{name, told};
use super::{corrected, experiment_designed, plain, worst_findings};
use crate::schema::{Diagnosis, Verdict};
use std::path::PathBuf;

/// What to do next, most urgent first: mend the recording, set the biggest cause's values, load the corrected model, record
/// the motion that tells ambiguous names apart. `code` says whether a patch has code for what the model cannot hold, and `patched` are
/// the paths of its files, the description first; empty where none are written.
pub fn next(d: &Diagnosis, code: bool, patched: &[PathBuf]) -> Vec<String> {
    let mut out = Vec::new();
    if !worst_findings(d).is_empty() {
        out.push(
            "Mend the recording first, as said below: until then no cause can be trusted.".into(),
        );
    }
    let mut confirmed = d.causes.iter().filter(|c| c.confirmed);
    if let Some(first) = confirmed.clone().next() {
        let model = corrected(d);
        let (effect, remedy) = (name(first.effect), told(first));
        let remedy = remedy.trim_end_matches('.');
        out.push(format!(
            "For the biggest cause, {effect}, in the {model}: {remedy}."
        ));
        let beside = if code {
            " and code beside it for what no model file holds"
        } else {
            ""
        };
        out.push(match patched.first() {
            Some(path) => format!(
                "Or load the corrected model with every change, {}{beside}.",
                path.display()
            ),
            None => format!(
                "Or load a corrected model with every change: --patch OUT writes it{beside} (in Python report.patch)."
            ),
        });
    }
    match (
        &d.next_experiment,
        confirmed.find(|c| !c.ambiguous_with.is_empty()),
    ) {
        (Some(designed), _) => out.push(experiment_designed(designed)),
        (None, Some(cause)) => {
            let rivals: Vec<&str> = cause.ambiguous_with.iter().map(|e| plain(*e)).collect();
            out.push(format!(
                "The name may be another: {} or {}. --next FILE.csv writes the motion that tells them apart; run it and add it to --data.",
                plain(cause.effect),
                rivals.join(" or ")
            ));
        }
        (None, None) => {}
    }
    if out.is_empty() {
        out.push(match d.verdict {
            Verdict::NoGap => format!("Nothing has to change in the {}.", corrected(d)),
            Verdict::CannotTell => {
                let reason = d.reason.as_deref().unwrap_or("the recording says too little");
                format!("Record again: {}.", reason.trim_end_matches('.'))
            }
            _ => "Look where the gap lies, below; --learn trains a compensator on what no cause explains.".into(),
        });
    }
    out
}
