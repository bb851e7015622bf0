//! Robots, drive files and models return an error or something sound for any bytes: they never panic.
//!
//! `fuzz/` does the same for longer; this is the part that every test run can afford (`PROPTEST_CASES` lengthens it).

use feedforward::network::Compensator;
use model::directory::ModelFile;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Builtin, Changed, Mjcf, Robot, drive::Drive, to_urdf, urdf_with};
use proptest::prelude::*;
use std::sync::OnceLock;
use tests::program::{program, run};
use tests::synthetic::{Plan, record_to};

const DRIVE: &str = "gear_ratio = [101, 101, 101, 101, 101, 101]\ndirection = [1, 1, -1, 1, 1, 1]\n\
    zero = [0, -1.5, 0, 0, 0, 0]\n[columns]\ntime = \"stamp\"\ntau = \"current_{}\"\n[units]\nangle = \"deg\"\n\
    torque = \"motor\"\n[torque_filter]\norder = 4\ncutoff_hz = 2.0\nripple_db = 0.2\n";

/// Models in MuJoCo's format.
const MJCF: [&str; 4] = [
    include_str!("../../../physics/tests/fixtures/mjcf/gripper.xml"),
    include_str!("../../../physics/tests/fixtures/mjcf/geoms.xml"),
    include_str!("../../../physics/tests/fixtures/mjcf/orientations.xml"),
    include_str!("../../../physics/tests/fixtures/mjcf/bounded.xml"),
];

/// What numbers and names are replaced by.
const ODD: [&str; 14] = [
    "0",
    "-1",
    "1e308",
    "-1e-320",
    "NaN",
    "inf",
    "1e999",
    "99999999999999999999",
    "",
    "\"\"",
    "null",
    "[]",
    "\u{0}",
    "é",
];

/// One change of a text or file: at a place (as a share of its length), of a kind.
type Change = (f64, u8, u8, usize);

/// Bytes with some changes: flipped, cut out, doubled, a number replaced, the end cut off.
fn changed(bytes: &[u8], changes: &[Change]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for &(share, kind, value, odd) in changes {
        if out.is_empty() {
            break;
        }
        let at = ((share * out.len() as f64) as usize).min(out.len() - 1);
        let end = (at + 1 + usize::from(value) % 40).min(out.len());
        match kind {
            0 => out[at] = value,
            1 => drop(out.drain(at..end)),
            2 => {
                let again = out[at..end].to_vec();
                out.splice(at..at, again);
            }
            3 => out.truncate(at),
            _ => {
                let number = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
                let start = (at..out.len())
                    .find(|&i| out[i].is_ascii_digit())
                    .unwrap_or(at);
                let stop = (start..out.len())
                    .find(|&i| !number(&out[i]))
                    .unwrap_or(out.len());
                out.splice(start..stop, ODD[odd % ODD.len()].bytes());
            }
        }
    }
    out
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    prop::collection::vec((0.0..1.0, 0_u8..8, any::<u8>(), 0_usize..ODD.len()), 1..5)
}

/// `model.json` and `compensator.safetensors` of a small model, made once.
fn model() -> &'static (Vec<u8>, Vec<u8>) {
    static MODEL: OnceLock<(Vec<u8>, Vec<u8>)> = OnceLock::new();
    MODEL.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let robot = Builtin::Ur5.robot();
        let data = record_to(folder.path(), "r.csv", &robot, &Plan::default());
        let out = folder.path().join("model");
        let mut train = program("train");
        train.args(["--robot", "ur5", "--basic", "--quiet", "--epochs", "2"]);
        train.args(["--members", "1", "--data"]).arg(&data);
        run(train.arg("--out").arg(&out)).succeeded();
        let read = |name: &str| std::fs::read(out.join(name)).expect("written");
        (read("model.json"), read("compensator.safetensors"))
    })
}

proptest! {
    #[test]
    fn a_damaged_urdf_is_no_panic(changes in changes()) {
        let whole = to_urdf(&Builtin::FoxbotA05.robot());
        let text = String::from_utf8_lossy(&changed(whole.as_bytes(), &changes)).into_owned();
        if let Ok(robot) = Robot::from_urdf_str(&text) {
            let n = robot.dof();
            let (rest, mut tau) = (vec![0.0; n], vec![0.0; n]);
            inverse_dynamics(&robot, &mut Workspace::new(&robot), &rest, &rest, &rest, &mut tau);
            prop_assert!(tau.iter().all(|t| !t.is_nan()), "{text}");
            let _ = urdf_with(&text, &robot);
            prop_assert!(Robot::from_urdf_str(&to_urdf(&robot)).is_ok(), "{text}");
        }
    }

    #[test]
    fn a_damaged_mjcf_is_no_panic(changes in changes(), which in 0..MJCF.len()) {
        let text = String::from_utf8_lossy(&changed(MJCF[which].as_bytes(), &changes)).into_owned();
        if let Ok((mjcf, robot)) = Mjcf::from_text(&text, &[]).and_then(|m| m.robot().map(|r| (m, r))) {
            let n = robot.dof();
            let (rest, mut tau) = (vec![0.0; n], vec![0.0; n]);
            inverse_dynamics(&robot, &mut Workspace::new(&robot), &rest, &rest, &rest, &mut tau);
            prop_assert!(tau.iter().all(|t| !t.is_nan()), "{text}");
            prop_assert!(Robot::from_urdf_str(&to_urdf(&robot)).is_ok(), "{text}");
            let heavier: Vec<f64> = robot.parameters().iter().map(|p| 1.5 * p).collect();
            let friction = vec![0.5; n];
            let new = robot.with_parameters(&heavier).and_then(|r| r.with_friction(&friction, &friction));
            let new = new.expect("as many values");
            let edited = mjcf.with(&Changed { zeros: &friction, ..Changed::of(&new) });
            let files = edited.expect("the same joints").files("out.xml".as_ref()).expect("one file");
            prop_assert!(Mjcf::from_text(&files[0].1, &[]).is_ok(), "{text}");
        }
    }

    #[test]
    fn a_damaged_drive_file_is_no_panic(changes in changes()) {
        let robot = Builtin::Ur5.robot();
        let text = String::from_utf8_lossy(&changed(DRIVE.as_bytes(), &changes)).into_owned();
        if let Ok(drive) = Drive::from_toml(&text, &robot) {
            let torque = drive.torque_conversion(&robot);
            prop_assert!(torque.is_ok_and(|list| list.len() == 6), "{text}");
            prop_assert!(drive.apply(robot).is_ok(), "{text}");
        }
    }

    #[test]
    fn a_damaged_model_is_no_panic(changes in changes()) {
        let bytes = changed(&model().0, &changes);
        let text = String::from_utf8_lossy(&bytes);
        if let Ok(file) = ModelFile::parse(&text, "model.json".into()) {
            prop_assert!(file.physics.model().is_ok());
            let table = file.covariance_table();
            prop_assert_eq!(table.nrows(), table.ncols());
        }
    }

    #[test]
    fn a_damaged_compensator_is_no_panic(changes in changes()) {
        let bytes = changed(&model().1, &changes);
        // Weights are under a checksum: what differs from the file is refused.
        prop_assert!(bytes == model().1 || Compensator::from_bytes(&bytes).is_err());
    }
}
