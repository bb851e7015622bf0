//! Time stamps as people write them: which clock, in which unit, from text.

/// Clock of a table: one column of time stamps.
pub(crate) struct Clock {
    /// Name of the clock's column.
    pub name: String,
    /// Time stamps as the table has them, in its unit.
    pub stamps: Vec<f64>,
    /// Seconds per unit, where it is known.
    pub unit: Option<f64>,
}

/// Clock that is taken, in s, with messages for the user on the choice.
pub(crate) struct Chosen {
    pub name: String,
    pub seconds: Vec<f64>,
    pub notes: Vec<String>,
}

/// Rates that robots are logged at, Hz. They span a factor of a thousand, so that of s, ms, µs and ns one alone fits.
const RATES: [f64; 2] = [5.0, 5000.0];
/// Median step from which stamps cannot be seconds: a robot's motion would not be resolved.
const NO_SECONDS: f64 = 1.0;

/// Takes the steadiest of the clocks; those that stand still or go back inside a trajectory come last.
///
/// `breaks` are the rows at which a trajectory begins: at a change of label, whatever the clock does there.
pub(crate) fn choose(clocks: Vec<Clock>, breaks: &[usize]) -> Option<Chosen> {
    let count = clocks.len();
    let names: Vec<String> = clocks.iter().map(|c| format!("`{}`", c.name)).collect();
    let judged = clocks
        .into_iter()
        .map(|c| (unsteadiness(&c.stamps, breaks), c));
    // The first of equals: the plainest name.
    let (_, best) = judged.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let mut notes = Vec::new();
    if count > 1 {
        notes.push(format!(
            "of the clocks {} `{}` is taken, the steadiest",
            names.join(", "),
            best.name
        ));
    }
    let unit = best.unit.unwrap_or_else(|| {
        let step = median_step(&best.stamps, breaks);
        let unit = usual_unit(step);
        if unit < 1.0 {
            notes.push(format!(
                "`{}` rises by {step} a row, which can be no seconds: read in {}, {:.0} Hz; a drive file can say units.time",
                best.name,
                name_of(unit),
                1.0 / (step * unit)
            ));
        }
        unit
    });
    let first = best.stamps.first().copied().unwrap_or(0.0);
    // Differences first: of an epoch in ns little would be left behind a product.
    let seconds = best
        .stamps
        .iter()
        .map(|t| (t - first) * unit + first * unit);
    Some(Chosen {
        name: best.name,
        seconds: if unit == 1.0 {
            best.stamps
        } else {
            seconds.collect()
        },
        notes,
    })
}

fn name_of(unit: f64) -> &'static str {
    match unit {
        u if u < 1e-8 => "ns",
        u if u < 1e-5 => "µs",
        _ => "ms",
    }
}

/// Seconds per unit of stamps with this median step.
fn usual_unit(step: f64) -> f64 {
    if !step.is_finite() || step < NO_SECONDS {
        return 1.0;
    }
    [1e-3, 1e-6, 1e-9]
        .into_iter()
        .find(|unit| {
            let rate = 1.0 / (step * unit);
            rate > RATES[0] && rate <= RATES[1]
        })
        .unwrap_or(1.0)
}

fn steps<'a>(stamps: &'a [f64], breaks: &'a [usize]) -> impl Iterator<Item = f64> + 'a {
    let within = (1..stamps.len()).filter(|row| breaks.binary_search(row).is_err());
    within.map(|row| stamps[row] - stamps[row - 1])
}

fn median_step(stamps: &[f64], breaks: &[usize]) -> f64 {
    signal::quantile::median(steps(stamps, breaks).collect()).unwrap_or(f64::NAN)
}

/// Mean deviation of the steps over the median step; infinite where a clock does not run forward.
fn unsteadiness(stamps: &[f64], breaks: &[usize]) -> f64 {
    if steps(stamps, breaks).any(|s| s.is_nan() || s <= 0.0) {
        return f64::INFINITY;
    }
    let step = median_step(stamps, breaks);
    let off: f64 = steps(stamps, breaks).map(|s| (s - step).abs()).sum();
    off / (step * stamps.len() as f64)
}

