//! Regions of motion in which the simulation error is concentrated, by joint: ranges of velocity, position, direction,
//! time, and time since the last command.

use crate::schema::Place;
use crate::score::Errors;
use crate::tracks::Replayed;

/// Number of regions that a coordinate is divided into, with equally many samples each.
const REGIONS: usize = 4;

/// Largest number of regions that the report lists.
const LISTED: usize = 12;

/// Regions that hold more of the squared error than of the time, largest share of the error first. For each joint and
/// coordinate at most one region is listed. `all` are errors of a roll-out; `rotates` says which joints are rotary.
pub fn places(
    all: &Errors,
    replayed: &Replayed,
    joints: &[String],
    rotates: &[bool],
) -> Vec<Place> {
    let n = joints.len();
    let weight = |j: usize| {
        let t = replayed.tracking[j];
        if replayed.moves[j] && t > 0.0 {
            t.powi(-2)
        } else {
            0.0
        }
    };
    let squared = crate::score::by_joint(all, n);
    let total: f64 = (0..n).map(|j| squared[j] * weight(j)).sum();
    if total <= 0.0 {
        return Vec::new();
    }
    let mut out = Vec::new();
    for j in 0..n {
        for (coordinate, unit) in coordinates(rotates[j]) {
            let mut samples = samples(all, replayed, j, coordinate);
            samples.sort_by(|a, b| a.0.total_cmp(&b.0));
            let best = regions(&samples, coordinate)
                .into_iter()
                .map(|part| {
                    let sum: f64 = samples[part.clone()].iter().map(|s| s.1).sum();
                    (part, sum * weight(j) / total)
                })
                .max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((part, share)) = best else { continue };
            // Samples of one value are in no order: such a region says nothing.
            let ends = [samples[part.start].0, samples[part.end - 1].0];
            if coordinate != "direction" && ends[0] == ends[1] {
                continue;
            }
            let own = squared[j] * weight(j) / total;
            let time = part.len() as f64 / samples.len() as f64;
            // Margin of a fifth: where the error is spread evenly, the coordinate says nothing.
            if share > own * time * 1.2 {
                out.push(Place {
                    joint: joints[j].clone(),
                    coordinate,
                    range: ends,
                    unit,
                    share_of_gap: share,
                    share_of_time: time,
                });
            }
        }
    }
    out.sort_by(|a, b| b.share_of_gap.total_cmp(&a.share_of_gap));
    out.truncate(LISTED);
    out
}

/// Name and unit of each coordinate of a joint.
fn coordinates(rotates: bool) -> [(&'static str, &'static str); 5] {
    let (position, velocity) = if rotates {
        ("rad", "rad/s")
    } else {
        ("m", "m/s")
    };
    [
        ("velocity", velocity),
        ("position", position),
        ("direction", "1"),
        ("time", "s"),
        ("command_time", "s"),
    ]
}

/// Regions as ranges of indices of samples sorted by the coordinate: two for the direction, else `REGIONS` with equally
/// many samples.
fn regions(samples: &[(f64, f64)], coordinate: &str) -> Vec<std::ops::Range<usize>> {
    let n = samples.len();
    if coordinate == "direction" {
        let middle = samples.partition_point(|s| s.0 < 0.0);
        let parts = [0..middle, middle..n];
        return parts.into_iter().filter(|p| !p.is_empty()).collect();
    }
    let cut = |k: usize| n * k / REGIONS;
    (0..REGIONS)
        .map(|k| cut(k)..cut(k + 1))
        .filter(|p| !p.is_empty())
        .collect()
}

/// Coordinate and squared error of each sample of a joint. Samples without velocity have no direction and are left out
/// there.
fn samples(all: &Errors, replayed: &Replayed, joint: usize, coordinate: &str) -> Vec<(f64, f64)> {
    let n = replayed.tracking.len();
    let mut out = Vec::new();
    for (errors, track) in all.iter().zip(&replayed.whole) {
        let mut changed = track.time[0];
        let mut last = track.commands[joint].value(track.time[0]);
        for row in 1..track.time.len() {
            let t = track.time[row];
            let command = track.commands[joint].value(t);
            if command != last {
                (changed, last) = (t, command);
            }
            let velocity =
                (track.q[(row, joint)] - track.q[(row - 1, joint)]) / (t - track.time[row - 1]);
            let at = match coordinate {
                "velocity" => velocity.abs(),
                "position" => track.q[(row, joint)],
                "direction" if velocity == 0.0 => continue,
                "direction" => velocity.signum(),
                "time" => t,
                _ => t - changed,
            };
            out.push((at, errors[row * n + joint].powi(2)));
        }
    }
    out
}
