//! Parquet: columns of numbers, labels as text or integers; of a column of lists of one length each element is a column.

use super::contained::contained;
use super::footer::{plausible, plausible_pages};
use crate::assemble::{Columns, LabelRuns, assemble};
use crate::columns::{Layout, Role};
use crate::{Problem, ReadError, ReadOptions, Recording, TorqueFilter, stamps};
use parquet::basic::Type as PhysicalType;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;
use std::collections::BTreeSet;
use std::path::Path;

/// Key of the file's metadata under which the writer of this crate notes the torque filter.
pub(crate) const TORQUE_FILTER_KEY: &str = "residyn.torque_filter";

/// Largest number of elements of a list that are read as columns: pictures have more.
pub(super) const LONGEST: usize = 1024;

/// Number of rows decoded at a time.
const BATCH: usize = 8192;

/// Reads a Parquet file held in memory.
pub(crate) fn read(
    bytes: &[u8],
    file: &Path,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    if !plausible(bytes) {
        let detail = "its footer claims more than it holds".to_owned();
        let format = "Parquet";
        return Err(Problem::Damaged { format, detail }.in_file(file));
    }
    contained("Parquet", file, || decode(bytes, file, options))
}

/// Names of a file's columns, those of lists element by element.
pub(super) fn names(bytes: &[u8]) -> Option<Vec<String>> {
    if !plausible(bytes) {
        return None;
    }
    let read = || {
        let owned = bytes::Bytes::copy_from_slice(bytes);
        let reader = SerializedFileReader::new(owned);
        let reader = reader.map_err(|e| Problem::Damaged {
            format: "Parquet",
            detail: e.to_string(),
        });
        let reader = reader.map_err(|problem| problem.in_file(Path::new("")))?;
        Ok(elements(reader.metadata())
            .into_iter()
            .map(|p| p.name)
            .collect())
    };
    contained("Parquet", Path::new(""), read).ok()
}

fn decode(bytes: &[u8], file: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    let damaged = |detail: String| Problem::Damaged {
        format: "Parquet",
        detail,
    };
    if bytes.is_empty() {
        return Err(Problem::Empty.in_file(file));
    }
    let owned = bytes::Bytes::copy_from_slice(bytes);
    let reader =
        SerializedFileReader::new(owned).map_err(|e| damaged(e.to_string()).in_file(file))?;
    let meta = reader.metadata().file_metadata();
    let schema = meta.schema_descr_ptr();
    let parts = elements(reader.metadata());
    let header: Vec<String> = parts.iter().map(|p| p.name.clone()).collect();
    let layout = Layout::resolve(&header, options, file)?;
    let mut numbers = Vec::new();
    let mut labels = None;
    for column in &layout.used {
        let part = &parts[column.index];
        let descr = schema.column(part.column);
        if descr.max_rep_level() > 1 {
            let kind = "list of lists".to_owned();
            return Err(Problem::ColumnType(kind).in_column(file, &column.name));
        }
        let mut sink = match column.role {
            Role::Label => Sink::Labels(LabelRuns::default()),
            Role::Time | Role::Nanoseconds | Role::Joint(..) => Sink::Numbers(Vec::new()),
        };
        let mut row = 0;
        for group in 0..reader.num_row_groups() {
            let chunk = reader.metadata().row_group(group).column(part.column);
            if !plausible_pages(within(bytes, chunk.byte_range())) {
                let detail = "the header of a page claims more than it holds".to_owned();
                return Err(damaged(detail).in_column(file, &column.name));
            }
            let column_reader = reader
                .get_row_group(group)
                .and_then(|g| g.get_column_reader(part.column))
                .map_err(|e| damaged(e.to_string()).in_column(file, &column.name))?;
            drain(
                column_reader,
                (descr.max_def_level(), part.of),
                &mut sink,
                &mut row,
            )
            .map_err(|stop| match stop {
                Stop::Decoder(e) => damaged(e.to_string()).in_column(file, &column.name),
                Stop::Value(p) => p.in_column(file, &column.name).at_row(row),
                Stop::Column(p) => p.in_column(file, &column.name),
            })?;
        }
        match sink {
            Sink::Numbers(values) => numbers.push(values),
            Sink::Labels(runs) => labels = Some(runs),
        }
        let rows = numbers.first().map_or(row, Vec::len);
        if row != rows {
            let detail = format!("{row} values where the column before has {rows}");
            return Err(damaged(detail).in_column(file, &column.name));
        }
    }
    let torque_filter = meta
        .key_value_metadata()
        .and_then(|all| all.iter().find(|kv| kv.key == TORQUE_FILTER_KEY))
        .map(|kv| stored_filter(kv.value.as_deref().unwrap_or("")))
        .transpose()
        .map_err(|p| p.in_file(file))?;
    let columns = Columns {
        numbers,
        labels,
        lines: None,
        empty: BTreeSet::new(),
        torque_filter,
    };
    assemble(&layout, columns, options, file)
}

