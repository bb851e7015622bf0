//! Reversals and rests of joints, and the torque that friction holds at rest.

settings! {
    /// Reversals and rests.
    MotionSettings {
        /// Speed below which a joint counts as reversing or standing, rad/s (m/s).
        reversal_speed: f64 = 0.01, contract;
        /// Time on either side of a reversal that the low-pass smears it over, s.
        reversal_time: f64 = 0.03, physics;
        /// Speed below which rows weigh less, because the sign of a filtered velocity is a guess, rad/s (m/s). Narrow,
        /// because friction with memory shows next to it.
        crossing_speed: f64 = 0.004, tuned;
        /// Weight of rows below `crossing_speed`.
        crossing_weight: f64 = 0.15, tuned;
        /// Weight of rows at standstill in a recording that is too slow for a low-pass.
        standstill_weight: f64 = 0.1, tuned;
        /// Duration from which a joint below the reversal speed stands and is judged as at rest, s.
        rest: f64 = 0.5, contract;
        /// Mean speed below which a joint keeps its position, rad/s (m/s).
        stays_speed: f64 = 0.002, tuned;
        /// Duration over which that mean speed is taken, s.
        stays_time: f64 = 0.25, tuned;
        /// Part of a rest in which the joint must keep its position: one that creeps through a slow reversal does not stand.
        staying: f64 = 0.5, tuned;
        /// Longest motion of a joint at rest that a push makes without ending the rest, s.
        budges_time: f64 = 0.3, tuned;
        /// Displacement within `stays_time` from which friction of a joint at rest has turned to oppose it, rad (m).
        gives: f64 = 1e-4, tuned;
        /// Duration for which friction stays turned after that, s.
        gives_time: f64 = 1.0, tuned;
        /// Largest displacement by a push that does not end a rest, rad (m).
        budges_way: f64 = 0.01, tuned;
        /// Duration at either end of a rest in which the joint still settles or starts, s.
        rest_edge: f64 = 0.1, tuned;
        /// Part of the Coulomb torque within which friction at rest is constant.
        constant: f64 = 0.15, tuned;
        /// Band added to that, in median steps of the held torque between samples.
        constant_steps: f64 = 3.0, tuned;
        /// Least part of a rest that must be constant. With less it is a slow reversal, as long as friction
        /// could hold all of the torque.
        plateau: f64 = 0.5, tuned;
        /// Torque over the Coulomb torque that friction holds before a joint breaks away.
        breakaway: f64 = 1.2, physics;
        /// Least part of a rest that must lie within the Coulomb torque for its median to be the held torque;
        /// else the whole rest is used.
        held: f64 = 0.2, tuned;
        /// Fewest stretches without a reversal from which the torque's noise is estimated; with fewer, all stretches are used.
        noise_stretches: usize = 8, tuned;
    }
}
