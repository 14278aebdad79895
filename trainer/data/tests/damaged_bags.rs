//! Damaged bags: every truncation, every flipped bit and every claim of gigabytes gives an error or a consistent data set.

mod bag;

use bag::{Chunks, Joints, bag};
use leastaction_data::{
    BagProblem, Column, Columns, DataError, Dataset, MIN_SAMPLES, Note, Place, Problem, Reading, decode_as,
};
use rayon::prelude::*;

fn small(chunks: Chunks) -> Vec<u8> {
    let q: Vec<[f64; 2]> = (0..6).map(|k| [f64::from(k), 1.0]).collect();
    let messages = (1..).zip(&q).map(|(k, q)| Joints {
        topic: "/j",
        stamp: 10_000_000 * k,
        names: &["a", "b"],
        fields: [q, &[], q],
    });
    let messages: Vec<_> = messages.collect();
    bag(&messages, chunks)
}

fn reading(step: Option<f64>) -> Reading {
    let all = |field: &str| ["a", "b"].map(|joint| Column::si(format!("/j/{joint}/{field}"))).to_vec();
    let (q, u) = (all("position"), all("effort"));
    let columns = Columns { t: Column::si("t"), q, v: Vec::new(), u, actuation: None };
    Reading { columns: Some(columns), step, ..Reading::default() }
}

fn read(bytes: &[u8]) -> Result<(Dataset, Vec<Note>), DataError> {
    decode_as("a.mcap", bytes, &reading(None))
}

fn holds_together(data: &Dataset) {
    assert!(data.n == 2 && data.h.is_finite() && data.h > 0.0 && !data.trajectories.is_empty());
    for motion in &data.trajectories {
        let u = motion.u.as_ref().unwrap();
        assert!(motion.samples() >= MIN_SAMPLES && u.len() == motion.samples() && motion.t0.is_finite());
        assert!(motion.q.as_flat().iter().chain(u.as_flat()).all(|x| x.is_finite()));
    }
}

const ALL: [Chunks; 4] = [Chunks::No, Chunks::Plain, Chunks::Zstd, Chunks::Lz4];

#[test]
fn cut_bags_are_refused_with_the_message_that_is_missing() {
    for chunks in ALL {
        let whole = small(chunks);
        assert!(read(&whole).is_ok());
        let said: Vec<DataError> =
            (0..whole.len()).into_par_iter().map(|length| read(&whole[..length]).unwrap_err()).collect();
        let at_message =
            |error: &DataError| matches!(error.place, Place::Message(number) if (1..=7).contains(&number));
        assert!(said.iter().all(at_message), "{chunks:?}");
        let last = said.last().unwrap().to_string();
        assert!(last.contains("a.mcap, message 7: not a readable .mcap file: it ends"), "{last}");
    }
}

#[test]
fn flipped_bits() {
    for chunks in ALL {
        let whole = small(chunks);
        let read = |bit: usize| {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            read(&bytes).ok()
        };
        let accepted: Vec<_> = (0..8 * whole.len()).into_par_iter().filter_map(read).collect();
        accepted.iter().for_each(|(data, _)| holds_together(data));
        assert!(!accepted.is_empty() && accepted.len() < 8 * whole.len());
    }
}

/// Stated lengths of 4 GiB, 2⁴⁰ and 2⁶⁴ bytes anywhere. No such size is allocated, so thousands of them can be tested
/// at once.
#[test]
fn claims_of_gigabytes() {
    for chunks in ALL {
        let whole = small(chunks);
        let claims: [&[u8]; 4] =
            [&[0xFF; 4], &[0xFF; 8], &[0, 0, 0, 0, 0, 1, 0, 0], &[0, 0, 0, 0x40, 0, 0, 0, 0]];
        (0..whole.len() - 8).into_par_iter().for_each(|at| {
            for claim in claims {
                let mut bytes = whole.clone();
                bytes[at..at + claim.len()].copy_from_slice(claim);
                if let Ok((data, _)) = read(&bytes) {
                    holds_together(&data);
                }
            }
        });
    }
}

