//! MCAP, version 0 (<https://mcap.dev/spec>): read from start to end, a record or a chunk at a time.
//!
//! The crate `mcap` does the same, but brings an LZ4 and a Zstandard of its own beside those that Parquet needs, makes room for
//! whatever length a damaged record claims, and does not say where in the file it stands.

use super::bytes::Bytes;
use super::source::{Channel, Definition, Sink, short};
use crate::Problem;
use crate::mcap::{MAGIC, op};
use crc32fast::Hasher;
use std::collections::HashMap;
use std::io::{Read, Take};

/// Length of a record's head, bytes: opcode and length.
const HEAD: usize = 9;
/// Largest chunk once unpacked, bytes: guards against one that claims to be huge.
const LARGEST: u64 = 1 << 30;
/// Number of bytes skipped at a time.
const PIECE: u64 = 1 << 20;

/// Reads a whole file.
///
/// # Errors
/// A file that is cut or damaged, a chunk of an unknown compression, or what `sink` refuses.
pub(super) fn read(input: impl Read, sink: &mut dyn Sink) -> Result<(), Problem> {
    let mut file = File {
        input,
        at: 0,
        checksum: Some(Hasher::new()),
    };
    let mut content = Content {
        schemas: HashMap::new(),
        sink,
    };
    let mut record = Vec::new();
    let mut unpacked = Vec::new();
    file.exactly(MAGIC.len() as u64, &mut record)?;
    if record != MAGIC {
        return Err(damaged("it does not start as MCAP files do"));
    }
    file.hash(&record);
    loop {
        let begin = file.at;
        file.exactly(HEAD as u64, &mut record)?;
        let (opcode, length) = head(&record);
        if opcode != op::DATA_END {
            file.hash(&record);
        }
        match opcode {
            op::SCHEMA | op::CHANNEL | op::MESSAGE => {
                file.exactly(length, &mut record)?;
                file.hash(&record);
                content.record(opcode, &record, begin)?;
            }
            op::CHUNK => {
                file.exactly(length, &mut record)?;
                file.hash(&record);
                let records = unpack(&record, &mut unpacked, begin)?;
                content.records(records, begin)?;
            }
            op::DATA_END => {
                file.exactly(length, &mut record)?;
                file.data_end(&record)?;
            }
            op::FOOTER => {
                file.skip(length, &mut record)?;
                return file.end(&mut record);
            }
            0 => return Err(damaged(format!("there is no record at byte {begin}"))),
            _ => file.skip(length, &mut record)?,
        }
    }
}

fn head(bytes: &[u8]) -> (u8, u64) {
    let mut bytes = Bytes(bytes);
    let opcode = bytes.u8().unwrap_or_default();
    (opcode, bytes.u64().unwrap_or_default())
}

fn damaged(detail: impl Into<String>) -> Problem {
    Problem::Damaged {
        format: "MCAP",
        detail: detail.into(),
    }
}

/// The file as far as it was read.
struct File<R> {
    input: R,
    at: u64,
    /// Checksum over everything up to the end of the data.
    checksum: Option<Hasher>,
}

impl<R: Read> File<R> {
    /// Reads the next `length` bytes. The buffer grows with the bytes that are there, not with the length that is claimed.
    fn exactly(&mut self, length: u64, into: &mut Vec<u8>) -> Result<(), Problem> {
        into.clear();
        let mut piece: Take<&mut R> = (&mut self.input).take(length);
        let got = piece.read_to_end(into)? as u64;
        self.at += got;
        if got < length {
            return Err(Problem::CutOff { at: self.at });
        }
        Ok(())
    }

    fn skip(&mut self, length: u64, scratch: &mut Vec<u8>) -> Result<(), Problem> {
        let mut left = length;
        while left > 0 {
            let piece = left.min(PIECE);
            self.exactly(piece, scratch)?;
            self.hash(scratch);
            left -= piece;
        }
        Ok(())
    }

    fn hash(&mut self, bytes: &[u8]) {
        if let Some(checksum) = &mut self.checksum {
            checksum.update(bytes);
        }
    }

    fn data_end(&mut self, record: &[u8]) -> Result<(), Problem> {
        let claimed = Bytes(record).u32().unwrap_or_default();
        let found = self.checksum.take().map_or(0, Hasher::finalize);
        // Zero: the writer left it out.
        if claimed != 0 && found != claimed {
            return Err(damaged(format!(
                "its messages have the checksum {found:08x} where {claimed:08x} is noted"
            )));
        }
        Ok(())
    }

    fn end(&mut self, scratch: &mut Vec<u8>) -> Result<(), Problem> {
        self.exactly(MAGIC.len() as u64, scratch)?;
        if scratch != MAGIC {
            return Err(damaged("it does not end as MCAP files do"));
        }
        Ok(())
    }
}

