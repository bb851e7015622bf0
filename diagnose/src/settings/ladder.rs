//! When a cause is listed.

settings! {
    /// When a cause is listed.
    LadderSettings {
        /// Fall of a joint's NRMSE by re-identification from which a change of parameters is listed.
        listed: f64 = 0.03, contract;
        /// Part of the largest change, relative to the joints' torques, from which an effect of the whole arm touches a
        /// joint.
        noticed: f64 = 0.35, tuned;
        /// Trajectories from which intervals draw whole ones; of fewer they draw stretches.
        trajectories: usize = 10, tuned;
        /// Length of such a stretch, s.
        stretch: f64 = 1.5, tuned;
    }
}
