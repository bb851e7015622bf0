//! Events that every container of messages gives, whatever its format.

use crate::Problem;

/// A stream of messages of one type.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    /// Number by which messages refer to it, within one file.
    pub id: u64,
    /// Name of the topic of the messages.
    pub topic: String,
    /// Type of the messages as `package/Name`.
    pub kind: String,
    /// Encoding of the messages; ROS 2 writes `cdr`.
    pub encoding: String,
    /// Definition of the type, as the container has it.
    pub definition: Definition,
}

/// Definition of a message type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Definition {
    /// Text in the format of .msg files, nested types behind it.
    Ros2(String),
    /// A definition in another language, by the language's name.
    Other(String),
    /// No definition in the container.
    Missing,
}

/// Receiver of a container's content, in the order of the file.
pub(super) trait Sink {
    /// Begin of another file, in which numbers of channels start anew.
    fn file(&mut self);

    /// A channel, before its first message; containers may repeat it.
    fn channel(&mut self, channel: Channel) -> Result<(), Problem>;

    /// A message, with the time at which it was logged, ns.
    fn message(&mut self, channel: u64, logged: i64, data: &[u8]) -> Result<(), Problem>;
}

/// `package/msg/Name` as `package/Name`.
pub(super) fn short(kind: &str) -> String {
    kind.replacen("/msg/", "/", 1)
}

/// Names in one line, shortened.
pub(super) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    const SHOWN: usize = 30;
    let names: Vec<&str> = names.into_iter().collect();
    match names.len() {
        0 => "none".to_owned(),
        all if all > SHOWN => format!("{}, and {} more", names[..SHOWN].join(", "), all - SHOWN),
        _ => names.join(", "),
    }
}
