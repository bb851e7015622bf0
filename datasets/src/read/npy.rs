//! One NumPy array (format versions 1 to 3 of `numpy.lib.format`).

/// Values in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Values {
    Reals(Vec<f64>),
    Integers(Vec<i64>),
    Text(Vec<String>),
}

/// An array of numbers or text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Array {
    pub shape: Vec<usize>,
    pub values: Values,
    fortran_order: bool,
}

/// Reasons why an array cannot be read.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(crate) enum NpyError {
    #[error("not a NumPy array")]
    Magic,
    #[error("the array's header is damaged")]
    Header,
    #[error("the type {0} is neither number nor text")]
    Type(String),
    #[error("the array is cut off: {0} bytes of {1}")]
    Length(usize, usize),
}

impl Array {
    /// Position of a cell of a one- or two-dimensional array among the values.
    pub fn index(&self, row: usize, column: usize) -> usize {
        let columns = self.shape.get(1).copied().unwrap_or(1);
        if self.fortran_order {
            column * self.shape[0] + row
        } else {
            row * columns + column
        }
    }

    /// Parses the bytes of a .npy file.
    pub fn parse(bytes: &[u8]) -> Result<Self, NpyError> {
        let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or(NpyError::Magic)?;
        let (&[major, _minor], rest) = rest.split_first_chunk::<2>().ok_or(NpyError::Header)?;
        let (length, rest) = if major == 1 {
            let (l, rest) = rest.split_first_chunk::<2>().ok_or(NpyError::Header)?;
            (usize::from(u16::from_le_bytes(*l)), rest)
        } else {
            let (l, rest) = rest.split_first_chunk::<4>().ok_or(NpyError::Header)?;
            (u32::from_le_bytes(*l) as usize, rest)
        };
        let (header, data) = rest.split_at_checked(length).ok_or(NpyError::Header)?;
        let header = std::str::from_utf8(header).map_err(|_| NpyError::Header)?;
        let descr = entry(header, "descr").ok_or(NpyError::Header)?;
        let fortran_order = entry(header, "fortran_order").is_some_and(|v| v.starts_with("True"));
        let shape = shape(entry(header, "shape").ok_or(NpyError::Header)?)?;
        let count = shape
            .iter()
            .try_fold(1_usize, |n, &d| n.checked_mul(d))
            .ok_or(NpyError::Header)?;
        let values = values(descr, count, data)?;
        Ok(Self {
            shape,
            values,
            fortran_order,
        })
    }
}

/// Text behind `'key':` in the header's dictionary.
fn entry<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let quoted = format!("'{key}'");
    let (_, rest) = header.split_once(&quoted)?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

fn shape(text: &str) -> Result<Vec<usize>, NpyError> {
    let inner = text
        .strip_prefix('(')
        .and_then(|t| t.split_once(')'))
        .ok_or(NpyError::Header)?
        .0;
    inner
        .split(',')
        .map(str::trim)
        .filter(|d| !d.is_empty())
        .map(|d| d.parse().map_err(|_| NpyError::Header))
        .collect()
}

