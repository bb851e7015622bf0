//! Parts that yield: the plant's own spring laws between a motor that moves as recorded and what it carries. The torque of
//! all else is linear in the part's small deflection.

use super::motion::{Motion, STEP, STRIDE};
use crate::effects::{Place, Withheld};
use physics::dynamics::{Workspace, inverse_dynamics, mass_matrix};
use physics::robot::RobotError;
use plant::arm::Arm;
use plant::build::Build;
use plant::mechanism::Instant;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// Deflection (rad) and its rate (rad/s) by which derivatives are taken.
const SMALL: [f64; 2] = [1e-3, 1e-2];
/// Largest product of a step and the part's fastest frequency.
const FINE: f64 = 0.25;
/// Largest number of solves of a step.
const MOST_SOLVES: usize = 8;

/// Linear surroundings of gears by joint, for as many trajectories as they were asked for.
#[derive(Default)]
pub struct Gears(RefCell<HashMap<(usize, usize), Rc<Surroundings>>>);

/// Torque around a part that yields, on every [`STRIDE`]th row of the grid.
struct Surroundings {
    /// Torque on the part without a deflection or any acceleration, N·m.
    bias: Vec<f64>,
    /// By the part's acceleration, its deflection and its rate: torque on the part, then on each motor.
    by: [Vec<f64>; 3],
}

impl Gears {
    /// Adds the torque by a part that yields, of an effect with its size, in the first `trajectories` of a motion.
    pub fn add(
        &self,
        plain: &Arm,
        motion: &Motion,
        (effect, size): (&dyn Withheld, f64),
        trajectories: usize,
        added: &mut [f64],
    ) -> Result<(), RobotError> {
        let Some(part) = effect.yielding() else {
            return Ok(());
        };
        let mut build = Build::plain(plain);
        effect.apply(size, &mut build)?;
        let at = (0..build.arm.dof()).find(|i| !build.axes.contains(i));
        let Some(at) = at else { return Ok(()) };
        let around = match part.place() {
            Place::Mount => Rc::new(surroundings(
                motion,
                &build.arm,
                [&build.axes, &[at]],
                trajectories,
            )?),
            Place::Gear(joint) => {
                let key = (joint, trajectories);
                let known = self.0.borrow().get(&key).cloned();
                match known {
                    Some(known) => known,
                    None => {
                        let made =
                            surroundings(motion, &build.arm, [&build.axes, &[at]], trajectories)?;
                        let made = Rc::new(made);
                        self.0.borrow_mut().insert(key, made.clone());
                        made
                    }
                }
            }
        };
        let stiffness = part.stiffness(size);
        for w in motion.starts[..=trajectories].windows(2) {
            swing(
                motion,
                &mut build,
                (at, stiffness),
                &around,
                [w[0], w[1]],
                added,
            );
        }
        Ok(())
    }
}

/// Surroundings of the last joint of `axes[1]` on an arm whose motors are `axes[0]`.
fn surroundings(
    motion: &Motion,
    arm: &Arm,
    [axes, part]: [&[usize]; 2],
    trajectories: usize,
) -> Result<Surroundings, RobotError> {
    let (robot, at) = (arm.robot()?, part[0]);
    let (n, mut workspace) = (arm.dof(), Workspace::new(&robot));
    let mut mass = vec![0.0; n * n];
    let widen = |x: &[f64]| {
        let mut wide = vec![0.0; n];
        axes.iter().zip(x).for_each(|(&axis, x)| wide[axis] = *x);
        wide
    };
    let order: Vec<usize> = std::iter::once(at).chain(axes.iter().copied()).collect();
    let mut made = Surroundings {
        bias: Vec::new(),
        by: [Vec::new(), Vec::new(), Vec::new()],
    };
    let (zero, mut rest) = (vec![0.0; n], vec![0.0; n]);
    let mut moved = vec![0.0; n];
    for k in (0..motion.starts[trajectories]).step_by(STRIDE) {
        let [q, v, a] = motion.state(k).map(widen);
        mass_matrix(&robot, &mut workspace, &q, &mut mass);
        inverse_dynamics(&robot, &mut workspace, &q, &v, &zero, &mut rest);
        made.bias.push(rest[at]);
        inverse_dynamics(&robot, &mut workspace, &q, &v, &a, &mut rest);
        made.by[0].extend(order.iter().map(|&j| mass[j * n + at]));
        for (i, small) in SMALL.into_iter().enumerate() {
            let (mut q, mut v) = (q.clone(), v.clone());
            [&mut q, &mut v][i][at] = small;
            inverse_dynamics(&robot, &mut workspace, &q, &v, &a, &mut moved);
            made.by[i + 1].extend(order.iter().map(|&j| (moved[j] - rest[j]) / small));
        }
    }
    Ok(made)
}

