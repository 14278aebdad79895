//! Logged motion, as written by a robot.

use leastaction_core::forces::ControlKind;
use leastaction_data::survey::{Guess, RawLog};
use leastaction_data::{Column, Columns, Dataset, MIN_SAMPLES, Reading, Rows, decode, decode_as};
use std::io::{Cursor, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Reads a text of columns: under our names, under its own names, by numbers and without time, and by `look`.
pub fn csv(bytes: &[u8]) {
    log("log.csv", bytes, ["time", "enc", "tau"]);
    log("log.csv", bytes, ["#1", "#2", "#3"]);
    let columns = columns(["t", "enc", "tau"]);
    let reading = Reading { columns: Some(columns), rate: Some(100.0), ..Reading::default() };
    if let Ok((data, _)) = decode_as("log.csv", bytes, &reading) {
        holds_together(&data);
    }
}

/// Reads an archive: unchanged, or built around the arrays of the input, so that its own checksums are right.
pub fn npz(input: &[u8]) {
    match input.split_first() {
        Some((0, bytes)) => log("log.npz", bytes, ["t", "q[0]", "u[0]"]),
        Some((_, arrays)) => log("log.npz", &archive(arrays), ["t", "q[0]", "u[0]"]),
        None => {}
    }
}

/// Reads a ROS 2 bag.
pub fn mcap(bytes: &[u8]) {
    log("log.mcap", bytes, ["t", "/joints/a/position", "/joints/a/effort"]);
}

/// Reads a ROS 2 bag of SQLite, unchanged or behind the first bytes of every database.
pub fn db3(input: &[u8]) {
    const HEAD: &[u8] = b"SQLite format 3\0\x02\0\x01\x01\0\x40\x20\x20";
    let names = ["t", "/joint_states/b/position", "/commands/a_joint_with_a_long_name/effort"];
    match input.split_first() {
        Some((0, bytes)) => log("log.db3", bytes, names),
        Some((_, bytes)) => log("log.db3", &[HEAD, bytes].concat(), names),
        None => {}
    }
}

/// Reads a MATLAB file: unchanged, or the elements of the input behind a header of either byte order.
pub fn mat(input: &[u8]) {
    let names = ["time", "enc[0]", "drive.tau"];
    let headed = |order: &[u8], elements: &[u8]| [&[b' '; 124], order, elements].concat();
    match input.split_first() {
        Some((0, bytes)) => log("log.mat", bytes, names),
        Some((1, bytes)) => log("log.mat", &headed(&[1, 0, b'M', b'I'], bytes), names),
        Some((_, bytes)) => log("log.mat", &headed(&[0, 1, b'I', b'M'], bytes), names),
        None => {}
    }
}

/// Returns an archive of the arrays, each preceded by the number of its name and two bytes of its length.
fn archive(mut arrays: &[u8]) -> Vec<u8> {
    const NAMES: [&str; 8] = ["q", "t", "u", "v", "a", "h", "trajectory", "control"];
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    while let Some(([name, a, b], rest)) = arrays.split_first_chunk::<3>() {
        let length = usize::from(u16::from_le_bytes([*a, *b])).min(rest.len());
        let name = format!("{}.npy", NAMES[usize::from(*name) % NAMES.len()]);
        // A repeated name is refused.
        if writer.start_file(name, options).is_ok() {
            let _of_memory = writer.write_all(&rest[..length]);
        }
        arrays = &rest[length..];
    }
    writer.finish().map(Cursor::into_inner).unwrap_or_default()
}

/// Returns columns of a time, a position and a force.
fn columns([t, q, u]: [&str; 3]) -> Columns {
    let q = vec![Column::scaled(q, 1e-3)];
    Columns { t: Column::si(t), q, v: Vec::new(), u: vec![Column::si(u)], actuation: None }
}

fn log(name: &str, bytes: &[u8], names: [&str; 3]) {
    let path = Path::new(name);
    if let Ok((data, _)) = decode(path, bytes) {
        holds_together(&data);
    }
    let columns = columns(names);
    let control = Some(ControlKind::Linear);
    for step in [None, Some(0.01)] {
        let reading = Reading { columns: Some(columns.clone()), step, control, ..Reading::default() };
        if let Ok((data, _)) = decode_as(path, bytes, &reading) {
            holds_together(&data);
        }
    }
    if let Ok(logs) = RawLog::decode(path, bytes) {
        drop(Guess::of(&logs));
    }
}

/// Checks that a data set is fit for learning: finite numbers, and as many rows of everything as of positions.
fn holds_together(data: &Dataset) {
    assert!(data.n > 0 && data.h.is_finite() && data.h > 0.0 && !data.trajectories.is_empty());
    for motion in &data.trajectories {
        assert!(motion.samples() >= MIN_SAMPLES && motion.t0.is_finite());
        let fields = [Some(&motion.q), motion.v.as_ref(), motion.a.as_ref(), motion.u.as_ref()];
        fields.into_iter().flatten().for_each(|rows| rows_hold_together(rows, [data.n, motion.samples()]));
    }
}

fn rows_hold_together(rows: &Rows, [n, samples]: [usize; 2]) {
    assert_eq!([rows.width(), rows.len()], [n, samples]);
    assert!(rows.as_flat().iter().all(|x| x.is_finite()));
}
