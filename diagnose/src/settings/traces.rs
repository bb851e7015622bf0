//! What is seen in a residual itself.

/// Traces in a residual.
#[derive(Clone, Debug, Default)]
pub struct TraceSettings {
    /// Pushes.
    pub contact: ContactSettings,
    /// Blows of a transmission with play.
    pub blows: BlowSettings,
    /// Structure that the catalogue does not explain.
    pub structure: StructureSettings,
}

settings! {
    /// When bursts of a residual are pushes.
    ContactSettings {
        /// Height of a burst over the usual window mean of its joint.
        height: f64 = 8.0, tuned;
        /// Height over that of the highest burst below which it is none.
        least_height: f64 = 0.05, tuned;
        /// Gap between windows of one burst, s.
        gap: f64 = 0.4, tuned;
        /// Time within which a pushed joint was quiet at rest before, and is again afterwards, s.
        budging: f64 = 1.0, tuned;
        /// Longest push, s: what presses longer is a load.
        longest: f64 = 20.0, contract;
        /// Fewest windows of a burst in motion, where shorter ones may be reversals.
        fewest: usize = 3, tuned;
        /// Fewest windows of a recording in which bursts are looked for.
        fewest_windows: usize = 20, tuned;
        /// Most of the time that bursts may take.
        most_time: f64 = 0.4, tuned;
        /// Least part of the squared window means that lies in bursts.
        least_share: f64 = 0.5, tuned;
        /// Window mean below which a joint counts as unloaded, relative to its torque.
        quiet: f64 = 0.004, tuned;
        /// Height of a loaded joint over that of the highest one.
        loaded: f64 = 0.15, tuned;
        /// Height from which a joint is loaded at all.
        loaded_height: f64 = 4.0, tuned;
        /// Part of a burst's load, relative to the joints' torques, from which one joint is loaded alone: a force from outside
        /// rarely does.
        alone: f64 = 0.97, tuned;
        /// Part of all bursts' load that lies in those that load several joints.
        several: f64 = 0.5, tuned;
        /// Part of the bursts' squared torque that has to be steady. Whoever touches the robot pushes it; what swings about
        /// zero inside every burst is the vibration of a joint or of the ground.
        steady: f64 = 0.18, tuned;
        /// Time over which it has to be, s.
        steady_time: f64 = 0.5, tuned;
        /// Part of a burst that another execution of its motion has to show for it to be the robot's own.
        again: f64 = 0.3, tuned;
        /// Part of the changes of sign of a joint's load that lie in bursts, and of its squared torque there that lies around
        /// them, from which they are the blows of its transmission.
        crossing: f64 = 0.6, tuned;
        /// Part of the load's deviation that it has to reach around such a change for the change to count.
        swing: f64 = 0.2, tuned;
        /// Fewest changes that tell.
        fewest_crossings: usize = 4, tuned;
        /// Part of the squared torque of the most loaded joint from which bursts are a torque that is cut off.
        cut_off: f64 = 0.5, tuned;
        /// Part of the error that a learner may predict for the rest to count as contact in motion.
        learnable: f64 = 0.35, tuned;
        /// Part of the recording that is left out, where nothing explains what is left, to see whether a push had bent the fit.
        suspected: f64 = 0.25, tuned;
        /// Least part that contact in motion makes of the whole gap, and of what the causes leave, pushes included.
        size: f64 = 0.1, tuned;
        /// Time around a push that is not fitted either, s.
        margin: f64 = 0.1, tuned;
    }
}

settings! {
    /// When vibration is the blows of a transmission with play.
    BlowSettings {
        /// Fewest changes of the torque's sign that can be seen.
        fewest: usize = 6, tuned;
        /// Power of the vibration after them over that elsewhere.
        ratio: f64 = 5.0, tuned;
        /// Size of the blows over the joint's torque, root mean square while they last.
        least: f64 = 0.01, tuned;
        /// Part of the changes after which it has to be louder than usual.
        followed: f64 = 0.25, tuned;
        /// Chance of such blows up to which they name a play by themselves, whatever error its torque removes.
        chance: f64 = 0.01, tuned;
    }
}

settings! {
    /// When a joint is examined for structure.
    StructureSettings {
        /// Fewest rows away from reversals.
        fewest_rows: usize = 50, tuned;
    }
}

/// Gap as given, sum over joints of the squared NRMSE, beyond which it says more of the description than of a push.
const FAR_OFF: f64 = 0.1;

impl ContactSettings {
    /// Least size of contact in motion, where the gap as given and what the causes leave are sums over joints of squared NRMSE.
    pub fn least(&self, given: f64, rest: f64) -> f64 {
        self.size * given.min(FAR_OFF).max(rest)
    }
}
