//! Tables as people write them: each style reads as the plain one does, or is refused with the lines that declare it.

use datasets::{ReadError, ReadOptions, Recording, read};
use ndarray::{Array2, s};
use std::fmt::Write as _;
use std::io::Write as _;

const ROWS: usize = 60;
const HZ: f64 = 50.0;

/// Values of a column at a row: group 0 is q, 1 qd, 2 tau, 3 q_ref.
fn value(group: usize, joint: usize, row: usize) -> f64 {
    let t = row as f64 / HZ;
    let (w, phase) = (1.1 + 0.3 * joint as f64, group as f64);
    let size = [0.7, 0.9, 12.0, 0.7][group];
    (1e4 * size * (w * t + phase + 0.4 * joint as f64).sin()).round() / 1e4
}

/// A table of these names, each with what it holds: `t`, or `g j` for a group and joint; anything else is written as it stands.
struct Table<'a> {
    columns: &'a [(&'a str, &'a str)],
    separator: &'a str,
    comma: bool,
}

impl Table<'_> {
    fn cell(&self, what: &str, row: usize) -> String {
        let number = match what.split_once(' ') {
            Some((g, j)) if what.len() == 3 => value(g.parse().unwrap(), j.parse().unwrap(), row),
            _ => match what {
                "t" => row as f64 / HZ,
                "ms" => row as f64 * 1000.0 / HZ,
                "ns" => 1.7e18 + row as f64 * 1e9 / HZ,
                "rough" => row as f64 / HZ + 0.004 * (row % 3) as f64,
                "row" => row as f64,
                "iso" => {
                    let ms = row * 20;
                    return format!("2026-03-02T08:00:{:02}.{:03}Z", ms / 1000, ms % 1000);
                }
                "deg" => 0.0,
                other => return other.to_owned(),
            },
        };
        let text = number.to_string();
        if self.comma {
            text.replace('.', ",")
        } else {
            text
        }
    }

    fn text(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|c| c.0).collect();
        let mut text = names.join(self.separator) + "\n";
        for row in 0..ROWS {
            let cells: Vec<String> = self.columns.iter().map(|c| self.cell(c.1, row)).collect();
            let _ = writeln!(text, "{}", cells.join(self.separator));
        }
        text
    }
}

fn options() -> ReadOptions {
    ReadOptions {
        joints: ["base_pan", "shoulder_lift", "elbow"]
            .map(str::to_owned)
            .to_vec(),
        ..ReadOptions::for_robot(3)
    }
}

fn try_text(name: &str, text: &str, options: &ReadOptions) -> Result<Recording, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    read(&path, options)
}

/// Whether a recording holds what the columns were made of.
#[track_caller]
fn as_made(found: &Recording) {
    assert_eq!((found.len(), found.dof()), (ROWS, 3));
    assert!(
        (found.median_step() * HZ - 1.0).abs() < 1e-4,
        "{}",
        found.median_step()
    );
    let tables = [
        Some(&found.q),
        found.qd.as_ref(),
        found.tau.as_ref(),
        found.q_ref.as_ref(),
    ];
    for (group, table) in tables.into_iter().enumerate() {
        let Some(table) = table else { continue };
        for ((row, joint), v) in table.indexed_iter() {
            assert!(
                (v - value(group, joint, row)).abs() < 1e-6,
                "{group} {joint} {row}"
            );
        }
    }
}

#[track_caller]
fn reads(columns: &[(&str, &str)], separator: &str, comma: bool) -> Recording {
    let table = Table {
        columns,
        separator,
        comma,
    };
    let found = try_text("run.csv", &table.text(), &options()).unwrap_or_else(|e| panic!("{e}"));
    as_made(&found);
    found
}

const PLAIN: [(&str, &str); 7] = [
    ("time", "t"),
    ("q1", "0 0"),
    ("q2", "0 1"),
    ("q3", "0 2"),
    ("tau1", "2 0"),
    ("tau2", "2 1"),
    ("tau3", "2 2"),
];

