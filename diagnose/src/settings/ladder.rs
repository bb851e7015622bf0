//! Thresholds by which an accepted cause is listed in the report.

settings! {
    /// Thresholds by which an accepted cause is listed in the report.
    LadderSettings {
        /// Fall of a joint's NRMSE by re-identification from which a change of parameters is listed.
        listed: f64 = 0.03, contract;
        /// Part of the largest change, relative to the joints' torques, from which an effect of the whole arm touches a
        /// joint.
        noticed: f64 = 0.35, tuned;
        /// Fewest trajectories from which the bootstrap of an interval draws whole trajectories; with fewer it draws stretches.
        trajectories: usize = 10, tuned;
        /// Length of such a stretch, s.
        stretch: f64 = 1.5, tuned;
        /// Fewest stretches for surrogates, whose stretches get random signs: eight have 256 patterns for 199
        /// surrogates. A recording of fewer is short.
        fewest: f64 = 8.0, physics;
        /// Length of the pieces of a short recording that are left out in turn, s.
        piece: f64 = 1.0, contract;
        /// Part of its squared error on pieces left out that a joint of a short recording may keep beside a
        /// cause: half of the error.
        halved: f64 = 0.25, contract;
        /// Part of the squared error that a joint may keep on every single piece, where a cause may act little.
        on_every: f64 = 0.5, contract;
    }
}
