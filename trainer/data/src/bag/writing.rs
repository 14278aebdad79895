//! Writing of `.mcap` files with joints, as ROS 2 records them: chunks with their indexes, a summary at the end.
//!
//! Source: the MCAP format, version 0 (mcap.dev/spec).

use super::record::{CHANNEL, CHUNK, FOOTER, MAGIC, MESSAGE, SCHEMA};
use super::written_message::{DEFINITION, TYPE, cdr};
use crate::bag_problem::BagProblem;
use crate::error::Fault;
use crate::place::Place;
use crc::{CRC_32_ISO_HDLC, Crc};

/// Kinds of records that are only written.
const HEADER: u8 = 0x01;
const MESSAGE_INDEX: u8 = 0x07;
const CHUNK_INDEX: u8 = 0x08;
const STATISTICS: u8 = 0x0B;
const DATA_END: u8 = 0x0F;

/// Size of a chunk, bytes.
const CHUNK_SIZE: usize = 1 << 20;
/// Number of the only schema.
const JOINTS: u16 = 1;
/// Last time of a message, s: its stamp has 31 bits of seconds.
const LATEST: f64 = 2_147_483_647.0;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Joint states of one topic of a bag.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTopic {
    /// Name of the topic, such as `/measured`.
    pub topic: String,
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Messages in the order of time.
    pub states: Vec<JointSample>,
}

/// A message of joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointSample {
    /// Stamp, s.
    pub time: f64,
    /// A number for each joint, m or rad; empty if there are none.
    pub position: Vec<f64>,
    /// Velocities, m/s or rad/s, likewise.
    pub velocity: Vec<f64>,
    /// Forces, N or N m, likewise.
    pub effort: Vec<f64>,
}

/// A message to be written.
struct Message<'a> {
    channel: u16,
    nanoseconds: u64,
    topic: &'a JointTopic,
    sample: &'a JointSample,
}

/// The content of a file with these topics, in the order of time.
pub(crate) fn encoded(topics: &[JointTopic]) -> Result<Vec<u8>, Fault> {
    let mut messages = Vec::new();
    for (channel, topic) in (1..).zip(topics) {
        for sample in &topic.states {
            messages.push(Message { channel, nanoseconds: nanoseconds(sample.time)?, topic, sample });
        }
    }
    messages.sort_by_key(|message| message.nanoseconds);
    let mut file = File::new();
    let definitions = definitions(topics);
    let mut content = definitions.clone();
    let mut first = 0;
    for (end, message) in (1..).zip(&messages) {
        content.extend(message.record());
        if content.len() >= CHUNK_SIZE || end == messages.len() {
            file.chunk(&std::mem::take(&mut content), &messages[first..end]);
            first = end;
        }
    }
    Ok(file.finish(&definitions, topics))
}

fn nanoseconds(time: f64) -> Result<u64, Fault> {
    if (0.0..=LATEST).contains(&time) {
        // Seconds are exact, so that their parts keep their digits.
        Ok(time.trunc() as u64 * 1_000_000_000 + (time.fract() * 1e9).round() as u64)
    } else {
        Err((Place::File, BagProblem::NoStamp(time).into()))
    }
}

/// The schema, and the channels of all topics.
fn definitions(topics: &[JointTopic]) -> Vec<u8> {
    let mut schema = Fields::default();
    schema.short(JOINTS).text(TYPE).text("ros2msg").bytes(DEFINITION.as_bytes());
    let mut all = schema.record(SCHEMA);
    for (id, topic) in (1..).zip(topics) {
        let mut channel = Fields::default();
        channel.short(id).short(JOINTS).text(&topic.topic).text("cdr").word(0);
        all.extend(channel.record(CHANNEL));
    }
    all
}

impl Message<'_> {
    fn record(&self) -> Vec<u8> {
        let mut fields = Fields::default();
        fields.short(self.channel).word(0).long(self.nanoseconds).long(self.nanoseconds);
        fields.0.extend(cdr(self.nanoseconds, &self.topic.joints, self.sample));
        fields.record(MESSAGE)
    }
}

/// A file so far, with the index of its chunks.
struct File {
    bytes: Vec<u8>,
    index: Vec<u8>,
    chunks: u32,
    times: Option<[u64; 2]>,
    counts: Vec<u16>,
}

