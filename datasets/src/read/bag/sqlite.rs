//! Tables of an SQLite file (<https://sqlite.org/fileformat2.html>), as far as rosbag2 needs them: a walk through all rows of tables with
//! row numbers, in their order. SQLite itself would be the largest thing that the programs are built of.

use crate::Problem;
use std::io::{Read, Seek, SeekFrom};

const MAGIC: &[u8; 16] = b"SQLite format 3\0";
/// Length of the file's header, at the start of the first page.
const HEADER: usize = 100;
/// Largest size of a row that is read, bytes.
const LARGEST: u64 = 1 << 30;

/// Value of one column in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value<'a> {
    /// Missing, or a kind of number that rosbag2 does not write.
    Null,
    Integer(i64),
    /// Bytes of a text or of a blob.
    Bytes(&'a [u8]),
}

impl Value<'_> {
    /// Value as a text; none for a number.
    pub fn text(self) -> Option<String> {
        match self {
            Self::Bytes(bytes) => Some(String::from_utf8_lossy(bytes).into_owned()),
            _ => None,
        }
    }

    /// Value as an integer; none for other values.
    pub fn integer(self) -> Option<i64> {
        match self {
            Self::Integer(value) => Some(value),
            _ => None,
        }
    }
}

/// A row: its number and its values.
pub(super) type Row<'a> = (i64, Vec<Value<'a>>);

/// Reader of an SQLite file. It decodes the pages itself and holds the list of tables.
pub(super) struct Database<R> {
    input: R,
    size: usize,
    usable: usize,
    pages: u64,
    tables: Vec<Table>,
}

/// Table of the file's schema.
#[derive(Clone, Debug)]
struct Table {
    name: String,
    root: u32,
    columns: Vec<String>,
}

impl<R: Read + Seek> Database<R> {
    /// Opens a file and reads its schema.
    ///
    /// # Errors
    /// The file is not SQLite, is cut short, or is damaged.
    pub fn open(mut input: R) -> Result<Self, Problem> {
        let length = input.seek(SeekFrom::End(0))?;
        let mut header = [0; HEADER];
        input.seek(SeekFrom::Start(0))?;
        input
            .read_exact(&mut header)
            .map_err(|_| Problem::CutOff { at: length })?;
        let size = match u16::from_be_bytes([header[16], header[17]]) {
            1 => 1 << 16,
            size => usize::from(size),
        };
        let usable = size.saturating_sub(usize::from(header[20]));
        if !header.starts_with(MAGIC) || !size.is_power_of_two() || usable < 480 {
            return Err(damaged("it does not start as SQLite files do"));
        }
        if !matches!(header[59], 0 | 1) {
            return Err(damaged("its texts are not UTF-8"));
        }
        let claimed = u32::from_be_bytes([header[28], header[29], header[30], header[31]]);
        let pages = length / size as u64;
        if u64::from(claimed) > pages {
            return Err(Problem::CutOff { at: length });
        }
        let mut database = Self {
            input,
            size,
            usable,
            pages,
            tables: Vec::new(),
        };
        let mut tables = Vec::new();
        database.walk(1, &mut |(_, row)| {
            let text = |i: usize| row.get(i).and_then(|v| v.text());
            let root = row.get(3).and_then(|v| v.integer());
            if let (Some("table"), Some(name), Some(root), Some(sql)) =
                (text(0).as_deref(), text(1), root, text(4))
            {
                tables.push(Table {
                    name,
                    root: u32::try_from(root).unwrap_or(0),
                    columns: columns(&sql),
                });
            }
            Ok(())
        })?;
        database.tables = tables;
        Ok(database)
    }

