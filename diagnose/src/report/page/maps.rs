//! Maps of the gap: shares by region, and the residual over the coordinates that may drive it.

use crate::outcome::Outcome;
use crate::schema::Diagnosis;
use crate::traces::order::Orders;
use ndarray::Array2;
use report::figure::{HeatMap, Ink, Panel, Plot};
use report::{Cell, Column, Figure, Section, Table};

/// Number of joints whose maps are drawn, those with the largest gap.
const MAPS: usize = 3;
/// Number of bins of a map over its coordinate.
const BINS: usize = 40;

/// Section with shares by joint and coordinate.
pub(super) fn places(d: &Diagnosis) -> Section {
    let mut coordinates: Vec<&str> = d.places.iter().map(|p| p.coordinate).collect();
    coordinates.sort_unstable();
    coordinates.dedup();
    let title = "Share of the gap in the worst region of each coordinate";
    let mut map = HeatMap::new(title, coordinates.iter().map(|c| c.replace('_', " ")));
    for joint in &d.joints {
        let share = |c: &&str| {
            let own = d
                .places
                .iter()
                .filter(|p| p.joint == *joint && p.coordinate == *c);
            own.map(|p| p.share_of_gap).reduce(f64::max)
        };
        let row: Vec<Option<f64>> = coordinates.iter().map(share).collect();
        if row.iter().any(Option::is_some) {
            map = map.row(joint, &row);
        }
    }
    let head = [
        Column::text("joint"),
        Column::text("coordinate"),
        Column::text("range"),
        Column::number("share of gap"),
        Column::text("90 % interval"),
        Column::number("share of time"),
    ];
    let table = d.places.iter().fold(Table::new(head), |t, p| {
        t.row([
            Cell::text(&p.joint),
            Cell::text(p.coordinate.replace('_', " ")),
            Cell::text(format!("{:.3} … {:.3} {}", p.range[0], p.range[1], p.unit)),
            Cell::number(p.share_of_gap, 2),
            p.share_interval.map_or_else(Cell::missing, |[low, high]| {
                Cell::text(format!("{low:.2} … {high:.2}"))
            }),
            Cell::number(p.share_of_time, 2),
        ])
    });
    Section::new("Where the gap lies")
        .figure(map.draw("Of all joints' squared error, relative to their torque. A region that holds far more of the gap than of the time is where to look."))
        .details(Section::new("The regions").table(table))
}

/// Section with the residual of the worst joints, as given and beside the causes.
pub(super) fn maps(outcome: &Outcome) -> Section {
    let d = &outcome.diagnosis;
    let (gap, left) = (&outcome.explanation.gap, &outcome.explanation.residual);
    let frame = &outcome.frames.heldout;
    let m = frame.samples();
    let mut order: Vec<usize> = (0..gap.ncols()).collect();
    let size = |j: usize| d.ladder[0].all.nrmse[j].unwrap_or(0.0);
    order.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    let start = m.time.first().copied().unwrap_or(0.0);
    let time: Vec<f64> = m.time.iter().map(|t| t - start).collect();
    let mut section = Section::new("Maps of the torque error").paragraph(
        "Means over bins with one standard deviation, of the joints with the largest gap. Against velocity, friction shows; against \
         position, gravity, springs and ripple; against the torque, gain and load; against time, \
         warming and contact; by order of position, ripple.",
    );
    for &j in order.iter().take(MAPS) {
        let (before, after) = (gap.column(j).to_vec(), left.column(j).to_vec());
        let predicted: Vec<f64> = (&frame.tau.column(j) - &gap.column(j)).to_vec();
        let [angle, rate, force] = units(outcome, j);
        let size = frame.tau.column(j).std(0.0);
        let views: Vec<(&str, &str, Vec<f64>)> = [
            ("velocity", rate, m.qd.column(j).to_vec(), 1e-6),
            ("position", angle, m.q.column(j).to_vec(), 1e-6),
            ("predicted torque", force, predicted, 1e-6 * size),
            ("time", "s", time.clone(), 0.0),
        ]
        .into_iter()
        .filter(|(_, _, x, least)| spread(x) > *least)
        .map(|(what, unit, x, _)| (what, unit, x))
        .collect();
        let draw = |(what, unit, x): &(&str, &str, Vec<f64>)| -> Figure {
            let panel = Panel::new(format!("torque error / {force}"))
                .height(170.0)
                .binned("as given", Ink::Muted, x, &before, BINS)
                .binned("explained", Ink::Predicted, x, &after, BINS);
            Plot::new(
                format!("{}: against {what}", d.joints[j]),
                format!("{what} / {unit}"),
            )
            .half_width()
            .panel(panel)
            .draw("")
        };
        section = section.figures(views.iter().map(draw).chain(orders(outcome, j)));
    }
    section
}

/// Figure of a residual's amplitude by order of position.
fn orders(outcome: &Outcome, joint: usize) -> Option<Figure> {
    let frame = &outcome.frames.heldout;
    let speed = outcome.frames.scale.speed[joint];
    let amplitudes = |residual: &Array2<f64>| {
        let q = frame.samples().q.column(joint);
        let rate = frame.report().rate_hz;
        let orders = Orders::new(residual.column(joint), q, speed, rate)?;
        let part = 2.0 / residual.nrows() as f64;
        let (k, a): (Vec<f64>, Vec<f64>) = orders
            .periodogram()
            .into_iter()
            .map(|(k, gain)| (k, (part * gain.max(0.0)).sqrt()))
            .unzip();
        Some((k, a))
    };
    let (k, before) = amplitudes(&outcome.explanation.gap)?;
    let (_, after) = amplitudes(&outcome.explanation.residual)?;
    let [angle, _, force] = units(outcome, joint);
    let panel = Panel::new(format!("amplitude / {force}"))
        .height(170.0)
        .line("as given", Ink::Muted, &k, &before)
        .line("explained", Ink::Predicted, &k, &after);
    let name = &outcome.diagnosis.joints[joint];
    let title = format!("{name}: by order of position");
    let plot = Plot::new(title, format!("order / (1/{angle})"));
    Some(plot.half_width().panel(panel).draw(""))
}

/// Units of position, velocity and torque of a joint.
pub(super) fn units(outcome: &Outcome, joint: usize) -> [&'static str; 3] {
    if outcome.findings.session.present.joints()[joint]
        .kind
        .is_rotation()
    {
        ["rad", "rad/s", "N·m"]
    } else {
        ["m", "m/s", "N"]
    }
}

/// Difference between the largest and the smallest value.
fn spread(x: &[f64]) -> f64 {
    let largest = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    largest - x.iter().copied().fold(f64::INFINITY, f64::min)
}
