//! Values of a message: common data representation (CDR, DDS-XTypes 1.3, 7.4; plain, as ROS 2 writes it).

use super::definition::{Arity, Content, Field, Number};

/// Reasons why a message cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Unreadable {
    /// The message is shorter than its type needs.
    Short,
    /// Encapsulation other than plain CDR, by its identifier.
    Encapsulation(u16),
    /// Field of wide characters that stands before a needed one.
    Wide,
}

impl std::fmt::Display for Unreadable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Short => f.write_str("is shorter than its type needs"),
            Self::Encapsulation(id) => write!(
                f,
                "has the encapsulation 0x{id:04x}, where plain CDR (0x0000, 0x0001) is read"
            ),
            Self::Wide => f.write_str("has a field of type wstring, which cannot be read"),
        }
    }
}

/// Texts of an array, in one allocation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Texts {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Texts {
    /// Iterates over the texts, damaged characters replaced.
    pub fn iter(&self) -> impl Iterator<Item = std::borrow::Cow<'_, str>> {
        (0..self.ends.len()).map(|i| {
            let start = if i == 0 { 0 } else { self.ends[i - 1] };
            String::from_utf8_lossy(&self.bytes[start..self.ends[i]])
        })
    }

    fn clear(&mut self) {
        self.bytes.clear();
        self.ends.clear();
    }

    fn push(&mut self, text: &[u8]) {
        self.bytes.extend_from_slice(text);
        self.ends.push(self.bytes.len());
    }
}

/// Values of the wanted fields of one message, by slot; reused from message to message.
#[derive(Clone, Debug, Default)]
pub(super) struct Values {
    pub numbers: Vec<Vec<f64>>,
    pub texts: Vec<Texts>,
}

impl Values {
    /// Room for fields with the slots up to these.
    pub fn new(numbers: usize, texts: usize) -> Self {
        Self {
            numbers: vec![Vec::new(); numbers],
            texts: vec![Texts::default(); texts],
        }
    }

    /// Reads the fields of a message that have a slot.
    ///
    /// # Errors
    /// Bytes that are not a message of this type.
    pub fn read(&mut self, fields: &[Field], message: &[u8]) -> Result<(), Unreadable> {
        self.numbers.iter_mut().for_each(Vec::clear);
        self.texts.iter_mut().for_each(Texts::clear);
        self.group(fields, &mut Cursor::of(message)?)
    }

    fn group(&mut self, fields: &[Field], cursor: &mut Cursor<'_>) -> Result<(), Unreadable> {
        if fields.is_empty() {
            // A type without fields takes a byte.
            return cursor.take(1).map(|_| ());
        }
        fields.iter().try_for_each(|f| self.field(f, cursor))
    }

    fn field(&mut self, field: &Field, cursor: &mut Cursor<'_>) -> Result<(), Unreadable> {
        let count = match field.arity {
            Arity::One => 1,
            Arity::Fixed(count) => count,
            Arity::Sequence => cursor.count()?,
        };
        if count == 0 {
            return Ok(());
        }
        match &field.content {
            Content::Number(kind) => {
                let bytes = cursor.numbers(*kind, count)?;
                if let Some(slot) = field.slot {
                    decode(bytes, *kind, cursor.little, &mut self.numbers[slot]);
                }
            }
            Content::Text => {
                for _ in 0..count {
                    let text = cursor.text()?;
                    if let Some(slot) = field.slot {
                        self.texts[slot].push(text);
                    }
                }
            }
            Content::Wide => return Err(Unreadable::Wide),
            Content::Group(fields) => {
                // Each takes at least a byte.
                if count > cursor.data.len() {
                    return Err(Unreadable::Short);
                }
                for _ in 0..count {
                    self.group(fields, cursor)?;
                }
            }
        }
        Ok(())
    }
}

/// A place in the data behind the encapsulation.
pub(super) struct Cursor<'a> {
    data: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> Cursor<'a> {
    /// The start of a message's data.
    pub fn of(message: &'a [u8]) -> Result<Self, Unreadable> {
        let (head, data) = message.split_first_chunk::<4>().ok_or(Unreadable::Short)?;
        let little = match [head[0], head[1]] {
            [0, 0] => false,
            [0, 1] => true,
            other => return Err(Unreadable::Encapsulation(u16::from_be_bytes(other))),
        };
        Ok(Self {
            data,
            at: 0,
            little,
        })
    }

    /// The next `count` numbers.
    pub fn values(&mut self, kind: Number, count: usize) -> Result<Vec<f64>, Unreadable> {
        if count == 0 {
            return Ok(Vec::new());
        }
        let mut values = Vec::new();
        decode(self.numbers(kind, count)?, kind, self.little, &mut values);
        Ok(values)
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], Unreadable> {
        let end = self.at.checked_add(count).ok_or(Unreadable::Short)?;
        let taken = self.data.get(self.at..end).ok_or(Unreadable::Short)?;
        self.at = end;
        Ok(taken)
    }

    fn numbers(&mut self, kind: Number, count: usize) -> Result<&'a [u8], Unreadable> {
        self.at = self.at.next_multiple_of(kind.size());
        let length = count.checked_mul(kind.size()).ok_or(Unreadable::Short)?;
        self.take(length)
    }

    /// Number of elements that follow.
    pub fn count(&mut self) -> Result<usize, Unreadable> {
        let bytes = self.numbers(Number::U32, 1)?;
        let bytes = <[u8; 4]>::try_from(bytes).map_err(|_| Unreadable::Short)?;
        Ok(if self.little {
            u32::from_le_bytes(bytes)
        } else {
            u32::from_be_bytes(bytes)
        } as usize)
    }

    /// The next text, without its closing zero.
    pub fn text(&mut self) -> Result<&'a [u8], Unreadable> {
        let count = self.count()?;
        let text = self.take(count)?;
        Ok(text.strip_suffix(b"\0").unwrap_or(text))
    }
}

/// Appends numbers of a kind.
fn decode(bytes: &[u8], kind: Number, little: bool, into: &mut Vec<f64>) {
    macro_rules! each {
        ($kind:ty, $convert:expr) => {{
            let (all, _) = bytes.as_chunks::<{ size_of::<$kind>() }>();
            let one = |b: &[u8; size_of::<$kind>()]| {
                if little {
                    <$kind>::from_le_bytes(*b)
                } else {
                    <$kind>::from_be_bytes(*b)
                }
            };
            into.extend(all.iter().map(|b| $convert(one(b))));
        }};
    }
    match kind {
        Number::U8 => each!(u8, f64::from),
        Number::I8 => each!(i8, f64::from),
        Number::U16 => each!(u16, f64::from),
        Number::I16 => each!(i16, f64::from),
        Number::U32 => each!(u32, f64::from),
        Number::I32 => each!(i32, f64::from),
        Number::U64 => each!(u64, |v| v as f64),
        Number::I64 => each!(i64, |v| v as f64),
        Number::F32 => each!(f32, f64::from),
        Number::F64 => each!(f64, |v| v),
    }
}