/// The plain table with its columns called by a pattern and the clock by a name.
fn called<'a>(time: (&'a str, &'a str), names: &'a [String]) -> Vec<(&'a str, &'a str)> {
    let rest = PLAIN[1..].iter().zip(names).map(|(p, n)| (n.as_str(), p.1));
    std::iter::once(time).chain(rest).collect()
}

fn names(pattern: impl Fn(&str, usize) -> String) -> Vec<String> {
    let of = |group| (0..3).map(move |j| (group, j));
    of("q")
        .chain(of("tau"))
        .map(|(g, j)| pattern(g, j))
        .collect()
}

#[test]
fn separators_and_decimal_commas() {
    assert!(reads(&PLAIN, ",", false).notes.is_empty());
    for (separator, comma) in [
        (";", true),
        (";", false),
        ("\t", true),
        ("\t", false),
        ("  ", false),
        (" ", true),
    ] {
        assert!(
            reads(&PLAIN, separator, comma).notes.is_empty(),
            "{separator:?}"
        );
    }
}

#[test]
fn stamps_in_words_and_units() {
    let plain = names(|g, j| format!("{g}{}", j + 1));
    for time in [
        ("time", "iso"),
        ("timestamp", "iso"),
        ("t", "t"),
        ("Time (s)", "t"),
        ("times", "t"),
        ("time", "ms"),
        ("stamp_ms", "ms"),
        ("timestamp", "ns"),
    ] {
        let found = reads(&called(time, &plain), ";", true);
        // A unit that the values alone show is said.
        let shown = time == ("time", "ms") || time == ("timestamp", "ns");
        assert_eq!(
            found.notes.len(),
            usize::from(shown),
            "{time:?}: {:?}",
            found.notes
        );
    }
    // Of several clocks the steadiest.
    let mut both = called(("host_time", "rough"), &plain);
    both.insert(1, ("robot_time", "t"));
    assert!(reads(&both, ",", false).notes[0].contains("robot_time"));
}

#[test]
fn names_of_any_style() {
    let quantity = |g: &str| {
        if g == "q" {
            ("position", "effort")
        } else {
            ("effort", "position")
        }
    };
    let joints = ["base_pan", "shoulder_lift", "elbow"];
    type Style<'a> = &'a dyn Fn(&str, usize) -> String;
    let styles: [Style<'_>; 8] = [
        &|g, j| format!("{}_{j}", quantity(g).0),
        &|g, j| format!("actual_{}_{j}", if g == "q" { "q" } else { "torque" }),
        &|g, j| format!("{g}[{j}]"),
        &|g, j| {
            format!(
                "joint_{}.{}",
                j + 1,
                if g == "q" { "pos" } else { "torque" }
            )
        },
        &|g, j| format!("{}.{}", joints[j], if g == "q" { "pos" } else { "effort" }),
        &|g, j| format!("{g}_{}", joints[j]),
        &|g, j| format!("/joint_states/{}/{}", joints[j], quantity(g).0),
        &|g, j| format!("J{}{}", j + 1, if g == "q" { "Angle" } else { "Torque" }),
    ];
    for style in styles {
        let own = names(style);
        let found = reads(&called(("time", "t"), &own), ",", false);
        assert_eq!(found.notes.len(), 2, "{:?}", found.notes);
        assert!(found.notes[0].contains(&own[0]), "{:?}", found.notes);
    }
}

