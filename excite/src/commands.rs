//! Commands for a replay: slow ramps, steps and holds joint by joint, and a sweep of all, inside the limits.

use crate::limits::Given;
use crate::motion::Labelled;
use identify::excitation::MotionLimits;
use model::failure::Failure;
use ndarray::Array2;
use signal::Motion;
use std::f64::consts::TAU;

/// Time in which a slow ramp runs through its range: friction shows apart from damping where hardly anything else acts, s.
const RAMP: f64 = 10.0;

/// Time of rest after each move: the slowest drive has settled, s.
const REST: f64 = 1.0;

/// Parts of half the range of the steps: small ones show gain over friction, large ones the drive's limit.
const STEPS: [f64; 3] = [0.1, 0.25, 0.5];

/// Part of the range that ramps and holds use.
const PART: f64 = 0.8;

/// Postures of the holds: from both sides, so that friction and droop under gravity can be told apart.
const POSTURES: [f64; 6] = [-0.5, 0.25, -0.25, 0.5, 0.0, -0.75];

/// Length of the sweep and its frequencies, s and Hz. An arm's drives follow commands up to some Hz.
const SWEEP: f64 = 24.0;
const FREQUENCIES: [f64; 2] = [0.1, 4.0];

/// The commands, and by label what each shows.
pub fn commands(
    given: &Given,
    share: f64,
    rate: f64,
    names: &[String],
) -> Result<(Labelled, Vec<&'static str>), Failure> {
    if !given.regions.is_empty() {
        return Err(Failure::input(
            "commands for a replay keep to ranges of joints, not to regions of the tool",
            "Give --position LO:HI,… in which the tool stays where it may be.",
        ));
    }
    let limits: Vec<MotionLimits> = given.limits.iter().map(|l| l.share(share)).collect();
    let home: Vec<f64> = match &given.home {
        Some(home) => home.clone(),
        None => limits.iter().map(|l| 0.5 * (l.lower + l.upper)).collect(),
    };
    // Room on the narrower side of home, so that what is symmetric stays inside.
    let room: Vec<f64> = limits
        .iter()
        .zip(&home)
        .map(|(l, h)| (l.upper - h).min(h - l.lower).max(0.0))
        .collect();
    if let Some(j) = room.iter().position(|room| *room <= 0.0) {
        return Err(Failure::input(
            format!(
                "{} cannot move: {} is at an end of its range",
                names[j], home[j]
            ),
            "Give a posture inside the limits with --home.",
        ));
    }
    let mut out = Vec::new();
    for (j, name) in names.iter().enumerate() {
        let mut path = Path::new(&home, &limits, rate);
        for to in [-PART, PART, 0.0] {
            let slowly =
                RAMP * (to * room[j] - (path.at[j] - home[j])).abs() / (2.0 * PART * room[j]);
            path.ramp(j, home[j] + to * room[j], slowly);
            path.rest();
        }
        out.push((
            format!("ramp {name}"),
            path.done(),
            "Coulomb friction, and friction by load",
        ));
        let mut path = Path::new(&home, &limits, rate);
        for part in STEPS {
            for to in [part, -part, 0.0] {
                path.step(&with(&home, j, home[j] + to * room[j]));
                path.rest();
            }
        }
        out.push((
            format!("steps {name}"),
            path.done(),
            "gain, damping, delay, limit of torque",
        ));
    }
    let mut path = Path::new(&home, &limits, rate);
    for part in POSTURES {
        let posture: Vec<f64> = home
            .iter()
            .zip(&room)
            .map(|(h, r)| h + PART * part * r)
            .collect();
        path.step(&posture);
        path.rest();
    }
    path.step(&home);
    path.rest();
    out.push((
        "holds".to_owned(),
        path.done(),
        "gain against gravity, zeros, load",
    ));
    let mut path = Path::new(&home, &limits, rate);
    path.sweep(&room);
    path.rest();
    out.push((
        "sweep".to_owned(),
        path.done(),
        "rotor inertia apart from damping and delay",
    ));
    Ok(joined(out, rate))
}

fn with(home: &[f64], j: usize, value: f64) -> Vec<f64> {
    let mut out = home.to_vec();
    out[j] = value;
    out
}