/// The records of a chunk, unpacked and compared with their checksum.
fn unpack<'a>(chunk: &'a [u8], room: &'a mut Vec<u8>, at: u64) -> Result<&'a [u8], Problem> {
    let broken = |why: &str| damaged(format!("the chunk at byte {at} {why}"));
    let mut fields = Bytes(chunk);
    let header = (|| {
        fields.take(16)?; // times of the first and last message
        let size = fields.u64()?;
        let checksum = fields.u32()?;
        let compression = fields.text()?;
        let length = usize::try_from(fields.u64()?).ok()?;
        Some((size, checksum, compression, fields.take(length)?))
    })();
    let (size, checksum, compression, packed) =
        header.ok_or_else(|| broken("is shorter than it claims"))?;
    if size > LARGEST {
        return Err(broken(&format!("claims {size} bytes")));
    }
    room.clear();
    // One byte more than claimed shows that there is more.
    let unpacked = match compression.as_str() {
        "" => return checked(packed, checksum, at),
        "lz4" => lz4_flex::frame::FrameDecoder::new(packed)
            .take(size + 1)
            .read_to_end(room),
        "zstd" => zstd::stream::read::Decoder::with_buffer(packed)
            .and_then(|decoder| decoder.take(size + 1).read_to_end(room)),
        _ => return Err(Problem::Compression(compression)),
    };
    unpacked.map_err(|e| broken(&format!("cannot be unpacked: {e}")))?;
    if room.len() as u64 != size {
        return Err(broken("unpacks to another length than it claims"));
    }
    checked(room, checksum, at)
}

fn checked(records: &[u8], checksum: u32, at: u64) -> Result<&[u8], Problem> {
    let found = crc32fast::hash(records);
    // Zero: the writer left it out.
    if checksum != 0 && found != checksum {
        return Err(damaged(format!(
            "the chunk at byte {at} has the checksum {found:08x} where {checksum:08x} is noted"
        )));
    }
    Ok(records)
}

/// Schema record: the definition of a message type.
struct Schema {
    name: String,
    definition: Definition,
}

/// Content of the records, handed to a sink.
struct Content<'a> {
    schemas: HashMap<u16, Schema>,
    sink: &'a mut dyn Sink,
}

impl Content<'_> {
    /// Reads the records of a chunk.
    fn records(&mut self, records: &[u8], at: u64) -> Result<(), Problem> {
        let mut rest = Bytes(records);
        while !rest.0.is_empty() {
            let (opcode, body) = (|| {
                let (opcode, length) = head(rest.take(HEAD)?);
                Some((opcode, rest.take(usize::try_from(length).ok()?)?))
            })()
            .ok_or_else(|| damaged(format!("a record of the chunk at byte {at} is cut off")))?;
            self.record(opcode, body, at)?;
        }
        Ok(())
    }

    fn record(&mut self, opcode: u8, body: &[u8], at: u64) -> Result<(), Problem> {
        let short = || damaged(format!("a record at byte {at} is shorter than it claims"));
        match opcode {
            op::SCHEMA => self.schema(body).ok_or_else(short),
            op::CHANNEL => {
                let channel = self.channel(body).ok_or_else(short)?;
                self.sink.channel(channel)
            }
            op::MESSAGE => {
                let mut fields = Bytes(body);
                let (channel, logged) = (|| {
                    let channel = fields.u16()?;
                    fields.u32()?; // sequence number
                    let logged = fields.u64()?;
                    fields.u64()?; // time at which it was published
                    Some((channel, logged))
                })()
                .ok_or_else(short)?;
                let logged = i64::try_from(logged).unwrap_or(i64::MAX);
                self.sink.message(u64::from(channel), logged, fields.0)
            }
            _ => Ok(()),
        }
    }

    fn schema(&mut self, body: &[u8]) -> Option<()> {
        let mut fields = Bytes(body);
        let id = fields.u16()?;
        let name = short(&fields.text()?);
        let encoding = fields.text()?;
        let text = fields.text()?;
        let definition = match encoding.as_str() {
            "ros2msg" if !text.is_empty() => Definition::Ros2(text),
            "ros2msg" | "" => Definition::Missing,
            _ => Definition::Other(encoding),
        };
        self.schemas.insert(id, Schema { name, definition });
        Some(())
    }

    fn channel(&mut self, body: &[u8]) -> Option<Channel> {
        let mut fields = Bytes(body);
        let id = u64::from(fields.u16()?);
        let schema = self.schemas.get(&fields.u16()?);
        Some(Channel {
            id,
            topic: fields.text()?,
            encoding: fields.text()?,
            kind: schema.map_or_else(String::new, |s| s.name.clone()),
            definition: schema.map_or(Definition::Missing, |s| s.definition.clone()),
        })
    }
}
