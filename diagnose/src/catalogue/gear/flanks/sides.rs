//! Gap between flanks that are too stiff for a visible deflection: the link stands on one side or the other,
//! depending on its load.

use super::rows::{EXPLAINS, Flanks, LAWS, Rows, SURE, rms};
use crate::algebra::folds::jackknife;
use signal::quantile::{median, quantile};

/// Most rows between the sides (nearer to the middle than half of the way), fewest rows on either side, and
/// largest spread of a side over half of the way. A departure that follows a load instead is rarely at its
/// ends.
const ON_THE_WAY: f64 = 0.2;
const EITHER: f64 = 0.05;
const SPREADS: f64 = 0.35;
/// Least mean number of rows of a stay on one side: noise of a sensor that counts in steps stays nowhere.
const STAYS: f64 = 5.0;
/// Largest number of iterations until the sides converge.
const STEPS: usize = 20;

/// The two sides, where the departure has two and the torque pushes towards the one at which the link stands.
pub(super) fn sides(rows: &Rows) -> Option<Flanks> {
    let own = &rows.departure;
    let at = settled(own)?;
    let (middle, half) = (0.5 * (at[0] + at[1]), 0.5 * (at[1] - at[0]));
    if half <= 0.0 {
        return None;
    }
    let n = own.len() as f64;
    let part = |of: &dyn Fn(f64) -> bool| {
        own.iter().filter(|d| of((**d - middle) / half)).count() as f64 / n
    };
    if part(&|x| x.abs() < 0.5) > ON_THE_WAY || part(&|x| x > 0.0).min(part(&|x| x < 0.0)) < EITHER
    {
        return None;
    }
    let side: Vec<f64> = own.iter().map(|d| (d - middle).signum()).collect();
    let spread = median(
        own.iter()
            .zip(&side)
            .map(|(d, s)| (d - middle - s * half).abs())
            .collect(),
    )?;
    let changes = side.windows(2).filter(|w| w[0] != w[1]).count();
    if spread > SPREADS * half || n < STAYS * (changes + 1) as f64 {
        return None;
    }
    // Inertia is left out: of a joint without gravity it is the load.
    let [qd, sign, _, ones] = &rows.motor;
    let [sine, cosine] = &rows.turn;
    let motor = [qd, sign, ones, sine, cosine];
    let all: Vec<usize> = (0..own.len()).collect();
    let pushed = [&[&side], &motor[..]].concat();
    let explained = 1.0 - rows.left(&pushed)? / rows.left(&motor)?.max(f64::MIN_POSITIVE);
    let by_side = rows.products(&pushed, &rows.torque, &all).solve()?[0];
    if explained < EXPLAINS || by_side < 0.0 {
        return None;
    }
    // What the flanks give way by goes with the torque.
    let stands: Vec<usize> = (0..own.len())
        .filter(|&i| (own[i] - middle).abs() > 0.5 * half)
        .collect();
    let columns = [&side, ones, &rows.torque, qd, sign];
    let without = rows.blocks().into_iter().map(|block| {
        let rest: Vec<usize> = stands
            .iter()
            .copied()
            .filter(|i| !block.contains(i))
            .collect();
        rows.products(&columns, own, &rest).solve().map(|x| x[0])
    });
    let without: Vec<f64> = without.collect::<Option<_>>()?;
    let found = rows.products(&columns, own, &stands).solve()?[0];
    // How much of the way is the flanks' own is only known so well.
    let std = jackknife(&without)?
        .hypot(LAWS[1] * found)
        .hypot(0.5 * (half - found));
    (found > SURE * std).then(|| Flanks {
        at: [middle - found, middle + found],
        stiffness: None,
        half_gap: Some([found, std]),
        inertia: 0.0,
        explained,
        parts: [rms(side.iter().map(|s| s * found)), spread],
    })
}

/// Median departure on either side of its middle.
fn settled(own: &[f64]) -> Option<[f64; 2]> {
    let mut at = [quantile(own.to_vec(), 0.03)?, quantile(own.to_vec(), 0.97)?];
    for _ in 0..STEPS {
        let middle = 0.5 * (at[0] + at[1]);
        let of = |above: bool| {
            median(
                own.iter()
                    .copied()
                    .filter(|d| (*d > middle) == above)
                    .collect(),
            )
        };
        let next = [of(false)?, of(true)?];
        if next == at {
            break;
        }
        at = next;
    }
    Some(at)
}
