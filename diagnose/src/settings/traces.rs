//! Thresholds of traces that a residual shows by itself: pushes, blows, structure.

/// Thresholds of traces in a residual.
#[derive(Clone, Debug, Default)]
pub struct TraceSettings {
    /// Thresholds of pushes.
    pub contact: ContactSettings,
    /// Blows of a transmission with play.
    pub blows: BlowSettings,
    /// Structure that the catalogue does not explain.
    pub structure: StructureSettings,
}

settings! {
    /// Thresholds by which bursts of a residual are pushes.
    ContactSettings {
        /// Height of a burst: its window mean over the joint's usual window mean.
        height: f64 = 8.0, tuned;
        /// Least height relative to that of the highest burst.
        least_height: f64 = 0.05, tuned;
        /// Longest gap between windows of one burst, s.
        gap: f64 = 0.4, tuned;
        /// Duration for which a pushed joint must have been quiet at rest before the push and after it, s.
        budging: f64 = 1.0, tuned;
        /// Longest push, s: a longer one is a load.
        longest: f64 = 20.0, contract;
        /// Fewest windows of a burst in motion, where shorter ones may be reversals.
        fewest: usize = 3, tuned;
        /// Fewest windows of a recording in which bursts are searched.
        fewest_windows: usize = 20, tuned;
        /// Largest part of the time that bursts may take.
        most_time: f64 = 0.4, tuned;
        /// Least part of the squared window means that must lie in bursts.
        least_share: f64 = 0.5, tuned;
        /// Window mean below which a joint counts as unloaded, relative to its torque.
        quiet: f64 = 0.004, tuned;
        /// Height of a burst on a loaded joint relative to that on the joint with the highest one.
        loaded: f64 = 0.15, tuned;
        /// Least height of a burst on a loaded joint.
        loaded_height: f64 = 4.0, tuned;
        /// Part of a burst's load, relative to the joints' torques, from which one joint is loaded alone: a
        /// force from outside rarely does that.
        alone: f64 = 0.97, tuned;
        /// Least part of all bursts' load that must lie in bursts that load several joints.
        several: f64 = 0.5, tuned;
        /// Least part of the bursts' squared torque that must be steady. A person who touches the robot pushes
        /// it to one side. Vibration of a joint or of the ground swings about zero inside every burst.
        steady: f64 = 0.18, tuned;
        /// Duration of the pieces over which the torque must be steady, s.
        steady_time: f64 = 0.5, tuned;
        /// Part of a burst that another execution of its motion must show for it to be the robot's own.
        again: f64 = 0.3, tuned;
        /// Limits from which bursts are blows of a joint's transmission: part of the load's sign changes that
        /// lie in bursts, and part of the joint's squared burst torque around sign changes.
        crossing: f64 = 0.6, tuned;
        /// Part of the load's deviation that the load must reach around a sign change for the change to count.
        swing: f64 = 0.2, tuned;
        /// Fewest sign changes for that judgement.
        fewest_crossings: usize = 4, tuned;
        /// Part of the squared burst torque of the most loaded joint from which bursts are a torque that is cut off.
        cut_off: f64 = 0.5, tuned;
        /// Largest part of the squared error that a learner may predict for the remainder to count as contact in motion.
        learnable: f64 = 0.35, tuned;
        /// Part of the recording that is left out, where nothing explains the residual, to see whether a push had bent the fit.
        suspected: f64 = 0.25, tuned;
        /// Least size of contact in motion: part of the whole gap, and of the residual beside the causes, pushes included.
        size: f64 = 0.1, tuned;
        /// Duration on either side of a push that is not fitted, s.
        margin: f64 = 0.1, tuned;
    }
}

settings! {
    /// Thresholds by which vibration is the blows of a transmission with play.
    BlowSettings {
        /// Fewest sign changes of the torque that must be seen.
        fewest: usize = 6, tuned;
        /// Power of the vibration after sign changes over that elsewhere.
        ratio: f64 = 5.0, tuned;
        /// Size of the blows over the joint's torque, root mean square while they last.
        least: f64 = 0.01, tuned;
        /// Part of the sign changes after which the vibration must be stronger than usual.
        followed: f64 = 0.25, tuned;
        /// Chance of such blows up to which they name a play by themselves, whatever error its torque removes.
        chance: f64 = 0.01, tuned;
    }
}

settings! {
    /// Thresholds of the test of a joint's residual for structure.
    StructureSettings {
        /// Fewest rows away from reversals with which a joint is tested.
        fewest_rows: usize = 50, tuned;
    }
}

/// Gap as given, sum over joints of the squared NRMSE. A larger one comes from the description rather than from a push.
const FAR_OFF: f64 = 0.1;

impl ContactSettings {
    /// Least size of contact in motion, sum over joints of squared NRMSE. `given` is the gap as given, `rest`
    /// what the causes leave of it, both as such sums.
    pub fn least(&self, given: f64, rest: f64) -> f64 {
        self.size * given.min(FAR_OFF).max(rest)
    }
}
