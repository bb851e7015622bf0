//! Parts of the MCAP format, version 0 (<https://mcap.dev/spec>), that reader and writer share.

/// Bytes with which a file begins and ends.
pub(crate) const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

/// Opcodes of the records that are read or written.
pub(crate) mod op {
    pub(crate) const HEADER: u8 = 0x01;
    pub(crate) const FOOTER: u8 = 0x02;
    pub(crate) const SCHEMA: u8 = 0x03;
    pub(crate) const CHANNEL: u8 = 0x04;
    pub(crate) const MESSAGE: u8 = 0x05;
    pub(crate) const CHUNK: u8 = 0x06;
    pub(crate) const STATISTICS: u8 = 0x0b;
    pub(crate) const DATA_END: u8 = 0x0f;
}