#[test]
fn joints_by_name_in_any_order_and_beside_others() {
    let turned = [
        ("gripper.pos", "9"),
        ("elbow.pos", "0 2"),
        ("base_pan.pos", "0 0"),
        ("shoulder_lift.pos", "0 1"),
        ("shoulder_lift.effort", "2 1"),
        ("gripper.effort", "9"),
        ("elbow.effort", "2 2"),
        ("base_pan.effort", "2 0"),
        ("tau_ext_1", "5"),
        ("timestamp", "t"),
    ];
    reads(&turned, ",", false);
    // A robot whose chain runs 1, 7, 2: numbers in names are names, other numbers count along the chain.
    let odd = ReadOptions {
        joints: ["arm_joint_1", "arm_joint_7", "arm_joint_2"]
            .map(str::to_owned)
            .to_vec(),
        ..options()
    };
    let by_name = [
        ("time", "t"),
        ("q_joint_1", "0 0"),
        ("q_joint_2", "0 2"),
        ("q_joint_7", "0 1"),
        ("tau_joint_1", "2 0"),
        ("tau_joint_2", "2 2"),
        ("tau_joint_7", "2 1"),
    ];
    let table = |columns| {
        Table {
            columns,
            separator: ",",
            comma: false,
        }
        .text()
    };
    as_made(&try_text("run.csv", &table(&by_name), &odd).unwrap());
    let found = try_text("run.csv", &table(&PLAIN), &odd).unwrap();
    as_made(&found);
    assert!(
        found.notes[0].contains("along the chain"),
        "{:?}",
        found.notes
    );
    // A chain chosen among more joints takes its own columns of all.
    let chosen = ReadOptions {
        described: ["wheel", "base_pan", "shoulder_lift", "elbow", "finger"]
            .map(str::to_owned)
            .to_vec(),
        ..options()
    };
    let mut wide = vec![("time", "t")];
    let all: Vec<String> = (0..10)
        .map(|k| format!("{}_{}", ["position", "effort"][k / 5], k % 5))
        .collect();
    let held = ["9", "0 0", "0 1", "0 2", "9", "9", "2 0", "2 1", "2 2", "9"];
    wide.extend(all.iter().map(String::as_str).zip(held));
    let found = try_text("run.csv", &table(&wide), &chosen).unwrap();
    as_made(&found);
    assert!(found.notes[0].contains("2, 3, 4"), "{:?}", found.notes);
    assert!(try_text("run.csv", &table(&wide), &options()).is_err());
}

#[test]
fn commands_in_every_style() {
    for style in [
        "q_ref{}",
        "target_q_{}",
        "command[{}]",
        "goal_position_{}",
        "action.joint_{}.pos",
    ] {
        let from_one = style.starts_with("q_ref");
        let own: Vec<String> = (0..3)
            .map(|j| style.replace("{}", &(j + usize::from(from_one)).to_string()))
            .collect();
        let mut all = PLAIN.to_vec();
        all.extend(own.iter().map(String::as_str).zip(["3 0", "3 1", "3 2"]));
        assert!(reads(&all, ",", false).q_ref.is_some(), "{style}");
    }
}

#[test]
fn indices_blank_rows_comments_and_row_names() {
    let mut with_index = vec![("", "row")];
    with_index.extend(PLAIN);
    reads(&with_index, ",", false);
    let text = Table {
        columns: &PLAIN,
        separator: ",",
        comma: false,
    }
    .text();
    // Row names have no name over them in R.
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for (k, line) in lines.iter_mut().enumerate().skip(1) {
        *line = format!("{k},{line}");
    }
    as_made(&try_text("run.csv", &lines.join("\n"), &options()).unwrap());
    // NumPy writes the header into a comment.
    let spaced = text.replace(',', " ");
    as_made(
        &try_text(
            "run.txt",
            &format!("# made by hand\n# {spaced}"),
            &options(),
        )
        .unwrap(),
    );
    let blank = text.replacen('\n', "\n,,,,,,\n\n", 3) + ",,,,,,\n";
    let found = try_text("run.csv", &blank, &options()).unwrap();
    as_made(&found);
    assert!(found.notes[0].contains("blank rows"), "{:?}", found.notes);
}