/// Instant of a part's step: time and length of the step, positions and velocities, and zeros for what the surroundings hold.
fn instant<'a>([t, dt]: [f64; 2], q: &'a [f64], v: &'a [f64], zero: &'a [f64]) -> Instant<'a> {
    Instant {
        t,
        dt,
        q,
        v,
        a: zero,
        load: zero,
    }
}

/// Forces of all mechanisms together.
fn push(build: &mut Build, now: &Instant, force: &mut [f64]) {
    force.fill(0.0);
    for m in &mut build.mechanisms {
        m.push(now, force);
    }
}

/// Lets the part swing from rest over rows `first` to `end` of the grid, by the plant's own step.
fn swing(
    motion: &Motion,
    build: &mut Build,
    (at, stiffness): (usize, f64),
    around: &Surroundings,
    [first, end]: [usize; 2],
    added: &mut [f64],
) {
    let (n, width) = (motion.dof, motion.dof + 1);
    let fastest = (stiffness / around.by[0][first / STRIDE * width]).sqrt();
    let parts = (STEP * fastest / FINE).ceil().clamp(1.0, 40.0);
    let h = STEP / parts;
    let (mut q, mut v) = (vec![0.0; build.arm.dof()], vec![0.0; build.arm.dof()]);
    let zero = vec![0.0; build.arm.dof()];
    let (mut x, mut rate, mut a) = (0.0, 0.0, 0.0);
    let last = around.bias.len() - 1;
    let mut force = zero.clone();
    for k in first..end {
        let (i, part) = (k / STRIDE, (k % STRIDE) as f64 / STRIDE as f64);
        let next = (i + 1).min(last);
        let between = |x: &[f64], width: usize, c: usize| {
            let (a, b) = (x[i * width + c], x[next * width + c]);
            a + part * (b - a)
        };
        let bias = between(&around.bias, 1, 0);
        let [mass, stiff, drag] = [0, 1, 2].map(|d| between(&around.by[d], width, 0));
        // A motor's acceleration at an instant holds the controller's noise; its mean is what the velocity shows.
        let shaken: Vec<f64> = (0..n)
            .map(|j| between(&around.by[0], width, j + 1))
            .collect();
        let carried = |a: &dyn Fn(usize) -> f64| -> f64 {
            shaken.iter().enumerate().map(|(j, m)| m * a(j)).sum()
        };
        let after = (k + 1).min(end - 1);
        let [now_v, next_v] = [k, after].map(|k| motion.state(k)[1]);
        let load = bias + carried(&|j| (next_v[j] - now_v[j]) / STEP);
        for _ in 0..parts as usize {
            let middle = x + 0.5 * h * rate;
            q[at] = middle;
            v[at] = rate + 0.5 * h * a;
            let now = instant([motion.time[k], h], &q, &v, &zero);
            push(build, &now, &mut force);
            let mechanisms = &build.mechanisms;
            let resist = |v: f64| mechanisms.iter().map(|m| m.resist(&now, v)).sum::<f64>();
            let still = resist(0.0);
            let pushed = force[at] - load - stiff * middle - drag * v[at] - still;
            let mut ends = rate + h * a;
            for _ in 0..MOST_SOLVES {
                let speed = if ends.abs() < 1e-9 { 1e-9 } else { ends };
                let chord = (resist(speed) - still) / speed;
                a = (pushed - chord * rate) / (mass + h * chord);
                let found = rate + h * a;
                let settled = (found - ends).abs() <= 1e-4 * found.abs() + 1e-9;
                ends = found;
                if settled {
                    break;
                }
            }
            v[at] = ends;
            let ended = instant([motion.time[k], h], &q, &zero, &zero);
            for m in &mut build.mechanisms {
                m.advance(&ended, &v);
            }
            x += 0.5 * h * (rate + ends);
            rate = ends;
        }
        // The state is that of the next row.
        if k + 1 < end {
            let sampled = motion.state(k + 1)[2];
            q[at] = x;
            let now = instant([motion.time[k + 1], h], &q, &zero, &zero);
            push(build, &now, &mut force);
            let mechanisms = &build.mechanisms;
            let resist: f64 = mechanisms.iter().map(|m| m.resist(&now, rate)).sum();
            let pushed = force[at] - resist - bias - stiff * x - drag * rate;
            let swung = (pushed - carried(&|j| sampled[j])) / mass;
            for j in 0..n {
                let by = [1, 2].map(|d| between(&around.by[d], width, j + 1));
                added[(k + 1) * n + j] += shaken[j] * swung + by[0] * x + by[1] * rate;
            }
        }
    }
}
