//! The verdict.
//!
//! Judged joint by joint on the residual of the last step, out of fold on the fitted recording, without pushes.
//! In motion and at rest it is compared with the floor, and away from reversals it is tested for structure.
//! Held-out torque can only lower the verdict: by the part of it that pushes cut out, and where no cause is confirmed on it and all
//! causes together make its error no smaller.

use crate::motion::frame::Frame;
use crate::motion::standing::{Judged, State};
use crate::schema::{Unexplained, Verdict};
use crate::settings::VerdictSettings;
use crate::traces::unknown::Misfit;
use ndarray::Array2;

/// Evidence for the verdict.
pub(crate) struct Evidence<'a> {
    /// Whether each joint lacks a usable torque channel.
    pub dead: &'a [bool],
    /// Whether some joint moves long enough to be judged.
    pub moves: bool,
    /// Gap as given on the fitted recording: sum over joints of the squared NRMSE.
    pub given: f64,
    /// Structure in the residual, by joint.
    pub left: &'a [Option<Misfit>],
    /// Residual of each joint that the causes leave, and its noise floor.
    pub rest: &'a [Unexplained],
    /// Whether any cause is listed.
    pub causes: bool,
    /// Whether a push is listed.
    pub pushed: bool,
    /// Part of the held-out samples that pushes cut out.
    pub cut: f64,
    /// Whether the errors as given are what two executions of one motion differ by.
    pub usual: bool,
    /// Mean NRMSE on the held-out recording, as given and with all causes. None unless the causes fail to lower it and
    /// none of them is confirmed there.
    pub denied: Option<[f64; 2]>,
}

/// Whether each joint's torque channel is unusable: nearly all samples have one value.
pub(crate) fn dead(frame: &Frame, settings: &VerdictSettings) -> Vec<bool> {
    let one = |column: ndarray::ArrayView1<f64>| {
        let mut values: Vec<f64> = column.to_vec();
        values.sort_by(f64::total_cmp);
        let runs = values.chunk_by(|a, b| a == b).map(<[f64]>::len);
        runs.max().unwrap_or(0) as f64 >= settings.same * values.len() as f64
    };
    frame.tau.columns().into_iter().map(one).collect()
}

/// Whether some joint with a torque channel moves long enough to be judged.
pub(crate) fn moves(
    frame: &Frame,
    states: &Array2<State>,
    dead: &[bool],
    settings: &VerdictSettings,
) -> bool {
    let least = settings.least_motion * frame.report().rate_hz;
    let seconds = |j: usize| {
        states
            .column(j)
            .iter()
            .filter(|s| **s == State::Moving)
            .count()
    };
    (0..frame.dof()).any(|j| !dead[j] && seconds(j) as f64 >= least)
}

/// Residual of every joint without `skipped` samples. `floors` is the noise floor by joint, N·m (N).
pub(crate) fn remainder(
    floors: &[Option<f64>],
    judged: &Judged,
    skipped: &[bool],
    left: &[Option<Misfit>],
    names: &[String],
    dead: &[bool],
    settings: &VerdictSettings,
) -> Vec<Unexplained> {
    let rms = |j: usize, state: State| {
        let rows = judged.state.column(j);
        let gap = judged.gap.column(j);
        let squares: Vec<f64> = (0..rows.len())
            .filter(|&i| rows[i] == state && !skipped[i])
            .map(|i| gap[i] * gap[i])
            .collect();
        let n = squares.len();
        (n >= settings.fewest_samples && !dead[j])
            .then(|| (squares.iter().sum::<f64>() / n as f64).sqrt())
    };
    (0..names.len())
        .map(|j| {
            let left = left[j].filter(|_| !dead[j]);
            Unexplained {
                joint: names[j].clone(),
                nrmse: left.map(|l| l.structured()),
                learnable: left.map(|l| l.learnable),
                moving: rms(j, State::Moving),
                standing: rms(j, State::Standing),
                floor: floors[j].filter(|_| !dead[j]),
            }
        })
        .collect()
}

/// Largest error of a joint, in motion or at rest, over its floor. None where nothing was judged; infinite
/// where an error is left and no floor is known.
fn over(rest: &Unexplained) -> Option<f64> {
    let most = rest
        .moving
        .into_iter()
        .chain(rest.standing)
        .reduce(f64::max)?;
    Some(most / rest.floor.unwrap_or(0.0))
}