/// Bytes of the file in a range given by start and length, as far as the file goes.
fn within(bytes: &[u8], (start, length): (u64, u64)) -> &[u8] {
    let at = |n: u64| usize::try_from(n).map_or(bytes.len(), |n| n.min(bytes.len()));
    let (start, end) = (at(start), at(start.saturating_add(length)));
    &bytes[start..end]
}

/// A column of the header: one of the file, or an element of its lists.
struct Part {
    name: String,
    /// Index of the column in the file.
    column: usize,
    of: Option<Element>,
}

/// An element of lists of one length.
#[derive(Clone, Copy)]
struct Element {
    index: usize,
    length: usize,
}

/// Columns of the table. A list of k numbers per row becomes the columns `NAME[0]` to `NAME[k-1]`. Lists of different
/// lengths, whose number of values is not a multiple of the rows, stay one column, which is refused where it is used.
fn elements(meta: &ParquetMetaData) -> Vec<Part> {
    let columns = meta.file_metadata().schema_descr().columns();
    let one = |(column, descr): (usize, &std::sync::Arc<ColumnDescriptor>)| -> Vec<Part> {
        let path = descr.path().parts();
        let whole = |of| Part {
            name: descr.path().string(),
            column,
            of,
        };
        if descr.max_rep_level() == 0 {
            return vec![whole(None)];
        }
        let groups = meta.row_groups();
        let values: i64 = groups.iter().map(|g| g.column(column).num_values()).sum();
        let rows: i64 = groups.iter().map(|g| g.num_rows()).sum::<i64>().max(1);
        let length = usize::try_from(values / rows).unwrap_or(0);
        // NAME.list.element, in whatever words.
        let base = path[..path.len().saturating_sub(2).max(1)].join(".");
        if descr.max_rep_level() > 1 || !(1..=LONGEST).contains(&length) || values % rows != 0 {
            return vec![whole(None)];
        }
        let element = |index| Part {
            name: format!("{base}[{index}]"),
            ..whole(Some(Element { index, length }))
        };
        (0..length).map(element).collect()
    };
    columns.iter().enumerate().flat_map(one).collect()
}

/// Reads `none` or `order,cutoff_hz,ripple_db`.
fn stored_filter(text: &str) -> Result<Option<TorqueFilter>, Problem> {
    if text == "none" {
        return Ok(None);
    }
    let damaged = || Problem::Damaged {
        format: "Parquet",
        detail: format!("`{TORQUE_FILTER_KEY}` is `{text}`"),
    };
    let mut parts = text.split(',');
    let mut next = || parts.next().ok_or_else(damaged);
    let order = next()?.parse().map_err(|_| damaged())?;
    let cutoff_hz: f64 = next()?.parse().map_err(|_| damaged())?;
    let ripple_db: f64 = next()?.parse().map_err(|_| damaged())?;
    let sensible = (1..=16).contains(&order) && cutoff_hz > 0.0 && ripple_db > 0.0;
    if !(sensible && cutoff_hz.is_finite() && ripple_db < 20.0) {
        return Err(damaged());
    }
    Ok(Some(TorqueFilter {
        order,
        cutoff_hz,
        ripple_db,
        recognised: false,
    }))
}

/// Destination of a column's values.
enum Sink {
    Numbers(Vec<f64>),
    Labels(LabelRuns),
}

/// Reasons why a column cannot be read.
enum Stop {
    Decoder(ParquetError),
    /// A problem with the value at the current row.
    Value(Problem),
    Column(Problem),
}

