//! Recordings checked before anything is fitted, and what is said of them.

use crate::arguments::Arguments;
use crate::input::{self, Input};
use crate::runtime::pool;
use datasets::check::{CheckReport, Complaint, Severity};
use datasets::prepare::PrepareOptions;
use model::directory::json;
use model::failure::Failure;
use model::preparation::check::check_recording;
use physics::robot::Robot;

/// Width of the lines.
const WIDTH: usize = 100;

/// Recordings of `--data`, checked.
pub struct Checked {
    /// The robot they are of.
    pub robot: Robot,
    /// Report of each recording.
    pub reports: Vec<CheckReport>,
}

/// Reads and checks recordings as `train --check-only` does.
///
/// # Errors
/// Input that cannot be used.
pub fn check(arguments: &Arguments) -> Result<Checked, Failure> {
    pool(&arguments.running)?.install(|| {
        let input = input::read(arguments)?;
        let reports = reports(&input, &prepare_options(arguments))?;
        Ok(Checked {
            robot: input.setup.robot,
            reports,
        })
    })
}

impl Checked {
    /// What `--check-only --json` prints.
    pub fn json(&self) -> String {
        json(&self.reports)
    }

    /// What `--check-only` prints.
    pub fn lines(&self) -> Vec<String> {
        lines(&self.robot, &self.reports, true)
    }
}

/// Options by which recordings are prepared for the check and for the fit.
pub(crate) fn prepare_options(arguments: &Arguments) -> PrepareOptions {
    PrepareOptions {
        cutoff_hz: arguments.cutoff_hz,
        ..PrepareOptions::default()
    }
}

/// Checks each of the training recordings.
pub(crate) fn reports(
    input: &Input,
    options: &PrepareOptions,
) -> Result<Vec<CheckReport>, Failure> {
    let check = |recording| check_recording(&input.setup.robot, recording, options);
    Ok(input.data.iter().map(check).collect::<Result<_, _>>()?)
}

/// Lines on the recordings: all of the check, or a line each and the severe findings. Parts of the description beyond the robot come
/// first.
pub(crate) fn lines(robot: &Robot, reports: &[CheckReport], whole: bool) -> Vec<String> {
    let mut out: Vec<String> = robot
        .notes()
        .iter()
        .map(|n| format!("Note: {n}."))
        .collect();
    for finding in robot.findings() {
        wrap(&mut out, &format!("Warning: {finding}."), "");
    }
    for report in reports {
        out.push(format!(
            "{}: {} samples, {} trajectories, {:.0} s at {:.1} Hz",
            report.source, report.samples, report.trajectories, report.duration_s, report.rate_hz
        ));
        if let (Some(r), true) = (&report.repeatability, whole) {
            let floor: Vec<String> = r
                .moving
                .iter()
                .map(|v| v.map_or_else(|| "–".into(), |v| format!("{v:.3}")))
                .collect();
            out.push(format!(
                "  {} repeated motions; spread in motion {} N·m",
                r.pairs.len(),
                floor.join(" ")
            ));
        }
        for complaint in &report.doctor {
            if whole || complaint.severity == Severity::Severe {
                wrap(
                    &mut out,
                    &format!("{:?}: {}", complaint.severity, seen(complaint)),
                    "  ",
                );
                if let Some(lines) = &complaint.drive {
                    out.push("    drive file (--drive FILE.toml):".to_owned());
                    out.extend(lines.lines().map(|line| format!("      {line}")));
                }
                wrap(&mut out, &format!("Do: {}.", complaint.advice), "    ");
            }
        }
        for finding in report.findings.iter().filter(|f| !report.is_told(f)) {
            if whole || finding.severity == Severity::Severe {
                out.push(format!("  {:?}: {}", finding.severity, finding.message));
            }
        }
        if whole && report.doctor.is_empty() && report.findings.is_empty() {
            out.push("  nothing is wrong with it".to_owned());
        }
    }
    out
}

/// Severe points of the description and of the recordings, each as one line.
pub(crate) fn severe(robot: &Robot, reports: &[CheckReport]) -> Vec<String> {
    let mut out: Vec<String> = robot.findings().iter().map(|f| format!("{f}.")).collect();
    for report in reports {
        let of = |text: String| format!("{}: {text}", report.source);
        let told = report
            .doctor
            .iter()
            .filter(|c| c.severity == Severity::Severe);
        out.extend(told.map(|c| of(format!("{} Do: {}.", seen(c), c.advice))));
        let found = report
            .findings
            .iter()
            .filter(|f| !report.is_told(f) && f.severity == Severity::Severe);
        out.extend(found.map(|f| of(f.message.clone())));
    }
    out
}

/// A complaint about the torque channel: observation and meaning.
fn seen(complaint: &Complaint) -> String {
    format!(
        "{}: {}. That is {}.",
        complaint.ailment.title(),
        complaint.seen,
        complaint.means
    )
}

fn wrap(out: &mut Vec<String>, text: &str, indent: &str) {
    out.extend(
        report::wrapped(text, WIDTH, indent)
            .lines()
            .map(str::to_owned),
    );
}
