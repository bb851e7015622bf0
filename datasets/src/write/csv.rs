//! CSV with a header.

use super::columns::Table;
use super::problem::WriteProblem;
use std::io::Write;

pub(super) fn encode(table: &Table, out: impl Write) -> Result<(), WriteProblem> {
    let fail = |e: csv::Error| WriteProblem::Encoder(e.to_string());
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(table.header()).map_err(fail)?;
    for t in table.trajectories {
        for row in t.range.clone() {
            writer.write_field(&t.label).map_err(fail)?;
            let cells = table.groups.iter().flat_map(|(_, values)| values.row(row));
            for v in std::iter::once(&table.time[row]).chain(cells) {
                writer.write_field(v.to_string()).map_err(fail)?;
            }
            writer.write_record(None::<&[u8]>).map_err(fail)?;
        }
    }
    writer.flush()?;
    Ok(())
}
