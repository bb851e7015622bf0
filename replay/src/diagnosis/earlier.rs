//! The simulator as earlier recordings of the same robot have it: what departs from it has changed since.

use super::spread::Spread;
use crate::decide::find;
use crate::given::{Earlier, Given};
use crate::score::{figures, roll_out};
use crate::simulate::Unstable;
use crate::tracks::Replayed;

/// Fits the simulator to earlier recordings with every cause that they show. What they leave open stays open within its deviation, and
/// what they leave unexplained is no change.
///
/// # Errors
/// The simulator as given is unstable.
pub fn earlier(
    given: &Given,
    before: &Replayed,
    mut stage: impl FnMut(&str),
) -> Result<Given, Unstable> {
    let rates = before.whole.iter().all(|t| t.rates.is_some());
    let given = if rates {
        given.clone()
    } else {
        given.without_rates()
    };
    let found = find(&given, before, |s| {
        stage(&format!("{s}, as the robot was before"));
    })?;
    let spread = Spread::of(&found);
    let arm = found.fitted.arm.clone();
    let left = figures(&roll_out(&arm, before)?, before).unexplained;
    let open = found.free.iter().zip(&spread.deviation);
    let open = open.filter(|(_, deviation)| deviation.is_finite());
    Ok(Given {
        earlier: Some(Earlier {
            open: open.map(|(f, d)| (f.parameter, *d)).collect(),
            unexplained: left,
        }),
        arm,
        tolerances: Vec::new(),
        free: Vec::new(),
        stated: false,
        ..given
    })
}