#[test]
fn a_chunk_that_unpacks_to_too_much_is_refused() {
    let whole = small(Chunks::Zstd);
    let at = whole.windows(4).position(|window| window == b"zstd").unwrap();
    // The length of the name, the checksum and the size precede the name.
    let size = at - 4 - 4 - 8;
    let with = |claim: u64| {
        let mut bytes = whole.clone();
        bytes[size..size + 8].copy_from_slice(&claim.to_le_bytes());
        read(&bytes).unwrap_err()
    };
    let error = with(1 << 40);
    assert!(
        matches!(error.problem, Problem::Bag(BagProblem::LargeChunk { .. }))
            && error.place == Place::Message(1),
        "{error}"
    );
    assert!(with(17).to_string().contains("unpacks to another size"));
    let mut other = whole.clone();
    other[at..at + 4].copy_from_slice(b"lzma");
    assert!(
        read(&other).unwrap_err().to_string().contains("compressed by \"lzma\"; zstd, lz4 and none are read")
    );
}

/// A record of an unknown kind, compressed by zstd: its head, then run-length blocks of zeros.
fn record_of_zeros(size: u64) -> Vec<u8> {
    const BLOCK: u64 = 1 << 17;
    let mut packed = vec![0x28, 0xB5, 0x2F, 0xFD, 0, 7 << 3, 9 << 3, 0, 0, 0x80];
    packed.extend((size - 9).to_le_bytes());
    let mut rest = size - 9;
    while rest > 0 {
        let part = rest.min(BLOCK);
        rest -= part;
        let head = (part as u32) << 3 | 1 << 1 | u32::from(rest == 0);
        packed.extend(&head.to_le_bytes()[..3]);
        packed.push(0);
    }
    packed
}

/// Chunks of zeros, each of which would be accepted alone: the second is not even unpacked.
#[test]
fn files_that_unpack_to_more_than_their_size_allows_are_refused() {
    const SIZE: u64 = 1 << 28;
    let plain = small(Chunks::Plain);
    let packed = record_of_zeros(SIZE);
    let mut chunk = vec![0; 16];
    chunk.extend(SIZE.to_le_bytes());
    chunk.extend([0, 0, 0, 0, 4, 0, 0, 0]);
    chunk.extend(b"zstd");
    chunk.extend((packed.len() as u64).to_le_bytes());
    chunk.extend(packed);
    let header = 9 + u64::from_le_bytes(plain[9..17].try_into().unwrap()) as usize;
    let mut bytes = plain[..8 + header].to_vec();
    for _ in 0..40 {
        bytes.push(6);
        bytes.extend((chunk.len() as u64).to_le_bytes());
        bytes.extend(&chunk);
    }
    assert!(bytes.len() < 1 << 21, "{}", bytes.len());
    let error = read(&bytes).unwrap_err();
    assert!(matches!(error.problem, Problem::Bag(BagProblem::Unpacked { .. })), "{error}");
}

#[test]
fn absurd_rates_and_spans_are_refused() {
    let q = [1.0, 2.0];
    let stamped = |stamps: &[i64]| {
        let joints =
            |stamp: &i64| Joints { topic: "/j", stamp: *stamp, names: &["a", "b"], fields: [&q, &[], &q] };
        bag(&stamps.iter().map(joints).collect::<Vec<_>>(), Chunks::No)
    };
    let years = 1_000_000_000_000_000_000;
    let error = decode_as("a.mcap", &stamped(&[1, years, 2 * years]), &reading(Some(1e-3))).unwrap_err();
    assert!(matches!(error.problem, Problem::FineStep { .. }), "{error}");
    let fast: Vec<i64> = (1..1000).collect();
    let (data, _) = decode_as("a.mcap", &stamped(&fast), &reading(Some(1e-7))).unwrap();
    assert!(data.samples() <= 10 && data.h == 1e-7);
    let error = decode_as("a.mcap", &stamped(&fast), &reading(Some(1.0))).unwrap_err();
    assert!(matches!(error.problem, Problem::Empty), "{error}");
}
