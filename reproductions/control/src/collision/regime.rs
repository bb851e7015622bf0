//! How a joint moved lately, on which it depends how wrong a model's friction may be.

use serde::Serialize;

/// What friction did lately.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Regime {
    /// It moves: the model's friction changes as speed does.
    Moving,
    /// It turned round: friction changed its sign over a way that few models know.
    Reversing,
    /// It stands, or has just left a standstill, in which friction held what nobody can tell.
    #[default]
    Standing,
}

impl Regime {
    /// All, in the order of tables.
    pub const ALL: [Self; 3] = [Self::Moving, Self::Reversing, Self::Standing];

    /// Name in tables.
    pub fn words(self) -> &'static str {
        match self {
            Self::Moving => "moving",
            Self::Reversing => "reversing",
            Self::Standing => "standing",
        }
    }
}

/// Part of a joint's largest speed below which it creeps.
const CREEPS: f64 = 0.01;
/// Time of creeping that makes a standstill, s.
const STOOD: f64 = 0.25;
/// How long a departure from a standstill is remembered, s; a reversal as long as the detectors look back.
const DEPARTS: f64 = 0.3;
const TURNS: f64 = 2.0 * super::WINDOW;

/// Regime of every joint, sample by sample.
#[derive(Debug, Clone)]
pub struct Regimes {
    /// Speed below which each joint creeps, rad/s or m/s.
    slow: Vec<f64>,
    joints: Vec<Lately>,
    now: Vec<Regime>,
}

/// One joint, s.
#[derive(Debug, Clone)]
struct Lately {
    /// How long it has been creeping.
    creeping: f64,
    since_standing: f64,
    since_creeping: f64,
}

/// A joint of which nothing is known counts as standing.
const UNKNOWN: Lately = Lately {
    creeping: STOOD,
    since_standing: 0.0,
    since_creeping: 0.0,
};

impl Regimes {
    /// For joints with these largest speeds, rad/s or m/s.
    pub fn new(largest_speed: &[f64]) -> Self {
        Self {
            slow: largest_speed.iter().map(|v| CREEPS * v).collect(),
            joints: vec![UNKNOWN; largest_speed.len()],
            now: vec![Regime::Standing; largest_speed.len()],
        }
    }

    /// Starts anew.
    pub fn reset(&mut self) {
        self.joints.fill(UNKNOWN);
        self.now.fill(Regime::Standing);
    }

    /// The next sample's regime of every joint that moves at `qd`, `dt` seconds after the last.
    pub fn step(&mut self, qd: &[f64], dt: f64) -> &[Regime] {
        let each = self.joints.iter_mut().zip(&mut self.now);
        for ((joint, now), (v, slow)) in each.zip(qd.iter().zip(&self.slow)) {
            joint.since_standing += dt;
            joint.since_creeping += dt;
            if v.abs() <= *slow {
                joint.creeping += dt;
                joint.since_creeping = 0.0;
            } else {
                joint.creeping = 0.0;
            }
            if joint.creeping >= STOOD {
                joint.since_standing = 0.0;
            }
            *now = if joint.since_standing <= DEPARTS {
                Regime::Standing
            } else if joint.since_creeping <= TURNS {
                Regime::Reversing
            } else {
                Regime::Moving
            };
        }
        &self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A start, a reversal, a stop: 1 kHz, up to 1 rad/s.
    #[test]
    fn a_start_a_reversal_and_a_stop() {
        let mut regimes = Regimes::new(&[1.0]);
        let speed = |t: f64| match t {
            t if t < 0.2 => 0.0,
            t if t < 1.2 => (std::f64::consts::TAU * (t - 0.2)).sin(),
            _ => 0.0,
        };
        let seen: Vec<Regime> = (0..2000)
            .map(|k| regimes.step(&[speed(f64::from(k) * 1e-3)], 1e-3)[0])
            .collect();
        let at = |t: f64| seen[(1e3 * t) as usize];
        assert_eq!(at(0.1), Regime::Standing);
        assert_eq!(at(0.49), Regime::Standing, "just left");
        assert_eq!(at(0.55), Regime::Moving);
        assert_eq!(at(0.72), Regime::Reversing, "through zero at 0.7 s");
        assert_eq!(at(0.8), Regime::Moving);
        assert_eq!(at(1.3), Regime::Reversing, "not yet a standstill");
        assert_eq!(at(1.6), Regime::Standing);
        regimes.reset();
        assert_eq!(regimes.step(&[0.5], 1e-3)[0], Regime::Standing);
    }
}
