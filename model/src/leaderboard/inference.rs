//! Inference time of a model in a control loop.

use feedforward::Feedforward;
use signal::Motion;
use std::time::Instant;

/// Number of calls before timing starts.
const WARM_UP: usize = 200;
/// Number of timed calls; a shorter recording is repeated.
const CALLS: usize = 3000;

/// Median time of one call of [`Feedforward::torque`] over a motion, µs. None without a sample.
///
/// It is the only score of a leaderboard that depends on the machine and its load.
pub(super) fn microseconds(model: &mut Feedforward, motion: &Motion) -> Option<f64> {
    let rows = motion.len();
    if rows == 0 {
        return None;
    }
    let n = model.dof();
    let [mut q, mut qd, mut qdd, mut tau] = [(); 4].map(|()| vec![0.0; n]);
    let mut times = Vec::with_capacity(CALLS);
    model.reset(None);
    for call in 0..WARM_UP + CALLS {
        let row = call % rows;
        for joint in 0..n {
            q[joint] = motion.q[[row, joint]];
            qd[joint] = motion.qd[[row, joint]];
            qdd[joint] = motion.qdd[[row, joint]];
        }
        let asked = Instant::now();
        model.torque(&q, &qd, &qdd, &mut tau);
        let took = asked.elapsed();
        if call >= WARM_UP {
            times.push(took);
        }
    }
    times.sort_unstable();
    Some(times[CALLS / 2].as_secs_f64() * 1e6)
}
