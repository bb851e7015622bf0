//! Thresholds of the verdict and of the statements beside the causes.

/// Thresholds of the verdict and of the statements beside the causes.
#[derive(Clone, Debug, Default)]
pub struct MeasureSettings {
    /// Thresholds of the verdict.
    pub verdict: VerdictSettings,
    /// Confidence in the name of a cause.
    pub confidence: ConfidenceSettings,
    /// Thresholds of resonances.
    pub resonance: ResonanceSettings,
    /// Statements on rivals, regions, parameters and friction.
    pub said: SaidSettings,
    /// Friction that differs in the held-out recording.
    pub other_day: OtherDaySettings,
}

settings! {
    /// Thresholds from which friction of the held-out recording counts as different.
    OtherDaySettings {
        /// False-alarm probability for a joint whose friction varies as it does between trajectories.
        chance: f64 = 0.002, tuned;
        /// Least change of friction that is reported, relative.
        least: f64 = 0.02, tuned;
    }
}

settings! {
    /// Thresholds of the verdict.
    VerdictSettings {
        /// Structure in the residual of some joint, relative to its torque, from which it counts as clear.
        clear: f64 = 0.03, tuned;
        /// Factor over the usual structure of the robot's own model from which structure is clear, where there
        /// is no simulator's model.
        beyond: f64 = 2.0, tuned;
        /// Least part of the whole squared gap that clear structure must be.
        clear_share: f64 = 0.06, tuned;
        /// Structure in the residual of some joint, relative to its torque, that is clear whatever part of the gap it is.
        plain: f64 = 0.09, tuned;
        /// Factor on the noise floor up to which a joint's error counts as at the floor.
        at_floor: f64 = 1.5, contract;
        /// Part of the held-out recording that pushes may cut out; above it the verdict is `partly_explained` at best.
        most_cut: f64 = 0.2, contract;
        /// Fewest samples of a joint that are scored, in motion or at rest.
        fewest_samples: usize = 50, tuned;
        /// Least duration of motion of some joint for a verdict, s.
        least_motion: f64 = 2.0, tuned;
        /// Part of the samples with one and the same value from which a torque channel counts as unusable.
        same: f64 = 0.99, tuned;
    }
}

settings! {
    /// Model of the probability that a cause has the right name.
    ConfidenceSettings {
        /// Weights of the log-odds: constant, ln(1 + lead), ln(1 + structure left in %). Without weights no confidence
        /// is given.
        weights: Option<[f64; 3]> = Some([1.414, 1.057, -1.532]), tuned;
    }
}

settings! {
    /// Thresholds from which a peak of the spectrum is a resonance.
    ResonanceSettings {
        /// Speed below which every joint of a standing arm must stay, rad/s (m/s).
        standing: f64 = 0.01, tuned;
        /// Number of recordings of pure noise among which one shows such a peak.
        chance: f64 = 1e4, physics;
        /// Spectral density over that around the peak from which the peak is reported.
        stands_out: f64 = 10.0, tuned;
        /// Part of that ratio that a single window must reach.
        window: f64 = 0.5, tuned;
        /// Part of the windows that must reach it: a peak in few windows is an event, not a vibration whenever it is excited.
        lasting: f64 = 0.5, tuned;
        /// Part of the residual's peak that the peak of the predicted torque may reach. Above it the peak is that of the motion.
        motion: f64 = 0.3, tuned;
        /// Width of a peak over its frequency from which it is a hump, not a resonance.
        narrow: f64 = 0.5, tuned;
        /// Relative difference of frequency below which the peaks of two joints are one resonance.
        same: f64 = 0.04, tuned;
    }
}

settings! {
    /// Thresholds of the statements on causes and beside them.
    SaidSettings {
        /// Difference of gain below which two names count as ambiguous, nats.
        ambiguous: f64 = 6.0, tuned;
        /// Difference of gain, relative to the better name's, below which two names count as ambiguous.
        ambiguous_part: f64 = 0.08, tuned;
        /// Part of the better name's gain that a rival must reach.
        rival: f64 = 0.5, tuned;
        /// Most candidates that the report lists beyond the causes.
        candidates: usize = 40, tuned;
        /// Least share of the gap from which a region is reported.
        region: f64 = 0.01, tuned;
        /// Most regions that are reported.
        regions: usize = 16, tuned;
        /// Change over its standard deviation from which a parameter has moved.
        moved: f64 = 3.0, physics;
        /// Most moved parameters that are reported.
        most_moved: usize = 24, tuned;
        /// Change over its standard deviation from which a link's parameter belongs to the cause `link_parameters`, and a joint to
        /// `friction_parameters`.
        changed: f64 = 2.0, physics;
        /// Relative change of the parameter that is needed beside that.
        changed_part: f64 = 0.05, tuned;
        /// Distance beyond a bound, in standard deviations, from which a coefficient of friction is reported as held by it.
        beyond: f64 = 0.05, tuned;
        /// Least duration of motion near a speed, in each direction, for a friction value there, s.
        friction: f64 = 0.1, tuned;
        /// Part of the squared error that a learned unit must remove on the pieces that judge it. A small gain
        /// on few may not carry over.
        learned: f32 = 0.05, tuned;
    }
}

impl SaidSettings {
    /// Whether a link's parameter, `given` before its `change` with the standard deviation `std`, belongs to `link_parameters`.
    pub fn is_changed(&self, given: f64, change: f64, std: f64) -> bool {
        change.abs() > self.changed * std && change.abs() > self.changed_part * given.abs()
    }
}