#[test]
fn a_stretch_without_values_is_left_out_and_said() {
    let mut lines: Vec<String> = Table {
        columns: &PLAIN,
        separator: ",",
        comma: false,
    }
    .text()
    .lines()
    .map(str::to_owned)
    .collect();
    for line in &mut lines[21..42] {
        let mut cells: Vec<&str> = line.split(',').collect();
        (cells[2], cells[5]) = ("", "NaN");
        *line = cells.join(",");
    }
    let mut few = lines.clone();
    lines.extend((60..80).map(|row| format!("{},0.1,0.2,0.3,{row},2,3", f64::from(row) / HZ)));
    let found = try_text("run.csv", &lines.join("\n"), &options()).unwrap();
    assert_eq!(found.len(), 80 - 21);
    assert_eq!(found.trajectories.len(), 2, "{:?}", found.trajectories);
    assert!(found.notes[0].contains("21 rows"), "{:?}", found.notes);
    // Single cells are damage.
    few.truncate(25);
    for line in &mut few[22..] {
        *line = "1,2,3,4,5,6,7".into();
    }
    let e = try_text("run.csv", &few.join("\n"), &options()).unwrap_err();
    assert_eq!((e.row, e.column.as_deref()), (Some(21), Some("q2")));
}

#[test]
fn no_time_asks_for_a_rate() {
    let text = Table {
        columns: &PLAIN[1..],
        separator: ",",
        comma: false,
    }
    .text();
    let e = try_text("run.csv", &text, &options()).unwrap_err();
    assert!(e.to_string().contains("--rate HZ"), "{e}");
    let rated = ReadOptions {
        rate_hz: Some(HZ),
        ..options()
    };
    let found = try_text("run.csv", &text, &rated).unwrap();
    as_made(&found);
    assert!(found.notes[0].contains("50 Hz"), "{:?}", found.notes);
}

#[test]
fn replay_is_named_where_commands_stand_beside_the_motion() {
    for (commands, named) in [("q_ref", true), ("note", false)] {
        let columns = ["q", commands, "current"].map(|g| format!("{g}1,{g}2,{g}3"));
        let text = format!("time,{}\n0,0,0,0,0,0,0,0,0,0\n", columns.join(","));
        let e = try_text("run.csv", &text, &options())
            .unwrap_err()
            .to_string();
        let hint = e.contains("`residyn replay` needs no torque");
        assert_eq!(hint, named, "{e}");
    }
}

#[test]
fn what_is_not_known_comes_with_the_lines_that_declare_it() {
    let refused = |names: &[String], options: &ReadOptions| {
        let columns = called(("time", "t"), names);
        let text = Table {
            columns: &columns,
            separator: ",",
            comma: false,
        }
        .text();
        try_text("run.csv", &text, options).unwrap_err().to_string()
    };
    let q = |g: &str, own: String, j: usize| if g == "q" { format!("q{}", j + 1) } else { own };
    // A current is no torque.
    let text = refused(
        &names(|g, j| q(g, format!("actual_current_{j}"), j)),
        &options(),
    );
    for line in [
        "[columns]",
        "tau1 = \"actual_current_0\"",
        "[units]",
        "torque = \"current\"",
    ] {
        assert!(text.contains(line), "{text}");
    }
    // Nor is what was asked for.
    let text = refused(
        &names(|g, j| q(g, format!("target_moment_{}", j + 1), j)),
        &options(),
    );
    assert!(
        text.contains("command") && text.contains("tau = \"target_moment_{}\""),
        "{text}"
    );
    // Names that say nothing.
    let text = refused(
        &names(|g, j| q(g, format!("sensor_{}", j + 1), j)),
        &options(),
    );
    assert!(text.contains("tau = \"sensor_{}\""), "{text}");
    // Joints of another robot.
    let text = refused(
        &names(|g, j| {
            format!(
                "{}.{}",
                ["hip", "knee", "ankle"][j],
                if g == "q" { "pos" } else { "effort" }
            )
        }),
        &options(),
    );
    assert!(
        text.contains("q1 = \"hip.pos\"") && text.contains("order of the chain"),
        "{text}"
    );
}

