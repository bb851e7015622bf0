//! Parquet, zstd-compressed; text labels, 64-bit numbers.

use super::columns::Table;
use super::problem::WriteProblem;
use crate::read::TORQUE_FILTER_KEY;
use parquet::basic::{Compression, ConvertedType, Repetition, Type as PhysicalType, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;
use std::io::Write;
use std::sync::Arc;

impl From<ParquetError> for WriteProblem {
    fn from(e: ParquetError) -> Self {
        Self::Encoder(e.to_string())
    }
}

pub(super) fn encode(table: &Table, out: impl Write + Send) -> Result<(), WriteProblem> {
    let filter = match table.torque_filter {
        None => "none".to_owned(),
        Some(f) => format!("{},{},{}", f.order, f.cutoff_hz, f.ripple_db),
    };
    let fields = table.header().into_iter().map(|name| match name.as_str() {
        "trajectory" => (name, PhysicalType::BYTE_ARRAY),
        _ => (name, PhysicalType::DOUBLE),
    });
    let filter = KeyValue::new(TORQUE_FILTER_KEY.to_owned(), filter);
    let mut writer = writer(fields, Some(vec![filter]), out)?;
    let mut group = writer.next_row_group()?;
    let labels: Vec<ByteArray> = table
        .trajectories
        .iter()
        .flat_map(|t| std::iter::repeat_n(ByteArray::from(t.label.as_str()), t.range.len()))
        .collect();
    if let Some(mut column) = group.next_column()? {
        column
            .typed::<ByteArrayType>()
            .write_batch(&labels, None, None)?;
        column.close()?;
    }
    numbers(&mut group, table.time)?;
    for (_, values) in &table.groups {
        for column in values.columns() {
            numbers(&mut group, &column.to_vec())?;
        }
    }
    group.close()?;
    writer.close()?;
    Ok(())
}

/// Encodes named columns of numbers, all of one length.
pub(super) fn numbered(
    columns: &[(String, Vec<f64>)],
    out: impl Write + Send,
) -> Result<(), WriteProblem> {
    let fields = columns.iter();
    let fields = fields.map(|(name, _)| (name.clone(), PhysicalType::DOUBLE));
    let mut writer = writer(fields, None, out)?;
    let mut group = writer.next_row_group()?;
    for (_, values) in columns {
        numbers(&mut group, values)?;
    }
    group.close()?;
    writer.close()?;
    Ok(())
}

/// Writer of a file with these columns, all of them without nulls.
fn writer<W: Write + Send>(
    fields: impl Iterator<Item = (String, PhysicalType)>,
    metadata: Option<Vec<KeyValue>>,
    out: W,
) -> Result<SerializedFileWriter<W>, ParquetError> {
    let field = |(name, kind): (String, PhysicalType)| {
        let field = Type::primitive_type_builder(&name, kind).with_repetition(Repetition::REQUIRED);
        let field = match kind {
            PhysicalType::BYTE_ARRAY => field.with_converted_type(ConvertedType::UTF8),
            _ => field,
        };
        Ok(Arc::new(field.build()?))
    };
    let fields = fields
        .map(field)
        .collect::<Result<Vec<_>, ParquetError>>()?;
    let schema = Type::group_type_builder("schema")
        .with_fields(fields)
        .build()?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_key_value_metadata(metadata)
        .build();
    SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))
}

fn numbers<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[f64],
) -> Result<(), ParquetError> {
    if let Some(mut column) = group.next_column()? {
        column
            .typed::<DoubleType>()
            .write_batch(values, None, None)?;
        column.close()?;
    }
    Ok(())
}
