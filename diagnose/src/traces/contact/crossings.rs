//! Bursts at sign changes of a joint's load: there a gap of its transmission is crossed. A force from outside
//! does not wait for them.

use crate::motion::frame::Frame;
use crate::settings::ContactSettings;
use crate::traces::impacts::changes;
use ndarray::ArrayView1;
use std::ops::Range;

/// Window around a sign change in which the gap is left and crossed, s before and after.
const REACH: (f64, f64) = (0.1, 0.25);

/// Whether the bursts (`samples`) come with the sign changes of one joint's load. A part `crossing` of the
/// changes must lie in bursts, and as large a part of the joint's squared `torque` in the bursts around them.
pub(super) fn cross(
    frame: &Frame,
    torque: ArrayView1<f64>,
    load: ArrayView1<f64>,
    bursts: &[Range<usize>],
    settings: &ContactSettings,
) -> bool {
    let rate = frame.report().rate_hz;
    let (before, after) = ((REACH.0 * rate) as usize, (REACH.1 * rate) as usize);
    let swing = settings.swing * load.std(0.0);
    let segments = &frame.samples().segments;
    let around = |i: usize| {
        let own = segments.iter().find(|s| s.contains(&i))?;
        Some(i.saturating_sub(before).max(own.start)..(i + after).min(own.end))
    };
    let swings = |r: &Range<usize>| r.clone().any(|i| load[i].abs() > swing);
    let changes = changes(load.iter().copied(), segments);
    let places: Vec<Range<usize>> = changes
        .into_iter()
        .filter_map(around)
        .filter(swings)
        .collect();
    let hit = |r: &&Range<usize>| bursts.iter().any(|b| b.start < r.end && r.start < b.end);
    let struck = places.iter().filter(hit).count() as f64;
    let mut near = vec![false; torque.len()];
    places.iter().cloned().for_each(|r| near[r].fill(true));
    let (mut there, mut all) = (0.0, 0.0);
    for i in bursts.iter().cloned().flatten() {
        let square = torque[i] * torque[i];
        all += square;
        there += if near[i] { square } else { 0.0 };
    }
    let most = settings.crossing;
    places.len() >= settings.fewest_crossings
        && struck >= most * places.len() as f64
        && there >= most * all
}

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::{PrepareOptions, Recording};
    use ndarray::{Array1, Array2};

    #[test]
    fn blows_wait_for_the_load_and_pushes_do_not() {
        let n = 4000;
        let time: Vec<f64> = (0..n).map(|i| 0.004 * f64::from(i)).collect();
        let load: Array1<f64> = time.iter().map(|t| (2.0 * t).sin()).collect();
        let q = Array2::from_shape_fn((n as usize, 1), |(i, _)| (0.5 * time[i]).sin());
        let recording = Recording::new("r", time.clone(), q.clone(), Some(q.clone()));
        let frame = Frame::new(&recording, q, &PrepareOptions::low_passed(8.0)).unwrap();
        let of = |starts: &[usize]| {
            let bursts: Vec<Range<usize>> = starts.iter().map(|&s| s..s + 30).collect();
            let mut torque = Array1::zeros(n as usize);
            for b in &bursts {
                b.clone().for_each(|i| torque[i] = 1.0);
            }
            cross(
                &frame,
                torque.view(),
                load.view(),
                &bursts,
                &ContactSettings::default(),
            )
        };
        let changes = super::changes(load.iter().copied(), &frame.samples().segments);
        assert!(changes.len() > 8);
        assert!(of(&changes));
        // A push here and there, one of them over a change.
        assert!(!of(&[changes[2], changes[4] + 100, changes[6] + 150]));
        // As often as the load changes, but between the changes.
        let between: Vec<usize> = changes
            .iter()
            .map(|c| c + 120)
            .filter(|c| c + 30 < n as usize)
            .collect();
        assert!(!of(&between));
    }
}
