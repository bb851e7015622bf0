//! Two runs side by side, in words and tables for the terminal and the page.

use super::comparison::{Change, Comparison, Pair, Sizes};
use super::read::{Cause, Gap, Run};
use report::{Cell, Column, Table};

/// Names of the two runs in text.
pub const NAMES: [&str; 2] = ["A", "B"];

/// What changed from the first run to the second, the most important first.
pub fn lines(c: &Comparison) -> Vec<String> {
    let mut out: Vec<String> = verdicts(c).into_iter().collect();
    out.extend(c.gaps.iter().map(|gap| error(c, gap)));
    let of = |has: [bool; 2]| {
        let pairs = c.causes.iter();
        pairs.filter(move |p| [p.0[0].is_some(), p.0[1].is_some()] == has)
    };
    out.extend(of([true, true]).map(both));
    for (run, has) in [[true, false], [false, true]].into_iter().enumerate() {
        out.extend(of(has).map(|pair| alone(NAMES[run], pair.either())));
    }
    if c.causes.is_empty() && c.runs[0].verdict.is_some() {
        out.push("Neither run lists a cause.".to_owned());
    }
    out
}

/// Name of an effect, a model or a coordinate as words.
pub fn plain(name: &str) -> String {
    name.replace('_', " ").replace("stribeck", "Stribeck")
}

/// Effect and joints of a pair.
fn title(pair: &Pair) -> String {
    place(pair.either(), &pair.joints().join(", "))
}

/// The same, short enough to stand beside a bar.
pub fn short(pair: &Pair) -> String {
    match pair.joints().len() {
        0..=1 => title(pair),
        n => place(pair.either(), &format!("{n} joints")),
    }
}

fn place(cause: &Cause, joints: &str) -> String {
    let driver = cause.driver.as_ref();
    let driver = driver.map_or(String::new(), |d| format!(" driven by {d}"));
    format!("{} on {joints}{driver}", plain(&cause.effect))
}

fn verdicts(c: &Comparison) -> Option<String> {
    let [a, b] = [c.runs[0].verdict.as_ref()?, c.runs[1].verdict.as_ref()?];
    Some(if a == b {
        format!("The verdict is the same: {a}.")
    } else {
        format!("The verdict changes from {a} to {b}.")
    })
}

/// Mean error of one model in both runs, with the joint that changes most.
fn error(c: &Comparison, [a, b]: &[Gap; 2]) -> String {
    let of = |run: &Run, gap: &Gap| format!("mean {}, {}", run.kind.measure(), gap.name);
    let head = of(&c.runs[0], a);
    let (Some(from), Some(to)) = (a.mean, b.mean) else {
        return format!("The {head} does not exist in both runs.");
    };
    let moved = |j: usize| Some((j, a.by_joint[j]?, b.by_joint[j]?));
    let joints = (0..a.by_joint.len()).filter_map(moved);
    let most = joints.max_by(|x, y| (x.2 - x.1).abs().total_cmp(&(y.2 - y.1).abs()));
    let most = most.filter(|(_, x, y)| x != y);
    let most = most.map_or(String::new(), |(j, x, y)| {
        format!("; most on {}, {x:.3} to {y:.3}", c.runs[0].joints[j])
    });
    format!(
        "The {head}: {from:.3} in A, {to:.3} in B{}{most}.",
        percent(from, to)
    )
}

/// A change in per cent, in parentheses; none from zero, and none where nothing changes.
fn percent(from: f64, to: f64) -> String {
    if from == 0.0 || from == to {
        return String::new();
    }
    let change = format!("{:+.0} %", 100.0 * (to - from) / from.abs());
    format!(" ({})", change.replace('-', "−"))
}

fn both(pair: &Pair) -> String {
    let [a, b] = [0, 1].map(|run| pair.0[run].as_ref().map_or(String::new(), closes));
    let head = format!("In both: {}; closes {a} in A, {b} in B.", title(pair));
    let sizes = pair.sizes();
    let of = |moved: &dyn Fn(Change) -> bool| -> Vec<String> {
        let chosen = sizes.iter().filter(|s| moved(s.change()));
        chosen.map(size).collect()
    };
    let clear = of(&|c| matches!(c, Change::Clear(..)));
    let unsure = of(&|c| matches!(c, Change::Unsure(by) if by != 0.0));
    let said = [
        ("Changed", &clear),
        ("Without a deviation to judge by", &unsure),
    ];
    let said = said.into_iter().filter(|(_, list)| !list.is_empty());
    let said: Vec<String> = said
        .map(|(what, list)| format!("{what}: {}.", list.join("; ")))
        .collect();
    let compared = sizes.iter().any(|s| s.change() != Change::Alone);
    match said.is_empty() {
        true if !compared => head,
        true => format!("{head} The sizes that both state are the same within 90 %."),
        false => format!("{head} {}", said.join(" ")),
    }
}

fn alone(run: &str, cause: &Cause) -> String {
    let confirmed = if cause.confirmed {
        ""
    } else {
        ", not confirmed by the held-out recording"
    };
    format!(
        "Only in {run}: {}; closes {}{confirmed}.",
        place(cause, &cause.joints.join(", ")),
        closes(cause)
    )
}

/// Part of its joints' gap that a cause closes, with its 90 % interval.
fn closes(cause: &Cause) -> String {
    let whole = |part: f64| {
        let whole = (100.0 * part).round() + 0.0;
        whole.to_string().replace('-', "−")
    };
    let interval = cause
        .gap_closed_interval
        .map(|[low, high]| format!(" ({}–{} %)", whole(low), whole(high)));
    format!(
        "{} %{}",
        whole(cause.gap_closed),
        interval.unwrap_or_default()
    )
}

