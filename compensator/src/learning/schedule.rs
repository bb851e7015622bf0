//! Learning rates, by burn's schedulers.

use burn::lr_scheduler::LrSchedulerRecord;
use burn::lr_scheduler::cosine::CosineAnnealingLrSchedulerConfig;
use burn::lr_scheduler::module_lr_scheduler::ModuleLrScheduler;
use burn::lr_scheduler::sequential::SequentialLrSchedulerConfig;

use crate::config::{Schedule, Training};

/// Schedule of the learning rate over `steps` steps.
///
/// # Errors
/// Rate out of range, or no step, in burn's words.
pub(super) fn rates(training: &Training, steps: usize) -> Result<ModuleLrScheduler, String> {
    let rate = f64::from(training.learning_rate);
    let fall = |end: f32, steps: usize| {
        CosineAnnealingLrSchedulerConfig::new(rate, steps).with_min_lr(rate * f64::from(end))
    };
    match training.schedule {
        Schedule::Constant => Ok(ModuleLrScheduler::new(rate)),
        Schedule::Cosine { end } => fall(end, steps).init(),
        Schedule::OneCycle {
            warm_up,
            start,
            end,
        } => {
            let rise = (f64::from(warm_up) * steps as f64).round() as usize;
            if rise == 0 || rise >= steps {
                return fall(end, steps).init();
            }
            let parts = vec![fall(start, rise).into(), fall(end, steps - rise).into()];
            let cycle = SequentialLrSchedulerConfig::new(parts, vec![rise]).init()?;
            // burn's cosine comes up again after its lowest point: begun there, it is a rise.
            let valley = LrSchedulerRecord::new().with_scalar("current_iter", rise - 1);
            let begin = LrSchedulerRecord::new()
                .with_scalar("step", 0_usize)
                .with_record("0", valley);
            Ok(cycle.load_record(LrSchedulerRecord::new().with_record("0", begin)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sequence(schedule: Schedule, steps: usize) -> Vec<f64> {
        let training = Training {
            learning_rate: 0.5,
            schedule,
            ..Training::default()
        };
        let mut rates = rates(&training, steps).unwrap();
        (0..steps).map(|_| rates.step().base()).collect()
    }

    /// Half a cosine from `from` at 0 to `to` at 1.
    fn along(done: f64, from: f64, to: f64) -> f64 {
        to + (from - to) * 0.5 * (1.0 + (std::f64::consts::PI * done).cos())
    }

    fn assert_close(rates: &[f64], expected: impl Iterator<Item = f64>) {
        for (k, (rate, expected)) in rates.iter().zip(expected).enumerate() {
            assert!(
                (rate - expected).abs() < 1e-7,
                "step {k}: {rate} not {expected}"
            );
        }
    }

    #[test]
    fn one_cycle_rises_and_falls_along_cosines() {
        let cycle = Schedule::OneCycle {
            warm_up: 0.25,
            start: 0.1,
            end: 0.001,
        };
        let expected = (0..40).map(|k| match k {
            0..10 => 0.5 * along(f64::from(k) / 10.0, 0.1, 1.0),
            _ => 0.5 * along(f64::from(k - 10) / 30.0, 1.0, 0.001),
        });
        assert_close(&sequence(cycle, 40), expected);
    }

    #[test]
    fn cosine_falls_to_its_end_and_constant_stays() {
        let expected = (0..20).map(|k| 0.5 * along(f64::from(k) / 20.0, 1.0, 0.2));
        assert_close(&sequence(Schedule::Cosine { end: 0.2 }, 20), expected);
        assert_close(&sequence(Schedule::Constant, 5), [0.5; 5].into_iter());
    }

    #[test]
    fn a_cycle_too_short_for_a_rise_only_falls() {
        let cycle = Schedule::OneCycle {
            warm_up: 0.1,
            start: 0.1,
            end: 0.0,
        };
        assert_close(&sequence(cycle, 3)[..1], [0.5].into_iter());
    }
}
