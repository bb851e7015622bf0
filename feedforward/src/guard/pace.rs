//! Timing of the caller's ticks.

/// Timing of the caller's ticks since the last start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pace {
    /// Number of ticks whose time could be used.
    pub ticks: u64,
    /// Number of ticks that came a period late or more.
    pub late: u64,
    /// Number of periods that passed without a tick.
    pub missed: u64,
    /// Mean time from tick to tick, s.
    pub mean: f64,
    /// Longest time from tick to tick, s.
    pub longest: f64,
}

/// Meaning of a tick's time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tick {
    /// Tick of the next period, with the number of periods that passed without one.
    Next { missed: usize },
    /// Tick within the period of the last sample.
    Stale,
    /// Time before that of the last sample.
    Backward,
}

/// Clock of the caller's ticks, as the guard follows it.
#[derive(Debug, Clone, Default)]
pub(super) struct Clock {
    last: Option<f64>,
    pub(super) pace: Pace,
}

impl Clock {
    /// Takes the time of a tick, s; `period` is that of the model.
    pub(super) fn tick(&mut self, time: f64, period: f64) -> Tick {
        let Some(last) = self.last else {
            self.last = Some(time);
            self.pace.ticks += 1;
            return Tick::Next { missed: 0 };
        };
        let passed = time - last;
        if passed < 0.0 {
            self.last = Some(time);
            return Tick::Backward;
        }
        // A cast saturates: a leap of years is a very large number of periods.
        let periods = (passed / period).round() as usize;
        if periods == 0 {
            return Tick::Stale;
        }
        let pace = &mut self.pace;
        self.last = Some(time);
        pace.mean += (passed - pace.mean) / pace.ticks as f64;
        pace.longest = pace.longest.max(passed);
        pace.ticks += 1;
        pace.late += u64::from(periods > 1);
        pace.missed = pace.missed.saturating_add(periods as u64 - 1);
        Tick::Next {
            missed: periods - 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_by_hand() {
        let mut clock = Clock::default();
        let times = [0.0, 0.0010, 0.0014, 0.0021, 0.0051, 0.0040, 0.0050];
        let said = times.map(|t| clock.tick(t, 0.001));
        let next = |missed| Tick::Next { missed };
        assert_eq!(
            said,
            [
                next(0),
                next(0),
                Tick::Stale,
                next(0),
                next(2),
                Tick::Backward,
                next(0)
            ]
        );
        let pace = clock.pace;
        assert_eq!((pace.ticks, pace.late, pace.missed), (5, 1, 2));
        assert!((pace.longest - 0.003).abs() < 1e-15);
        // 1.0, 1.1, 3.0 and 1.0 ms.
        assert!((pace.mean - 0.001_525).abs() < 1e-15);
    }
}
