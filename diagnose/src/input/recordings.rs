//! Checks of the recordings before any physics: faults, effects that they cannot show, and notes on their preparation.

use crate::catalogue::Unit;
use crate::catalogue::effect::Effect;
use crate::catalogue::info::Need;
use crate::input::frames::Frames;
use crate::motion::frame::Frame;
use crate::schema::{NotIdentifiable, SHORT};
use crate::settings::{InputSettings, LadderSettings};
use crate::simulator::NominalModel;
use datasets::Recording;
use datasets::check::{CheckReport, check};
use datasets::prepare::{PrepareReport, Source};
use model::preparation::check::{add_channel, options};
use physics::robot::Robot;

/// Checks of both recordings, the fitted one, then the held-out one: those of `train`, without the requirements of its own fit.
pub fn checked(
    model: &NominalModel,
    frames: &Frames,
    recordings: [&Recording; 2],
) -> Vec<CheckReport> {
    let both = [&frames.data, &frames.heldout].into_iter().zip(recordings);
    both.filter_map(|(frame, recording)| one(model, frame, recording))
        .collect()
}

fn one(model: &NominalModel, frame: &Frame, recording: &Recording) -> Option<CheckReport> {
    let options = options(&model.robot);
    let mut report = check(recording, frame.prepared(), &options).ok()?;
    // Against the robot's own earlier recordings the channel is a cause among others: no description says how large torque is.
    if model.replay().is_none() {
        add_channel(&mut report, &model.robot, recording, frame.prepared());
    }
    Some(report)
}

/// Effects that the fitted recording cannot show, each with the reason.
pub fn not_identifiable(
    frames: &Frames,
    report: Option<&CheckReport>,
    robot: &Robot,
    settings: &InputSettings,
) -> Vec<NotIdentifiable> {
    let names = robot.joint_names();
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
        let unit = match robot.joints()[j].kind.is_rotation() {
            true => Unit::Rad,
            false => Unit::Metre,
        };
        if high - low < settings.still {
            add(&Effect::ALL, own, format!("{name} never moves"));
            continue;
        }
        let Some(figures) = report.and_then(|r| r.joints.get(j)) else {
            continue;
        };
        if figures.cycles < settings.cycles {
            let effects = needing(Need::Reversals);
            let reason = format!(
                "{name} turns round {:.0} times; record six reversals or more",
                2.0 * figures.cycles
            );
            add(&effects, own.clone(), reason);
        }
        if figures.top_speed < settings.slow {
            let effects = needing(Need::Speed);
            let reason = format!(
                "{name} moves at {:.3} {unit}/s at most; record faster motion",
                figures.top_speed
            );
            add(&effects, own.clone(), reason);
        }
        if high - low < settings.narrow {
            let effects = needing(Need::Range);
            let reason = format!(
                "{name} covers {:.2} {unit}; record more of its range",
                high - low
            );
            add(&effects, own, reason);
        }
    }
    let seconds = frames.data.len() as f64 / frames.data.row_rate();
    if seconds < settings.short {
        let effects = needing(Need::Minute);
        let reason = format!(
            "{seconds:.0} s of motion are too short to tell it from other effects; record a minute or more"
        );
        add(&effects, names.to_vec(), reason);
    }
    let rate = frames.data.report().rate_hz;
    if rate < settings.coarse {
        let effects = needing(Need::Rate);
        let reason = format!(
            "at {rate:.0} Hz nothing above {:.0} Hz is recorded: no resonance and no ripple of the motor's order",
            0.5 * rate
        );
        add(&effects, names.to_vec(), reason);
    }
    out
}

/// Effects with a given need of a recording.
fn needing(need: Need) -> Vec<Effect> {
    let all = Effect::ALL.into_iter();
    all.filter(|e| e.info().needs.contains(&need)).collect()
}

/// Sources of velocity and acceleration as text.
fn derivatives(report: &PrepareReport) -> String {
    let word = |source: &Source| match source {
        Source::Recorded => "as recorded",
        Source::Derived => "derived from position",
        Source::Replaced => "derived from position instead of the recorded one",
        Source::Fused => "derived from position and recorded velocity together",
    };
    let mut velocity: Vec<&str> = Vec::new();
    for source in &report.velocity {
        if !velocity.contains(&word(source)) {
            velocity.push(word(source));
        }
    }
    format!(
        "velocity {}, acceleration {}",
        velocity.join(" or, on other joints, "),
        word(&report.acceleration)
    )
}

/// Notes on the preparation of the recordings.
pub fn notes(frames: &Frames, settings: &InputSettings, ladder: &LadderSettings) -> Vec<String> {
    let mut out = Vec::new();
    for (what, frame) in [("data", &frames.data), ("heldout", &frames.heldout)] {
        let r = frame.report();
        let cutoff = r
            .cutoff_hz
            .map_or("interpolated without a low-pass".to_owned(), |c| {
                format!("low-passed at {c:.1} Hz")
            });
        out.push(format!(
            "{what}: {:.1} Hz, motion {cutoff}, {}",
            r.rate_hz,
            derivatives(r)
        ));
    }
    let (a, b) = (
        frames.data.report().rate_hz,
        frames.heldout.report().rate_hz,
    );
    let seconds = frames.data.len() as f64 / frames.data.row_rate();
    if frames.data.is_short(ladder) {
        out.push(format!(
            "{SHORT}: {seconds:.1} s of motion have too few stretches of {} s for a null. No chance of a gain and no confidence is estimated, \
             what halves a joint's error out of fold is listed as well, and no push is looked for in the held-out recording",
            ladder.stretch
        ));
    }
    if (a / b - 1.0).abs() > settings.rates {
        out.push(format!(
            "the recordings have different rates ({a:.0} and {b:.0} Hz): the held-out motion is resampled to the grid \
             on which effects are built, and scored at its own samples"
        ));
    }
    out
}
