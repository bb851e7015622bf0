//! How far the motion that is advised may go.

settings! {
    /// Guards of the next motion.
    AdviceSettings {
        /// Distance kept from the ends of a joint's range, relative to it.
        margin: f64 = 0.05, physics;
        /// Part of the speed limit that is used.
        speed: f64 = 0.9, physics;
        /// Fastest motion and acceleration over the recorded ones, where the robot's description has no limit.
        faster: f64 = 1.2, physics;
    }
}
