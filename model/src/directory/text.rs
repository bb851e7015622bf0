//! Text form of the files of a model directory.

use serde::Serialize;

/// Pretty JSON with a line break at the end.
pub fn json<T: Serialize>(value: &T) -> String {
    // Types here hold no map with keys other than strings and no failing serialiser.
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}
