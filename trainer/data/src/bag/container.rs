//! The records of an MCAP file, and those within its chunks.
//!
//! The file is read sequentially, at most one chunk at a time. Allocations do not trust stated lengths: records are no longer than the
//! file, and chunks unpack to at most the size that they state.

use super::record::{self, CHANNEL, CHUNK, Channel, Chunk, Damage, FOOTER, MAGIC, MESSAGE, SCHEMA, Schema};
use crate::bag_problem::BagProblem;
use crate::error::Fault;
use crate::place::Place;
use crc::{CRC_32_ISO_HDLC, Crc, Table};
use std::borrow::Cow;
use std::collections::HashMap;
use std::io::{self, Read};

/// Largest size of an unpacked chunk, bytes. Recorders write chunks of some megabytes.
const LARGEST_CHUNK: u64 = 1 << 28;

/// Total size, in bytes, to which the chunks of any file may unpack, however small the file.
const MOST_ANYWAY: u64 = LARGEST_CHUNK;

/// Further bytes that chunks may unpack to per byte of the file: even blank images compress less than this.
const MOST_PER_BYTE: u64 = 1000;

static CRC: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

/// A message on any topic.
pub(super) struct Message<'a> {
    /// Number of the message in the bag, from 1.
    pub number: u64,
    /// Bytes of the file read so far.
    pub read: u64,
    pub channel: &'a Channel,
    /// Name of the channel's schema, empty if it has none.
    pub schema: &'a str,
    /// Time of recording, ns.
    pub log_time: u64,
    pub content: &'a [u8],
}

/// Callback for every message.
pub(super) type Visit<'v> = &'v mut dyn FnMut(&Message<'_>) -> Result<(), Fault>;

/// Passes every message of a file to `visit`, numbered from `before` + 1 on; returns the number of the last.
pub(super) fn messages(source: &mut dyn Read, before: u64, visit: Visit<'_>) -> Result<u64, Fault> {
    let mut scan = Scan { messages: before, ..Scan::new(visit) };
    let done = scan.file(source);
    done.map_err(|fault| scan.located(fault))?;
    Ok(scan.messages)
}

/// The time of recording of the first message, ns; `None` if there is none that can be read.
pub(super) fn first_time(source: &mut dyn Read) -> Option<u64> {
    let mut first = None;
    let _stopped = messages(source, 0, &mut |message| {
        first = Some(message.log_time);
        Err(damaged("the first message is enough"))
    });
    first
}

fn damaged(reason: Damage) -> Fault {
    (Place::File, BagProblem::NotMcap(reason.to_owned()).into())
}

const CUT: Damage = "it ends in the middle of a record";

/// Fills `to` from the file.
fn fill(source: &mut dyn Read, to: &mut [u8]) -> Result<(), Fault> {
    source.read_exact(to).map_err(|error| match error.kind() {
        io::ErrorKind::UnexpectedEof => damaged(CUT),
        _ => (Place::File, error.into()),
    })
}

fn magic(source: &mut dyn Read) -> Result<(), Fault> {
    let mut found = [0; MAGIC.len()];
    fill(source, &mut found)?;
    if found == MAGIC { Ok(()) } else { Err(damaged("it does not begin and end as one")) }
}

/// Size of the kind and the length in front of a record, bytes.
const HEAD: usize = 9;

fn head([kind, length @ ..]: [u8; HEAD]) -> (u8, u64) {
    (kind, u64::from_le_bytes(length))
}

/// State of the scan of a file.
struct Scan<'v> {
    schemas: HashMap<u16, Schema>,
    channels: HashMap<u16, Channel>,
    messages: u64,
    read: u64,
    /// Total size of the unpacked chunks so far, as they state it.
    unpacked: u64,
    visit: Visit<'v>,
}

impl<'v> Scan<'v> {
    fn new(visit: Visit<'v>) -> Self {
        let (schemas, channels) = (HashMap::new(), HashMap::new());
        Self { schemas, channels, messages: 0, read: 0, unpacked: 0, visit }
    }

    /// Gives a problem of the file as a whole a place: the message after the last one that was read.
    fn located(&self, (place, problem): Fault) -> Fault {
        if place == Place::File { (Place::Message(self.messages + 1), problem) } else { (place, problem) }
    }

    fn file(&mut self, source: &mut dyn Read) -> Result<(), Fault> {
        magic(source)?;
        let mut body = Vec::new();
        loop {
            let mut start = [0; HEAD];
            fill(source, &mut start)?;
            let (kind, length) = head(start);
            body.clear();
            let read = (&mut *source).take(length).read_to_end(&mut body);
            if read.map_err(|error| (Place::File, error.into()))? as u64 != length {
                return Err(damaged(CUT));
            }
            self.read += length;
            match kind {
                FOOTER => return magic(source),
                CHUNK => self.chunk(&body)?,
                _ => self.record(kind, &body)?,
            }
        }
    }