fn values(descr: &str, count: usize, data: &[u8]) -> Result<Values, NpyError> {
    let other = || NpyError::Type(descr.chars().take_while(|c| *c != ',').take(20).collect());
    // A record type begins with a list.
    let name = descr
        .strip_prefix('\'')
        .and_then(|d| d.split_once('\''))
        .ok_or_else(other)?
        .0;
    let mut letters = name.chars();
    let (order, kind) = (
        letters.next().ok_or_else(other)?,
        letters.next().ok_or_else(other)?,
    );
    let size: usize = letters.as_str().parse().map_err(|_| other())?;
    let bytes_each = if kind == 'U' {
        size.checked_mul(4)
    } else {
        Some(size)
    };
    let total = bytes_each
        .and_then(|b| b.checked_mul(count))
        .ok_or(NpyError::Header)?;
    let data = data
        .get(..total)
        .ok_or(NpyError::Length(data.len(), total))?;
    let big = order == '>';
    Ok(match (kind, size) {
        ('f', 8) => Values::Reals(cells(data, big, f64::from_le_bytes)),
        ('f', 4) => Values::Reals(cells(data, big, |b| f64::from(f32::from_le_bytes(b)))),
        ('i', 8) => Values::Integers(cells(data, big, i64::from_le_bytes)),
        ('i', 4) => Values::Integers(cells(data, big, |b| i64::from(i32::from_le_bytes(b)))),
        ('i', 2) => Values::Integers(cells(data, big, |b| i64::from(i16::from_le_bytes(b)))),
        ('i', 1) => Values::Integers(cells(data, big, |b| i64::from(i8::from_le_bytes(b)))),
        ('u', 8) => Values::Reals(cells(data, big, |b| u64::from_le_bytes(b) as f64)),
        ('u', 4) => Values::Integers(cells(data, big, |b| i64::from(u32::from_le_bytes(b)))),
        ('u', 2) => Values::Integers(cells(data, big, |b| i64::from(u16::from_le_bytes(b)))),
        ('u' | 'b', 1) => Values::Integers(cells(data, big, |[b]: [u8; 1]| i64::from(b))),
        ('S', 1..) => Values::Text(data.chunks_exact(size).map(bytes_text).collect()),
        ('U', 1..) => Values::Text(
            data.chunks_exact(4 * size)
                .map(|c| wide_text(c, big))
                .collect(),
        ),
        // NumPy stores arrays of empty strings with size 0.
        ('S' | 'U', 0) if count > 0 => return Err(other()),
        _ => return Err(other()),
    })
}

fn cells<const N: usize, T>(data: &[u8], big: bool, convert: impl Fn([u8; N]) -> T) -> Vec<T> {
    data.chunks_exact(N)
        .map(|chunk| {
            let mut b = [0; N];
            b.copy_from_slice(chunk);
            if big {
                b.reverse();
            }
            convert(b)
        })
        .collect()
}

fn bytes_text(cell: &[u8]) -> String {
    let end = cell.iter().rposition(|&b| b != 0).map_or(0, |i| i + 1);
    String::from_utf8_lossy(&cell[..end]).into_owned()
}

fn wide_text(cell: &[u8], big: bool) -> String {
    let letters = cells(cell, big, u32::from_le_bytes);
    let end = letters.iter().rposition(|&c| c != 0).map_or(0, |i| i + 1);
    letters[..end]
        .iter()
        .map(|&c| char::from_u32(c).unwrap_or('\u{fffd}'))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn numbers_and_text_of_both_byte_orders() {
        let array = Array::parse(&npy(
            "<f8",
            "(2,)",
            &[1.5_f64.to_le_bytes(), 2.0_f64.to_le_bytes()].concat(),
        ));
        assert_eq!(array.unwrap().values, Values::Reals(vec![1.5, 2.0]));
        let array = Array::parse(&npy(">i4", "(1,)", &[0, 0, 1, 2]));
        assert_eq!(array.unwrap().values, Values::Integers(vec![258]));
        let array = Array::parse(&npy("<U2", "(2,)", b"a\0\0\0b\0\0\0c\0\0\0\0\0\0\0"));
        assert_eq!(
            array.unwrap().values,
            Values::Text(vec!["ab".into(), "c".into()])
        );
    }

    #[test]
    fn a_cut_or_lying_array_is_refused() {
        assert_eq!(
            Array::parse(&npy("<f8", "(2,)", &[0; 15])),
            Err(NpyError::Length(15, 16))
        );
        let huge = format!("({}, {})", usize::MAX, 2);
        assert_eq!(Array::parse(&npy("<f8", &huge, &[])), Err(NpyError::Header));
        assert!(matches!(
            Array::parse(&npy("|O", "(2,)", &[])),
            Err(NpyError::Type(_))
        ));
        assert_eq!(Array::parse(b"nothing"), Err(NpyError::Magic));
    }
}
