//! The records of an MCAP file, and those within its chunks.
//!
//! The file is read sequentially, at most one chunk at a time. Allocations do not trust stated lengths: records are no longer than the
//! file, and chunks unpack to at most the size that they state.

use crate::error::{Fault, Problem};
use crate::place::Place;
use crc::{CRC_32_ISO_HDLC, Crc, Table};
use mcap::McapError;
use mcap::read::ChannelAccumulator;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::borrow::Cow;
use std::io::{self, ErrorKind, Read};

/// Largest size of an unpacked chunk, bytes. Recorders write chunks of some megabytes.
const LARGEST_CHUNK: u64 = 1 << 28;

/// Total size, in bytes, to which the chunks of any file may unpack.
const MOST_ANYWAY: u64 = LARGEST_CHUNK;

/// Further bytes per byte of the file: even blank images compress less.
const MOST_PER_BYTE: u64 = 1000;

/// Largest number of bytes per read.
const BLOCK: usize = 1 << 20;

static CRC: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

/// A message on any topic.
pub(super) struct Message<'a> {
    /// Number of the message in the file, from 1.
    pub number: u64,
    /// Bytes of the file read so far.
    pub read: u64,
    pub channel: &'a mcap::Channel<'a>,
    /// Time of recording, ns.
    pub log_time: u64,
    pub content: &'a [u8],
}

/// Callback for every message.
pub(super) type Visit<'v> = &'v mut dyn FnMut(&Message<'_>) -> Result<(), Fault>;

/// Passes every message of a file with this length to `visit`.
pub(super) fn messages(source: &mut dyn Read, length: u64, visit: Visit<'_>) -> Result<(), Fault> {
    let mut scan = Scan { channels: ChannelAccumulator::default(), messages: 0, read: 0, unpacked: 0, visit };
    let limit = usize::try_from(length).unwrap_or(usize::MAX);
    let options = LinearReaderOptions::default().with_emit_chunks(true).with_record_length_limit(limit);
    let done = records(source, options, &mut |opcode, body| scan.of_file(opcode, body));
    done.map_err(|fault| scan.located(fault))
}

/// Callback for every record, with its opcode and its bytes.
type Each<'e> = &'e mut dyn FnMut(u8, &[u8]) -> Result<(), Fault>;

/// Passes every record of a file or a chunk to `each`.
fn records(source: &mut dyn Read, options: LinearReaderOptions, each: Each<'_>) -> Result<(), Fault> {
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event.map_err(broken)? {
            LinearReadEvent::Record { opcode, data } => each(opcode, data)?,
            LinearReadEvent::ReadRequest(wanted) => {
                let read = source.read(reader.insert(wanted.min(BLOCK)));
                match read {
                    Ok(read) => reader.notify_read(read),
                    Err(error) if error.kind() == ErrorKind::Interrupted => {}
                    Err(error) => return Err((Place::File, error.into())),
                }
            }
        }
    }
    Ok(())
}

fn broken(error: McapError) -> Fault {
    let problem = match error {
        McapError::UnexpectedEof => Problem::NotMcap("it ends in the middle of a record".to_owned()),
        error => Problem::NotMcap(error.to_string()),
    };
    (Place::File, problem)
}

fn damaged(reason: &'static str) -> Fault {
    (Place::File, Problem::NotMcap(reason.to_owned()))
}

/// State of the scan of a file.
struct Scan<'v> {
    channels: ChannelAccumulator<'static>,
    messages: u64,
    read: u64,
    /// Total size of the unpacked chunks so far, as they state it.
    unpacked: u64,
    visit: Visit<'v>,
}

impl Scan<'_> {
    /// Locates a problem of the file as a whole after the last message.
    fn located(&self, (place, problem): Fault) -> Fault {
        if place == Place::File { (Place::Message(self.messages + 1), problem) } else { (place, problem) }
    }

    fn of_file(&mut self, opcode: u8, body: &[u8]) -> Result<(), Fault> {
        self.read += body.len() as u64;
        if opcode != op::CHUNK {
            return self.of_chunk(opcode, body);
        }
        let Record::Chunk { header, data } = mcap::parse_record(opcode, body).map_err(broken)? else {
            return Ok(());
        };
        self.unpacked = self.unpacked.saturating_add(header.uncompressed_size);
        let most = MOST_PER_BYTE.saturating_mul(self.read).saturating_add(MOST_ANYWAY);
        if self.unpacked > most && header.uncompressed_size <= LARGEST_CHUNK {
            return Err((Place::File, Problem::Unpacked { bytes: self.unpacked, most }));
        }
        let content = unpacked(&header, &data)?;
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_emit_chunks(true)
            .with_record_length_limit(content.len());
        records(&mut &content[..], options, &mut |opcode, body| self.of_chunk(opcode, body))
    }

    fn of_chunk(&mut self, opcode: u8, body: &[u8]) -> Result<(), Fault> {
        // Other records are not parsed.
        if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
            return Ok(());
        }
        match mcap::parse_record(opcode, body).map_err(broken)? {
            Record::Schema { header, data } => {
                self.channels.add_schema_from_slice(header, &data).map_err(broken)
            }
            Record::Channel(channel) => self.channels.add_channel(channel).map_err(broken),
            Record::Message { header, data } => {
                let Some(channel) = self.channels.get(header.channel_id) else {
                    return Err(damaged("a message is of a topic that the file does not name"));
                };
                self.messages += 1;
                let Self { messages: number, read, .. } = *self;
                let (log_time, content) = (header.log_time, &data[..]);
                (self.visit)(&Message { number, read, channel: &channel, log_time, content })
            }
            _ => Ok(()),
        }
    }
}

/// The contents of a chunk, after a check of its length and checksum.
fn unpacked<'a>(header: &ChunkHeader, data: &'a [u8]) -> Result<Cow<'a, [u8]>, Fault> {
    let size = header.uncompressed_size;
    if size > LARGEST_CHUNK {
        return Err((Place::File, Problem::LargeChunk { bytes: size, most: LARGEST_CHUNK }));
    }
    let content = match header.compression.as_str() {
        "" => Cow::Borrowed(data),
        "zstd" => {
            let decoder = ruzstd::decoding::StreamingDecoder::new(data);
            read_whole(decoder.map_err(|error| (Place::File, Problem::NotMcap(error.to_string())))?, size)?
        }
        "lz4" => read_whole(lz4_flex::frame::FrameDecoder::new(data), size)?,
        other => return Err((Place::File, Problem::Compression(other.to_owned()))),
    };
    if content.len() as u64 != size {
        return Err(damaged("a chunk unpacks to another size than it says"));
    }
    if header.uncompressed_crc != 0 && CRC.checksum(&content) != header.uncompressed_crc {
        return Err(damaged("the checksum of a chunk is wrong"));
    }
    Ok(content)
}

/// Reads the whole content; reading one byte more than `size` detects excess content.
fn read_whole<'a>(from: impl Read, size: u64) -> Result<Cow<'a, [u8]>, Fault> {
    let mut content = Vec::new();
    let read = from.take(size + 1).read_to_end(&mut content);
    let problem = |error: io::Error| (Place::File, Problem::NotMcap(error.to_string()));
    read.map(|_| Cow::Owned(content)).map_err(problem)
}
