//! What recordings are too short, slow or coarse for.

settings! {
    /// When a recording cannot show an effect, and how its friction's sign is softened.
    InputSettings {
        /// Range of a joint that never moves, rad (m).
        still: f64 = 1e-3, physics;
        /// Motion below which effects that act over a session are hidden by the others, s.
        short: f64 = 30.0, physics;
        /// Fewest cycles of a joint that show what happens at reversals.
        cycles: f64 = 3.0, physics;
        /// Speed below which viscous friction of any form is hidden by Coulomb friction, rad/s (m/s).
        slow: f64 = 0.05, physics;
        /// Range below which torques of the position look alike, rad (m).
        narrow: f64 = 0.2, physics;
        /// Rate below which what vibrates is not recorded, Hz.
        coarse: f64 = 40.0, physics;
        /// Relative difference of both recordings' rates from which it is said.
        rates: f64 = 0.02, tuned;
        /// Part of the error that another softness of the sign must save to be taken.
        softness: f64 = 0.02, tuned;
    }
}
