//! Fields of the records of an MCAP file. Numbers are little-endian; texts and the content of a chunk follow their length.
//!
//! Source: the MCAP format, version 0 (mcap.dev/spec).

use std::str;

/// First and last bytes of every file.
pub(super) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// Kinds of records.
pub(super) const FOOTER: u8 = 0x02;
pub(super) const SCHEMA: u8 = 0x03;
pub(super) const CHANNEL: u8 = 0x04;
pub(super) const MESSAGE: u8 = 0x05;
pub(super) const CHUNK: u8 = 0x06;

/// Reason why bytes are not a record.
pub(super) type Damage = &'static str;

/// Message type; its number is not 0.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Schema {
    pub id: u16,
    pub name: String,
}

/// Topic with the number of its schema, which is 0 if there is none.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Channel {
    pub id: u16,
    pub schema: u16,
    pub topic: String,
    pub encoding: String,
}

/// Message on a channel; `log_time` is the time of recording, ns.
pub(super) struct Message<'a> {
    pub channel: u16,
    pub log_time: u64,
    pub content: &'a [u8],
}

/// Records compressed together.
pub(super) struct Chunk<'a> {
    /// Size of the unpacked content, bytes.
    pub size: u64,
    /// CRC-32 of the unpacked content, 0 if there is none.
    pub crc: u32,
    pub compression: &'a str,
    pub content: &'a [u8],
}

impl Schema {
    pub fn parse(record: &[u8]) -> Result<Self, Damage> {
        let mut fields = Fields(record);
        let (id, name) = (fields.short()?, fields.text()?.to_owned());
        if id == 0 { Err("a schema has the number 0") } else { Ok(Self { id, name }) }
    }
}

impl Channel {
    pub fn parse(record: &[u8]) -> Result<Self, Damage> {
        let mut fields = Fields(record);
        let (id, schema) = (fields.short()?, fields.short()?);
        Ok(Self { id, schema, topic: fields.text()?.to_owned(), encoding: fields.text()?.to_owned() })
    }
}

impl<'a> Message<'a> {
    pub fn parse(record: &'a [u8]) -> Result<Self, Damage> {
        let mut fields = Fields(record);
        let (channel, _sequence) = (fields.short()?, fields.word()?);
        let (log_time, _publish_time) = (fields.long()?, fields.long()?);
        Ok(Self { channel, log_time, content: fields.0 })
    }
}

impl<'a> Chunk<'a> {
    pub fn parse(record: &'a [u8]) -> Result<Self, Damage> {
        let mut fields = Fields(record);
        let [_first_time, _last_time, size] = [fields.long()?, fields.long()?, fields.long()?];
        let (crc, compression) = (fields.word()?, fields.text()?);
        let length = usize::try_from(fields.long()?).map_err(|_| SHORT)?;
        Ok(Self { size, crc, compression, content: fields.bytes(length)? })
    }
}

const SHORT: Damage = "a record is shorter than its fields";

/// Bytes of a record after the fields already read.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn bytes(&mut self, count: usize) -> Result<&'a [u8], Damage> {
        let (own, rest) = self.0.split_at_checked(count).ok_or(SHORT)?;
        self.0 = rest;
        Ok(own)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Damage> {
        let (own, rest) = self.0.split_first_chunk().ok_or(SHORT)?;
        self.0 = rest;
        Ok(*own)
    }

    fn short(&mut self) -> Result<u16, Damage> {
        self.array().map(u16::from_le_bytes)
    }

    fn word(&mut self) -> Result<u32, Damage> {
        self.array().map(u32::from_le_bytes)
    }

    fn long(&mut self) -> Result<u64, Damage> {
        self.array().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Result<&'a str, Damage> {
        let length = self.word()? as usize;
        str::from_utf8(self.bytes(length)?).map_err(|_| "a text of a record is not UTF-8")
    }
}
