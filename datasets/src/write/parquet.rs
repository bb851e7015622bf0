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
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_key_value_metadata(Some(vec![KeyValue::new(
            TORQUE_FILTER_KEY.to_owned(),
            filter,
        )]))
        .build();
    let fields = table
        .header()
        .iter()
        .map(|name| {
            let kind = match name.as_str() {
                "trajectory" => PhysicalType::BYTE_ARRAY,
                _ => PhysicalType::DOUBLE,
            };
            let field =
                Type::primitive_type_builder(name, kind).with_repetition(Repetition::REQUIRED);
            let field = match kind {
                PhysicalType::BYTE_ARRAY => field.with_converted_type(ConvertedType::UTF8),
                _ => field,
            };
            Ok(Arc::new(field.build()?))
        })
        .collect::<Result<Vec<_>, ParquetError>>()?;
    let schema = Arc::new(
        Type::group_type_builder("schema")
            .with_fields(fields)
            .build()?,
    );
    let mut writer = SerializedFileWriter::new(out, schema, Arc::new(properties))?;
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
