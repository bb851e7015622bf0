//! When a cause is accepted.

use super::rules::Off;

settings! {
    /// When a cause is accepted.
    SearchSettings {
        /// Deviation of the given inertial parameters that is nothing to report, relative.
        inertial_tolerance: f64 = 0.025, tuned;
        /// Deviation of given friction coefficients that is nothing to report, relative.
        friction_tolerance: f64 = 0.12, tuned;
        /// The same of parameters that the robot's own earlier recordings gave.
        inertial_of_own: f64 = 0.003, tuned;
        /// The same where the motion is that of the earlier recordings.
        inertial_repeated: f64 = 1e-4, tuned;
        /// The same of friction.
        friction_of_own: f64 = 0.01, tuned;
        /// Torque of a change of friction that nobody would report however small the coefficient is, over the joint's.
        unreported: f64 = 0.003, tuned;
        /// Torque that friction which the model lacks may make, over the joint's, one deviation.
        missing: f64 = 3.0, tuned;
        /// Torque that a candidate may make, over the joint's, one deviation.
        wide: f64 = 3.0, tuned;
        /// Deviation of a suspected link's parameters, in their sizes.
        freed: f64 = 0.5, tuned;
        /// Deviation of a suspected link's density, relative.
        density: f64 = 0.5, tuned;
        /// Largest change of a suspected link's parameter, in squares of its deviation: beyond that the link is not the
        /// cause, it stands in for something else.
        most_change: f64 = 9.0, tuned;
        /// How far parameters may leave the given values when they are identified again, in tolerances: of these, what
        /// predicts best where the fit did not see. The freest comes first.
        freedoms: [f64; 4] = [100.0, 30.0, 10.0, 3.0], tuned;
        /// Part of the squared error out of fold that less freedom must spare.
        freedom_gain: f64 = 0.02, tuned;
        /// Rows per independent sample at most, and as long as no search has shown how long what is left remembers itself.
        correlated_rows: f64 = 25.0, tuned;
        /// Rows per independent sample, in rows for which what is left remembers itself: it holds mechanisms that nobody described, which are no noise.
        memories: f64 = 4.0, tuned;
        /// Fewest rows per independent sample.
        fewest_rows: f64 = 8.0, tuned;
        /// Price of a coefficient, nats.
        cost: f64 = 4.0, tuned;
        /// Coefficients that a body on the last link is charged for at most: those that a recording shows.
        last_link_price: usize = 2, physics;
        /// Gain from which a cause is named, nats.
        enough: f64 = 10.0, tuned;
        /// The same where its error is not visible, in `enough`.
        enough_unseen: f64 = 1.4, tuned;
        /// The same of friction with memory.
        enough_memory: f64 = 2.0, tuned;
        /// The same of memory within `narrow` that does not show plainly.
        enough_narrow: f64 = 3.0, tuned;
        /// The same of what makes a prediction late or oscillate, whatever part of the error it removes.
        enough_dynamic: f64 = 20.0, tuned;
        /// Part of an earlier cause's gain that a further cause must exceed.
        leftover: f64 = 0.12, tuned;
        /// Part of its gain that the same effect on another joint must exceed.
        leftover_same: f64 = 0.35, tuned;
        /// Part of its joints' squared error from which a cause stands for itself, whatever earlier ones gained.
        plain_part: f64 = 0.1, tuned;
        /// Gain that it needs for that, nats.
        plain_gain: f64 = 60.0, tuned;
        /// Error that a cause must remove on some joint, relative to the joint's torque.
        visible: f64 = 0.015, tuned;
        /// Share of the gap, or of what parameters leave of it, that a cause must remove.
        share: f64 = 0.015, tuned;
        /// Error below which a joint counts as explained, relative to its torque.
        floor: f64 = 0.006, tuned;
        /// Part of the error that shows plainly: asked of what a wrong sign at reversals imitates, and of springs.
        plainly: f64 = 0.35, tuned;
        /// Part of the error that a delay has to remove: what the catalogue lacks may be late, too.
        late_part: f64 = 0.18, tuned;
        /// The same of one joint where no other is late.
        late_alone: f64 = 0.75, tuned;
        /// Velocity of a Stribeck law below which it has to show plainly, rad/s (m/s).
        abrupt: f64 = 0.012, tuned;
        /// Way over which friction has memory below which a wrong sign imitates it, rad (m).
        narrow: f64 = 1.2e-3, tuned;
        /// Part of the error that such memory has to remove.
        narrow_part: f64 = 0.22, tuned;
        /// Squared error over the free refit's up to which few parameters are the answer alone.
        as_good: f64 = 1.3, contract;
        /// Squared error over the free refit's up to which few parameters are named first, the refit beside them.
        rivalled: f64 = 2.0, contract;
        /// Part of the largest change that makes a joint one of the cause's in that comparison.
        touched: f64 = 0.35, tuned;
        /// Factors on the tolerances among which the recording chooses, of links and friction each: a description is rarely right to a few percent.
        tolerant: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0], tuned;
        /// What a body on the last link has to be worth against wider tolerances for every joint, nats.
        body: f64 = 3.75, tuned;
        /// What each doubling of the tolerances costs, nats.
        widening: f64 = 4.0, tuned;
        /// Factors under which what no few parameters explain is left to the parameters.
        wider: [f64; 4] = [1.0, 4.0, 16.0, 100.0], tuned;
        /// Special rules that are switched off, for an ablation.
        off: Off = Off::NONE, contract;
        /// Most causes that are named.
        most_causes: usize = 24, tuned;
    }
}

impl SearchSettings {
    /// Rows per independent sample of a joint of which what is left remembers itself for `memory` rows.
    pub fn correlated(&self, memory: f64) -> f64 {
        (self.memories * memory).clamp(self.fewest_rows, self.correlated_rows)
    }
}
