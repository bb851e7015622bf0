//! Bags as a driver would record them: MCAP with joint states, written by hand after the specification.

use datasets::Recording;
use ndarray::Array2;
use std::path::Path;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
const TYPE: &str = "sensor_msgs/msg/JointState";
const DEFINITION: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
    ================================================================================\nMSG: std_msgs/Header\n\
    builtin_interfaces/Time stamp\nstring frame_id\n\
    ================================================================================\nMSG: builtin_interfaces/Time\n\
    int32 sec\nuint32 nanosec\n";
/// Time of the first sample, ns since 1970.
const START: u64 = 1_790_000_000_000_000_000;

/// Writes positions, velocities (where there are some) and torques as the topic `/joint_states`, the joints of message i turned
/// by i places: their order says nothing. Unpacked, without chunks.
///
/// # Panics
/// When the file cannot be written.
pub fn write_bag(path: &Path, recording: &Recording, joints: &[String]) {
    let mut file = MAGIC.to_vec();
    record(&mut file, 0x01, &[text("ros2"), text("residyn")].concat());
    let schema = [
        &1_u16.to_le_bytes()[..],
        &text(TYPE),
        &text("ros2msg"),
        &text(DEFINITION),
    ];
    record(&mut file, 0x03, &schema.concat());
    let ids = [1_u16.to_le_bytes(), 1_u16.to_le_bytes()].concat();
    let channel = [
        ids,
        text("/joint_states"),
        text("cdr"),
        0_u32.to_le_bytes().to_vec(),
    ];
    record(&mut file, 0x04, &channel.concat());
    for row in 0..recording.len() {
        let time = START + (recording.time[row] * 1e9).round() as u64;
        let head = [
            &1_u16.to_le_bytes()[..],
            &(row as u32).to_le_bytes(),
            &time.to_le_bytes(),
            &time.to_le_bytes(),
        ];
        record(
            &mut file,
            0x05,
            &[head.concat(), state(recording, joints, row, time)].concat(),
        );
    }
    record(&mut file, 0x0f, &[0; 4]);
    record(&mut file, 0x02, &[0; 20]);
    file.extend(MAGIC);
    std::fs::write(path, file).expect("a file in a temporary folder");
}

fn record(file: &mut Vec<u8>, opcode: u8, body: &[u8]) {
    file.push(opcode);
    file.extend((body.len() as u64).to_le_bytes());
    file.extend(body);
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

/// One message in little-endian CDR.
fn state(recording: &Recording, joints: &[String], row: usize, time: u64) -> Vec<u8> {
    let order: Vec<usize> = (0..joints.len())
        .map(|j| (j + row) % joints.len())
        .collect();
    let mut data = Vec::new();
    data.extend(((time / 1_000_000_000) as i32).to_le_bytes());
    data.extend(((time % 1_000_000_000) as u32).to_le_bytes());
    string(&mut data, "base");
    count(&mut data, order.len());
    order.iter().for_each(|&j| string(&mut data, &joints[j]));
    let tables: [Option<&Array2<f64>>; 3] = [
        Some(&recording.q),
        recording.qd.as_ref(),
        recording.tau.as_ref(),
    ];
    for table in tables {
        count(&mut data, table.map_or(0, |_| order.len()));
        let Some(table) = table else { continue };
        data.resize(data.len().next_multiple_of(8), 0);
        let values = order.iter().map(|&j| table[[row, j]]);
        values.for_each(|v| data.extend(v.to_le_bytes()));
    }
    [&[0, 1, 0, 0][..], &data].concat()
}

fn count(data: &mut Vec<u8>, count: usize) {
    data.resize(data.len().next_multiple_of(4), 0);
    data.extend((count as u32).to_le_bytes());
}

fn string(data: &mut Vec<u8>, text: &str) {
    count(data, text.len() + 1);
    data.extend(text.as_bytes());
    data.push(0);
}
