//! Text on one cause: effect, part of the gap that it closes, numbers to set.

use crate::catalogue::effect::Effect;
use crate::catalogue::experiment::Experiment;
use crate::catalogue::{Parameter, REFERENCE};
use crate::schema::Cause;
use crate::schema::value::value;

/// Sentence with cause, joint and size.
pub fn sentence(cause: &Cause) -> String {
    let of = |p: &Parameter| match &p.joint {
        // A time is on no joint.
        _ if cause.effect.info().outside => format!(", {}", value(p)),
        Some(joint) if cause.joints.len() > 1 => format!(", {} on {joint}", value(p)),
        _ => format!(", {}", value(p)),
    };
    let size = cause.parameters.first().map_or(String::new(), of);
    let remark = cause.remark.map_or(String::new(), |r| format!(" ({r})"));
    format!("{} on {}{size}{remark}", what(cause), place(cause))
}

/// Name of a cause's effect in plain words.
fn what(cause: &Cause) -> &'static str {
    if cause.parameters.iter().any(|p| p.name == REFERENCE) {
        "friction that goes with the joint's temperature"
    } else {
        plain(cause.effect)
    }
}

/// Joints of a cause, with the driver of a coupling.
pub(super) fn place(cause: &Cause) -> String {
    let driver = cause
        .driver
        .as_ref()
        .map_or(String::new(), |d| format!(" driven by {d}"));
    format!("{}{driver}", cause.joints.join(", "))
}

/// Part of the gap that the cause closes, and the confidence of its name, as text.
pub fn closes(cause: &Cause) -> String {
    let interval = cause
        .gap_closed_interval
        .map_or(String::new(), |[low, high]| {
            format!(" ({}–{} %)", percent(low), percent(high))
        });
    let sure = cause.confidence.map_or(String::new(), |c| {
        // Sixty cases show no certainty.
        let least = if c > 0.99 {
            "over 0.99".to_owned()
        } else {
            format!("{c:.2}")
        };
        format!(", rightly named with a probability of {least}")
    });
    format!(
        "closes {} % of the gap of {} on held-out data{interval}{sure}",
        percent(cause.gap_closed),
        cause.joints.join(", ")
    )
}

/// A part in whole per cent, without negative zero.
fn percent(part: f64) -> f64 {
    (100.0 * part).round() + 0.0
}

/// The effect's name as a heading.
pub fn name(effect: Effect) -> String {
    let name = effect.name().replace('_', " ");
    name.replace("stribeck", "Stribeck")
}

/// The effect's name in plain words.
pub fn plain(effect: Effect) -> &'static str {
    effect.info().plain
}

/// Advice on the simulator's settings, in one line.
pub fn told(cause: &Cause) -> String {
    let lines = advice(cause).into_iter();
    lines
        .reduce(|said, line| joined(&said, &line))
        .unwrap_or_default()
}

/// Two lines joined into one; a line that begins as a sentence stays one.
pub fn joined(said: &str, line: &str) -> String {
    let (said, line) = (said.trim_end_matches('.'), line.trim());
    let mark = match line.chars().next() {
        _ if said.ends_with(':') => "",
        Some(first) if first.is_uppercase() => ".",
        _ => ";",
    };
    format!("{said}{mark} {line}")
}

/// Advice on the simulator's settings; values of several joints follow joint by joint.
pub fn advice(cause: &Cause) -> Vec<String> {
    let mut joints: Vec<&str> = Vec::new();
    for name in cause.parameters.iter().filter_map(|p| p.joint.as_deref()) {
        if !joints.contains(&name) {
            joints.push(name);
        }
    }
    if joints.len() < 2 {
        let size: Vec<String> = cause.parameters.iter().take(4).map(value).collect();
        return vec![remedy(cause.effect, &size.join(", "))];
    }
    let own = |name: &str| {
        let own = cause
            .parameters
            .iter()
            .filter(|p| p.joint.as_deref() == Some(name));
        format!(
            "  {name}: {}",
            own.map(value).collect::<Vec<_>>().join(", ")
        )
    };
    let head = format!("{}:", remedy(cause.effect, "joint by joint"));
    std::iter::once(head)
        .chain(joints.into_iter().map(own))
        .collect()
}

/// Advice on the simulator's settings, with `size` inserted.
fn remedy(effect: Effect, size: &str) -> String {
    effect.info().remedy.replace("{}", size)
}

/// The motion that would separate the cause from its rivals.
pub(super) fn experiment(cause: &Cause) -> &'static str {
    let rivals = || std::iter::once(&cause.effect).chain(&cause.ambiguous_with);
    let all = rivals().flat_map(|effect| {
        let info = effect.info();
        let pairs = info.experiments.iter();
        let pairs = pairs.filter(|(other, _)| rivals().any(|r| r == other));
        pairs.map(|p| p.1).chain([info.experiment])
    });
    all.min().unwrap_or(Experiment::Reversals).text()
}
