//! Progress bars.

use compensator::training::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Progress bar in percent; hidden when quiet or when the output is not a terminal.
pub fn bar(quiet: bool, what: &str) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template("{msg:<28} {bar:40} {pos:>3} %  {elapsed} (left {eta})")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(100)
        .with_style(style)
        .with_message(what.to_owned())
}

/// Shows all networks of a training as one bar with the latest figures.
pub struct Training {
    bar: ProgressBar,
    joints: Vec<String>,
    done: Mutex<BTreeMap<(usize, usize), (usize, usize)>>,
    networks: usize,
}

impl Training {
    /// A bar for `networks` networks.
    pub fn new(quiet: bool, joints: &[String], networks: usize) -> Self {
        let bar = if quiet {
            ProgressBar::hidden()
        } else {
            let style = ProgressStyle::with_template("{bar:40} {pos:>3} %  {msg}")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(100).with_style(style)
        };
        Self {
            bar,
            joints: joints.to_vec(),
            done: Mutex::default(),
            networks,
        }
    }

    /// Takes the state of one network.
    pub fn update(&self, p: &Progress) {
        let Ok(mut done) = self.done.lock() else {
            return;
        };
        done.insert(
            (p.job, p.member),
            (if p.finished { p.epochs } else { p.epoch }, p.epochs),
        );
        let share: f64 = done
            .values()
            .map(|&(e, of)| e as f64 / of.max(1) as f64)
            .sum::<f64>()
            / self.networks.max(1) as f64;
        self.bar.set_position((100.0 * share) as u64);
        let validation = p
            .best_validation_rmse
            .map_or_else(String::new, |v| format!(", validation {v:.4} N·m"));
        let joint = self.joints.get(p.joint).map_or("", String::as_str);
        self.bar.set_message(format!(
            "{joint} epoch {}/{} loss {:.4}{validation}, {} s left",
            p.epoch,
            p.epochs,
            p.last.train_loss,
            p.remaining.as_secs()
        ));
    }

    /// Removes the bar from the terminal.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