    /// Calls `take` with these columns of every row of a table; false where no table has that name.
    ///
    /// # Errors
    /// A column is missing, the file is cut or damaged, or what `take` refuses.
    pub fn rows(
        &mut self,
        table: &str,
        wanted: &[&str],
        take: &mut dyn FnMut(Row<'_>) -> Result<(), Problem>,
    ) -> Result<bool, Problem> {
        let Some(table) = self.tables.iter().find(|t| t.name == table).cloned() else {
            return Ok(false);
        };
        let place = |name: &&str| {
            let column = table.columns.iter().position(|c| c == name);
            column.ok_or_else(|| damaged(format!("table `{}` has no `{name}`", table.name)))
        };
        let places: Vec<usize> = wanted.iter().map(place).collect::<Result<_, _>>()?;
        self.walk(table.root, &mut |(number, row)| {
            let value = |&p: &usize| row.get(p).copied().unwrap_or(Value::Null);
            take((number, places.iter().map(value).collect()))
        })?;
        Ok(true)
    }

    fn page(&mut self, number: u32) -> Result<Vec<u8>, Problem> {
        let index = u64::from(number)
            .checked_sub(1)
            .filter(|&i| i < self.pages)
            .ok_or_else(|| {
                damaged(format!(
                    "it refers to page {number}, which it does not have"
                ))
            })?;
        self.input.seek(SeekFrom::Start(index * self.size as u64))?;
        let mut page = vec![0; self.size];
        self.input.read_exact(&mut page)?;
        Ok(page)
    }

    /// Every row of the tree of pages at `root`.
    fn walk(
        &mut self,
        root: u32,
        take: &mut dyn FnMut(Row<'_>) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        let mut waiting = vec![root];
        let mut seen = 0;
        let mut payload = Vec::new();
        while let Some(number) = waiting.pop() {
            seen += 1;
            if seen > self.pages {
                return Err(damaged("its pages refer to each other in a circle"));
            }
            let page = self.page(number)?;
            let broken = || damaged(format!("page {number} is not as it should be"));
            let start = if number == 1 { HEADER } else { 0 };
            let cells = usize::from(be16(&page, start + 3).ok_or_else(broken)?);
            let leaf = match page[start] {
                0x0d => true,
                0x05 => false,
                _ => return Err(broken()),
            };
            let pointers = start + if leaf { 8 } else { 12 };
            let cell = |i: usize| be16(&page, pointers + 2 * i).map(usize::from);
            if leaf {
                for i in 0..cells {
                    let at = cell(i).ok_or_else(broken)?;
                    let row = self.payload(&page, at, &mut payload)?.ok_or_else(broken)?;
                    let values = values(&payload).ok_or_else(broken)?;
                    take((row, values))?;
                }
            } else {
                let children = (0..cells).map(|i| be32(&page, cell(i)?));
                let children = children.chain([be32(&page, start + 8)]);
                let children: Vec<u32> = children.collect::<Option<_>>().ok_or_else(broken)?;
                waiting.extend(children.into_iter().rev());
            }
        }
        Ok(())
    }

    /// Reads the content of a cell of a leaf, with the pages that it runs over into; the row's number.
    fn payload(
        &mut self,
        page: &[u8],
        at: usize,
        into: &mut Vec<u8>,
    ) -> Result<Option<i64>, Problem> {
        into.clear();
        let mut at = at;
        let head = (|| Some((varint(page, &mut at)?, varint(page, &mut at)?)))();
        let longest = LARGEST.min(self.pages * self.size as u64);
        let Some((length, row)) = head.filter(|(length, _)| *length <= longest) else {
            return Ok(None);
        };
        let length = length as usize;
        let here = self.local(length);
        let Some(first) = page.get(at..at + here) else {
            return Ok(None);
        };
        into.extend_from_slice(first);
        let mut next = be32(page, at + here);
        while into.len() < length {
            let Some(number) = next.filter(|&n| n != 0) else {
                return Ok(None);
            };
            let more = self.page(number)?;
            let count = (length - into.len()).min(self.usable - 4);
            into.extend_from_slice(&more[4..4 + count]);
            next = be32(&more, 0);
        }
        Ok(Some(row as i64))
    }

    /// Number of bytes of a row's content that stand in its leaf page.
    fn local(&self, length: usize) -> usize {
        let most = self.usable - 35;
        if length <= most {
            return length;
        }
        let least = (self.usable - 12) * 32 / 255 - 23;
        match least + (length - least) % (self.usable - 4) {
            fits if fits <= most => fits,
            _ => least,
        }
    }
}

fn damaged(detail: impl Into<String>) -> Problem {
    Problem::Damaged {
        format: "SQLite",
        detail: detail.into(),
    }
}

fn be16(bytes: &[u8], at: usize) -> Option<u16> {
    let two = bytes.get(at..at.checked_add(2)?)?;
    two.try_into().ok().map(u16::from_be_bytes)
}

fn be32(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    four.try_into().ok().map(u32::from_be_bytes)
}

/// A number in one to nine bytes, most significant first.
fn varint(bytes: &[u8], at: &mut usize) -> Option<u64> {
    let mut value = 0;
    for i in 0..9 {
        let byte = *bytes.get(*at)?;
        *at += 1;
        if i == 8 {
            return Some(value << 8 | u64::from(byte));
        }
        value = value << 7 | u64::from(byte & 0x7f);
        if byte < 0x80 {
            break;
        }
    }
    Some(value)
}

/// The values of a row's content.
fn values(content: &[u8]) -> Option<Vec<Value<'_>>> {
    let mut at = 0;
    let head = usize::try_from(varint(content, &mut at)?).ok()?;
    let mut body = head;
    let mut values = Vec::new();
    while at < head {
        let kind = varint(content, &mut at)?;
        let length = match kind {
            0 | 8 | 9 => 0,
            1..=4 => kind,
            5 => 6,
            6 | 7 => 8,
            12.. => (kind - 12) / 2,
            _ => return None,
        };
        let end = body.checked_add(usize::try_from(length).ok()?)?;
        let bytes = content.get(body..end)?;
        body = end;
        values.push(match kind {
            8 => Value::Integer(0),
            9 => Value::Integer(1),
            1..=6 => Value::Integer(signed(bytes)),
            12.. => Value::Bytes(bytes),
            _ => Value::Null,
        });
    }
    Some(values)
}

/// A signed number, most significant byte first.
fn signed(bytes: &[u8]) -> i64 {
    let sign = if bytes.first().is_some_and(|b| *b >= 0x80) {
        -1
    } else {
        0
    };
    bytes
        .iter()
        .fold(sign, |value, byte| value << 8 | i64::from(*byte))
}

/// The names of the columns in a statement that creates a table.
fn columns(sql: &str) -> Vec<String> {
    let body = sql.split_once('(').map_or("", |(_, body)| body);
    let named = |part: &str| {
        let word = part.split_whitespace().next()?;
        Some(word.trim_matches(['"', '`', '[', ']']).to_owned())
    };
    body.split(',').filter_map(named).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_length() {
        assert_eq!(signed(&[0xff]), -1);
        assert_eq!(signed(&[0x01, 0x00]), 256);
        assert_eq!(signed(&[0x80, 0, 0, 0, 0, 0, 0, 0]), i64::MIN);
        let mut at = 0;
        assert_eq!(varint(&[0x81, 0x00, 0x7f], &mut at), Some(128));
        assert_eq!((varint(&[0x81, 0x00, 0x7f], &mut at), at), (Some(127), 3));
        assert_eq!(varint(&[0xff; 9], &mut 0), Some(u64::MAX));
        assert_eq!(varint(&[0xff; 3], &mut 0), None);
    }

    #[test]
    fn rows_and_columns() {
        // Header of five bytes: null, one byte, the number 1, a text of two.
        let content = [5, 0, 1, 9, 17, 0xfe, b'o', b'k'];
        let expected = [
            Value::Null,
            Value::Integer(-2),
            Value::Integer(1),
            Value::Bytes(b"ok"),
        ];
        assert_eq!(values(&content).unwrap(), expected);
        assert_eq!(values(&content[..7]), None);
        let sql = "CREATE TABLE messages(id INTEGER PRIMARY KEY, \"topic_id\" INTEGER NOT NULL,data BLOB)";
        assert_eq!(columns(sql), ["id", "topic_id", "data"]);
    }
}
