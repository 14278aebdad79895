//! Logs of a pendulum in every format.

use super::{Done, Seeds};
use leastaction_data::{self as data, Dataset, Rows, Trajectory};
use std::fs;
use std::path::Path;

#[allow(dead_code, missing_docs, reason = "shared with tests, which use more of it")]
#[path = "../../../../../trainer/data/tests/bag/mod.rs"]
mod bag;

/// Bags of SQLite.
const DATABASES: [&[u8]; 2] = [
    include_bytes!("../../../../../trainer/data/tests/golden/bag_0.db3"),
    include_bytes!("../../../../../trainer/data/tests/golden/bag_1.db3"),
];
/// MATLAB files.
const ARRAYS: [&[u8]; 2] = [
    include_bytes!("../../../../../trainer/data/tests/golden/compressed.mat"),
    include_bytes!("../../../../../trainer/data/tests/golden/plain.mat"),
];

/// Motions of a pendulum under two pushes.
pub fn motions(samples: usize) -> Done<Dataset> {
    let rows = |f: &dyn Fn(f64) -> f64| {
        Rows::from_flat(1, (0..samples).map(|k| f(0.05 * k as f64)).collect()).ok_or("one column")
    };
    let mut trajectories = Vec::new();
    for id in 0..2_i32 {
        let phase = f64::from(id);
        let (q, u) = (rows(&|t| (3.0 * t + phase).cos())?, rows(&|_| 0.5)?);
        trajectories.push(Trajectory { id: id.into(), t0: 0.0, q, v: None, a: None, u: Some(u) });
    }
    Ok(Dataset { n: 1, h: 0.05, control: None, trajectories })
}

/// Writes logs of a pendulum in every format.
pub fn logs(corpus: &Path) -> Done {
    let folder = tempfile::tempdir()?;
    let (mut csv, mut npz, mut mcap) =
        (Seeds::of(corpus, "csv")?, Seeds::of(corpus, "npz")?, Seeds::of(corpus, "mcap")?);
    let motions = motions(4)?;
    for extension in ["csv", "npz"] {
        let path = folder.path().join("log").with_extension(extension);
        data::write(&path, &motions)?;
        let bytes = fs::read(path)?;
        if extension == "csv" { csv.add(&bytes)? } else { npz.add(&[&[0], &bytes[..]].concat())? }
    }
    for text in [
        "time;enc;tau;mode\n0.00;100;0.5;on\n0.01;101;0.5;on\n0.021;103;-1;on\n0.03;104;-1;on\n0.041;106;2;on\n0.08;107;2;on\n",
        "# h = 0.05\n# control = held\nq0,u0,trajectory\n1,0,1\n2,0.5,1\n3,1e-3,1\n4,0,2\n5,0,2\n6,0,2\n",
        "t\tq\tv\n0\t0,5\t1\n0,1\t0,6\t1\n0,2\t0,7\t1\n",
        "time,enc,tau\n0,1,2\n1,2,3\n2,3,4\n9,9,9\n10,9,9\n11,9,9\n",
        "time,enc,tau,\ns,deg,Nm,\n0,1,2,\n1,2,3,\n2,3,4,\n3,4,5,\ntime,enc,tau,\n4,1,2,\n5,2,3,\n6,3,4,\n7,4",
        "0.00 1.0 2\n0.01 1.1 2\n0.02  1.3 -1\n0.03 1.4 -1\n0.04 1.6 2\n",
        "time,enc,tau\n2026-01-02T03:04:05.00Z,1,2\n2026-01-02T03:04:05.01Z,2,3\n2026-01-02T03:04:05.02Z,3,4\n2026-01-02T03:04:05.03Z,4,5\n",
        "time,enc,tau\n0.000,1,\n0.001,,2\n0.010,2,\n0.011,,3\n0.020,3,\n0.021,,4\n0.030,4,\n0.031,,5\n0.040,5,\n",
        "# enc tau\n1.0 2\n1.1 2\n1.3 -1\n1.4 -1\n1.6 2\n",
        "enc,tau\n1,2\n2,3\n3,4\n",
    ] {
        csv.add(text.as_bytes())?;
        let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        csv.add(&[&[0xff, 0xfe], &wide[..]].concat())?;
    }
    for arrays in arrays() {
        npz.add(&[&[1], &arrays[..]].concat())?;
    }
    let (mut db3, mut mat) = (Seeds::of(corpus, "db3")?, Seeds::of(corpus, "mat")?);
    for bytes in DATABASES {
        db3.add(&[&[0], bytes].concat())?;
        db3.add(&[&[1], &bytes[24..]].concat())?;
    }
    for bytes in ARRAYS {
        mat.add(&[&[0], bytes].concat())?;
        mat.add(&[&[2], &bytes[128..]].concat())?;
    }
    for chunks in [bag::Chunks::No, bag::Chunks::Plain, bag::Chunks::Zstd, bag::Chunks::Lz4] {
        let (stamps, names) = ([0_i64, 10_000_000, 20_000_000, 31_000_000, 90_000_000], ["a"]);
        let values: Vec<[f64; 3]> = (0..stamps.len()).map(|k| [0.1 * k as f64, 0.5, -1.0]).collect();
        let messages: Vec<_> = (stamps.iter().zip(&values))
            .map(|(stamp, [q, v, u])| {
                let fields = [q, v, u].map(std::slice::from_ref);
                bag::Joints { topic: "/joints", stamp: *stamp, names: &names, fields }
            })
            .collect();
        mcap.add(&without_checksums(bag::bag(&messages, chunks)))?;
    }
    Ok(())
}

