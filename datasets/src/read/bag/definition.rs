//! Message types from the text of their definitions (.msg files of ROS 2).

use super::source::{Definition, short};
use std::collections::HashMap;

/// Depth to which types nest, at most.
const DEEPEST: usize = 32;
/// Largest number of fields of a type with all that it nests.
const MOST: usize = 20_000;
/// Largest number of elements of a fixed array.
const LONGEST: usize = 1 << 24;

/// Definition of the joint-state message, which a bag of an earlier ROS leaves out.
const JOINT_STATE: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
    ================================================================================\nMSG: std_msgs/Header\n\
    builtin_interfaces/Time stamp\nstring frame_id\n\
    ================================================================================\nMSG: builtin_interfaces/Time\n\
    int32 sec\nuint32 nanosec\n";
/// The type whose definition is known.
pub(super) const JOINT_STATE_TYPE: &str = "sensor_msgs/JointState";

/// Storage type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl Number {
    /// Size of a number of this type, bytes.
    pub fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "bool" | "byte" | "char" | "uint8" => Self::U8,
            "int8" => Self::I8,
            "uint16" => Self::U16,
            "int16" => Self::I16,
            "uint32" => Self::U32,
            "int32" => Self::I32,
            "uint64" => Self::U64,
            "int64" => Self::I64,
            "float32" => Self::F32,
            "float64" => Self::F64,
            _ => return None,
        })
    }
}

/// Number of values of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arity {
    One,
    Fixed(usize),
    Sequence,
}

/// Content of a message's field: number, text or nested fields.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Content {
    Number(Number),
    Text,
    /// Text of wide characters, whose width is a matter of the writer.
    Wide,
    Group(Vec<Field>),
}

/// Field of a message type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field {
    pub name: String,
    pub arity: Arity,
    pub content: Content,
    /// Slot that its values go to, if they are wanted.
    pub slot: Option<usize>,
}

/// The fields of a type.
///
/// # Errors
/// Why its messages cannot be read, as the end of a sentence.
pub(super) fn fields(kind: &str, definition: &Definition) -> Result<Vec<Field>, String> {
    match definition {
        Definition::Ros2(text) => parse(text),
        _ if kind == JOINT_STATE_TYPE => parse(JOINT_STATE),
        Definition::Other(language) => Err(format!(
            "its definition is written in `{language}`, not as a .msg file"
        )),
        Definition::Missing => Err("the bag does not hold its definition".to_owned()),
    }
}

fn parse(text: &str) -> Result<Vec<Field>, String> {
    let mut types: HashMap<String, &str> = HashMap::new();
    let mut root = None;
    for block in blocks(text) {
        let first = block.trim_start();
        match first.strip_prefix("MSG:") {
            Some(rest) => {
                let (name, body) = rest.split_once('\n').unwrap_or((rest, ""));
                types.insert(short(name.trim()), body);
                root = root.or(Some(body));
            }
            None => root = root.or(Some(block)),
        }
    }
    let mut budget = MOST;
    group(root.unwrap_or_default(), "", &types, 0, &mut budget)
}

/// Definitions between lines of equals signs.
fn blocks(text: &str) -> Vec<&str> {
    let mut blocks = Vec::new();
    let mut start = 0;
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let bar = line.trim_end();
        if bar.len() >= 40 && bar.bytes().all(|b| b == b'=') {
            blocks.push(&text[start..at]);
            start = at + line.len();
        }
        at += line.len();
    }
    blocks.push(&text[start..]);
    blocks
}

fn group(
    text: &str,
    package: &str,
    types: &HashMap<String, &str>,
    depth: usize,
    budget: &mut usize,
) -> Result<Vec<Field>, String> {
    if depth > DEEPEST {
        return Err("its definition nests without end".to_owned());
    }
    let mut fields = Vec::new();
    for line in text.lines() {
        let Some((kind, name)) = declared(line) else {
            continue;
        };
        *budget = budget
            .checked_sub(1)
            .ok_or_else(|| "its definition has too many fields".to_owned())?;
        let (base, arity) = split_array(kind).ok_or_else(|| format!("`{kind}` is no type"))?;
        let content = match Number::named(base) {
            Some(number) => Content::Number(number),
            None if base == "string" || base.starts_with("string<=") => Content::Text,
            None if base == "wstring" || base.starts_with("wstring<=") => Content::Wide,
            None => {
                let (full, body) = nested(base, package, types)
                    .ok_or_else(|| format!("the definition of `{base}` is missing"))?;
                let package = full.split('/').next().unwrap_or_default();
                Content::Group(group(body, package, types, depth + 1, budget)?)
            }
        };
        fields.push(Field {
            name: name.to_owned(),
            arity,
            content,
            slot: None,
        });
    }
    Ok(fields)
}

