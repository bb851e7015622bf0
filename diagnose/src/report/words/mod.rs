//! The report as text, for the terminal and the page.

mod cause;
mod next;

pub use cause::{advice, closes, joined, name, plain, sentence, told};
pub use next::next;

use crate::catalogue::effect::Effect;
use crate::schema::Bounds;
use crate::schema::Resonance;
use crate::schema::value::value;
use crate::schema::{Cause, Diagnosis, NextExperiment, STRUCK, Simulation, Step, Verdict};
use cause::{experiment, place};
use datasets::check::{CheckReport, Severity};

/// The diagnosis as lines of text, the most important first.
pub fn lines(d: &Diagnosis) -> Vec<String> {
    let mut out = vec![verdict(d)];
    out.extend(worst_findings(d));
    out.extend(d.resonances.iter().map(resonance));
    let (confirmed, rest): (Vec<&Cause>, Vec<&Cause>) = d.causes.iter().partition(|c| c.confirmed);
    let (traced, rest): (Vec<&Cause>, Vec<&Cause>) =
        rest.into_iter().partition(|c| c.remark == Some(STRUCK));
    match confirmed.split_first() {
        Some((first, others)) => {
            out.push(format!("Biggest cause: {}.", sentence(first)));
            out.push(format!("  {}", closes(first)));
            let advice = advice(first);
            out.push(format!("  In the {}: {}", corrected(d), advice[0]));
            out.extend(advice[1..].iter().map(|l| format!("  {l}")));
            out.extend(also("Also", others));
        }
        None if !traced.is_empty() => {}
        None if rest.is_empty() => out.push("No cause to report.".to_owned()),
        None => out.push("No cause shows on the held-out recording.".to_owned()),
    }
    out.extend(also(
        "Shown by what the data hold, though its torque cannot be foretold",
        &traced,
    ));
    out.extend(also(
        "Found in the data, not confirmed by the held-out recording",
        &rest,
    ));
    out.extend(supposed(d));
    out.extend(d.bounds.as_ref().map(bounds));
    out.extend(remainder(d));
    out.extend(d.simulation.as_ref().map(|s| motion(s, &d.joints)));
    out.extend(ambiguities(d));
    out.extend(d.next_experiment.as_ref().map(experiment_designed));
    out.extend(unknowable(d));
    out
}

/// Name of the model that the causes correct: a simulator's, or the robot's own earlier one.
pub fn corrected(d: &Diagnosis) -> &'static str {
    match d.compared {
        None => "simulator",
        Some(_) => "earlier model",
    }
}

/// Text on parameters held at a bound, and the cost of the bounds.
pub fn bounds(b: &Bounds) -> String {
    const NAMED: usize = 3;
    let held = match b.held.len() {
        0 => "coefficients that would be negative within their deviation".to_owned(),
        n if n <= NAMED + 1 => b.held.join(", "),
        n => format!("{} and {} more", b.held[..NAMED].join(", "), n - NAMED),
    };
    format!(
        "Held to what is possible: {held}; that costs {:.4} of mean NRMSE on the fitted recording.",
        b.cost.max(0.0)
    )
}

/// Text on a resonance. It precedes the causes, since friction or a delay may be blamed for it.
pub fn resonance(r: &Resonance) -> String {
    let when = match (r.in_motion, r.at_rest) {
        (true, true) => "in motion, and rings at rest",
        (false, true) => "rings at rest",
        _ => "in motion",
    };
    format!(
        "Resonance: {:.2} Hz ({:.2} Hz wide), {when}, on {}: what swings there is neither friction nor a delay.",
        r.frequency,
        r.width,
        r.joints.join(", ")
    )
}

