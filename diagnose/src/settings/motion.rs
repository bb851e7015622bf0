//! How joints move: reversals, rests, and what friction holds at rest.

settings! {
    /// Reversals and rests.
    MotionSettings {
        /// Speed below which a joint turns round or stands, rad/s (m/s).
        reversal_speed: f64 = 0.01, contract;
        /// Time on either side of a reversal that the low-pass smears it over, s.
        reversal_time: f64 = 0.03, physics;
        /// Speed below which rows weigh less, because the sign of a filtered velocity is a guess, rad/s (m/s). Narrow,
        /// because friction with memory shows next to it.
        crossing_speed: f64 = 0.004, tuned;
        /// Weight of such rows.
        crossing_weight: f64 = 0.15, tuned;
        /// Weight of rows at standstill in a recording that is too slow for a low-pass.
        standstill_weight: f64 = 0.1, tuned;
        /// Time from which a joint that is slower stands and is judged at rest, s.
        rest: f64 = 0.5, contract;
        /// Speed on average below which a joint stays where it is, rad/s (m/s).
        stays_speed: f64 = 0.002, tuned;
        /// Time over which that average is taken, s.
        stays_time: f64 = 0.25, tuned;
        /// Part of a rest in which the joint stays: one that creeps through a slow reversal does not stand.
        staying: f64 = 0.5, tuned;
        /// Time for which a push may move a joint at rest, s: the rest goes on.
        budges_time: f64 = 0.3, tuned;
        /// Way within `stays_time` from which friction of a joint at rest has turned that way, rad (m).
        gives: f64 = 1e-4, tuned;
        /// Time for which it stays turned, s.
        gives_time: f64 = 1.0, tuned;
        /// Way that it may move it, rad (m).
        budges_way: f64 = 0.01, tuned;
        /// Time at either end of a rest where the joint still comes to rest or leaves it, s.
        rest_edge: f64 = 0.1, tuned;
        /// Part of the Coulomb torque within which friction at rest is constant.
        constant: f64 = 0.15, tuned;
        /// What is added to that, in usual steps between samples.
        constant_steps: f64 = 3.0, tuned;
        /// Part of a rest that is constant; less is a slow reversal while friction could hold all of it.
        plateau: f64 = 0.5, tuned;
        /// Torque over the Coulomb torque that friction holds before a joint breaks away.
        breakaway: f64 = 1.2, physics;
        /// Part of a rest within the Coulomb torque from which that part says what friction holds.
        held: f64 = 0.2, tuned;
        /// Fewest stretches without a reversal that say how strong the torque's noise is; of fewer, all stretches do.
        noise_stretches: usize = 8, tuned;
    }
}