    fn chunk(&mut self, body: &[u8]) -> Result<(), Fault> {
        let chunk = Chunk::parse(body).map_err(damaged)?;
        self.unpacked = self.unpacked.saturating_add(chunk.size);
        let most = MOST_PER_BYTE.saturating_mul(self.read).saturating_add(MOST_ANYWAY);
        if self.unpacked > most && chunk.size <= LARGEST_CHUNK {
            return Err((Place::File, BagProblem::Unpacked { bytes: self.unpacked, most }.into()));
        }
        let content = unpacked(&chunk)?;
        let mut rest = &content[..];
        while let Some((start, behind)) = rest.split_first_chunk() {
            let (kind, length) = head(*start);
            let length = usize::try_from(length).unwrap_or(usize::MAX);
            let (body, behind) = behind.split_at_checked(length).ok_or_else(|| damaged(CUT))?;
            self.record(kind, body)?;
            rest = behind;
        }
        if rest.is_empty() { Ok(()) } else { Err(damaged(CUT)) }
    }

    fn record(&mut self, kind: u8, body: &[u8]) -> Result<(), Fault> {
        match kind {
            SCHEMA => {
                let schema = Schema::parse(body).map_err(damaged)?;
                keep(&mut self.schemas, schema.id, schema, "two schemas have one number")
            }
            CHANNEL => {
                let channel = Channel::parse(body).map_err(damaged)?;
                if channel.schema != 0 && !self.schemas.contains_key(&channel.schema) {
                    return Err(damaged("a topic is of a schema that the file does not name"));
                }
                keep(&mut self.channels, channel.id, channel, "two topics have one number")
            }
            MESSAGE => self.message(record::Message::parse(body).map_err(damaged)?),
            _ => Ok(()),
        }
    }

    fn message(&mut self, message: record::Message<'_>) -> Result<(), Fault> {
        let Some(channel) = self.channels.get(&message.channel) else {
            return Err(damaged("a message is of a topic that the file does not name"));
        };
        self.messages += 1;
        let schema = self.schemas.get(&channel.schema).map_or("", |schema| &schema.name);
        let Self { messages: number, read, .. } = *self;
        let record::Message { log_time, content, .. } = message;
        (self.visit)(&Message { number, read, channel, schema, log_time, content })
    }
}

/// Stores a definition under its number. The same definition may be repeated, as in the summary at the end of a file; a
/// different one is an error.
fn keep<T: PartialEq>(all: &mut HashMap<u16, T>, id: u16, new: T, twice: Damage) -> Result<(), Fault> {
    match all.get(&id) {
        Some(known) if *known != new => Err(damaged(twice)),
        _ => {
            all.insert(id, new);
            Ok(())
        }
    }
}

/// The content of a chunk, after a check of its length and checksum.
fn unpacked<'a>(chunk: &Chunk<'a>) -> Result<Cow<'a, [u8]>, Fault> {
    let (size, data) = (chunk.size, chunk.content);
    if size > LARGEST_CHUNK {
        return Err((Place::File, BagProblem::LargeChunk { bytes: size, most: LARGEST_CHUNK }.into()));
    }
    let content = match chunk.compression {
        "" => Cow::Borrowed(data),
        "zstd" => {
            let decoder = ruzstd::decoding::StreamingDecoder::new(data);
            read_whole(
                decoder.map_err(|error| (Place::File, BagProblem::NotMcap(error.to_string()).into()))?,
                size,
            )?
        }
        "lz4" => read_whole(lz4_flex::frame::FrameDecoder::new(data), size)?,
        other => return Err((Place::File, BagProblem::Compression(other.to_owned()).into())),
    };
    if content.len() as u64 != size {
        return Err(damaged("a chunk unpacks to another size than it says"));
    }
    if chunk.crc != 0 && CRC.checksum(&content) != chunk.crc {
        return Err(damaged("the checksum of a chunk is wrong"));
    }
    Ok(content)
}

/// Reads the whole content; reading one byte more than `size` detects excess content.
fn read_whole<'a>(from: impl Read, size: u64) -> Result<Cow<'a, [u8]>, Fault> {
    let mut content = Vec::new();
    let read = from.take(size + 1).read_to_end(&mut content);
    let problem = |error: io::Error| (Place::File, BagProblem::NotMcap(error.to_string()).into());
    read.map(|_| Cow::Owned(content)).map_err(problem)
}