/// Positions, sample by sample, from one posture to another.
struct Path<'a> {
    home: &'a [f64],
    limits: &'a [MotionLimits],
    rate: f64,
    at: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

impl<'a> Path<'a> {
    fn new(home: &'a [f64], limits: &'a [MotionLimits], rate: f64) -> Self {
        let mut out = Self {
            home,
            limits,
            rate,
            at: home.to_vec(),
            rows: Vec::new(),
        };
        out.rest();
        out
    }

    fn rest(&mut self) {
        let count = (REST * self.rate).ceil() as usize;
        self.rows
            .extend(std::iter::repeat_n(self.at.clone(), count));
    }

    /// Straight motion to a posture, as quick as the limits allow, at rest at both ends.
    fn step(&mut self, to: &[f64]) {
        // Of the polynomial of fifth order that rests at both ends the speed is 15/8 of the mean one and the acceleration 5.774.
        let needed = to
            .iter()
            .zip(&self.at)
            .zip(self.limits)
            .map(|((to, at), l)| {
                let way = (to - at).abs();
                (1.875 * way / l.velocity)
                    .max((5.774 * way / l.acceleration).sqrt())
                    .max((60.0 * way / l.jerk).cbrt())
            });
        let time = needed.fold(0.0, f64::max);
        let count = (time * self.rate).ceil() as usize;
        let from = self.at.clone();
        for k in 1..=count {
            let t = k as f64 / count as f64;
            let part = t.powi(3) * (10.0 + t * (-15.0 + 6.0 * t));
            let row = from.iter().zip(to).map(|(a, b)| a + part * (b - a));
            self.rows.push(row.collect());
        }
        self.at = to.to_vec();
    }

    /// One joint at one speed, which it takes up and leaves within a tenth of the way.
    fn ramp(&mut self, j: usize, to: f64, seconds: f64) {
        let (from, way) = (self.at[j], to - self.at[j]);
        let limit = &self.limits[j];
        // Speed way / (0.9 T), taken up within 0.1 T.
        let time = seconds
            .max(way.abs() / (0.9 * limit.velocity))
            .max((way.abs() / (0.09 * limit.acceleration)).sqrt());
        let count = (time * self.rate).ceil() as usize;
        for k in 1..=count {
            let t = k as f64 / count as f64;
            let speed = 1.0 / 0.9;
            let part = match t {
                t if t < 0.1 => 0.5 * speed * t * t / 0.1,
                t if t < 0.9 => speed * (t - 0.05),
                t => 1.0 - 0.5 * speed * (1.0 - t).powi(2) / 0.1,
            };
            let mut row = self.at.clone();
            row[j] = from + part * way;
            self.rows.push(row);
        }
        self.at[j] = to;
    }

    /// Sines of all joints whose frequency rises, as large as the limits allow, each a little apart from the others.
    fn sweep(&mut self, room: &[f64]) {
        let columns: Vec<Vec<f64>> = (0..self.home.len())
            .map(|j| self.swept(j, room[j]))
            .collect();
        for k in 0..columns[0].len() {
            let row = columns.iter().zip(self.home).map(|(c, home)| home + c[k]);
            self.rows.push(row.collect());
        }
    }

    /// One joint's way from home, as large as its limits allow.
    fn swept(&self, j: usize, room: f64) -> Vec<f64> {
        let count = (SWEEP * self.rate).ceil() as usize;
        let apart = 1.0 + 0.3 * j as f64 / self.home.len() as f64;
        let [low, high] = FREQUENCIES;
        let (low, high) = (low * apart, high.min(0.1 * self.rate) / 1.3 * apart);
        let (grows, limit) = ((high / low).ln(), &self.limits[j]);
        let at = |k: usize| {
            let t = k as f64 / count as f64;
            // Rest at both ends.
            let envelope = (t.min(1.0 - t) / 0.1).min(1.0);
            let envelope = envelope * envelope * (3.0 - 2.0 * envelope);
            let omega = TAU * low * (grows * t).exp();
            let phase = TAU * low * SWEEP / grows * ((grows * t).exp() - 1.0);
            // No more than the least of the three, and smooth where another takes over: a kink would be a blow.
            let bounds = [
                PART * room,
                limit.velocity / omega,
                limit.acceleration / omega.powi(2),
            ];
            let size = bounds.map(|b| b.powi(-4)).iter().sum::<f64>().powf(-0.25);
            envelope * size * phase.sin()
        };
        let out: Vec<f64> = (1..=count).map(at).collect();
        // The envelope adds speed and acceleration of its own.
        let speed = out.windows(2).map(|w| (w[1] - w[0]).abs() * self.rate);
        let turn = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]).abs() * self.rate.powi(2);
        let acceleration = out.windows(3).map(turn).fold(0.0, f64::max);
        let most = (speed.fold(0.0, f64::max) / limit.velocity)
            .max(acceleration / limit.acceleration)
            .max(1.0);
        out.into_iter().map(|v| v / most).collect()
    }

    fn done(self) -> Vec<Vec<f64>> {
        self.rows
    }
}

