//! The messages of an SQLite file of rosbag2.

use super::source::{Channel, Definition, Sink, short};
use super::sqlite::Database;
use crate::Problem;
use std::collections::HashMap;
use std::io::{Read, Seek};

/// Reads a whole file: its topics, then its messages in the order in which they were written.
///
/// # Errors
/// A file that is cut or damaged or no bag, or what `sink` refuses.
pub(super) fn read(input: impl Read + Seek, sink: &mut dyn Sink) -> Result<(), Problem> {
    let mut database = Database::open(input)?;
    let mut definitions = HashMap::new();
    // Bags before ROS 2 Iron have no definitions.
    let columns = ["topic_type", "encoding", "encoded_message_definition"];
    database.rows("message_definitions", &columns, &mut |(_, row)| {
        if let [Some(kind), Some(encoding), Some(text)] = [0, 1, 2].map(|i| row[i].text()) {
            let definition = match encoding.as_str() {
                _ if text.is_empty() => Definition::Missing,
                "ros2msg" => Definition::Ros2(text),
                _ => Definition::Other(encoding),
            };
            definitions.insert(short(&kind), definition);
        }
        Ok(())
    })?;
    let columns = ["name", "type", "serialization_format"];
    let topics = database.rows("topics", &columns, &mut |(id, row)| {
        let kind = short(&row[1].text().unwrap_or_default());
        sink.channel(Channel {
            id: id as u64,
            topic: row[0].text().unwrap_or_default(),
            encoding: row[2].text().unwrap_or_default(),
            definition: definitions
                .get(&kind)
                .cloned()
                .unwrap_or(Definition::Missing),
            kind,
        })
    })?;
    let columns = ["topic_id", "timestamp", "data"];
    let messages = database.rows("messages", &columns, &mut |(_, row)| {
        let [topic, logged] = [0, 1].map(|i| row[i].integer().unwrap_or_default());
        match row[2] {
            super::sqlite::Value::Bytes(data) => sink.message(topic as u64, logged, data),
            _ => Ok(()),
        }
    })?;
    if !(topics && messages) {
        return Err(Problem::NoBagTables);
    }
    Ok(())
}
