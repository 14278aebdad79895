//! Bags as ROS 2 writes them.

use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};
use std::collections::BTreeMap;
use std::io::{Cursor, Write};

/// A message of joints.
#[derive(Clone, Default)]
pub struct Joints<'a> {
    pub topic: &'a str,
    /// Nanoseconds.
    pub stamp: i64,
    pub names: &'a [&'a str],
    pub fields: [&'a [f64]; 3],
}

impl Joints<'_> {
    /// The message in CDR, little endian.
    pub fn cdr(&self) -> Vec<u8> {
        let mut body = Vec::new();
        body.extend(((self.stamp / 1_000_000_000) as i32).to_le_bytes());
        body.extend(((self.stamp % 1_000_000_000) as u32).to_le_bytes());
        text(&mut body, "base");
        count(&mut body, self.names.len());
        self.names.iter().for_each(|name| text(&mut body, name));
        for field in self.fields {
            count(&mut body, field.len());
            if !field.is_empty() {
                align(&mut body, 8);
            }
            field.iter().for_each(|value| body.extend(value.to_le_bytes()));
        }
        [vec![0, 1, 0, 0], body].concat()
    }
}

fn align(body: &mut Vec<u8>, to: usize) {
    body.resize(body.len().next_multiple_of(to), 0);
}

fn count(body: &mut Vec<u8>, count: usize) {
    align(body, 4);
    body.extend((count as u32).to_le_bytes());
}

fn text(body: &mut Vec<u8>, text: &str) {
    count(body, text.len() + 1);
    body.extend(text.as_bytes());
    body.push(0);
}

/// How chunks are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Chunks {
    No,
    Plain,
    Zstd,
    Lz4,
}

/// A file with these messages, recorded 1 ms after they were stamped.
pub fn bag(messages: &[Joints<'_>], chunks: Chunks) -> Vec<u8> {
    let contents: Vec<_> =
        messages.iter().map(|joints| (joints.topic, joints.stamp + 1_000_000, joints.cdr())).collect();
    file(&contents, "sensor_msgs/msg/JointState", chunks)
}

/// A file with messages of topics, times of recording and contents.
pub fn file(messages: &[(&str, i64, Vec<u8>)], schema: &str, chunks: Chunks) -> Vec<u8> {
    let options = WriteOptions::new()
        .compression(None)
        .profile("ros2")
        .use_chunks(chunks != Chunks::No)
        .emit_message_indexes(false);
    let mut writer = Writer::with_options(Cursor::new(Vec::new()), options).unwrap();
    let schema = writer.add_schema(schema, "ros2msg", b"string[] name").unwrap();
    for (sequence, (topic, log_time, content)) in (1..).zip(messages) {
        let channel_id = writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap();
        let log_time = *log_time as u64;
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, content).unwrap();
    }
    writer.finish().unwrap();
    let whole = writer.into_inner().into_inner();
    if matches!(chunks, Chunks::Zstd | Chunks::Lz4) { compressed(&whole, chunks) } else { whole }
}

const CHUNK: u8 = 6;

/// The file with every chunk compressed, which the writer cannot do without C libraries; without the indexes behind the chunks.
fn compressed(whole: &[u8], chunks: Chunks) -> Vec<u8> {
    let mut done = whole[..8].to_vec();
    let mut rest = &whole[8..];
    loop {
        let (opcode, length) = (rest[0], u64::from_le_bytes(rest[1..9].try_into().unwrap()) as usize);
        let body = &rest[9..9 + length];
        rest = &rest[9 + length..];
        // The data end here; the summary that follows is optional.
        if opcode == 0x0F {
            let footer = [vec![0x0F, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 20], vec![0; 27]].concat();
            return [done, footer, whole[..8].to_vec()].concat();
        }
        let body = if opcode == CHUNK { compressed_chunk(body, chunks) } else { body.to_vec() };
        done.push(opcode);
        done.extend((body.len() as u64).to_le_bytes());
        done.extend(body);
    }
}

/// A chunk: two times, size, checksum, the name of the compression, the content behind its length.
fn compressed_chunk(body: &[u8], chunks: Chunks) -> Vec<u8> {
    let (head, content) = (&body[..28], &body[28 + 4 + 8..]);
    let (name, packed) = if chunks == Chunks::Zstd {
        ("zstd", ruzstd::encoding::compress_to_vec(content, ruzstd::encoding::CompressionLevel::Fastest))
    } else {
        let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
        encoder.write_all(content).unwrap();
        ("lz4", encoder.finish().unwrap())
    };
    let mut done = head.to_vec();
    done.extend((name.len() as u32).to_le_bytes());
    done.extend(name.as_bytes());
    done.extend((packed.len() as u64).to_le_bytes());
    done.extend(packed);
    done
}