/// Lines on further causes, those of one effect in one line.
fn also(head: &str, causes: &[&Cause]) -> Vec<String> {
    let mut groups: Vec<Vec<&Cause>> = Vec::new();
    for &cause in causes {
        match groups.iter_mut().find(|g| g[0].effect == cause.effect) {
            Some(group) => group.push(cause),
            None => groups.push(vec![cause]),
        }
    }
    let one = |cause: &&Cause| {
        let size = cause.parameters.first().map(|p| format!("{}, ", value(p)));
        format!(
            "{} ({}closes {:.0} %)",
            place(cause),
            size.unwrap_or_default(),
            100.0 * cause.gap_closed
        )
    };
    let line = |group: Vec<&Cause>| match group.as_slice() {
        [cause] => format!("{head}: {}; {}.", sentence(cause), closes(cause)),
        several => {
            let list: Vec<String> = several.iter().map(one).collect();
            format!(
                "{head}: {} on {}.",
                plain(several[0].effect),
                list.join(", ")
            )
        }
    };
    groups.into_iter().map(line).collect()
}

/// Lines on ambiguous names, causes with the same rivals together.
fn ambiguities(d: &Diagnosis) -> Vec<String> {
    let mut groups: Vec<Vec<&Cause>> = Vec::new();
    for cause in d.causes.iter().filter(|c| !c.ambiguous_with.is_empty()) {
        let same = |c: &Cause| c.effect == cause.effect && c.ambiguous_with == cause.ambiguous_with;
        match groups.iter_mut().find(|g| same(g[0])) {
            Some(group) => group.push(cause),
            None => groups.push(vec![cause]),
        }
    }
    let next = match d.next_experiment {
        None => " --next FILE.csv writes the best motion for it.",
        Some(_) => "",
    };
    let line = |group: Vec<&Cause>| {
        let joints: Vec<String> = group.iter().map(|c| c.joints.join(", ")).collect();
        let rivals: Vec<&str> = group[0].ambiguous_with.iter().map(|e| plain(*e)).collect();
        format!(
            "Cannot be told apart here: {} on {} and {}. {}{next}",
            plain(group[0].effect),
            joints.join(", "),
            rivals.join(" or "),
            experiment(group[0]),
        )
    };
    groups.into_iter().map(line).collect()
}

/// Lines on causes that wider tolerances of the description would absorb.
fn supposed(d: &Diagnosis) -> Vec<String> {
    let one = |cause: &Cause| {
        let right_to = cause.right_to.filter(|_| d.compared.is_none())?;
        Some(format!(
            "Supposes that the description's inertial parameters are right to {:.0} %: {} on {}; were they further off, they would be the answer.",
            100.0 * right_to,
            plain(cause.effect),
            place(cause),
        ))
    };
    d.causes.iter().filter_map(one).collect()
}

/// Lines on faults of the recordings, severe ones only: no cause can be trusted before they are corrected.
pub fn worst_findings(d: &Diagnosis) -> Vec<String> {
    let of = |report: &CheckReport| -> Vec<String> {
        let severe = |s: Severity| s == Severity::Severe;
        let found = report.findings.iter().filter(|f| severe(f.severity));
        let found = found.map(|f| f.message.clone());
        let complaints = report.doctor.iter().filter(|c| severe(c.severity));
        let complaints = complaints.map(|c| {
            let mend = "`train --check-only` gives the lines that mend it";
            format!("{}: {}; {mend}", c.means, c.seen)
        });
        let all = found.chain(complaints);
        all.map(|what| format!("In {}: {what}.", report.source))
            .collect()
    };
    d.recordings.iter().flat_map(of).collect()
}

/// Lines on effects that the recording cannot show, those with the same reason together.
pub fn unknowable(d: &Diagnosis) -> Vec<String> {
    let mut out: Vec<(String, Vec<&str>)> = Vec::new();
    for n in &d.not_identifiable {
        let effect = n.effect.map_or("anything at all", plain);
        match out.iter_mut().find(|(reason, _)| *reason == n.reason) {
            Some((_, effects)) => effects.push(effect),
            None => out.push((n.reason.clone(), vec![effect])),
        }
    }
    let say = |(reason, effects): (String, Vec<&str>)| {
        let list = if effects.len() == Effect::ALL.len() {
            "any effect".to_owned()
        } else {
            effects.join(", ")
        };
        format!("Cannot be known: {list}: {reason}.")
    };
    out.into_iter().map(say).collect()
}

