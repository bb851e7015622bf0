//! The recordings before any physics: what is wrong with them, what they cannot show, and what was done to them.

use crate::analysis::Frames;
use crate::effect::Effect;
use crate::frame::Frame;
use crate::model::NominalModel;
use crate::report::NotIdentifiable;
use crate::scene::Scale;
use crate::shift::torque_shift;
use datasets::Recording;
use datasets::check::{CheckOptions, CheckReport, Finding, Kind, Severity, check, shift_finding};
use ndarray::Array2;

/// Longest shift between torque and motion that is looked for, s.
const LONGEST_SHIFT: f64 = 0.1;
/// Range of a joint that never moves, rad (m).
const STILL: f64 = 1e-3;
/// Scale of the torque beyond which its unit is in doubt.
const SCALE: f64 = 3.0;
/// Least correlation of measured and predicted torque for a scale to mean something.
const ALIKE: f64 = 0.8;
/// Motion below which effects that act over a session are hidden by the others, s.
const SHORT: f64 = 30.0;
/// Fewest cycles of a joint that show what happens at reversals.
const CYCLES: f64 = 3.0;
/// Speed below which viscous friction of any form is hidden by Coulomb friction, rad/s (m/s).
const SLOW: f64 = 0.05;
/// Range below which torques of the position look alike, rad (m).
const NARROW: f64 = 0.2;
/// Rate below which what vibrates is not recorded, Hz.
const COARSE: f64 = 40.0;

/// Checks both recordings against each other and the model: the fitted one, then the held-out one.
pub fn checked(
    model: &NominalModel,
    frames: &Frames,
    recordings: [&Recording; 2],
) -> Vec<CheckReport> {
    let both = [&frames.data, &frames.heldout].into_iter().zip(recordings);
    both.filter_map(|(frame, recording)| one(model, frame, recording, &frames.scale))
        .collect()
}

fn one(
    model: &NominalModel,
    frame: &Frame,
    recording: &Recording,
    scale: &Scale,
) -> Option<CheckReport> {
    let predicted = model.predicted(frame, scale);
    let joints = model.robot.joints();
    let options = CheckOptions {
        joints: model.robot.joint_names(),
        position_limits: joints
            .iter()
            .map(|j| [j.limits.lower, j.limits.upper])
            .collect(),
        // Scales are judged below, where measured and predicted torque are alike.
        torque_reference: Vec::new(),
    };
    let mut report = check(recording, frame.prepared(), &options).ok()?;
    report
        .findings
        .extend(scale_findings(frame, &predicted, &options.joints));
    let mut shifts: Vec<f64> = torque_shift(recording, &predicted, LONGEST_SHIFT)
        .into_iter()
        .flatten()
        .collect();
    shifts.sort_by(f64::total_cmp);
    // One clock for all joints: a shift that only some of them show is not the recording's.
    if let (Some(&least), Some(&most)) = (shifts.first(), shifts.last()) {
        let step = recording.median_step();
        let middle = shifts[shifts.len() / 2];
        if least.signum() == most.signum() && most - least < 2.0 * step {
            report.findings.extend(shift_finding(middle, step));
        }
    }
    report
        .findings
        .sort_by_key(|f| std::cmp::Reverse(f.severity));
    Some(report)
}

/// Torque of another unit: measured torque that follows the predicted one at a scale far from one. Where most joints
/// do, one finding speaks for all.
fn scale_findings(frame: &Frame, predicted: &Array2<f64>, names: &[String]) -> Vec<Finding> {
    let scales: Vec<Option<f64>> = (0..frame.dof())
        .map(|j| {
            let (t, p) = (frame.tau.column(j), predicted.column(j));
            let (tt, pp, tp) = (t.dot(&t), p.dot(&p), t.dot(&p));
            (tp.abs() > ALIKE * (tt * pp).sqrt()).then(|| tp / pp)
        })
        .collect();
    let mut known: Vec<f64> = scales.iter().flatten().copied().collect();
    known.sort_by(f64::total_cmp);
    let far = |s: f64| !(1.0 / SCALE..=SCALE).contains(&s);
    let finding = |joint, value, message| Finding {
        kind: Kind::TorqueScale,
        severity: Severity::Severe,
        joint,
        row: None,
        value,
        parameters: Vec::new(),
        message,
    };
    let remedy = "give gear ratios and torque constants by --drive, or multiply the column";
    if known.len() > 1 && 2 * known.iter().filter(|s| far(**s)).count() > known.len() {
        let list: Vec<String> = scales
            .iter()
            .map(|s| s.map_or("unknown".to_owned(), |s| format!("{s:.4}")))
            .collect();
        let middle = known[known.len() / 2];
        let guess = if middle.abs() < 1.0 {
            "motor current in A or motor-side torque, not joint torque in N·m"
        } else {
            "another unit than N·m"
        };
        let message = format!(
            "the recorded torque is {} times what the model predicts, joint by joint: it looks like {guess}; {remedy}",
            list.join(", ")
        );
        return vec![finding(None, middle, message)];
    }
    let each = scales
        .iter()
        .enumerate()
        .filter_map(|(j, s)| Some((j, s.filter(|s| far(*s))?)));
    each.map(|(j, s)| {
        let message = format!(
            "{}: the recorded torque is {s:.4} times what the model predicts (current in A, motor side, or a sign?); \
             {remedy}",
            names[j]
        );
        finding(Some(j), s, message)
    })
    .collect()
}

