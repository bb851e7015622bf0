//! Topics with clocks of their own, brought to the clock of the positions: the one place where values are interpolated.

use crate::Problem;

/// Number of median steps from which a hole between messages is not interpolated over.
const HOLE_STEPS: i64 = 10;

/// Messages of one topic, as columns on their own clock.
#[derive(Debug)]
pub(super) struct Series {
    pub name: String,
    /// Times of the messages, ns, increasing.
    pub times: Vec<i64>,
    pub columns: Vec<Vec<f64>>,
}

/// Interpolates the columns of `others` at the times of `base`, linearly between the messages on either side. Messages
/// of `base` outside the time of the others, or within a hole in it, are left out. Returns the number of messages left
/// out.
///
/// # Errors
/// The topics share no time.
pub(super) fn onto(base: &mut Series, others: &mut [Series]) -> Result<usize, Problem> {
    let places: Vec<Vec<Option<Place>>> = others.iter().map(|o| places(&base.times, o)).collect();
    let kept: Vec<usize> = (0..base.times.len())
        .filter(|&row| places.iter().all(|p| p[row].is_some()))
        .collect();
    if kept.is_empty() {
        let apart = places.iter().position(|p| p.iter().all(Option::is_none));
        return Err(Problem::NoOverlap {
            base: base.name.clone(),
            other: others[apart.unwrap_or(0)].name.clone(),
        });
    }
    for (other, places) in others.iter_mut().zip(&places) {
        for column in &mut other.columns {
            *column = kept
                .iter()
                .filter_map(|&row| Some(places[row]?.value(column)))
                .collect();
        }
    }
    let dropped = base.times.len() - kept.len();
    if dropped > 0 {
        for column in &mut base.columns {
            *column = kept.iter().map(|&row| column[row]).collect();
        }
        base.times = kept.iter().map(|&row| base.times[row]).collect();
    }
    Ok(dropped)
}

/// Place of a time between two neighbouring messages.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    before: usize,
    /// Fraction of the way from this message to the next, 0 to 1.
    share: f64,
}

impl Place {
    fn value(self, column: &[f64]) -> f64 {
        let first = column[self.before];
        if self.share == 0.0 {
            return first;
        }
        first + self.share * (column[self.before + 1] - first)
    }
}

fn places(base: &[i64], other: &Series) -> Vec<Option<Place>> {
    let times = &other.times;
    let mut steps: Vec<i64> = times
        .windows(2)
        .map(|w| w[1].saturating_sub(w[0]))
        .collect();
    let middle = steps.len() / 2;
    let usual = steps
        .get(middle)
        .is_some()
        .then(|| *steps.select_nth_unstable(middle).1);
    let longest = usual.map_or(0, |u| u.saturating_mul(HOLE_STEPS));
    base.iter()
        .map(|&t| {
            let after = times.partition_point(|&o| o <= t);
            let before = after.checked_sub(1)?;
            if times[before] == t {
                return Some(Place { before, share: 0.0 });
            }
            let length = times.get(after)?.saturating_sub(times[before]);
            (length <= longest).then(|| Place {
                before,
                share: (t - times[before]) as f64 / length as f64,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(times: &[i64], column: &[f64]) -> Series {
        Series {
            name: "/t".into(),
            times: times.to_vec(),
            columns: vec![column.to_vec()],
        }
    }

    #[test]
    fn between_messages() {
        let mut base = series(&[0, 10, 15, 20, 40], &[0.0, 1.0, 2.0, 3.0, 4.0]);
        let mut others = [series(&[10, 20, 30], &[1.0, 3.0, 9.0])];
        assert_eq!(onto(&mut base, &mut others).unwrap(), 2);
        assert_eq!(base.times, [10, 15, 20]);
        assert_eq!(base.columns, [vec![1.0, 2.0, 3.0]]);
        assert_eq!(others[0].columns, [vec![1.0, 2.0, 3.0]]);
    }

    #[test]
    fn not_over_holes_and_not_without_overlap() {
        let times: Vec<i64> = (0..20).chain(200..220).collect();
        let values = vec![1.0; 40];
        let mut base = series(&[5, 100, 205], &[0.0; 3]);
        assert_eq!(onto(&mut base, &mut [series(&times, &values)]).unwrap(), 1);
        assert_eq!(base.times, [5, 205]);
        let mut base = series(&[500, 600], &[0.0; 2]);
        let apart = onto(&mut base, &mut [series(&times, &values)]);
        assert!(matches!(apart, Err(Problem::NoOverlap { .. })));
    }
}
