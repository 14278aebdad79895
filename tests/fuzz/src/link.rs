//! Processor's end of the link.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use leastaction_firmware_sim::link::{
    Answer, Files, Flash, Port, Receiver, Workspace, parse_answer, serve, serve_arm,
};

static CRC: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

macro_rules! in_flash {
    ($name:ident, $file:literal) => {
        static $name: &[u8] = include_bytes!(concat!("../../../firmware-sim/chip/models/", $file));
    };
}
in_flash!(CARTPOLE, "cartpole.postcard");
in_flash!(DRY, "cartpole-dry.postcard");
in_flash!(PLAN, "swing-up.postcard");
in_flash!(ARM, "arm.postcard");

/// A port that hears prepared bytes and keeps the answers.
struct Line<'a> {
    heard: std::slice::Iter<'a, u8>,
    said: Vec<u8>,
}

impl Port for Line<'_> {
    type Error = ();

    fn receive(&mut self) -> Result<u8, ()> {
        self.heard.next().copied().ok_or(())
    }

    fn send(&mut self, byte: u8) -> Result<(), ()> {
        self.said.push(byte);
        Ok(())
    }
}

/// Sends the world's bytes, either unchanged or as documents in valid frames, to a processor with one of three models,
/// one of them with plans, or none.
///
/// Every answer must be a whole frame, and every command a finite number.
pub fn link(input: &[u8]) {
    let Some(([mode], rest)) = input.split_first_chunk::<1>() else { return };
    let heard = if mode & 4 == 0 { framed(rest) } else { rest.to_vec() };
    let mut line = Line { heard: heard.iter(), said: Vec::new() };
    let files: [&[&[u8]]; 4] = [&[CARTPOLE], &[DRY, PLAN, PLAN], &[ARM], &[]];
    let (mut memory, kind) = ([0; 1 << 14], usize::from(mode & 3));
    let flash = Flash(Files::put(&mut memory, files[kind]).expect("the files fit"));
    let end = match kind {
        2 => serve_arm::<_, 7, 256>(&mut line, flash, "fuzz"),
        _ => serve::<_, 32, 2>(&mut line, flash, &mut Workspace::new(), "fuzz"),
    };
    assert!(end.is_ok() || line.heard.len() == 0);
    if kind == 2 { answers::<7>(&line.said) } else { answers::<2>(&line.said) }
}

fn answers<const N: usize>(said: &[u8]) {
    let mut receiver = Receiver::default();
    for frame in said.iter().filter_map(|byte| receiver.push(*byte)) {
        let frame = frame.expect("an answer is a whole frame");
        // Answers of a program for one coordinate have another length.
        if let Ok(Answer::Done(done)) = parse_answer::<N>(&frame) {
            assert!(done.outcome.command.u.iter().all(|u| u.is_finite()), "{:?}", done.outcome.command);
        }
    }
}

/// Returns the documents, each preceded by its length, in frames: with a checksum, and stuffed so that each ends with a 0.
fn framed(mut input: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    while let Some((length, rest)) = input.split_first() {
        let (document, rest) = rest.split_at(usize::from(*length).min(rest.len()));
        let whole = [document, &CRC.checksum(document).to_le_bytes()].concat();
        for run in whole.split(|byte| *byte == 0) {
            all.push(run.len().min(254) as u8 + 1);
            all.extend(run);
        }
        all.push(0);
        input = rest;
    }
    all
}
