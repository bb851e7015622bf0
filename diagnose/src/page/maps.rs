//! Where the gap lies: shares by region, and the residual against what may drive it.

use crate::diagnosis::Outcome;
use crate::report::Diagnosis;
use report::figure::{HeatMap, Ink, Panel, Plot};
use report::{Cell, Column, Figure, Section, Table};

/// Joints whose maps are drawn: those with most of the gap.
const MAPS: usize = 3;
/// Bins of a map.
const BINS: usize = 40;

/// Shares by joint and coordinate.
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

/// The residual of the worst joints, as given and explained.
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
         position, gravity, springs and ripple; against the torque, gain and load; against time, warming and contact.",
    );
    for &j in order.iter().take(MAPS) {
        let (before, after) = (gap.column(j).to_vec(), left.column(j).to_vec());
        let predicted: Vec<f64> = (&frame.tau.column(j) - &gap.column(j)).to_vec();
        let views: [(&str, &str, Vec<f64>); 4] = [
            ("velocity", "rad/s", m.qd.column(j).to_vec()),
            ("position", "rad", m.q.column(j).to_vec()),
            ("predicted torque", "N·m", predicted),
            ("time", "s", time.clone()),
        ];
        let draw = |(what, unit, x): &(&str, &str, Vec<f64>)| -> Figure {
            let panel = Panel::new("torque error / N·m")
                .height(170.0)
                .binned("as given", Ink::Muted, x, &before, BINS)
                .binned("explained", Ink::Residual, x, &after, BINS);
            Plot::new(
                format!("{}: against {what}", d.joints[j]),
                format!("{what} / {unit}"),
            )
            .half_width()
            .panel(panel)
            .draw("")
        };
        section = section.figures(views.iter().map(draw));
    }
    section
}