/// Trajectories one after another, with velocities and accelerations by central differences.
fn joined(
    all: Vec<(String, Vec<Vec<f64>>, &'static str)>,
    rate: f64,
) -> (Labelled, Vec<&'static str>) {
    let n = all[0].1[0].len();
    let rows: usize = all.iter().map(|(_, rows, _)| rows.len()).sum();
    let mut q = Array2::zeros((rows, n));
    let (mut qd, mut qdd) = (Array2::zeros((rows, n)), Array2::zeros((rows, n)));
    let (mut time, mut segments, mut labels, mut shows) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut start = 0;
    for (label, own, what) in all {
        let at = |k: isize, j: usize| own[k.clamp(0, own.len() as isize - 1) as usize][j];
        for k in 0..own.len() {
            time.push(k as f64 / rate);
            for j in 0..n {
                let [before, here, after] = [-1, 0, 1].map(|d| at(k as isize + d, j));
                q[(start + k, j)] = here;
                qd[(start + k, j)] = 0.5 * (after - before) * rate;
                qdd[(start + k, j)] = (after - 2.0 * here + before) * rate * rate;
            }
        }
        segments.push(start..start + own.len());
        start += own.len();
        labels.push(label);
        shows.push(what);
    }
    let motion = Motion {
        time,
        q,
        qd,
        qdd,
        segments,
    };
    (Labelled { motion, labels }, shows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_stay_inside_the_limits_and_start_and_end_at_rest() {
        let limit = |velocity: f64, acceleration: f64| MotionLimits {
            lower: -1.0,
            upper: 2.5,
            velocity,
            acceleration,
            jerk: 10.0 * acceleration,
        };
        let given = Given {
            limits: vec![limit(2.0, 4.0), limit(0.4, 1.0), limit(6.0, 60.0)],
            assumed: [false; 2],
            tool: [0.0; 3],
            regions: Vec::new(),
            home: Some(vec![0.0, 0.75, 1.9]),
        };
        let names = ["a", "b", "c"].map(str::to_owned);
        let (labelled, shows) = commands(&given, 0.9, 100.0, &names).expect("commands");
        let motion = &labelled.motion;
        assert_eq!(labelled.labels.len(), 8);
        assert_eq!(shows.len(), 8);
        for (j, l) in given.limits.iter().enumerate() {
            let most =
                |table: &Array2<f64>| table.column(j).iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let q = motion.q.column(j);
            assert!(q.iter().all(|q| (l.lower..=l.upper).contains(q)));
            assert!(most(&motion.qd) <= l.velocity, "{j}: {}", most(&motion.qd));
            assert!(
                most(&motion.qdd) <= l.acceleration,
                "{j}: {}",
                most(&motion.qdd)
            );
            // Every joint moves through half the room on the narrower side of its home.
            let home = [0.0, 0.75, 1.9][j];
            let room = (l.upper - home).min(home - l.lower);
            assert!(q.iter().any(|q| (q - home).abs() > 0.5 * room));
        }
        for s in &motion.segments {
            for row in [s.start, s.end - 1] {
                assert!(
                    motion
                        .q
                        .row(row)
                        .iter()
                        .zip([0.0, 0.75, 1.9])
                        .all(|(q, h)| (q - h).abs() < 1e-9)
                );
                assert!(motion.qd.row(row).iter().all(|v| v.abs() < 1e-9));
            }
        }
    }
}
