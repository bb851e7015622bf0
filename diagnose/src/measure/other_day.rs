//! Change of friction between the fitted and the held-out recording, as on another day.
//!
//! For each joint and trajectory of either recording, the residual is regressed on the joint's friction: a
//! factor on all of it. The spread of the factors between trajectories of the fitted recording gives the noise.
//! It changes no cause, no size and no verdict.

use crate::input::frames::Frames;
use crate::measure::explain::Explanation;
use crate::measure::friction::resisting;
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use crate::search::find::Findings;
use crate::settings::OtherDaySettings;
use crate::simulator::NominalModel;
use ndarray::Array2;
use signal::delay::student;

/// A joint whose friction differs in the held-out recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Changed {
    /// Index of the joint whose friction differs.
    pub joint: usize,
    /// Relative change of friction from the fitted to the held-out recording.
    pub change: f64,
    /// Standard deviation of the relative change of friction.
    pub std: f64,
}

/// Joints whose friction differs. `left` and `skipped` belong to the fitted recording at its samples: the
/// residual out of fold, shape (samples, joints), and the samples that a push cuts out.
pub fn changed(
    model: &NominalModel,
    frames: &Frames,
    found: &Findings,
    explanation: &Explanation,
    left: &Array2<f64>,
    skipped: &[bool],
) -> Vec<Changed> {
    let settings = &found.settings.measure.other_day;
    let scene = |passage| Scene::new(&found.session.present, passage, &frames.scale);
    let there = scene(frames.heldout_passage());
    let friction = [
        resisting(model, found, &scene(frames.passage()), &frames.data),
        resisting(model, found, &there, &frames.heldout),
    ];
    let kept = |i: usize| !skipped[i];
    let scored = |i: usize| explanation.scored.keeps(i);
    (0..model.robot.dof())
        .filter_map(|j| {
            let own = factors(&frames.data, left, &friction[0], j, &kept);
            let other = factors(
                &frames.heldout,
                &explanation.residual,
                &friction[1],
                j,
                &scored,
            );
            difference(&own, &other, settings).map(|(change, std)| Changed {
                joint: j,
                change,
                std,
            })
        })
        .collect()
}

/// Regression coefficient of the residual on the friction, by trajectory.
fn factors(
    frame: &Frame,
    left: &Array2<f64>,
    friction: &Array2<f64>,
    joint: usize,
    kept: &dyn Fn(usize) -> bool,
) -> Vec<f64> {
    let of = |rows: std::ops::Range<usize>| {
        let (mut product, mut square) = (0.0, 0.0);
        for i in rows.filter(|i| kept(*i)) {
            let f = friction[[i, joint]];
            product += f * left[[i, joint]];
            square += f * f;
        }
        (square > 0.0).then(|| product / square)
    };
    let each = frame.rows.iter().cloned();
    each.filter_map(|rows| of(frame.samples_of(rows))).collect()
}

/// Difference of the means and its standard deviation, where it is too large for one between trajectories of a day.
fn difference(own: &[f64], other: &[f64], settings: &OtherDaySettings) -> Option<(f64, f64)> {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let squares = |x: &[f64]| {
        let mean = mean(x);
        x.iter().map(|v| (v - mean).powi(2)).sum::<f64>()
    };
    if own.is_empty() || other.is_empty() {
        return None;
    }
    let freedom = (own.len() + other.len())
        .checked_sub(2)
        .filter(|f| *f > 1)?;
    let spread = ((squares(own) + squares(other)) / freedom as f64).sqrt();
    let std = spread * (1.0 / own.len() as f64 + 1.0 / other.len() as f64).sqrt();
    let change = mean(other) - mean(own);
    let most = student(0.5 * settings.chance, freedom);
    (change.abs() > settings.least && change.abs() > most * std).then_some((change, std))
}

/// Note for the report; none where nothing changed.
pub fn note(changed: &[Changed], names: &[String]) -> Option<String> {
    let one = |c: &Changed| {
        format!(
            "{} {:+.0} % (± {:.0} %)",
            names[c.joint],
            100.0 * c.change,
            100.0 * c.std
        )
    };
    let list: Vec<String> = changed.iter().map(one).collect();
    (!list.is_empty()).then(|| {
        format!(
            "heldout: friction is another there than in data, as on another day or at another temperature: {}; no cause, size or verdict \
             comes from that, but it is in every error on the held-out recording",
            list.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_one_that_trajectories_of_a_day_do_not_show() {
        let settings = OtherDaySettings::default();
        let own = [0.01, -0.01, 0.0, 0.02, -0.02, 0.0];
        let (change, std) = difference(&own, &[0.09, 0.11, 0.1], &settings).unwrap();
        assert!(
            (change - 0.1).abs() < 1e-12 && (0.005..0.02).contains(&std),
            "{std}"
        );
        // As far apart as the trajectories are.
        assert_eq!(difference(&own, &[0.03, 0.0, 0.02], &settings), None);
        // Sure, and nothing.
        assert_eq!(
            difference(&[0.0, 1e-4, 0.0], &[0.01, 0.0101], &settings),
            None
        );
        // Two numbers have no spread.
        assert_eq!(difference(&[0.0], &[0.1], &settings), None);
    }
}