/// Type and name of a field; nothing for comments and constants.
fn declared(line: &str) -> Option<(&str, &str)> {
    let line = line.split('#').next().unwrap_or_default();
    let mut words = line.split_whitespace();
    let (kind, name) = (words.next()?, words.next()?);
    let constant = name.contains('=') || words.next().is_some_and(|w| w.starts_with('='));
    (!constant).then_some((kind, name))
}

/// `float64[7]` as `float64` and seven.
fn split_array(kind: &str) -> Option<(&str, Arity)> {
    let Some((base, rest)) = kind.split_once('[') else {
        return Some((kind, Arity::One));
    };
    let arity = match rest.strip_suffix(']')? {
        "" => Arity::Sequence,
        bound if bound.starts_with("<=") => Arity::Sequence,
        count => Arity::Fixed(count.parse().ok().filter(|&n| n <= LONGEST)?),
    };
    Some((base, arity))
}

/// The full name and the text of a type that is named in a definition of `package`.
fn nested<'a>(
    name: &str,
    package: &str,
    types: &HashMap<String, &'a str>,
) -> Option<(String, &'a str)> {
    let name = short(name);
    let candidates = [name.clone(), format!("{package}/{name}")];
    let known = candidates
        .into_iter()
        .find_map(|n| types.get(&n).map(|t| (n.clone(), *t)));
    // The root's own package is not said: a short name there is the one type that ends so.
    known.or_else(|| {
        let ending = format!("/{name}");
        let mut alike = types.iter().filter(|(n, _)| n.ends_with(&ending));
        let found = alike.next().map(|(n, t)| (n.clone(), *t));
        found.filter(|_| alike.next().is_none())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ros2(text: &str) -> Result<Vec<Field>, String> {
        fields("a/B", &Definition::Ros2(text.to_owned()))
    }

    #[test]
    fn every_kind_of_line() {
        let text = "# comment\nuint8 MODE=3\nstring KEY = \"a\"\nstring<=8[<=3] tags # of it\nfloat32[7] q\nint32 n 5\nPart[] parts\n\
            ================================================================================\nMSG: a/Part\nbool on\nc/msg/D d\n\
            ================================================================================\nMSG: c/D\nwstring w\n";
        let fields = ros2(text).unwrap();
        let names: Vec<&str> = fields.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["tags", "q", "n", "parts"]);
        assert_eq!(
            (fields[0].arity, &fields[0].content),
            (Arity::Sequence, &Content::Text)
        );
        assert_eq!(fields[1].arity, Arity::Fixed(7));
        assert_eq!(fields[2].content, Content::Number(Number::I32));
        let Content::Group(part) = &fields[3].content else {
            panic!("a nested type");
        };
        assert_eq!(part[0].content, Content::Number(Number::U8));
        assert!(
            matches!(&part[1].content, Content::Group(d) if d.len() == 1 && d[0].content == Content::Wide)
        );
    }

    #[test]
    fn what_is_no_definition_is_refused() {
        for (text, why) in [
            ("Thing x", "the definition of `Thing` is missing"),
            ("float64[x] q", "is no type"),
            ("float64[99999999999] q", "is no type"),
        ] {
            assert!(ros2(text).unwrap_err().contains(why), "{text}");
        }
        let bar = "=".repeat(80);
        let endless = format!("A a\n{bar}\nMSG: p/A\nA a\n");
        assert!(ros2(&endless).unwrap_err().contains("without end"));
        // Eight of eight of eight …: more fields than anybody writes.
        let mut wide = "T0 a\n".to_owned();
        for level in 0..8 {
            wide += &format!("{bar}\nMSG: p/T{level}\n");
            for field in 0..8 {
                wide += &format!("T{} f{field}\n", level + 1);
            }
        }
        wide += &format!("{bar}\nMSG: p/T8\nint8 x\n");
        assert!(ros2(&wide).unwrap_err().contains("too many fields"));
        assert!(fields("a/B", &Definition::Missing).is_err());
        assert!(fields("a/B", &Definition::Other("ros2idl".into())).is_err());
        assert_eq!(
            fields(JOINT_STATE_TYPE, &Definition::Missing)
                .unwrap()
                .len(),
            5
        );
    }
}
