//! How fast a path is run: trapezoid of speed, smoothed to an S-curve.

/// Way over time from rest to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Way, m or rad; positive.
    distance: f64,
    /// Highest speed that is reached.
    speed: f64,
    acceleration: f64,
    /// Time over which the trapezoid is averaged, s: the acceleration rises and falls within it. 0: a plain trapezoid.
    smoothing: f64,
}

impl Profile {
    /// Over `distance` at `speed` and `acceleration` where the way is long enough for them, averaged over `smoothing` seconds.
    pub fn new(distance: f64, speed: f64, acceleration: f64, smoothing: f64) -> Self {
        Self {
            distance,
            speed: speed.min((distance * acceleration).sqrt()),
            acceleration,
            smoothing,
        }
    }

    fn trapezoid(&self) -> f64 {
        self.distance / self.speed + self.speed / self.acceleration
    }

    /// Length, s.
    pub fn duration(&self) -> f64 {
        self.trapezoid() + self.smoothing
    }

    /// Integral of the way, way and speed of the trapezoid at time `t`.
    fn plain(&self, t: f64) -> [f64; 3] {
        let (d, v, a, end) = (
            self.distance,
            self.speed,
            self.acceleration,
            self.trapezoid(),
        );
        let ramp = v / a;
        if t <= 0.0 {
            [0.0; 3]
        } else if t < ramp {
            [a * t * t * t / 6.0, 0.5 * a * t * t, a * t]
        } else if t < end - ramp {
            let on = t - ramp;
            let way = 0.5 * v * ramp;
            [
                a * ramp.powi(3) / 6.0 + way * on + 0.5 * v * on * on,
                way + v * on,
                v,
            ]
        } else {
            // What is run and what is left make the distance: the integral over all is d·end/2.
            let left = (end - t).max(0.0);
            let after = (t - end).max(0.0);
            [
                0.5 * d * end - d * left + a * left.powi(3) / 6.0 + d * after,
                d - 0.5 * a * left * left,
                a * left,
            ]
        }
    }

    /// Way, speed and acceleration at time `t`, s.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let s = self.smoothing;
        if s > 0.0 {
            let (now, before) = (self.plain(t), self.plain(t - s));
            // Means over the window are differences of integrals.
            return std::array::from_fn(|i| (now[i] - before[i]) / s);
        }
        let [_, way, speed] = self.plain(t);
        let ramp = self.speed / self.acceleration;
        let acceleration = if t <= 0.0 || t >= self.trapezoid() {
            0.0
        } else if t < ramp {
            self.acceleration
        } else if t > self.trapezoid() - ramp {
            -self.acceleration
        } else {
            0.0
        };
        [way, speed, acceleration]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrives_at_rest_with_exact_derivatives() {
        for (distance, smoothing) in [(0.6, 0.05), (0.6, 0.0), (0.01, 0.02)] {
            let p = Profile::new(distance, 0.9, 9.0, smoothing);
            let [way, speed, acceleration] = p.at(p.duration());
            assert!((way - distance).abs() < 1e-12, "{way}");
            assert!(speed.abs() < 1e-12 && acceleration.abs() < 1e-9);
            let h = 1e-6;
            for k in 1..40 {
                // Off the corners of the trapezoid.
                let t = p.duration() * (f64::from(k) + 0.37) / 41.0;
                let (before, now, after) = (p.at(t - h), p.at(t), p.at(t + h));
                assert!((after[0] - before[0] - 2.0 * h * now[1]).abs() < 1e-11);
                assert!(
                    (after[1] - before[1] - 2.0 * h * now[2]).abs() < 1e-9,
                    "t {t}"
                );
                assert!(now[1] <= 0.9 + 1e-12 && now[2].abs() <= 9.0 + 1e-9);
            }
        }
        // 0.6 m at 0.9 m/s and 9 m/s²: 0.1 s up, 0.1 s down, 0.51 m at speed, by hand.
        assert!(
            (Profile::new(0.6, 0.9, 9.0, 0.05).duration() - (0.2 + 0.51 / 0.9 + 0.05)).abs()
                < 1e-12
        );
    }
}
