//! CSV with a header.

use super::columns::{header, tables};
use super::problem::WriteProblem;
use crate::Recording;
use std::io::Write;

pub(super) fn encode(recording: &Recording, out: impl Write) -> Result<(), WriteProblem> {
    let fail = |e: csv::Error| WriteProblem::Encoder(e.to_string());
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(header(recording)).map_err(fail)?;
    let tables = tables(recording);
    for t in &recording.trajectories {
        for row in t.range.clone() {
            writer.write_field(&t.label).map_err(fail)?;
            let cells = tables.iter().flat_map(|(_, table)| table.row(row));
            for v in std::iter::once(&recording.time[row]).chain(cells) {
                writer.write_field(v.to_string()).map_err(fail)?;
            }
            writer.write_record(None::<&[u8]>).map_err(fail)?;
        }
    }
    writer.flush()?;
    Ok(())
}
