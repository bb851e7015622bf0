//! Simulator of the robot at an earlier time, from earlier recordings. Differences from it are changes since then.

use super::spread::Spread;
use crate::decide::find;
use crate::given::{Earlier, Given};
use crate::score::{figures, roll_out};
use crate::simulate::Unstable;
use crate::tracks::Replayed;

/// Fits the simulator to earlier recordings with every cause that they show. The result is the simulator as given for a
/// diagnosis of later recordings. Fitted values stay free within their posterior deviation. Errors that remain do not
/// count as a change.
///
/// # Errors
/// Simulator as given that is unstable.
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
    let given = given.limited(before)?;
    let found = find(&given, before, |s| {
        stage(&format!("{s}, as the robot was before"));
    })?;
    let spread = Spread::of(&found);
    let arm = given.released(&found.fitted.arm);
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
        unlimited: Vec::new(),
        ..given
    })
}