#[test]
fn rubbish_and_two_sources_are_refused() {
    let text = Table {
        columns: &PLAIN,
        separator: ",",
        comma: false,
    }
    .text();
    for rubbish in ["1.04e224", "2.9e-321", "-3e38"] {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let at = lines[30].rfind(',').unwrap();
        lines[30].replace_range(at + 1.., rubbish);
        let e = try_text("run.csv", &lines.join("\n"), &options()).unwrap_err();
        assert_eq!((e.row, e.column.as_deref()), (Some(30), Some("tau3")));
        assert!(e.to_string().contains("lay in memory"), "{e}");
    }
    type Second<'a> = &'a dyn Fn(usize, &[&str]) -> Option<[String; 3]>;
    let second: [Second<'_>; 3] = [
        &|row, _| (row % 2 == 1).then(|| ["0", "0", "0"].map(str::to_owned)),
        &|row, _| (row % 3 == 1).then(|| ["0.0", "0.0", "0.0"].map(str::to_owned)),
        &|row, tau| {
            let shifted = |k: usize| (tau[k].parse::<f64>().unwrap() * 0.3 + 20.0).to_string();
            (row % 2 == 1).then(|| [0, 1, 2].map(shifted))
        },
    ];
    for second in second {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for (row, line) in lines.iter_mut().enumerate().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            if let Some(tau) = second(row, &cells[4..]) {
                *line = [&cells[..4], &tau.each_ref().map(String::as_str)]
                    .concat()
                    .join(",");
            }
        }
        let e = try_text("run.csv", &lines.join("\n"), &options()).unwrap_err();
        assert!(e.to_string().contains("two sources"), "{e}");
    }
}

#[test]
fn held_samples_are_left_out_and_said() {
    for every in [2_usize, 5, 10, 20] {
        let mut text = String::from("time,q1,q2,q3,tau1,tau2,tau3\n");
        for row in 0..40 * every {
            let held = row / every;
            let _ = write!(text, "{}", row as f64 * 1e-3);
            for (group, joint) in [0, 2].into_iter().flat_map(|g| (0..3).map(move |j| (g, j))) {
                let _ = write!(text, ",{}", value(group, joint, held));
            }
            text.push('\n');
        }
        let found = try_text("run.csv", &text, &options()).unwrap();
        assert_eq!(found.len(), 40, "{every}");
        assert!((found.median_step() - 1e-3 * every as f64).abs() < 1e-9);
        assert!(found.notes[0].contains("held samples"), "{:?}", found.notes);
    }
}

#[test]
fn arrays_by_their_usual_names() {
    let npy = |descr: &str, shape: &str, data: Vec<u8>| {
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    };
    let table = |group: usize| Array2::from_shape_fn((ROWS, 3), |(i, j)| value(group, j, i));
    let flat = |t: Array2<f64>| t.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let stamps: Vec<u8> = (0..ROWS)
        .flat_map(|row| (1.7e9 + row as f64 / HZ).to_le_bytes())
        .collect();
    for [q, qd, tau, time] in [
        ["positions", "velocities", "torques", "times"],
        [
            "joint_positions",
            "joint_velocities",
            "joint_efforts",
            "timestamps",
        ],
        ["qpos", "qvel", "tau", "t"],
        ["q", "dq", "measured_torque", "stamp"],
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.npz");
        let mut zip = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
        let shape = format!("({ROWS}, 3)");
        for (name, bytes) in [
            (q, npy("<f8", &shape, flat(table(0)))),
            (qd, npy("<f8", &shape, flat(table(1)))),
            (tau, npy("<f8", &shape, flat(table(2)))),
            (time, npy("<f8", &format!("({ROWS},)"), stamps.clone())),
        ] {
            zip.start_file(
                format!("{name}.npy"),
                zip::write::SimpleFileOptions::default(),
            )
            .unwrap();
            zip.write_all(&bytes).unwrap();
        }
        zip.finish().unwrap();
        let found = read(&path, &options()).unwrap_or_else(|e| panic!("{e}"));
        as_made(&found);
        assert!(found.qd.is_some());
        assert_eq!(found.q.slice(s![0, ..]).len(), 3);
    }
}