/// Seconds since 1970 of a stamp like `2026-03-02T08:00:00.020Z` (ISO 8601: blank for `T`, comma for point, an offset
/// from UTC), or of a time of day alone. None for any other text.
pub(crate) fn from_text(text: &str) -> Option<f64> {
    let text = text.trim();
    let (date, clock) = match text.split_once(['T', ' ']) {
        Some((date, clock)) => (Some(date), clock.trim()),
        None => (None, text),
    };
    let days = match date {
        Some(date) => {
            let mut parts = date.splitn(3, '-');
            let mut next = || parts.next()?.parse::<i64>().ok();
            days_since_1970(next()?, next()?, next()?)?
        }
        None => 0,
    };
    let (clock, offset) = match clock.rfind(['Z', 'z', '+', '-']) {
        Some(at) => (&clock[..at], zone(&clock[at..])?),
        None => (clock, 0.0),
    };
    let mut parts = clock.splitn(3, ':');
    let hours: i64 = parts.next()?.parse().ok()?;
    let minutes: i64 = parts.next()?.parse().ok()?;
    let seconds: f64 = match parts.next() {
        Some(seconds) => seconds.replace(',', ".").parse().ok()?,
        None => 0.0,
    };
    let possible =
        (0..=24).contains(&hours) && (0..60).contains(&minutes) && (0.0..61.0).contains(&seconds);
    possible.then(|| (days * 86_400 + hours * 3600 + minutes * 60) as f64 + seconds - offset)
}

/// Seconds east of UTC of `Z`, `+01:00` or `-0730`.
fn zone(text: &str) -> Option<f64> {
    let (sign, rest) = match text.split_at(1) {
        ("Z" | "z", "") => return Some(0.0),
        ("+", rest) => (1.0, rest),
        ("-", rest) => (-1.0, rest),
        _ => return None,
    };
    let digits: String = rest.chars().filter(|c| *c != ':').collect();
    let number: u32 = digits.parse().ok()?;
    let (hours, minutes) = match digits.len() {
        2 => (number, 0),
        4 => (number / 100, number % 100),
        _ => return None,
    };
    Some(sign * f64::from(hours * 3600 + minutes * 60))
}

/// Days since 1970 of a date of the Gregorian calendar, by the algorithm of Hinnant ("chrono-compatible low-level date algorithms").
fn days_since_1970(year: i64, month: i64, day: i64) -> Option<i64> {
    if !((1..=9999).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day)) {
        return None;
    }
    let year = if month <= 2 { year - 1 } else { year };
    let era = year / 400;
    let of_era = year - era * 400;
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    Some(era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_of_iso_8601() {
        // date -u -d 2026-03-02T08:00:00Z +%s
        for (text, seconds) in [
            ("2026-03-02T08:00:00Z", 1_772_438_400.0),
            ("2026-03-02 08:00:00.250", 1_772_438_400.25),
            ("2026-03-02T09:00:00,5+01:00", 1_772_438_400.5),
            ("1970-01-01T00:00:01Z", 1.0),
            ("2000-02-29T00:00Z", 951_782_400.0),
            ("08:00:00.02", 28_800.02),
        ] {
            assert_eq!(from_text(text), Some(seconds), "{text}");
        }
        for text in [
            "",
            "1.5",
            "run 3",
            "2026-13-02T08:00:00Z",
            "25:00:00",
            "a:b:c",
            "12:30:00+1",
        ] {
            assert_eq!(from_text(text), None, "{text}");
        }
    }

    fn clock(name: &str, stamps: impl Iterator<Item = f64>) -> Clock {
        Clock {
            name: name.to_owned(),
            stamps: stamps.collect(),
            unit: None,
        }
    }

    #[test]
    fn the_steadiest_clock_in_its_unit() {
        let rows = || (0..100).map(f64::from);
        for (step, unit) in [
            (0.01, 1.0),
            (10.0, 1e-3),
            (1.0, 1e-3),
            (5e3, 1e-6),
            (2e6, 1e-9),
        ] {
            let own = clock("stamp", rows().map(|k| 1.7e9 + k * step));
            let found = choose(vec![own], &[]).unwrap();
            let read = (found.seconds[99] - found.seconds[0]) / 99.0;
            assert!((read / (step * unit) - 1.0).abs() < 1e-3, "{step}: {read}");
            assert_eq!(found.notes.is_empty(), unit == 1.0);
        }
        let steady = clock("robot", rows().map(|k| k * 0.01));
        let rough = clock("host", rows().map(|k| k * 0.01 + 0.003 * (k % 3.0)));
        let stuck = clock("sensor", rows().map(|k| (k / 2.0).floor() * 0.02));
        let found = choose(vec![stuck, rough, steady], &[]).unwrap();
        assert_eq!(found.name, "robot");
        assert!(found.notes[0].contains("`host`"), "{:?}", found.notes);
    }
}