fn size(sizes: &Sizes) -> String {
    let [a, b] = sizes.values.map(|v| stated(v, &sizes.unit));
    let change = change(sizes).map_or(String::new(), |(by, _)| format!(" ({by})"));
    let (joint, name) = (joint(&sizes.joint), plain(&sizes.name));
    format!("{joint}{name} {a} in A, {b} in B{change}")
}

fn joint(joint: &Option<String>) -> String {
    joint.as_ref().map_or(String::new(), |j| format!("{j} "))
}

fn stated(value: Option<(f64, Option<f64>)>, unit: &str) -> String {
    let Some((value, std)) = value else {
        return "not stated".to_owned();
    };
    let number = Cell::with_std(value, std.unwrap_or(0.0)).to_string();
    if unit == "1" {
        number
    } else {
        format!("{number} {unit}")
    }
}

/// Difference of a parameter and the judgement of it; none where one run alone states it.
fn change(sizes: &Sizes) -> Option<(String, &'static str)> {
    let signed = |by: f64, std: f64| {
        let sign = if by > 0.0 { "+" } else { "" };
        format!("{sign}{}", Cell::with_std(by, std)).replace('-', "−")
    };
    match sizes.change() {
        Change::Alone => None,
        Change::Unsure(by) => Some((signed(by, 0.0), "no deviation to judge the change by")),
        Change::Within(by, std) => Some((signed(by, std), "the same within 90 %")),
        Change::Clear(by, std) => Some((signed(by, std), "changed")),
    }
}

/// A table per model: the error of each joint in both runs.
pub fn errors(c: &Comparison) -> Vec<Table> {
    let table = |[a, b]: &[Gap; 2]| {
        let head = [
            Column::text("joint"),
            Column::number(NAMES[0]),
            Column::number(NAMES[1]),
            Column::number("change / %"),
        ];
        let row = |name: &str, values: [Option<f64>; 2]| {
            let [from, to] = values;
            let change = from.zip(to).filter(|(from, _)| *from > 0.0);
            let change = change.map(|(from, to)| 100.0 * (to - from) / from);
            [
                Cell::text(name),
                Cell::optional(from, 4),
                Cell::optional(to, 4),
                Cell::optional(change, 0),
            ]
        };
        let joints = c.runs[0].joints.iter().enumerate();
        joints
            .fold(Table::new(head), |t, (j, name)| {
                t.row(row(name, [a.by_joint[j], b.by_joint[j]]))
            })
            .row(row("mean", [a.mean, b.mean]))
            .emphasise_last()
            .caption(format!("{}, {}", c.runs[0].kind.measure(), a.name))
    };
    c.gaps.iter().map(table).collect()
}

/// Table of the causes of both runs; none where there are none.
pub fn causes(c: &Comparison) -> Option<Table> {
    if c.causes.is_empty() {
        return None;
    }
    let head = [Column::text("cause"), Column::text("joints")];
    let head = head.into_iter().chain(
        NAMES
            .iter()
            .map(|run| Column::number(format!("closes in {run}")))
            .chain(
                NAMES
                    .iter()
                    .map(|run| Column::number(format!("share in {run}"))),
            ),
    );
    let table = c.causes.iter().fold(Table::new(head), |t, pair| {
        let of = |cell: &dyn Fn(&Cause) -> Cell| {
            [0, 1].map(|run| pair.0[run].as_ref().map_or_else(Cell::missing, cell))
        };
        let closes = of(&|cause: &Cause| {
            Cell::with_interval(cause.gap_closed, cause.gap_closed_interval, 2)
        });
        let shares = of(&|cause: &Cause| Cell::number(cause.share_of_gap, 2));
        let driver = pair.either().driver.as_ref();
        let driver = driver.map_or(String::new(), |d| format!(" ← {d}"));
        let first = [
            Cell::text(plain(&pair.either().effect)),
            Cell::text(format!("{}{driver}", pair.joints().join(", "))),
        ];
        t.row(first.into_iter().chain(closes).chain(shares))
    });
    Some(table.caption(
        "Part of its joints' squared error that each cause removes, with 90 % interval; share of what all causes of the run remove",
    ))
}

/// Table of the causes' parameters in both runs; none where there are none.
pub fn sizes(c: &Comparison) -> Option<Table> {
    let head = [
        Column::text("cause"),
        Column::text("parameter"),
        Column::text("joint"),
        Column::number(NAMES[0]),
        Column::number(NAMES[1]),
        Column::text("unit"),
        Column::number("change"),
        Column::text("judgement"),
    ];
    let mut rows = 0;
    let mut table = Table::new(head);
    for pair in &c.causes {
        for sizes in pair.sizes() {
            rows += 1;
            let cell = |v: Option<(f64, Option<f64>)>| {
                v.map_or_else(Cell::missing, |(v, std)| {
                    Cell::with_std(v, std.unwrap_or(0.0))
                })
            };
            let [a, b] = sizes.values.map(cell);
            let (change, said) = match change(&sizes) {
                Some((change, said)) => (Cell::text(change), Cell::text(said)),
                None => (Cell::missing(), Cell::text("in one run alone")),
            };
            table.push([
                Cell::text(plain(&pair.either().effect)),
                Cell::text(plain(&sizes.name)),
                sizes.joint.as_ref().map_or_else(Cell::missing, Cell::text),
                a,
                b,
                Cell::text(&sizes.unit),
                change,
                said,
            ]);
        }
    }
    (rows > 0).then(|| {
        table.caption("Sizes with standard deviations. A change counts where its 90 % interval leaves zero out.")
    })
}
