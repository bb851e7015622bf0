//! Results in the layout of the controller's identification program (`IDNT<group>.PRG`): seven lines of comment, numbered
//! parameters, friction of the axes, the number of the dynamic model.

use crate::description::{Kind, Moves};
use crate::identification::{ALLOWED, Identified};
use physics::robot::drive::Drive;
use std::fmt::Write;

/// What a program says beyond the identification.
#[derive(Debug, Clone, Default)]
pub struct Extras<'a> {
    /// Date and time, as it is to stand there; a program without keeps the same bytes for the same recording.
    pub date: Option<&'a str>,
    /// Drive file: delays and thresholds of the additive torque.
    pub drive: Option<&'a Drive>,
}

/// The program.
///
/// Friction has the manual's sign: it counts as a torque against the motion, so its coefficients are negative there.
pub fn program(identified: &Identified, extras: &Extras) -> String {
    let machine = &identified.machine;
    let single = matches!(
        machine.description().kind,
        Kind::RotaryAxis | Kind::LinearAxis
    );
    let owner = if single {
        machine.axes()[0].name.clone()
    } else {
        machine.description().name.to_uppercase()
    };
    let mut out = comment(identified, &owner, extras.date);
    let _ = writeln!(out, "\nPROGRAM CONTINUE\nATTACH {owner}\n");
    let own = machine.model_parameters();
    let (model, friction) = identified.estimate.values.split_at(own);
    for (i, value) in machine.model().numbered(model).iter().enumerate() {
        let _ = writeln!(
            out,
            "{owner}.DynamicParameter[{}] = {}",
            i + 1,
            number(*value)
        );
    }
    for (j, (axis, pair)) in machine
        .axes()
        .iter()
        .zip(friction.chunks_exact(2))
        .enumerate()
    {
        let name = &axis.name;
        let _ = writeln!(out, "\n{name}.ViscousFriction = {}", number(-pair[0]));
        let _ = writeln!(out, "{name}.CoulombFriction = {}", number(-pair[1]));
        let Some(drive) = extras.drive else { continue };
        if let Some(cycles) = drive.torque_delay.as_ref().and_then(|d| d.get(j)) {
            let _ = writeln!(out, "{name}.AdditiveTorqueDelay = {cycles}");
        }
        if let Some(threshold) = drive.torque_threshold.as_ref().and_then(|t| t.get(j)) {
            let _ = writeln!(out, "{name}.TorqueThreshold = {}", number(*threshold));
        }
    }
    let model = machine.description().dynamic_model;
    let _ = writeln!(out, "\n{owner}.DynamicModel = {model}");
    let _ = writeln!(out, "\nDETACH {owner}\nTERMINATE PROGRAM");
    out
}

/// The seven lines at the top.
fn comment(identified: &Identified, owner: &str, date: Option<&str>) -> String {
    let list = |item: &dyn Fn(usize) -> String| -> String {
        let items = (0..identified.axes.len()).map(|j| format!("axis {} = {}; ", j + 1, item(j)));
        items.collect::<String>().trim_end().to_owned()
    };
    let axes = &identified.axes;
    let percent = |value: f64| format!("{:.2} %", 100.0 * value);
    let worst = list(&|j| percent(axes[j].max_relative));
    let mean = list(&|j| percent(axes[j].mean_relative));
    let moving = list(&|j| {
        let unit = match identified.machine.axes()[j].kind {
            Moves::Rotary => "rad/s",
            Moves::Linear => "m/s",
        };
        let lower = axes[j].band.lower;
        format!(
            "{} samples (threshold = {lower:.6} {unit})",
            axes[j].samples
        )
    });
    let verdict = if identified.success() {
        "succeeded"
    } else {
        "failed"
    };
    let [recorded, kept] = identified.samples;
    format!(
        "'Dynamic parameter identification for {owner} {verdict}!\n\
         'Identification date and time: {}\n\
         'Max relative torque error: {worst} (maximal allowed = {:.2} %)\n\
         'Mean relative torque error: {mean}\n\
         'Signal filter cutoff frequency = {:.3} Hz\n\
         'Signal data length = {kept} samples (raw record length = {recorded} samples)\n\
         'Moving data length: {moving}\n",
        date.unwrap_or("-"),
        100.0 * ALLOWED,
        identified.filter_hz,
    )
}

/// Nine decimals and an exponent of a sign and at least two digits.
fn number(value: f64) -> String {
    let text = format!("{value:.9e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    format!(
        "{mantissa}e{}{:02}",
        if exponent < 0 { '-' } else { '+' },
        exponent.abs()
    )
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_as_the_controller_writes_them() {
        assert_eq!(number(87.593_093_07), "8.759309307e+01");
        assert_eq!(number(-0.972_465_820_7), "-9.724658207e-01");
        assert_eq!(number(0.0), "0.000000000e+00");
        assert_eq!(number(1e100), "1.000000000e+100");
    }
}