/// The verdict, and the reason where it is `cannot_tell`.
pub(crate) fn verdict(e: &Evidence, settings: &VerdictSettings) -> (Verdict, Option<String>) {
    let tell = |why: &str| (Verdict::CannotTell, Some(why.to_owned()));
    if e.dead.iter().all(|d| *d) {
        return tell("no joint has a usable torque channel");
    }
    if !e.moves && !e.pushed {
        return tell(
            "there is hardly any motion, and nothing pushes the robot; record motion of every joint",
        );
    }
    let clear = e.left.iter().zip(e.dead).any(|(left, dead)| {
        let s = left.filter(|_| !dead).map_or(0.0, |l| l.structured());
        s > settings.plain || s > settings.clear && s * s > settings.clear_share * e.given
    });
    if clear {
        return (Verdict::UnknownEffect, None);
    }
    let worst = e
        .rest
        .iter()
        .filter_map(|r| Some((r, over(r)?)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let floor = worst.is_some_and(|w| w.1 <= settings.at_floor);
    if let (true, true, Some([given, explained])) = (e.causes, floor, e.denied) {
        return tell(&format!(
            "what explains the fitted recording explains nothing of the held-out one ({given:.3} as given, {explained:.3} with it); the \
             two do not show the same torque or the same robot"
        ));
    }
    match (e.causes, floor) {
        (false, floor) if floor || e.usual => (Verdict::NoGap, None),
        (true, true) if e.cut <= settings.most_cut => (Verdict::Explained, None),
        (true, _) => (Verdict::PartlyExplained, None),
        (false, _) => {
            let rest = worst.map_or("nothing could be judged".to_owned(), |(r, _)| {
                let number = |x: Option<f64>| x.map_or("unknown".to_owned(), |x| format!("{x:.3}"));
                format!(
                    "on {} an error of {} in motion and {} at rest is left where the torque's noise is {} (N·m or N), without a \
                     pattern and without a cause",
                    r.joint,
                    number(r.moving),
                    number(r.standing),
                    number(r.floor)
                )
            });
            (Verdict::CannotTell, Some(rest))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(moving: f64, standing: Option<f64>, causes: bool, cut: f64) -> (Verdict, Option<String>) {
        with(moving, standing, causes, cut, &VerdictSettings::default())
    }

    fn with(
        moving: f64,
        standing: Option<f64>,
        causes: bool,
        cut: f64,
        settings: &VerdictSettings,
    ) -> (Verdict, Option<String>) {
        let rest = Unexplained {
            joint: "j".to_owned(),
            nrmse: Some(0.02),
            learnable: Some(0.0),
            moving: Some(moving),
            standing,
            floor: Some(1.0),
        };
        let left = Misfit {
            error: 0.02,
            lasting: 1.0,
            learnable: 0.0,
            rows: 1000,
        };
        let evidence = Evidence {
            dead: &[false],
            moves: true,
            given: 0.01,
            left: &[Some(left)],
            rest: &[rest],
            causes,
            pushed: false,
            cut,
            usual: false,
            denied: None,
        };
        verdict(&evidence, settings)
    }

    #[test]
    fn the_floor_decides_where_nothing_has_structure() {
        let name = |v: (Verdict, Option<String>)| v.0;
        assert_eq!(name(of(1.4, None, false, 0.0)), Verdict::NoGap);
        assert_eq!(name(of(1.4, Some(0.9), true, 0.1)), Verdict::Explained);
        assert_eq!(name(of(1.4, None, true, 0.3)), Verdict::PartlyExplained);
        assert_eq!(name(of(1.6, None, true, 0.0)), Verdict::PartlyExplained);
        // Each of both numbers decides.
        let strict = VerdictSettings {
            at_floor: 1.3,
            ..VerdictSettings::default()
        };
        assert_eq!(
            name(with(1.4, None, true, 0.0, &strict)),
            Verdict::PartlyExplained
        );
        let clear = VerdictSettings {
            plain: 0.01,
            ..VerdictSettings::default()
        };
        assert_eq!(
            name(with(1.4, None, true, 0.0, &clear)),
            Verdict::UnknownEffect
        );
        // The score looks at rests as well.
        let (rest, why) = of(1.2, Some(9.0), false, 0.0);
        assert_eq!(rest, Verdict::CannotTell);
        assert!(why.is_some_and(|w| w.contains("9.000 at rest")));
    }

    #[test]
    fn nothing_is_told_without_torque_or_motion_and_structure_comes_first() {
        let left = |lasting| Misfit {
            error: 0.2,
            lasting,
            learnable: 0.0,
            rows: 1000,
        };
        let of = |dead: bool, moves: bool, pushed: bool, lasting: f64| {
            let misfit = left(lasting);
            let evidence = Evidence {
                dead: &[dead],
                moves,
                given: 0.05,
                left: &[Some(misfit)],
                rest: &[],
                causes: true,
                pushed,
                cut: 0.0,
                usual: false,
                denied: None,
            };
            verdict(&evidence, &VerdictSettings::default())
        };
        let (name, why) = of(true, true, false, 0.0);
        assert_eq!(name, Verdict::CannotTell);
        assert!(why.unwrap().contains("torque channel"));
        let (name, why) = of(false, false, false, 0.0);
        assert_eq!(name, Verdict::CannotTell);
        assert!(why.unwrap().contains("motion"));
        // A push tells something of a robot that stands.
        assert_eq!(of(false, false, true, 0.0).0, Verdict::PartlyExplained);
        // 0.2 of the torque, all of it lasting: more than anybody calls plain.
        assert_eq!(of(false, true, false, 1.0).0, Verdict::UnknownEffect);
        // What has the floor's size ten times over is judged by the worse of motion and rest.
        let rest = |moving, standing, floor| Unexplained {
            joint: "j".to_owned(),
            nrmse: None,
            learnable: None,
            moving,
            standing,
            floor,
        };
        assert_eq!(over(&rest(Some(2.0), Some(5.0), Some(0.5))), Some(10.0));
        assert_eq!(over(&rest(None, None, Some(0.5))), None);
        assert_eq!(over(&rest(Some(2.0), None, None)), Some(f64::INFINITY));
    }
}