/// Effects that the fitted recording cannot show, and why.
pub fn not_identifiable(
    frames: &Frames,
    report: Option<&CheckReport>,
    names: &[String],
) -> Vec<NotIdentifiable> {
    let mut out = Vec::new();
    let mut add = |effects: &[Effect], joints: Vec<String>, reason: String| {
        out.extend(effects.iter().map(|&effect| NotIdentifiable {
            effect: Some(effect),
            joints: joints.clone(),
            reason: reason.clone(),
        }));
    };
    for (j, (low, high)) in frames.scale.range.iter().enumerate() {
        let own = vec![names[j].clone()];
        let name = &names[j];
        if high - low < STILL {
            add(&Effect::ALL, own, format!("{name} never moves"));
            continue;
        }
        let Some(figures) = report.and_then(|r| r.joints.get(j)) else {
            continue;
        };
        if figures.cycles < CYCLES {
            let effects = [
                Effect::AsymmetricFriction,
                Effect::StribeckFriction,
                Effect::PreslidingHysteresis,
                Effect::Backlash,
            ];
            let reason = format!(
                "{name} turns round {:.0} times; record six reversals or more",
                2.0 * figures.cycles
            );
            add(&effects, own.clone(), reason);
        }
        if figures.top_speed < SLOW {
            let effects = [Effect::NonlinearViscousFriction, Effect::RotorInertia];
            let reason = format!(
                "{name} moves at {:.3} rad/s at most; record faster motion",
                figures.top_speed
            );
            add(&effects, own.clone(), reason);
        }
        if high - low < NARROW {
            let effects = [
                Effect::Counterbalance,
                Effect::EncoderOffset,
                Effect::TorqueRipple,
            ];
            let reason = format!(
                "{name} covers {:.2} rad; record more of its range",
                high - low
            );
            add(&effects, own, reason);
        }
    }
    let seconds = frames.data.len() as f64 / frames.data.row_rate();
    if seconds < SHORT {
        let effects = [
            Effect::FrictionDrift,
            Effect::LinkParameters,
            Effect::TorqueRipple,
        ];
        let reason = format!(
            "{seconds:.0} s of motion are too short to tell it from other effects; record a minute or more"
        );
        add(&effects, names.to_vec(), reason);
    }
    let rate = frames.data.report().rate_hz;
    if rate < COARSE {
        let effects = [Effect::JointElasticity, Effect::TorqueRipple];
        let reason = format!(
            "at {rate:.0} Hz nothing above {:.0} Hz is recorded: no resonance and no ripple of the motor's order",
            0.5 * rate
        );
        add(&effects, names.to_vec(), reason);
    }
    out
}

/// What was done to the recordings.
pub fn notes(frames: &Frames) -> Vec<String> {
    let mut out = Vec::new();
    for (what, frame) in [("data", &frames.data), ("heldout", &frames.heldout)] {
        let r = frame.report();
        let cutoff = r
            .cutoff_hz
            .map_or("interpolated without a low-pass".to_owned(), |c| {
                format!("low-passed at {c:.1} Hz")
            });
        out.push(format!(
            "{what}: {:.1} Hz, motion {cutoff}, derivatives made from position",
            r.rate_hz
        ));
    }
    let (a, b) = (
        frames.data.report().rate_hz,
        frames.heldout.report().rate_hz,
    );
    if (a / b - 1.0).abs() > 0.02 {
        out.push(format!(
            "the recordings have different rates ({a:.0} and {b:.0} Hz): the held-out motion is resampled to the grid \
             on which effects are built, and scored at its own samples"
        ));
    }
    out
}