/// One value of any physical type.
enum Value<'a> {
    Integer(i64),
    Real(f64),
    Text(&'a [u8]),
}

/// Level of a value that is there, and which element of a row's list is meant.
type Wanted = (i16, Option<Element>);

fn drain(
    reader: ColumnReader,
    level: Wanted,
    sink: &mut Sink,
    row: &mut usize,
) -> Result<(), Stop> {
    let unusable = |kind: PhysicalType| Err(Stop::Column(Problem::ColumnType(kind.to_string())));
    match reader {
        ColumnReader::BoolColumnReader(r) => {
            drain_typed(r, level, sink, row, |v| Value::Integer(i64::from(*v)))
        }
        ColumnReader::Int32ColumnReader(r) => {
            drain_typed(r, level, sink, row, |v| Value::Integer(i64::from(*v)))
        }
        ColumnReader::Int64ColumnReader(r) => {
            drain_typed(r, level, sink, row, |v| Value::Integer(*v))
        }
        ColumnReader::FloatColumnReader(r) => {
            drain_typed(r, level, sink, row, |v| Value::Real(f64::from(*v)))
        }
        ColumnReader::DoubleColumnReader(r) => {
            drain_typed(r, level, sink, row, |v| Value::Real(*v))
        }
        ColumnReader::ByteArrayColumnReader(r) => {
            drain_typed(r, level, sink, row, |v: &ByteArray| Value::Text(v.data()))
        }
        ColumnReader::Int96ColumnReader(_) => unusable(PhysicalType::INT96),
        ColumnReader::FixedLenByteArrayColumnReader(_) => {
            unusable(PhysicalType::FIXED_LEN_BYTE_ARRAY)
        }
    }
}

fn drain_typed<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    (level, element): Wanted,
    sink: &mut Sink,
    row: &mut usize,
    convert: impl for<'a> Fn(&'a T::T) -> Value<'a>,
) -> Result<(), Stop> {
    let mut values = Vec::with_capacity(BATCH);
    let mut levels = Vec::with_capacity(BATCH);
    let mut repeated = Vec::new();
    let Element { index, length } = element.unwrap_or(Element {
        index: 0,
        length: 1,
    });
    loop {
        values.clear();
        levels.clear();
        repeated.clear();
        let wanted = (level > 0).then_some(&mut levels);
        let lists = element.is_some().then_some(&mut repeated);
        let (records, read, _) = reader
            .read_records(BATCH, wanted, lists, &mut values)
            .map_err(Stop::Decoder)?;
        if records == 0 {
            return Ok(());
        }
        if let Some(at) = levels.iter().position(|&l| l < level) {
            *row += at / length;
            return Err(Stop::Value(Problem::MissingValue));
        }
        // A list begins where nothing is repeated: each after `length` values.
        let odd = |(i, r): (usize, &i16)| (*r == 0) != (i % length == 0);
        if let Some(at) = repeated.iter().enumerate().position(odd) {
            *row += at / length;
            let kind = format!("a list of another length than {length}");
            return Err(Stop::Value(Problem::ColumnType(kind)));
        }
        if read != records * length {
            return Err(Stop::Value(Problem::MissingValue));
        }
        for value in values.iter().skip(index).step_by(length) {
            sink.push(convert(value)).map_err(Stop::Value)?;
            *row += 1;
        }
    }
}

impl Sink {
    fn push(&mut self, value: Value<'_>) -> Result<(), Problem> {
        match self {
            Self::Numbers(numbers) => numbers.push(match value {
                Value::Integer(v) => v as f64,
                Value::Real(v) => v,
                Value::Text(v) => {
                    let text = String::from_utf8_lossy(v);
                    let stamp = stamps::from_text(&text);
                    stamp.ok_or_else(|| Problem::NotANumber(text.chars().take(40).collect()))?
                }
            }),
            Self::Labels(labels) => match value {
                Value::Integer(v) => labels.push(&v.to_string()),
                Value::Real(v) if v.is_finite() => labels.push(&v.to_string()),
                Value::Real(v) => return Err(Problem::NotFinite(v)),
                Value::Text(v) => labels.push(&String::from_utf8_lossy(v)),
            },
        }
        Ok(())
    }
}
