//! Recordings: columns, clocks, numbers, formats.

use super::{ARMS, Made, UNIT, Urdf, recorded, robot, says};
use tests::csv::Csv;

/// Cells of a column as numbers.
fn numbers(csv: &Csv, column: &str) -> Vec<f64> {
    let at = csv.header.iter().position(|h| h == column);
    let at = at.unwrap_or_else(|| panic!("no column {column}"));
    let cells = csv.rows.iter().map(|row| row[at].parse());
    cells.map(|cell| cell.expect("a number")).collect()
}

fn set(csv: &mut Csv, column: &str, values: impl Fn(usize) -> String) {
    let at = match csv.header.iter().position(|h| h == column) {
        Some(at) => at,
        None => {
            csv.header.push(column.to_owned());
            csv.rows.iter_mut().for_each(|row| row.push(String::new()));
            csv.header.len() - 1
        }
    };
    for (i, row) in csv.rows.iter_mut().enumerate() {
        row[at] = values(i);
    }
}

#[test]
fn columns_in_another_order_and_by_name() {
    for (arm, [a, b]) in [(0, [1, 2]), (1, [2, 3]), (2, [1, 2])] {
        let mut csv = Csv::of(&recorded(&robot(arm), 4));
        for group in ["q", "tau"] {
            for name in &mut csv.header {
                let (first, second) = (format!("{group}{a}"), format!("{group}{b}"));
                if *name == first {
                    *name = second;
                } else if *name == second {
                    *name = first;
                }
            }
        }
        let said = format!("columns {a} and {b} look exchanged");
        says(&Made::arm(arm).to(&csv, ","), &[&said], &UNIT);
    }
    for (arm, q, tau) in [
        (0, "q_", "tau_"),
        (1, "position_", "effort_"),
        (2, "pos.", "torque."),
    ] {
        let mut csv = Csv::of(&recorded(&robot(arm), 5));
        for (k, joint) in ARMS[arm].iter().enumerate() {
            for (short, long) in [("q", q), ("tau", tau)] {
                let old = format!("{short}{}", k + 1);
                let at = csv.header.iter().position(|h| *h == old);
                csv.header[at.expect("the column")] = format!("{long}{}", joint.0);
            }
        }
        // The file's order is another one.
        csv.header.reverse();
        csv.rows.iter_mut().for_each(|row| row.reverse());
        let n = ARMS[arm].len();
        let said = format!("q1 to q{n} are read from {q}{}", ARMS[arm][0].0);
        says(
            &Made::arm(arm).to(&csv, ","),
            &[&said, "2001 samples"],
            &["error"],
        );
    }
}

#[test]
fn values_that_are_held_and_sources_that_alternate() {
    for (arm, every) in [(0, 5), (1, 10), (2, 20)] {
        let mut csv = Csv::of(&recorded(&robot(arm), 6));
        let rate = 100 * every;
        csv.rows = (0..1000 * every)
            .map(|i| csv.rows[i / every].clone())
            .collect();
        set(&mut csv, "time", |i| format!("{}", i as f64 / rate as f64));
        let said = format!("100 Hz in truth where the stamps say {rate} Hz");
        says(
            &Made::arm(arm).to(&csv, ","),
            &["held samples", &said],
            &["commanded"],
        );
    }
    for (arm, [every, first]) in [(0, [2, 0]), (1, [2, 1]), (2, [3, 1])] {
        let mut csv = Csv::of(&recorded(&robot(arm), 7));
        for k in 1..=ARMS[arm].len() {
            let name = format!("tau{k}");
            let own = numbers(&csv, &name);
            set(&mut csv, &name, |i| {
                if i % every == first {
                    "0".to_owned()
                } else {
                    own[i].to_string()
                }
            });
        }
        says(
            &Made::arm(arm).to(&csv, ","),
            &["two sources write into one log"],
            &["current"],
        );
    }
}

#[test]
fn targets_of_another_time_and_unit() {
    for (arm, rows, unit, said) in [
        (
            0,
            60,
            std::f64::consts::PI / 180.0,
            ["the motion comes 0.60 s after its command", "π/180"],
        ),
        (
            1,
            90,
            180.0 / std::f64::consts::PI,
            [
                "the motion comes 0.90 s after its command",
                "it is in degrees",
            ],
        ),
        (
            2,
            140,
            std::f64::consts::PI / 180.0,
            ["the motion comes 1.40 s after its command", "π/180"],
        ),
    ] {
        let mut csv = Csv::of(&recorded(&robot(arm), 8));
        for k in 1..=ARMS[arm].len() {
            let q = numbers(&csv, &format!("q{k}"));
            set(&mut csv, &format!("q_ref{k}"), |i| {
                (unit * q[(i + rows).min(q.len() - 1)]).to_string()
            });
        }
        says(&Made::arm(arm).to(&csv, ","), &said, &[]);
    }
}

