//! Guards of the motion that is advised.

settings! {
    /// Guards of the next motion.
    AdviceSettings {
        /// Margin to the ends of a joint's range, relative to the range.
        margin: f64 = 0.05, physics;
        /// Part of the speed limit that a motion may use.
        speed: f64 = 0.9, physics;
        /// Largest velocity and acceleration over the recorded ones, where the robot's description has no limit.
        faster: f64 = 1.2, physics;
    }
}
