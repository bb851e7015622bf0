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
        /// Fewest stretches whose signs can be drawn anew often enough to say what chance earns: eight have 256 patterns for 199
        /// surrogates. A recording of fewer is short.
        fewest: f64 = 8.0, physics;
        /// Length of the pieces that are left out of a short recording, s.
        piece: f64 = 1.0, contract;
        /// Part of its squared error on pieces left out that a cause may leave a joint of a short recording: half of the error.
        halved: f64 = 0.25, contract;
        /// The same of every single piece, where it may act little.
        on_every: f64 = 0.5, contract;
    }
}
