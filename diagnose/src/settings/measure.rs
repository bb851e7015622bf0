//! The verdict, and what is said beside the causes.

/// What is measured and said.
#[derive(Clone, Debug, Default)]
pub struct MeasureSettings {
    /// The verdict.
    pub verdict: VerdictSettings,
    /// How surely a cause is named.
    pub confidence: ConfidenceSettings,
    /// Resonances.
    pub resonance: ResonanceSettings,
    /// Rivals, regions, parameters, friction.
    pub said: SaidSettings,
    /// Friction of another day.
    pub other_day: OtherDaySettings,
}

settings! {
    /// When friction of the held-out recording is another.
    OtherDaySettings {
        /// Chance of saying so of a joint whose friction differs as it does between trajectories.
        chance: f64 = 0.002, tuned;
        /// Least change that is said, relative.
        least: f64 = 0.02, tuned;
    }
}

settings! {
    /// What a diagnosis comes to.
    VerdictSettings {
        /// Structure left on some joint, relative to its torque, from which it counts as clear.
        clear: f64 = 0.03, tuned;
        /// The same over what is usual of the robot's own model, where there is no simulator's.
        beyond: f64 = 2.0, tuned;
        /// Part of the whole squared gap that such structure must be.
        clear_share: f64 = 0.06, tuned;
        /// Structure left on some joint, relative to its torque, that is clear whatever part of the gap it is.
        plain: f64 = 0.09, tuned;
        /// Error over the floor up to which a joint is at the floor.
        at_floor: f64 = 1.5, contract;
        /// Part of the held-out recording that pushes may cut before it explains in part at best.
        most_cut: f64 = 0.2, contract;
        /// Fewest samples of a joint that are judged, in motion or at rest.
        fewest_samples: usize = 50, tuned;
        /// Least motion of some joint that says anything, s.
        least_motion: f64 = 2.0, tuned;
        /// Part of the samples of one value from which a torque channel says nothing.
        same: f64 = 0.99, tuned;
    }
}

settings! {
    /// How surely a cause has the right name.
    ConfidenceSettings {
        /// Weights of a constant, ln(1 + lead), likeness, ln(1 + gain over chance), ln(1 + structure left in %) in the logarithm
        /// of the odds; without them no confidence is given.
        weights: Option<[f64; 5]> = Some([1.414, 1.057, -0.090, 0.037, -1.532]), tuned;
    }
}

settings! {
    /// When a peak of the spectrum is a resonance.
    ResonanceSettings {
        /// Speed below which every joint of a standing arm stays, rad/s (m/s).
        standing: f64 = 0.01, tuned;
        /// Recordings of noise among which one has such a peak.
        chance: f64 = 1e4, physics;
        /// Density over its surroundings from which a peak is worth saying.
        stands_out: f64 = 10.0, tuned;
        /// Part of that density which a single window has to show.
        window: f64 = 0.5, tuned;
        /// Part of the windows that have to show it: what shows in few is an event, not what swings whenever it is struck.
        lasting: f64 = 0.5, tuned;
        /// Part of the residual's peak that the predicted torque's may reach for the peak not to be the motion's.
        motion: f64 = 0.3, tuned;
        /// Width of a peak over its frequency from which it is a hump, and nothing that swings.
        narrow: f64 = 0.5, tuned;
        /// Frequencies of two joints that differ by less, relative to them, are one.
        same: f64 = 0.04, tuned;
    }
}

settings! {
    /// What is said of causes and beside them.
    SaidSettings {
        /// Gain below which two names are one answer, nats.
        ambiguous: f64 = 6.0, tuned;
        /// The same relative to the better one.
        ambiguous_part: f64 = 0.08, tuned;
        /// Part of the better one's gain that a rival has to have.
        rival: f64 = 0.5, tuned;
        /// Most candidates beyond the causes.
        candidates: usize = 40, tuned;
        /// Least share of the gap that a region is reported with.
        region: f64 = 0.01, tuned;
        /// Most regions.
        regions: usize = 16, tuned;
        /// Deviations from which a parameter has moved.
        moved: f64 = 3.0, physics;
        /// Most moved parameters.
        most_moved: usize = 24, tuned;
        /// Deviations from which a link's parameter belongs to the cause `link_parameters`.
        changed: f64 = 2.0, physics;
        /// Change relative to the parameter that it needs for that.
        changed_part: f64 = 0.05, tuned;
        /// Part of its deviation by which a coefficient of friction would be beyond a bound to be said to be held.
        beyond: f64 = 0.05, tuned;
        /// Least motion near a speed in each direction for friction to be stated there, s.
        friction: f64 = 0.1, tuned;
        /// Part of the error that a learned unit must spare on the pieces that judge it: what helps a little on few may not
        /// help elsewhere.
        learned: f32 = 0.05, tuned;
    }
}
