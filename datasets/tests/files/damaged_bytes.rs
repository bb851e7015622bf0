//! Readers return an error or a sound recording for any bytes: they never panic.
//!
//! `fuzz/` does the same for longer; this is the part that every test run can afford.

use datasets::read::{Format, read_bytes};
use datasets::{Part, ReadOptions, Recording, write};
use ndarray::Array2;
use proptest::prelude::*;
use std::io::Write as _;
use std::path::Path;

fn small() -> Recording {
    let time: Vec<f64> = (0..24).map(|i| f64::from(i) * 0.1).collect();
    let table = Array2::from_shape_fn((24, 6), |(i, j)| (i * 7 + j) as f64 * 0.01);
    Recording::new("made", time, table.clone(), Some(table))
}

fn written(name: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write(&small(), &path).unwrap();
    std::fs::read(path).unwrap()
}

fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn npz() -> Vec<u8> {
    let r = small();
    let reals =
        |v: &mut dyn Iterator<Item = &f64>| v.flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let labels: Vec<u8> = "run"
        .repeat(24)
        .chars()
        .flat_map(|c| (c as u32).to_le_bytes())
        .collect();
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, array) in [
        ("time.npy", npy("<f8", "(24,)", &reals(&mut r.time.iter()))),
        ("q.npy", npy("<f8", "(24, 6)", &reals(&mut r.q.iter()))),
        (
            "tau.npy",
            npy(
                "<f8",
                "(24, 6)",
                &reals(&mut r.tau.as_ref().unwrap().iter()),
            ),
        ),
        ("trajectory.npy", npy("<U3", "(24,)", &labels)),
    ] {
        archive
            .start_file(name, zip::write::SimpleFileOptions::default())
            .unwrap();
        archive.write_all(&array).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A MATLAB 5 file whose matrices are too small to be a recording but well formed.
fn mat() -> Vec<u8> {
    let mut bytes = vec![b' '; 124];
    bytes.extend([0x00, 0x01, b'I', b'M']);
    for (name, rows) in [("time_train", 1_u32), ("u_train", 6), ("y_train", 6)] {
        let values = vec![0_u8; rows as usize * 24 * 8];
        let mut body = Vec::new();
        for (kind, data) in [
            (6_u32, vec![6, 0, 0, 0, 0, 0, 0, 0]),
            (5, [rows.to_le_bytes(), 24_u32.to_le_bytes()].concat()),
            (1, name.as_bytes().to_vec()),
            (9, values),
        ] {
            body.extend(kind.to_le_bytes());
            body.extend((data.len() as u32).to_le_bytes());
            body.extend(&data);
            body.resize(body.len().next_multiple_of(8), 0);
        }
        bytes.extend(14_u32.to_le_bytes());
        bytes.extend((body.len() as u32).to_le_bytes());
        bytes.extend(body);
    }
    bytes
}

/// Without chunks, so that damage reaches the messages, and of two joints.
fn bag(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    std::fs::read(folder.join("tests/fixtures/bags").join(name)).unwrap()
}

fn parse(bytes: &[u8], format: Format) -> Result<Recording, datasets::ReadError> {
    let options = match format {
        Format::Bag => ReadOptions {
            joints: vec!["shoulder".into(), "elbow".into()],
            ..ReadOptions::for_robot(2)
        },
        _ => ReadOptions::kr300(Part::Train),
    };
    read_bytes(bytes, format, Path::new("damaged"), &options)
}

#[test]
fn the_undamaged_files_are_read() {
    for (bytes, format) in [
        (written("a.csv"), Format::Csv),
        (written("a.parquet"), Format::Parquet),
        (npz(), Format::Npz),
    ] {
        let r = parse(&bytes, format).unwrap();
        assert_eq!((r.q, r.tau), (small().q, small().tau), "{format:?}");
    }
    assert_eq!(
        parse(&npz(), Format::Npz).unwrap().trajectories[0].label,
        "run"
    );
    let e = parse(&mat(), Format::Mat).unwrap_err();
    assert!(e.to_string().contains("time goes from"), "{e}");
}

/// Overwrites, cuts and repeats parts of a file.
fn damage(bytes: &mut Vec<u8>, edits: &[(u32, u8, u8)]) {
    for &(at, value, kind) in edits {
        if bytes.is_empty() {
            return;
        }
        let at = at as usize % bytes.len();
        match kind % 8 {
            0 => bytes.truncate(at),
            1 => bytes.insert(at, value),
            2 => {
                bytes.remove(at);
            }
            3 => bytes[at] ^= 1 << (value % 8),
            _ => bytes[at] = value,
        }
    }
}

/// A recording that comes out of damaged bytes is still a recording.
fn survives(mut bytes: Vec<u8>, format: Format, edits: &[(u32, u8, u8)]) {
    damage(&mut bytes, edits);
    if let Ok(r) = parse(&bytes, format) {
        r.validate().unwrap();
    }
}

type Edits = Vec<(u32, u8, u8)>;

fn edits() -> impl Strategy<Value = Edits> {
    prop::collection::vec(any::<(u32, u8, u8)>(), 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn damaged_csv(edits in edits()) {
        survives(written_once(0), Format::Csv, &edits);
    }

    #[test]
    fn damaged_parquet(edits in edits()) {
        survives(written_once(1), Format::Parquet, &edits);
    }

    #[test]
    fn damaged_npz(edits in edits()) {
        survives(written_once(2), Format::Npz, &edits);
    }

    #[test]
    fn damaged_bag(edits in edits()) {
        survives(written_once(4), Format::Bag, &edits);
    }

    #[test]
    fn damaged_sqlite_bag(edits in edits()) {
        survives(written_once(5), Format::Bag, &edits);
    }

    #[test]
    fn damaged_mat(edits in edits()) {
        survives(written_once(3), Format::Mat, &edits);
    }
}

fn written_once(which: usize) -> Vec<u8> {
    static FILES: std::sync::OnceLock<[Vec<u8>; 6]> = std::sync::OnceLock::new();
    FILES.get_or_init(|| {
        [
            written("a.csv"),
            written("a.parquet"),
            npz(),
            mat(),
            bag("unchunked.mcap"),
            bag("rosbag2_db3/rosbag2_db3.db3"),
        ]
    })[which]
        .clone()
}
