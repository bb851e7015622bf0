//! Small descriptions and recordings as people have them: what the programs answer to each.

use physics::robot::Description;
use tests::program::{program, run};
use tests::shared::shared;

/// What a program answers in a folder of `repro`, both streams, on one line.
fn answer(folder: &str, name: &str, arguments: &[&str]) -> Option<String> {
    let folder = shared(&format!("repro/{folder}"))?;
    let ended = run(program(name).current_dir(&folder).args(arguments));
    let said = format!("{}\n{}", ended.out, ended.err);
    Some(said.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Folder, robot, recording, what is said of them, and what is not. A bar parts several of either.
type Case = (
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
);

/// What would make a user multiply a right torque.
const UNIT: &str = "torque_scale = [|motor current in A.";

fn check(cases: &[Case]) {
    for (folder, robot, data, said, unsaid) in cases {
        let check = ["--check-only", "--robot", robot, "--data", data];
        let Some(answer) = answer(folder, "train", &check) else {
            return;
        };
        for part in said.split('|').filter(|p| !p.is_empty()) {
            assert!(answer.contains(part), "{folder}: no `{part}` in {answer}");
        }
        for part in unsaid.split('|').filter(|p| !p.is_empty()) {
            assert!(!answer.contains(part), "{folder}: `{part}` in {answer}");
        }
    }
}

#[test]
fn chains_and_descriptions() {
    let (urdf, train) = ("robot.urdf", "train.parquet");
    check(&[
        (
            "gripper",
            urdf,
            train,
            "the chain joint1, joint2, joint3|finger_right_joint (which follows finger_left_joint)|4000 samples",
            "error",
        ),
        (
            "linkage",
            urdf,
            train,
            "the chain joint1, joint2, joint3|cylinder_joint (which follows joint2)|4000 samples",
            "error",
        ),
        (
            "field/urdf-with-fingers",
            "arm.urdf",
            "data.csv",
            "the chain j1, j2, j3|finger2 (which follows finger1)",
            "error",
        ),
        (
            "no_masses",
            urdf,
            train,
            "the description has no masses|4000 samples",
            UNIT,
        ),
        (
            "placeholders",
            urdf,
            train,
            "the description's masses are placeholders",
            UNIT,
        ),
        (
            "field/placeholder-masses",
            "arm.urdf",
            "data-1.csv",
            "the description's masses are placeholders",
            UNIT,
        ),
        (
            "field/no-or-impossible-masses",
            "none.urdf",
            "data.csv",
            "the description has no masses",
            UNIT,
        ),
        (
            "field/no-or-impossible-masses",
            "impossible.urdf",
            "data.csv",
            "link l1: no mass distribution has its inertia",
            UNIT,
        ),
        (
            "field/no-or-impossible-masses",
            "com-far-away.urdf",
            "data.csv",
            "link l3: all of its mass lies|a description that is wrong",
            UNIT,
        ),
        (
            "xacro",
            "arm.urdf.xacro",
            "../gripper/train.parquet",
            "expand it first: `xacro arm.urdf.xacro > arm.urdf`",
            "",
        ),
        (
            "field/mjcf-comment-and-attach",
            "comment.xml",
            "data.csv",
            "2000 samples",
            "error",
        ),
        (
            "field/mjcf-comment-and-attach",
            "scene.xml",
            "data.csv",
            "2000 samples",
            "error",
        ),
    ]);
}

#[test]
fn sizes_and_columns() {
    let (urdf, train) = ("robot.urdf", "train.parquet");
    let field = "field/called-a-current";
    check(&[
        (
            "heavy_description",
            urdf,
            train,
            "a description whose masses are wrong|the friction is the described one",
            UNIT,
        ),
        (
            field,
            "heavy.urdf",
            "data-1.csv",
            "or a description that is wrong: this recording does not tell which",
            UNIT,
        ),
        (
            field,
            "placeholder.urdf",
            "data-1.csv",
            "all weigh 1 kg: a guess, not a measurement",
            UNIT,
        ),
        (
            "columns_permuted",
            urdf,
            train,
            "columns 1 and 2 look exchanged",
            UNIT,
        ),
        (
            field,
            "right.urdf",
            "swapped12-1.csv",
            "columns 1 and 2 look exchanged",
            UNIT,
        ),
        (
            field,
            "right.urdf",
            "q2-turned-1.csv",
            "positions of j2 look turned round|direction = [1, -1, 1]",
            UNIT,
        ),
        (
            "columns_by_name",
            urdf,
            train,
            "q1 to q3 are read from q_joint1, q_joint2, q_joint3",
            "error",
        ),
        (
            "field/gravity-is-there",
            "pend.urdf",
            "swingup-1.csv",
            "4000 samples",
            "gravity removed|--gravity",
        ),
        (
            "field/explained-but-most-is-left",
            "pend.urdf",
            "command.csv",
            "torque, commanded|a command that holds the weight of an arm",
            "sensor",
        ),
        (
            "field/late-by-nothing",
            "pend.urdf",
            "chatter.csv",
            "3000 samples",
            "ms late",
        ),
    ]);
}

#[test]
fn tables_clocks_and_logs() {
    let (urdf, train) = ("robot.urdf", "train.parquet");
    let everyday = "field/everyday-tables";
    check(&[
        (
            "held_samples",
            urdf,
            train,
            "held samples|100 Hz in truth where the stamps say 1000 Hz",
            "commanded",
        ),
        (
            "two_publishers",
            urdf,
            train,
            "two sources write into one log",
            "current",
        ),
        (
            "targets_wrong_unit",
            urdf,
            train,
            "0.70 s after its command|π/180",
            "",
        ),
        (
            "decimal_commas",
            urdf,
            "train.csv",
            "2000 samples|50.0 Hz",
            "error",
        ),
        (
            "npz_names",
            urdf,
            "train.npz",
            "read from positions1",
            "error",
        ),
        ("no_time", urdf, "train.csv", "--rate HZ", ""),
        (
            everyday,
            "arm.urdf",
            "gap-of-nan.csv",
            "301 rows without values",
            "error",
        ),
        (
            everyday,
            "arm.urdf",
            "held-at-1kHz.csv",
            "held samples",
            "commanded",
        ),
        (
            everyday,
            "arm.urdf",
            "milliseconds.csv",
            "read in ms",
            "error",
        ),
        (
            everyday,
            "arm.urdf",
            "semicolon-decimal-comma.csv",
            "3000 samples",
            "error",
        ),
        (everyday, "arm.urdf", "ten-hertz.csv", "10.0 Hz", "0.1 Hz"),
        (
            everyday,
            "arm.urdf",
            "gravity-has-a-top.csv",
            "3000 samples",
            "cut at|stays at",
        ),
        (
            "field/rubbish-efforts",
            "arm.urdf",
            "data.csv",
            "is no measurement",
            "",
        ),
        (
            "field/rubbish-efforts",
            "arm.urdf",
            "every-second-zero.csv",
            "two sources write into one log",
            "",
        ),
        (
            "field/wrapped-angle",
            "arm.urdf",
            "wrapped.csv",
            "wrapped to one turn",
            "error",
        ),
    ]);
}

#[test]
fn motions_units_and_angles_of_the_field() {
    let out = tempfile::tempdir().expect("a temporary folder");
    let model = out.path().join("model");
    let model = model.to_str().expect("a name in UTF-8");
    let taught = |robot: &'static str, data: &[&'static str]| {
        let given = [
            &["--robot", robot, "--physics-only", "--out", model, "--data"],
            data,
        ];
        given.concat()
    };
    let percent = [
        "--check-only",
        "--robot",
        "arm.urdf",
        "--drive",
        "explicit.toml",
        "--data",
    ];
    let right_angle = "15 base parameters of the rigid body";
    let twice = [
        "--robot", "arm.urdf", "--before", "run1.csv", "--data", "run2.csv",
    ];
    let fast = ["slow-1.csv", "slow-2.csv", "--heldout", "fast.csv"];
    for (folder, name, arguments, said) in [
        (
            "same-motion-twice",
            "diagnose",
            twice.to_vec(),
            "Nothing has changed beyond noise",
        ),
        (
            "slow-then-fast",
            "train",
            taught("arm.urdf", &fast),
            "lie outside what was taught",
        ),
        (
            "rounded-right-angle",
            "train",
            taught("exact.urdf", &["data.csv"]),
            right_angle,
        ),
        (
            "rounded-right-angle",
            "train",
            taught("rounded.urdf", &["data.csv"]),
            right_angle,
        ),
        (
            "percent-of-range",
            "train",
            [&percent[..], &["dataset"]].concat(),
            "per cent of each motor's range",
        ),
        (
            "percent-of-range",
            "train",
            [&percent[..], &["dataset-deg"]].concat(),
            r#"units.angle = "deg""#,
        ),
    ] {
        let Some(answer) = answer(&format!("field/{folder}"), name, &arguments) else {
            return;
        };
        assert!(answer.contains(said), "{folder}: no `{said}` in {answer}");
    }
}

#[test]
fn masses_as_diagnose_sees_them() {
    let fast = "--fast --robot robot.urdf --data train.parquet --heldout test.parquet";
    let fast: Vec<&str> = fast.split(' ').collect();
    for (folder, said) in [
        (
            "no_masses",
            "the description has no masses, so that there is no gap as given to judge",
        ),
        (
            "placeholders",
            "the description's masses are placeholders, so that there is no gap as given to judge",
        ),
        (
            "heavy_description",
            "Biggest cause: inertial parameters of links on joint1, joint2, joint3",
        ),
        ("columns_permuted", "columns 1 and 2 look exchanged"),
    ] {
        let Some(answer) = answer(folder, "diagnose", &fast) else {
            return;
        };
        assert!(answer.contains(said), "{folder}: no `{said}` in {answer}");
        assert!(!answer.contains("payload, "), "{folder}: {answer}");
    }
}

/// A `<dcmotor>` brakes its joint while its voltage is zero: that is no damping of the joint as well.
#[test]
fn back_emf_is_not_written_as_damping() {
    let Some(given) = shared("repro/field/mjcf-dcmotor") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name);
    let table = std::fs::read_to_string(given.join("data.csv")).expect("readable");
    let (head, rows) = table.split_once('\n').expect("a header");
    let rows: Vec<&str> = rows.lines().collect();
    let halves = rows.split_at(rows.len() / 2);
    for (name, rows) in [("a.csv", halves.0), ("b.csv", halves.1)] {
        let text = format!("{head}\n{}\n", rows.join("\n"));
        std::fs::write(path(name), text).expect("writable");
    }
    let mut diagnose = program("diagnose");
    diagnose
        .args(["--fast", "--robot"])
        .arg(given.join("dc.xml"));
    diagnose.arg("--data").arg(path("a.csv"));
    diagnose.arg("--heldout").arg(path("b.csv"));
    let ended = run(diagnose.arg("--patch").arg(path("patched.xml")));
    let said = &ended.succeeded().out;
    assert!(said.contains("Nothing is missing"), "{said}");
    let [was, now] = [given.join("dc.xml"), path("patched.xml")].map(|file| {
        let (_, robot) = Description::load(&file, &[]).expect("a model");
        robot.joints()[0].damping
    });
    // K²/R of the motor, N·s/m.
    assert!(
        (was - 8.0).abs() < 1e-9 && (now - was).abs() < 0.05,
        "{now}"
    );
}