/// Text on the error that is left at a step of the ladder.
fn remainder(d: &Diagnosis) -> Option<String> {
    let mean = |name: &str| {
        d.ladder
            .iter()
            .find(|s| s.step == name)
            .and_then(|s| s.all.mean_nrmse)
    };
    let learned =
        mean("learned").map(|l| format!("a learned compensator would bring it to {l:.3}"));
    let floor = mean("repeatability")
        .map(|f| format!("repeated motions differ by {f:.3} among themselves"));
    let parts: Vec<String> = learned.into_iter().chain(floor).collect();
    (!parts.is_empty()).then(|| format!("Of the mean NRMSE, {}.", parts.join("; ")))
}

/// Text on the purpose of the designed motion.
fn experiment_designed(n: &NextExperiment) -> String {
    let [own, rival] = n.effects.map(plain);
    format!(
        "Run the motion of {:.0} s that --next wrote and add it to --data: it tells {own} from {rival} with a likelihood ratio \
         of e^{:.0}, where the recorded data reach e^{:.1} at most.",
        n.seconds, n.evidence_expected, n.evidence_recorded
    )
}

/// Text on the gap as motion.
pub fn motion(s: &Simulation, joints: &[String]) -> String {
    let (before, after) = (&s.closed_loop.before, &s.closed_loop.after);
    let worst = (0..before.len()).max_by(|&a, &b| before[a].total_cmp(&before[b]));
    let tracking = worst.map_or(String::new(), |j| {
        format!(
            "; with the model's torque as feed-forward, {} is off its path by {:.2e} as given, {:.2e} as explained (rad or m, \
             position feedback of {:.0} Hz)",
            joints[j], before[j], after[j], s.closed_loop.bandwidth_hz
        )
    });
    format!(
        "In motion: under the recorded torque the simulated robot follows the real one for {:.2} s as given, {:.2} s as \
         explained (median of {} runs of at most {:.0} s){tracking}.",
        s.free.before_s, s.free.after_s, s.free.starts, s.free.longest_s
    )
}

fn verdict(d: &Diagnosis) -> String {
    let nrmse = |step: Option<&Step>| {
        let mean = step.and_then(|s| s.all.mean_nrmse);
        mean.map_or("unknown".to_owned(), |m| format!("{m:.3}"))
    };
    let last = d
        .ladder
        .iter()
        .rfind(|s| s.step != "learned" && s.step != "repeatability");
    let figures = match d.no_gap_as_given {
        Some(why) => format!(
            "{why}, so that there is no gap as given to judge; mean NRMSE on held-out data {} with masses learned",
            nrmse(last)
        ),
        None => format!(
            "mean NRMSE on held-out data {} as given, {} explained",
            nrmse(d.ladder.first()),
            nrmse(last)
        ),
    };
    let since = d.compared.is_some();
    let says = match d.verdict {
        Verdict::NoGap if since => "Nothing has changed beyond noise",
        Verdict::Explained if since => "What has changed is explained",
        Verdict::PartlyExplained if since => "What has changed is explained in part",
        Verdict::NoGap => {
            "Nothing is missing: what separates model and recording is noise and small parameter changes"
        }
        Verdict::Explained => "The gap is explained",
        Verdict::PartlyExplained => "The gap is explained in part",
        Verdict::UnknownEffect => {
            let worst = d
                .unexplained
                .iter()
                .max_by(|a, b| a.nrmse.unwrap_or(0.0).total_cmp(&b.nrmse.unwrap_or(0.0)));
            let place = worst.map_or("", |w| w.joint.as_str());
            let what = if since {
                "Something has changed that is none of what is looked for"
            } else {
                "Something is there that the catalogue does not know"
            };
            return format!("{what}, on {place} ({figures}).");
        }
        Verdict::CannotTell => {
            let reason = d.reason.as_deref().unwrap_or_default();
            return format!("This recording does not say: {reason} ({figures}).");
        }
    };
    format!("{says} ({figures}).")
}
