//! Several trajectories, each chosen to complement those before it.

use super::criterion::Goal;
use super::error::ExcitationError;
use super::search::Found;
use super::series::Series;

/// Number of attempts at a trajectory that lowers the cost before no further one is added (Han et al., section IV-B: ten).
const ATTEMPTS: u64 = 10;

/// Set of chosen trajectories.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// Trajectories in the order of choice; the cost of each is that of all up to it.
    pub chosen: Vec<Found>,
    /// Number of trajectories judged, rejected ones included.
    pub evaluations: usize,
}

/// Adds up to `count` trajectories one by one. `design` makes one for a goal and a seed. A trajectory that does
/// not lower the cost of those already chosen is dropped and designed anew, up to ten times; then the stack
/// stays as it is.
///
/// # Errors
/// Those of `design`, of the first trajectory at once.
pub fn stack(
    goal: &mut dyn Goal,
    count: usize,
    seed: u64,
    design: impl Fn(&dyn Goal, u64) -> Result<Found, ExcitationError>,
) -> Result<Stack, ExcitationError> {
    let mut out = Stack {
        chosen: Vec::new(),
        evaluations: 0,
    };
    let mut least = f64::INFINITY;
    for k in 0..count as u64 {
        let mut next = None;
        for attempt in 0..ATTEMPTS {
            let found = design(goal, seed.wrapping_add(k * ATTEMPTS + attempt))?;
            out.evaluations += found.evaluations;
            if found.cost < least {
                next = Some(found);
                break;
            }
        }
        let Some(found) = next else {
            break;
        };
        least = found.cost;
        goal.take(&found.trajectory)?;
        out.chosen.push(found);
    }
    Ok(out)
}

impl Stack {
    /// The chosen trajectories without their costs.
    pub fn trajectories(&self) -> Vec<Series> {
        self.chosen.iter().map(|f| f.trajectory.clone()).collect()
    }
}