#[test]
fn tables_of_other_countries_and_without_time() {
    for (arm, separator, stamp) in [(0, ";", true), (1, "\t", false), (2, ";", false)] {
        let mut csv = Csv::of(&recorded(&robot(arm), 9));
        for row in &mut csv.rows {
            row.iter_mut()
                .for_each(|cell| *cell = cell.replace('.', ","));
        }
        if stamp {
            set(&mut csv, "time", |i| {
                format!(
                    "2027-05-04T09:{:02}:{:02}.{:02}Z",
                    i / 6000,
                    i / 100 % 60,
                    i % 100
                )
            });
        }
        if arm == 2 {
            // As spreadsheets leave them: a row of nothing, and the rows' numbers without a name.
            csv.header.insert(0, String::new());
            let rows = csv.rows.iter_mut().enumerate();
            rows.for_each(|(i, row)| row.insert(0, i.to_string()));
            let width = csv.header.len();
            csv.rows.push(vec![String::new(); width]);
        }
        says(
            &Made::arm(arm).to(&csv, separator),
            &["2001 samples", "100.0 Hz"],
            &["error"],
        );
    }
    for arm in 0..3 {
        let csv = Csv::of(&recorded(&robot(arm), 10)).without(&["time"]);
        says(&Made::arm(arm).to(&csv, ","), &["--rate HZ"], &[]);
    }
}

/// A NumPy file of doubles, version 1.0.
fn npy(shape: &str, values: impl Iterator<Item = f64>) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}");
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{header:<0$}\n", length - 1).bytes());
    bytes.extend(values.flat_map(f64::to_le_bytes));
    bytes
}

#[test]
fn archives_with_names_of_their_own() {
    for (arm, [q, tau, time]) in [
        (0, ["positions", "torques", "times"]),
        (1, ["qpos", "effort", "timestamps"]),
        (2, ["joint_positions", "joint_torques", "t"]),
    ] {
        let (recording, made) = (recorded(&robot(arm), 11), Made::arm(arm));
        let path = made.folder.path().join("data.npz");
        let mut archive = zip::ZipWriter::new(std::fs::File::create(&path).expect("writable"));
        let shape = format!("{}, {}", recording.len(), recording.dof());
        let torque = recording.tau.as_ref().expect("torque was recorded");
        let stamps = recording.time.iter().map(|t| 1.8e9 + t);
        for (name, bytes) in [
            (q, npy(&shape, recording.q.iter().copied())),
            (tau, npy(&shape, torque.iter().copied())),
            (time, npy(&format!("{},", recording.len()), stamps)),
        ] {
            let options = zip::write::SimpleFileOptions::default();
            archive
                .start_file(format!("{name}.npy"), options)
                .expect("writable");
            std::io::Write::write_all(&mut archive, &bytes).expect("writable");
        }
        archive.finish().expect("writable");
        let said = format!("read from {q}1");
        says(&made.answer(&path), &[&said, "2001 samples"], &["error"]);
    }
}

#[test]
fn efforts_of_memory_and_wrapped_angles() {
    for (arm, rubbish) in [
        (0, ["1.04e224", "2.9e-321"]),
        (1, ["-7e180", "5e-324"]),
        (2, ["3.1e299", "-1e-310"]),
    ] {
        let mut csv = Csv::of(&recorded(&robot(arm), 14));
        let own = numbers(&csv, "tau2");
        set(&mut csv, "tau2", |i| {
            if i % 97 == 5 {
                rubbish[i / 97 % 2].to_owned()
            } else {
                own[i].to_string()
            }
        });
        says(&Made::arm(arm).to(&csv, ","), &["is no measurement"], &[]);
    }
    for (arm, [least, turns]) in [(0, [-1.0, 12.0]), (1, [0.0, 10.0]), (2, [-1.0, 15.0])] {
        let description = Urdf {
            arm,
            ..Urdf::default()
        }
        .text()
        .replacen("revolute", "continuous", 1);
        let mut recording = recorded(&robot(arm), 15);
        let own = recording.q.column(0).mapv(|q| turns * q);
        recording.q.column_mut(0).assign(&own);
        let pi = std::f64::consts::PI;
        let wrap = |q: f64| (q - least * pi).rem_euclid(2.0 * pi) + least * pi;
        recording.q.column_mut(0).mapv_inplace(wrap);
        says(
            &Made::new("arm.urdf", &description).to_plain(&recording),
            &["wrapped to one turn"],
            &["error:"],
        );
    }
}