/// Sets the checksums of a bag to 0, which means that there are none, so that a reader accepts the fuzzer's changes.
fn without_checksums(mut bag: Vec<u8>) -> Vec<u8> {
    let mut at = 8;
    while let Some(head) = bag.get(at..at + 9) {
        let (opcode, length) =
            (head[0], head[1..].iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte)));
        let body = at + 9;
        let zeroed = match opcode {
            // Checksum of a chunk, after two times and a size.
            6 => Some(body + 24),
            // Checksums of the end of the data, and of the footer.
            15 => Some(body),
            2 => Some(body + 16),
            _ => None,
        };
        if let Some(sum) = zeroed.and_then(|start| bag.get_mut(start..start + 4)) {
            sum.fill(0);
        }
        at = body + length;
    }
    bag
}

/// Arrays, each preceded by the number of its name and its length: positions, stamps, forces of several element types and orders.
fn arrays() -> Vec<Vec<u8>> {
    let npy = |header: &str, content: &[u8]| {
        let padded = format!("{header:<117}\n");
        [b"\x93NUMPY\x01\x00", &(padded.len() as u16).to_le_bytes()[..], padded.as_bytes(), content].concat()
    };
    let doubles = |x: &[f64]| x.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
    let singles = |x: &[f32]| x.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>();
    let one = |kind: &str, shape: &str, fortran: &str| {
        format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}")
    };
    let (t, q) = ([0.0, 0.1, 0.2, 0.3], [1.0, 2.0, 3.0, 4.0]);
    let t = npy(&one("<f8", "(4,)", "False"), &doubles(&t));
    let q1 = npy(&one("<f8", "(4, 1)", "False"), &doubles(&q));
    let q2 = npy(&one(">f4", "(4, 2)", "True"), &singles(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]));
    let ids = npy(&one("|i1", "(4,)", "False"), &[0, 0, 0, 0]);
    let h = npy(&one("<f8", "()", "False"), &doubles(&[0.1]));
    let control = npy(&one("<U4", "()", "False"), b"h\0\0\0e\0\0\0l\0\0\0d\0\0\0");
    let put = |parts: &[(u8, &Vec<u8>)]| {
        let mut all = Vec::new();
        for (name, array) in parts {
            all.push(*name);
            all.extend((array.len() as u16).to_le_bytes());
            all.extend(*array);
        }
        all
    };
    vec![
        put(&[(0, &q1), (1, &t), (2, &q1)]),
        put(&[(0, &q2), (5, &h), (3, &q2), (6, &ids)]),
        put(&[(0, &q1), (5, &h), (7, &control)]),
    ]
}
