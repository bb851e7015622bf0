//! Clock of the messages, and the messages at which it starts anew.

use super::topic::Topic;
use crate::Problem;

/// Number of median steps from which a step back is a clock that was set anew. A shorter one is messages out of order.
const RESET_STEPS: i64 = 10;

/// Times of the messages of each topic.
#[derive(Debug)]
pub(super) struct Times {
    /// Times of the messages, ns, topic by topic.
    pub times: Vec<Vec<i64>>,
    /// Messages of the first topic at which the clock starts anew.
    pub resets: Vec<usize>,
    /// Reason why the clock is not that of the headers.
    pub note: Option<String>,
}

/// A clock seen over all messages.
enum Course {
    /// Increasing, but for the messages at which it starts anew.
    Runs(Vec<usize>),
    /// Clock that does not increase: index of the first message that is not later than the one before.
    Stands(usize),
}

/// The header stamps where all topics have them and they increase, else the times of the log.
///
/// # Errors
/// Neither increases, or a clock is set back that others are to be aligned with; with the message.
pub(super) fn times(topics: &mut [Topic]) -> Result<Times, (Problem, usize)> {
    let stamps = topics.iter().map(|t| (t, stamped(t)));
    let reason = stamps
        .into_iter()
        .find_map(|(topic, fault)| Some(format!("`{}` {}", topic.name, fault?)));
    let times: Vec<Vec<i64>> = topics
        .iter_mut()
        .map(|t| {
            let stamps = std::mem::take(&mut t.stamps);
            let logged = std::mem::take(&mut t.logged);
            if reason.is_some() { logged } else { stamps }
        })
        .collect();
    let mut resets = Vec::new();
    for (topic, times) in topics.iter().zip(&times) {
        match course(times) {
            Course::Runs(anew) if anew.is_empty() => {}
            Course::Runs(anew) if topics.len() == 1 => resets = anew,
            Course::Runs(anew) => return Err((backwards(topic, times, anew[0]), anew[0])),
            Course::Stands(row) => return Err((backwards(topic, times, row), row)),
        }
    }
    Ok(Times {
        times,
        resets,
        note: reason.map(|r| format!("time is that of the log, for {r}")),
    })
}

/// Objection to the header stamps of a topic; none where they are usable.
fn stamped(topic: &Topic) -> Option<String> {
    if topic.stamps.contains(&0) {
        return Some("has messages without header stamp".to_owned());
    }
    match course(&topic.stamps) {
        Course::Runs(_) => None,
        Course::Stands(row) => Some(format!(
            "has a header stamp in message {} that is not after the one before",
            row + 1
        )),
    }
}

fn backwards(topic: &Topic, times: &[i64], row: usize) -> Problem {
    let second = |i: usize| times[i].saturating_sub(times[0]) as f64 * 1e-9;
    Problem::Backwards {
        topic: topic.name.clone(),
        from: second(row - 1),
        to: second(row),
    }
}

fn course(times: &[i64]) -> Course {
    let step = |i: usize| times[i].saturating_sub(times[i - 1]);
    let back: Vec<usize> = (1..times.len()).filter(|&i| step(i) <= 0).collect();
    if back.is_empty() {
        return Course::Runs(back);
    }
    let mut forward: Vec<i64> = (1..times.len()).map(step).filter(|&s| s > 0).collect();
    if forward.is_empty() {
        return Course::Stands(1);
    }
    let middle = forward.len() / 2;
    let usual = *forward.select_nth_unstable(middle).1;
    let reset = |&&i: &&usize| step(i) >= usual.saturating_mul(-RESET_STEPS);
    match back.iter().find(reset) {
        Some(&row) => Course::Stands(row),
        None => Course::Runs(back),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topic(stamps: Vec<i64>, logged: Vec<i64>) -> Topic {
        let mut topic = Topic::new("/t".into(), "a/B".into(), Vec::new());
        (topic.stamps, topic.logged) = (stamps, logged);
        topic
    }

    #[test]
    fn stamps_before_the_log() {
        let mut good = [topic(vec![5, 7, 9], vec![1, 2, 3])];
        let chosen = times(&mut good).unwrap();
        assert_eq!(chosen.times, [vec![5, 7, 9]]);
        assert!(chosen.note.is_none());
        for stamps in [vec![0, 0, 0], vec![5, 5, 6]] {
            let chosen = times(&mut [topic(stamps, vec![1, 2, 3])]).unwrap();
            assert_eq!(chosen.times, [vec![1, 2, 3]]);
            assert!(chosen.note.is_some());
        }
        // One topic without stamps, and all are on the clock of the log.
        let mut two = [
            topic(vec![5, 7, 9], vec![1, 2, 3]),
            topic(vec![0, 0], vec![1, 3]),
        ];
        assert_eq!(times(&mut two).unwrap().times, [vec![1, 2, 3], vec![1, 3]]);
        let (problem, row) = times(&mut [topic(vec![0, 0], vec![4, 4])]).unwrap_err();
        assert!(matches!(problem, Problem::Backwards { .. }) && row == 1);
    }

    #[test]
    fn a_clock_that_is_set_anew_starts_a_trajectory() {
        let mut stamps: Vec<i64> = (1..30).collect();
        stamps.extend(1..20);
        let logged: Vec<i64> = (0..48).collect();
        let once = times(&mut [topic(stamps.clone(), logged.clone())]).unwrap();
        assert_eq!(once.resets, [29]);
        // Not where another topic is to be put on the same clock.
        let mut two = [
            topic(stamps, logged.clone()),
            topic(logged.iter().map(|t| t + 1).collect(), logged),
        ];
        assert_eq!(times(&mut two).unwrap_err().1, 29);
    }
}
