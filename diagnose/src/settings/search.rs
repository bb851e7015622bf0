//! Thresholds by which the search accepts a cause.

use super::rules::Off;

settings! {
    /// Thresholds by which the search accepts a cause.
    SearchSettings {
        /// Tolerance of the given inertial parameters, relative: a smaller deviation is not reported.
        inertial_tolerance: f64 = 0.025, tuned;
        /// Tolerance of the given friction coefficients, relative: a smaller deviation is not reported.
        friction_tolerance: f64 = 0.12, tuned;
        /// Tolerance of inertial parameters that were identified from the robot's own earlier recordings, relative.
        inertial_of_own: f64 = 0.003, tuned;
        /// Tolerance of inertial parameters, relative, where the motion repeats that of the earlier recordings.
        inertial_repeated: f64 = 1e-4, tuned;
        /// Tolerance of friction coefficients that were identified from the robot's own earlier recordings, relative.
        friction_of_own: f64 = 0.01, tuned;
        /// Torque of a friction change, over the joint's torque, that is not reported however small the coefficient is.
        unreported: f64 = 0.003, tuned;
        /// Prior deviation of friction that the model lacks: its torque over the joint's torque.
        missing: f64 = 3.0, tuned;
        /// Prior deviation of a candidate's coefficient: its torque over the joint's torque.
        wide: f64 = 3.0, tuned;
        /// Prior deviation of a suspected link's parameters, over their sizes.
        freed: f64 = 0.5, tuned;
        /// Prior deviation of a suspected link's density, relative.
        density: f64 = 0.5, tuned;
        /// Largest change of a suspected link's parameter, in squares of its prior deviation. Beyond it the
        /// link is not the cause but stands in for something else.
        most_change: f64 = 9.0, tuned;
        /// Factors on the tolerances within which parameters are identified again. The one with the least error
        /// out of fold is used. The freest comes first.
        freedoms: [f64; 4] = [100.0, 30.0, 10.0, 3.0], tuned;
        /// Part of the squared error out of fold that a smaller freedom must remove.
        freedom_gain: f64 = 0.02, tuned;
        /// Rows per independent sample: the most, and the value as long as no search has shown the residual's
        /// autocorrelation time.
        correlated_rows: f64 = 25.0, tuned;
        /// Rows per independent sample, in autocorrelation times of the residual. The residual holds mechanisms
        /// that nobody described, which are no noise.
        memories: f64 = 4.0, tuned;
        /// Least number of rows per independent sample.
        fewest_rows: f64 = 8.0, tuned;
        /// Penalty of a coefficient, nats.
        cost: f64 = 4.0, tuned;
        /// Most coefficients that a body on the last link is charged for: those that a recording shows.
        last_link_price: usize = 2, physics;
        /// Gain from which a cause is named, nats.
        enough: f64 = 10.0, tuned;
        /// Factor on `enough` for a cause whose removed error is not visible on any joint.
        enough_unseen: f64 = 1.4, tuned;
        /// Factor on `enough` for friction with memory.
        enough_memory: f64 = 2.0, tuned;
        /// Factor on `enough` for memory shorter than `narrow` that does not remove the part `plainly`.
        enough_narrow: f64 = 3.0, tuned;
        /// Part of an earlier cause's gain that a further cause must exceed.
        leftover: f64 = 0.12, tuned;
        /// Part of an earlier cause's gain that the same effect on another joint must exceed.
        leftover_same: f64 = 0.35, tuned;
        /// Part of its joints' squared error from which a cause is accepted whatever earlier ones gained.
        plain_part: f64 = 0.1, tuned;
        /// Gain that such a cause needs beside that part, nats.
        plain_gain: f64 = 60.0, tuned;
        /// Error that a cause must remove on some joint, relative to the joint's torque.
        visible: f64 = 0.015, tuned;
        /// Share of the gap that a cause must remove; of the error that re-identification leaves, where that is less.
        share: f64 = 0.015, tuned;
        /// Error below which a joint counts as explained, relative to its torque.
        floor: f64 = 0.006, tuned;
        /// Part of the squared error that an effect must remove where a wrong sign at reversals imitates it,
        /// and that a spring must.
        plainly: f64 = 0.35, tuned;
        /// Part of the squared error that a delay must remove: torque that the catalogue lacks may be late, too.
        late_part: f64 = 0.18, tuned;
        /// Part of the squared error that a delay of one joint must remove where no other joint is late.
        late_alone: f64 = 0.75, tuned;
        /// Stribeck velocity below which the law must remove the part `plainly`, rad/s (m/s).
        abrupt: f64 = 0.012, tuned;
        /// Length of friction's memory below which a wrong sign at reversals imitates it, rad (m).
        narrow: f64 = 1.2e-3, tuned;
        /// Part of the squared error that memory shorter than `narrow` must remove.
        narrow_part: f64 = 0.22, tuned;
        /// Squared error over the free refit's up to which few parameters are the answer alone.
        as_good: f64 = 1.3, contract;
        /// Squared error over the free refit's up to which few parameters are named first, the refit beside them.
        rivalled: f64 = 2.0, contract;
        /// Part of the largest fall of the error from which a joint belongs to the cause in that comparison.
        touched: f64 = 0.35, tuned;
        /// Factors on the tolerances among which the recording chooses, for links and friction each. A
        /// description is rarely right to a few percent.
        tolerant: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0], tuned;
        /// Penalty of a body on the last link against wider tolerances, per joint of the robot, nats.
        body: f64 = 3.75, tuned;
        /// Penalty of each doubling of the tolerances, nats.
        widening: f64 = 4.0, tuned;
        /// Factors on the tolerances within which parameters may take up an error that no few parameters explain.
        wider: [f64; 4] = [1.0, 4.0, 16.0, 100.0], tuned;
        /// Special rules that are switched off, for an ablation.
        off: Off = Off::default(), contract;
        /// Most causes that are accepted.
        most_causes: usize = 24, tuned;
    }
}

impl SearchSettings {
    /// Rows per independent sample of a joint whose residual has an autocorrelation time of `memory` rows.
    pub fn correlated(&self, memory: f64) -> f64 {
        (self.memories * memory).clamp(self.fewest_rows, self.correlated_rows)
    }
}