impl File {
    fn new() -> Self {
        let mut header = Fields::default();
        header.text("ros2").text(concat!("leastaction ", env!("CARGO_PKG_VERSION")));
        let bytes = [&MAGIC[..], &header.record(HEADER)].concat();
        Self { bytes, index: Vec::new(), chunks: 0, times: None, counts: Vec::new() }
    }

    /// Adds a chunk with these messages, which stand at its end, and their indexes.
    fn chunk(&mut self, content: &[u8], messages: &[Message<'_>]) {
        let [start, end] =
            [messages.first(), messages.last()].map(|own| own.map_or(0, |own| own.nanoseconds));
        let size = content.len() as u64;
        let mut chunk = Fields::default();
        chunk.long(start).long(end).long(size).word(CRC.checksum(content)).text("").long(size);
        chunk.0.extend(content);
        let at = self.bytes.len();
        self.bytes.extend(chunk.record(CHUNK));
        let length = self.bytes.len() - at;
        let (indexes, places) = self.message_indexes(content, messages);
        let mut index = Fields::default();
        index.long(start).long(end).long(at as u64).long(length as u64).bytes(&places);
        index.long(indexes.len() as u64).text("").long(size).long(size);
        self.bytes.extend(indexes);
        self.index.extend(index.record(CHUNK_INDEX));
        self.chunks += 1;
        self.times = Some([self.times.map_or(start, |[first, _]| first), end]);
        self.counts.extend(messages.iter().map(|message| message.channel));
    }

    /// The index of every channel of a chunk, to be written next, and a map from channels to places of their indexes.
    fn message_indexes(&self, content: &[u8], messages: &[Message<'_>]) -> (Vec<u8>, Vec<u8>) {
        let mut channels: Vec<u16> = messages.iter().map(|message| message.channel).collect();
        channels.sort_unstable();
        channels.dedup();
        let lengths: usize = messages.iter().map(|message| message.record().len()).sum();
        let (mut all, mut places) = (Vec::new(), Fields::default());
        for channel in channels {
            let (mut entries, mut offset) = (Fields::default(), content.len() - lengths);
            for message in messages {
                if message.channel == channel {
                    entries.long(message.nanoseconds).long(offset as u64);
                }
                offset += message.record().len();
            }
            places.short(channel).long((self.bytes.len() + all.len()) as u64);
            let mut index = Fields::default();
            index.short(channel).bytes(&entries.0);
            all.extend(index.record(MESSAGE_INDEX));
        }
        (all, places.0)
    }

    /// Ends the file with its summary.
    fn finish(mut self, definitions: &[u8], topics: &[JointTopic]) -> Vec<u8> {
        let mut end = Fields::default();
        end.word(0);
        self.bytes.extend(end.record(DATA_END));
        let summary = self.bytes.len() as u64;
        let [first, last] = self.times.unwrap_or_default();
        let (mut statistics, mut counts) = (Fields::default(), Fields::default());
        for id in (1..).take(topics.len()) {
            counts.short(id).long(self.counts.iter().filter(|channel| **channel == id).count() as u64);
        }
        statistics.long(self.counts.len() as u64).short(1).word(topics.len() as u32).word(0).word(0);
        statistics.word(self.chunks).long(first).long(last).bytes(&counts.0);
        let mut footer = Fields::default();
        footer.long(summary).long(0).word(0);
        let parts =
            [definitions, &statistics.record(STATISTICS), &self.index, &footer.record(FOOTER), &MAGIC];
        self.bytes.extend(parts.concat());
        self.bytes
    }
}

/// Fields of a record. Numbers are little-endian; texts and bytes follow their length.
#[derive(Default)]
struct Fields(Vec<u8>);

impl Fields {
    fn short(&mut self, value: u16) -> &mut Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn word(&mut self, value: u32) -> &mut Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn long(&mut self, value: u64) -> &mut Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn text(&mut self, text: &str) -> &mut Self {
        self.bytes(text.as_bytes())
    }

    fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.word(bytes.len() as u32);
        self.0.extend(bytes);
        self
    }

    /// The record of this kind.
    fn record(&self, kind: u8) -> Vec<u8> {
        [&[kind][..], &(self.0.len() as u64).to_le_bytes(), &self.0].concat()
    }
}
