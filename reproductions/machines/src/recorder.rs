//! Signals of an identification in the columns of the controller's recorder (`IDNT<group>.REC`), as CSV: for each axis
//! `tfbRaw`, `pfbRaw` (as recorded), `tfb`, `pfb`, `vfb`, `afb` (filtered), `tcmd` (of the fitted model), `te` (their difference).

use crate::identification::Identified;
use std::fmt::Write;

/// Columns of one axis, in order.
const COLUMNS: [&str; 8] = ["tfbRaw", "pfbRaw", "tfb", "pfb", "vfb", "afb", "tcmd", "te"];

/// The table, `time` first; rad, m, N·m, N.
pub fn recorder(identified: &Identified) -> String {
    let axes = identified.machine.axes();
    let mut out = String::from("time");
    for axis in axes {
        for column in COLUMNS {
            let _ = write!(out, ",{}.{column}", axis.name);
        }
    }
    out.push('\n');
    let signals = &identified.signals;
    for row in 0..signals.motion.len() {
        let _ = write!(out, "{}", signals.motion.time[row]);
        for j in 0..axes.len() {
            let at = (row, j);
            let (measured, command) = (signals.torque[at], identified.command[at]);
            let motion = &signals.motion;
            for value in [
                signals.torque_raw[at],
                signals.position_raw[at],
                measured,
                motion.q[at],
                motion.qd[at],
                motion.qdd[at],
                command,
                command - measured,
            ] {
                let _ = write!(out, ",{value}");
            }
        }
        out.push('\n');
    }
    out
}
