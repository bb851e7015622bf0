//! Report in words, for a terminal and for the page.

mod not_known;

pub use not_known::not_known;

use crate::schema::{Cause, Place, REPEATABILITY, Report, Step, Value};
use crate::score::Figures;
use std::path::PathBuf;

/// How a corrected model is written, for a report without one.
const OFFERED: &str = "--patch OUT writes it (in Python report.patch)";

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
    let confirmed = if cause.confirmed {
        ""
    } else {
        ", not confirmed on held-out data"
    };
    let driver = cause
        .driver
        .as_ref()
        .map_or(String::new(), |j| format!(", driven by {j}"));
    format!(
        "{words} on {}{driver}: {}, probability {:.2}{confirmed}",
        cause.joints.join(", "),
        removed(cause.gap_closed, cause.gap_closed_interval),
        cause.confidence
    )
}

/// Part of a squared error that a cause removes, in words; what makes the error larger adds to it. The cause has been left out and
/// all else fitted again: where nothing is lost by that, other values take its place.
fn removed(part: f64, [low, high]: [f64; 2]) -> String {
    let said = |verb: &str, sign: f64, values: [f64; 3]| {
        // Adding zero takes the sign off a rounded minus zero.
        let [part, low, high] = values.map(|v| (sign * v).round() + 0.0);
        format!("{verb} {part} % of the squared error there ({low} to {high} %)")
    };
    if low <= 0.0 && high >= 0.0 {
        format!(
            "without it all else, fitted again, may follow the motion as well: it {}",
            said("removes", 100.0, [part, low, high])
        )
    } else if part < 0.0 {
        said("held out it adds", -100.0, [part, high, low])
    } else {
        said("removes", 100.0, [part, low, high])
    }
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
    let unit = match unit(value.unit) {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    format!(
        "{place}{}: {} → {}{std}{unit}",
        value.name,
        value.given.map_or("none".to_owned(), number),
        number(value.value)
    )
}

/// Unit of a value as it is said: none of a pure number.
pub fn unit(unit: &str) -> &str {
    if unit == "1" { "" } else { unit }
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

/// What to do next, most urgent first: set the biggest cause's values, load the corrected model, tell ambiguous names apart. `words`
/// turns an effect's name into plain words; `patched` are the paths of the corrected model's files, the model first.
pub fn next(
    report: &Report,
    patched: &[PathBuf],
    words: impl Fn(&str) -> &'static str,
) -> Vec<String> {
    let load = patched.first().map(|path| path.display().to_string());
    let Some(first) = report.causes.iter().find(|c| c.confirmed) else {
        return vec![match report.verdict {
            "no_gap" => "Nothing has to change.".to_owned(),
            "explained" if report.causes.is_empty() => format!(
                "No effect is missing. Load the corrected model, whose values differ within their tolerance: {}.",
                load.unwrap_or(OFFERED.to_owned())
            ),
            "cannot_tell" => {
                let reason = report.reason.as_deref().unwrap_or("this motion says too little");
                format!("Record again: {}.", reason.trim_end_matches('.'))
            }
            _ => "Look where the gap lies, below, and record more motion there: fast and slow, in both directions, with load.".to_owned(),
        }];
    };
    let values: Vec<String> = first.parameters.iter().map(value).collect();
    let mut out = vec![format!(
        "For the biggest cause, {}, set: {}.",
        words(first.effect),
        values.join("; ")
    )];
    let left = report.file_alone.figures.mean_unexplained;
    let left = left.map_or(String::new(), |part| {
        format!(
            " Fitted for what it can hold, it leaves {:.0} % unexplained.",
            100.0 * part
        )
    });
    out.push(format!(
        "Or load the corrected model with every change that it can hold: {}.{left} python -m residyn.verify --replay replays the \
         commands on it in MuJoCo.",
        load.unwrap_or(OFFERED.to_owned())
    ));
    let confirmed = report.causes.iter().filter(|c| c.confirmed);
    for cause in confirmed.filter(|c| !c.ambiguous_with.is_empty()).take(1) {
        let others: Vec<&str> = cause.ambiguous_with.iter().map(|n| words(n)).collect();
        out.push(format!(
            "The name may be another: {} or {} on {}. Their pages in docs/effects say which motion tells them apart.",
            words(cause.effect),
            others.join(" or "),
            cause.joints.join(", ")
        ));
    }
    out
}

/// What the corrected simulator leaves where its values are fitted to the held-out recording itself, in one sentence.
pub fn ceiling(figures: &Figures) -> Option<String> {
    let part = figures.mean_unexplained?;
    Some(format!(
        "Fitted to the held-out recording itself, the same effects leave {:.1} %.",
        100.0 * part
    ))
}

/// Region of motion in words.
fn region(place: &Place) -> String {
    let [low, high] = place.range;
    match place.coordinate {
        "direction" if high < 0.0 => "moving backwards".to_owned(),
        "direction" => "moving forwards".to_owned(),
        coordinate => format!(
            "at {coordinate} {} to {} {}",
            number(low),
            number(high),
            place.unit
        ),
    }
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
    // Without a gap there is no place to name.
    let gap = report.verdict != "no_gap";
    for place in report.places.iter().filter(|_| gap).take(3) {
        out.push(format!(
            "Where: {} {}: {:.0} % of the whole arm's gap in {:.0} % of the time.",
            place.joint,
            region(place),
            100.0 * place.share_of_gap,
            100.0 * place.share_of_time
        ));
    }
    let open = not_known(&report.not_identifiable);
    out.extend(open.iter().map(|what| format!("Not known: {what}.")));
    out
}

#[cfg(test)]
mod tests {
    use super::removed;

    #[test]
    fn a_worsening_is_said_as_one() {
        assert_eq!(
            removed(0.9, [0.8, 0.95]),
            "removes 90 % of the squared error there (80 to 95 %)"
        );
        assert_eq!(
            removed(-0.24, [-0.3, -0.1]),
            "held out it adds 24 % of the squared error there (10 to 30 %)"
        );
    }

    #[test]
    fn a_cause_that_others_replace_is_said_to_be_replaced() {
        assert_eq!(
            removed(-0.001, [-0.02, 0.01]),
            "without it all else, fitted again, may follow the motion as well: it removes 0 % of the squared error there (-2 to 1 %)"
        );
    }
}
