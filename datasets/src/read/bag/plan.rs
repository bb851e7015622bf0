//! Decoding plan of a channel: the values taken out of each message.

use super::definition::{Arity, Content, Field};
use super::message::Values;
use super::source::list;
use super::wanted::{Want, Wanted};
use crate::Problem;
use crate::columns::Group;

/// Slots that hold the header stamp.
#[derive(Clone, Copy, Debug)]
enum Stamp {
    /// Slots of seconds and nanoseconds.
    Parts(usize, usize),
    /// One number, with the nanoseconds of its unit.
    Number(usize, f64),
}

/// Reads the messages of one channel.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    fields: Vec<Field>,
    pub values: Values,
    /// Slot of the joints' names.
    pub names: Option<usize>,
    stamp: Option<Stamp>,
    /// Slot of each column; none where the messages lack a field that is not needed.
    pub slots: Vec<Option<usize>>,
}

impl Plan {
    /// Plan for `columns` of a topic with these fields.
    ///
    /// # Errors
    /// A field that is needed and missing, or holds no numbers.
    pub fn new(mut fields: Vec<Field>, columns: &[Want], wanted: &Wanted) -> Result<Self, Problem> {
        let mut slots = Slots::default();
        let mut of_columns = Vec::with_capacity(columns.len());
        for want in columns {
            let slot = slots.number(&mut fields, &want.field);
            if slot.is_none() && want.needed {
                return Err(missing(&want.field, &fields));
            }
            of_columns.push(slot);
        }
        let names = match &wanted.names {
            Some(path) => Some(
                slots
                    .text(&mut fields, path)
                    .ok_or_else(|| missing(path, &fields))?,
            ),
            None => ["name", "names", "joint_names"]
                .iter()
                .find_map(|path| slots.text(&mut fields, path)),
        };
        let own = wanted
            .time
            .as_ref()
            .and_then(|path| stamp(&mut slots, &mut fields, path, wanted.time_scale));
        // Topics beside that of the positions may well stamp their messages otherwise.
        if let (Some(path), None, true) = (
            &wanted.time,
            own,
            columns.iter().any(|c| c.group == Group::Q),
        ) {
            return Err(missing(path, &fields));
        }
        let stamp = own.or_else(|| {
            let usual = ["header.stamp", "stamp"];
            usual
                .iter()
                .find_map(|path| stamp(&mut slots, &mut fields, path, 1.0))
        });
        Ok(Self {
            fields,
            values: Values::new(slots.numbers, slots.texts),
            names,
            stamp,
            slots: of_columns,
        })
    }

    /// Reads a message into `values`.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn read(&mut self, message: &[u8]) -> Result<(), String> {
        self.values
            .read(&self.fields, message)
            .map_err(|e| e.to_string())
    }

    /// Stamp of the message that was read last, ns; zero where messages have no stamp.
    pub fn stamp(&self) -> i64 {
        let first = |slot: usize| self.values.numbers[slot].first().copied().unwrap_or(0.0);
        match self.stamp {
            None => 0,
            Some(Stamp::Parts(seconds, rest)) => (first(seconds) as i64)
                .saturating_mul(1_000_000_000)
                .saturating_add(first(rest) as i64),
            Some(Stamp::Number(slot, unit)) => (first(slot) * unit).round() as i64,
        }
    }
}

fn stamp(slots: &mut Slots, fields: &mut [Field], path: &str, scale: f64) -> Option<Stamp> {
    let seconds = slots.number(fields, &format!("{path}.sec"));
    match seconds {
        Some(seconds) => {
            let rest = slots.number(fields, &format!("{path}.nanosec"))?;
            Some(Stamp::Parts(seconds, rest))
        }
        None => Some(Stamp::Number(slots.number(fields, path)?, scale * 1e9)),
    }
}

fn missing(path: &str, fields: &[Field]) -> Problem {
    let mut paths = Vec::new();
    describe(fields, "", &mut paths);
    Problem::MissingField {
        missing: path.to_owned(),
        present: list(paths.iter().map(String::as_str)),
    }
}

/// The fields that hold numbers or texts, each with its path, arrays with brackets.
pub(super) fn describe(fields: &[Field], before: &str, into: &mut Vec<String>) {
    for field in fields {
        let array = match field.arity {
            Arity::One => String::new(),
            Arity::Fixed(count) => format!("[{count}]"),
            Arity::Sequence => "[]".to_owned(),
        };
        let path = format!("{before}{}{array}", field.name);
        match &field.content {
            Content::Group(inner) => describe(inner, &format!("{path}."), into),
            _ => into.push(path),
        }
    }
}

/// Number of slots that are given so far, by kind of value.
#[derive(Default)]
struct Slots {
    numbers: usize,
    texts: usize,
}

impl Slots {
    fn number(&mut self, fields: &mut [Field], path: &str) -> Option<usize> {
        let field = find(fields, path)?;
        matches!(field.content, Content::Number(_)).then(|| given(field, &mut self.numbers))
    }

    fn text(&mut self, fields: &mut [Field], path: &str) -> Option<usize> {
        let field = find(fields, path)?;
        let texts =
            field.content == Content::Text && (field.arity != Arity::One || path.contains('.'));
        texts.then(|| given(field, &mut self.texts))
    }
}

fn given(field: &mut Field, next: &mut usize) -> usize {
    *field.slot.get_or_insert_with(|| {
        *next += 1;
        *next - 1
    })
}

/// Field at a path; brackets of arrays on the way may be left out.
fn find<'a>(fields: &'a mut [Field], path: &str) -> Option<&'a mut Field> {
    let (name, rest) = match path.split_once('.') {
        Some((name, rest)) => (name, Some(rest)),
        None => (path, None),
    };
    let field = fields
        .iter_mut()
        .find(|f| f.name == name.split('[').next().unwrap_or_default())?;
    let Some(rest) = rest else {
        return Some(field);
    };
    match &mut field.content {
        Content::Group(inner) => find(inner, rest),
        _ => None,
    }
}
