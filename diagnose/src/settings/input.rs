//! Limits below which a recording is too short, too slow or too coarse to show an effect.

settings! {
    /// Limits below which a recording cannot show an effect, and the choice of the softness of friction's sign.
    InputSettings {
        /// Range of motion below which a joint counts as never moving, rad (m).
        still: f64 = 1e-3, physics;
        /// Duration of motion below which effects that act over a session are hidden by the other effects, s.
        short: f64 = 30.0, physics;
        /// Fewest cycles of motion of a joint in which effects at reversals show.
        cycles: f64 = 3.0, physics;
        /// Speed below which viscous friction of any form is hidden by Coulomb friction, rad/s (m/s).
        slow: f64 = 0.05, physics;
        /// Range below which torques of the position look alike, rad (m).
        narrow: f64 = 0.2, physics;
        /// Sampling rate below which vibration is not recorded, Hz.
        coarse: f64 = 40.0, physics;
        /// Relative difference between the sampling rates of both recordings from which a note says so.
        rates: f64 = 0.02, tuned;
        /// Part of the squared error that another softness of the sign must remove to be chosen.
        softness: f64 = 0.02, tuned;
    }
}
