//! Report in words, for a terminal and for the page.

use crate::schema::{Cause, REPEATABILITY, Report, Step, Value};
use crate::score::Figures;

/// Verdict of the report in one sentence, with the error as given and as corrected.
pub fn verdict(report: &Report) -> String {
    let part = |step: Option<&Step>| step.and_then(|s| s.figures.mean_unexplained);
    let (first, last) = (part(report.ladder.first()), part(report.corrected()));
    let changed = report.corrected().is_some_and(|s| s.step != "as_given");
    let model = if report.compared.is_some() {
        "The robot as it was before"
    } else {
        "The simulator as given"
    };
    let figures = match (first, last) {
        (Some(a), Some(b)) if changed => format!(
            "{model} leaves {:.0} % of the departure from the commands unexplained, the corrected one {:.0} %",
            100.0 * a,
            100.0 * b
        ),
        (Some(a), _) => format!(
            "{model} leaves {:.0} % of the departure from the commands unexplained",
            100.0 * a
        ),
        _ => "No joint departs from its commands".to_owned(),
    };
    let meaning = match report.verdict {
        "no_gap" if report.compared.is_some() => "nothing has changed that this motion shows",
        "explained" if report.compared.is_some() => "the causes below are what has changed",
        "partly_explained" if report.compared.is_some() => {
            "the causes below have changed, and more without a clear pattern"
        }
        "no_gap" => "nothing is missing that this motion shows",
        "explained" if report.causes.is_empty() => {
            "given values within their tolerance explain the motion"
        }
        "explained" => "the causes below explain the motion",
        "partly_explained" => "more is left than noise, without a clear pattern",
        "unknown_effect" => "something is left that no effect of the catalogue explains",
        _ => "this motion does not say what is missing",
    };
    format!("{figures}: {meaning}.")
}

/// Cause in one line: joints, part of the squared error removed, and probability. `words` names the effect.
pub fn cause(cause: &Cause, words: &str) -> String {
    let [low, high] = cause.gap_closed_interval;
    let confirmed = if cause.confirmed {
        ""
    } else {
        ", not confirmed on held-out data"
    };
    let driver = cause
        .driver
        .as_ref()
        .map_or(String::new(), |j| format!(", driven by {j}"));
    let change = if cause.gap_closed < 0.0 {
        "held out it adds"
    } else {
        "removes"
    };
    format!(
        "{words} on {}{driver}: {change} {:.0} % of the squared error there ({:.0} to {:.0} %), probability {:.2}{confirmed}",
        cause.joints.join(", "),
        100.0 * cause.gap_closed.abs(),
        100.0 * low,
        100.0 * high,
        cause.confidence
    )
}

/// Value of a parameter in one line: given value, fitted value, standard deviation and unit.
pub fn value(value: &Value) -> String {
    let place = value
        .joint
        .as_ref()
        .map_or(String::new(), |j| format!("{j} "));
    let std = value
        .std
        .map_or(String::new(), |s| format!(" ± {}", number(s)));
    format!(
        "{place}{}: {} → {}{std} {}",
        value.name,
        number(value.given),
        number(value.value),
        value.unit
    )
}

/// Number with three significant digits.
pub fn number(v: f64) -> String {
    if v == 0.0 || !v.is_finite() {
        return format!("{v}");
    }
    let digits = 2 - v.abs().log10().floor() as i32;
    if (-3..=6).contains(&digits) {
        format!("{v:.*}", digits.max(0) as usize)
    } else {
        format!("{v:.2e}")
    }
}

/// What the corrected simulator leaves where its values are fitted to the held-out recording itself, in one sentence.
pub fn ceiling(figures: &Figures) -> Option<String> {
    let part = figures.mean_unexplained?;
    Some(format!(
        "Fitted to the held-out recording itself, the same effects leave {:.1} %.",
        100.0 * part
    ))
}

/// Report as lines for a terminal. `words` turns an effect's name into plain words.
pub fn lines(report: &Report, words: impl Fn(&str) -> &'static str) -> Vec<String> {
    let mut out = vec![verdict(report)];
    for (k, c) in report.causes.iter().enumerate() {
        out.push(format!("{}. {}", k + 1, cause(c, words(c.effect))));
        for v in &c.parameters {
            out.push(format!("     {}", value(v)));
        }
        if !c.ambiguous_with.is_empty() {
            let others: Vec<&str> = c.ambiguous_with.iter().map(|n| words(n)).collect();
            out.push(format!("     could also be: {}", others.join(", ")));
        }
    }
    let floor = report.ladder.iter().find(|s| s.step == REPEATABILITY);
    if let Some(part) = floor.and_then(|s| s.figures.mean_unexplained) {
        out.push(format!(
            "Executions of one motion differ by {:.1} % of the departure from the commands.",
            100.0 * part
        ));
    }
    out.extend(report.ceiling.as_ref().and_then(ceiling));
    for unknown in &report.unknown {
        out.push(format!(
            "Something unknown on {}, probability {:.2}.",
            unknown.joint, unknown.probability
        ));
    }
    for place in report.places.iter().take(3) {
        out.push(format!(
            "Where: {} at {} {} to {} {}: {:.0} % of the gap in {:.0} % of the time.",
            place.joint,
            place.coordinate,
            number(place.range[0]),
            number(place.range[1]),
            place.unit,
            100.0 * place.share_of_gap,
            100.0 * place.share_of_time
        ));
    }
    for item in &report.not_identifiable {
        out.push(format!("Not known: {}.", item.reason));
    }
    out
}
