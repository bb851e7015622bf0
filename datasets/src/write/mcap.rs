//! MCAP files with one channel: its messages, and at the end the summary in which plotters look for channels.

use crate::mcap::{MAGIC, op};

/// Channel of a file: where its messages belong and how they are written.
pub(super) struct Channel<'a> {
    /// Conventions that the file follows; empty for none.
    pub profile: &'a str,
    /// Name of the messages' type.
    pub kind: &'a str,
    /// Language of the type's definition.
    pub language: &'a str,
    /// Definition of the type.
    pub definition: &'a str,
    /// Topic of the messages.
    pub topic: &'a str,
    /// Encoding of the messages.
    pub encoding: &'a str,
}

/// A file that is being put together.
pub(super) struct Mcap {
    /// Bytes of the file so far.
    file: Vec<u8>,
    /// Records of the type and the channel, which the summary repeats.
    described: Vec<u8>,
    /// Number of messages.
    messages: u64,
    /// Earliest and latest time of a message, ns.
    first: u64,
    last: u64,
}

impl Mcap {
    /// A file without messages.
    pub fn new(channel: &Channel) -> Self {
        let mut described = Vec::new();
        let kind = [channel.kind, channel.language, channel.definition].map(text);
        let topic = [channel.topic, channel.encoding].map(text);
        record(&mut described, op::SCHEMA, &[&one(), &kind.concat()]);
        let no_metadata = 0_u32.to_le_bytes();
        let parts: [&[u8]; 4] = [&one(), &one(), &topic.concat(), &no_metadata];
        record(&mut described, op::CHANNEL, &parts);
        let mut file = MAGIC.to_vec();
        record(
            &mut file,
            op::HEADER,
            &[&text(channel.profile), &text("residyn")],
        );
        file.extend(&described);
        Self {
            file,
            described,
            messages: 0,
            first: u64::MAX,
            last: 0,
        }
    }

    /// Adds a message, logged and published at `time`, ns.
    pub fn message(&mut self, time: u64, data: &[u8]) {
        let sequence = (self.messages as u32).to_le_bytes();
        let times = [time.to_le_bytes(); 2].concat();
        record(
            &mut self.file,
            op::MESSAGE,
            &[&one(), &sequence, &times, data],
        );
        self.messages += 1;
        self.first = self.first.min(time);
        self.last = self.last.max(time);
    }

    /// The whole file, without checksums.
    pub fn finish(mut self) -> Vec<u8> {
        record(&mut self.file, op::DATA_END, &[&[0; 4]]);
        let summary = (self.file.len() as u64).to_le_bytes();
        self.file.extend(&self.described);
        let count = self.messages.to_le_bytes();
        // One schema and one channel; no attachments, metadata or chunks.
        let counts = [1_u32, 0, 0, 0].map(u32::to_le_bytes).concat();
        let times = [self.first.min(self.last), self.last]
            .map(u64::to_le_bytes)
            .concat();
        let per_channel = [&10_u32.to_le_bytes()[..], &one(), &count].concat();
        let parts: [&[u8]; 5] = [&count, &one(), &counts, &times, &per_channel];
        record(&mut self.file, op::STATISTICS, &parts);
        record(&mut self.file, op::FOOTER, &[&summary, &[0; 12]]);
        self.file.extend(MAGIC);
        self.file
    }
}

/// Number of the only schema and of the only channel.
fn one() -> [u8; 2] {
    1_u16.to_le_bytes()
}

fn record(file: &mut Vec<u8>, opcode: u8, parts: &[&[u8]]) {
    let body = parts.concat();
    file.push(opcode);
    file.extend((body.len() as u64).to_le_bytes());
    file.extend(body);
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}
