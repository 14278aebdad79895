//! MATLAB's files, as `golden/arrays.py` wrote them by SciPy and as a big-endian machine would.

use leastaction_data::survey::RawLog;
use leastaction_data::{
    Column, Columns, DataError, Dataset, MatProblem, Place, Problem, Reading, decode, decode_as,
};
use proptest::prelude::*;
use std::path::Path;

const FILES: [&[u8]; 2] = [include_bytes!("golden/compressed.mat"), include_bytes!("golden/plain.mat")];

fn columns(q: &[&str], u: &str) -> Columns {
    let q = q.iter().map(|name| Column::si(*name)).collect();
    let actuation = Some(vec![vec![1.0], vec![0.0]]);
    Columns { t: Column::si("time"), q, v: Vec::new(), u: vec![Column::si(u)], actuation }
}

fn read(bytes: &[u8], columns: Columns) -> Result<Dataset, DataError> {
    let reading = Reading { columns: Some(columns), ..Reading::default() };
    decode_as("log.mat", bytes, &reading).map(|(data, _)| data)
}

/// Positions k/2 and −k, and forces as `u` gives them.
fn is_as_written(data: &Dataset, u: impl Fn(f64) -> f64) {
    let motion = &data.trajectories[0];
    assert_eq!((data.h, motion.samples()), (0.01, 6));
    for (k, (q, force)) in motion.q.iter().zip(motion.u.as_ref().unwrap().iter()).enumerate() {
        let k = k as f64;
        assert_eq!((q, force[0]), (&[0.5 * k, -k][..], u(k)));
    }
}

#[test]
fn arrays_of_every_type_and_fields_are_columns() {
    for bytes in FILES {
        for q in [&["enc"][..], &["wide"], &["wide[0]", "enc[1]"]] {
            is_as_written(&read(bytes, columns(q, "drive.tau")).unwrap(), f64::sqrt);
        }
        is_as_written(&read(bytes, columns(&["enc"], "drive.motor.current")).unwrap(), |k| 2.0 * k);
        is_as_written(&read(bytes, columns(&["enc"], "counts")).unwrap(), |k| 100.0 * k);
        is_as_written(&read(bytes, columns(&["enc"], "big")).unwrap(), |k| k + f64::from(2.0_f32.powi(40)));
        is_as_written(&read(bytes, columns(&["enc"], "once")).unwrap(), |_| 0.0);
    }
}

#[test]
fn look_lists_what_has_numbers() {
    let [log] = &RawLog::decode(Path::new("log.mat"), FILES[0]).unwrap()[..] else { panic!("one log") };
    let expected = [
        "time",
        "enc[0]",
        "enc[1]",
        "wide[0]",
        "wide[1]",
        "counts",
        "flags",
        "big",
        "once",
        "drive.tau",
        "drive.motor.current",
    ];
    assert_eq!(log.names, expected);
    assert_eq!(log.others, ["note", "cells", "phasor", "drive.name", "volume"]);
}

#[test]
fn what_cannot_be_read_is_named() {
    let refused = |q: &str| read(FILES[0], columns(&[q], "counts")).unwrap_err();
    assert!(
        refused("angle").to_string().contains("\"angle\"; the file has time, enc"),
        "{}",
        refused("angle")
    );
    assert!(matches!(&refused("volume").problem, Problem::Shape { found, .. } if *found == [2, 3, 4]));
    assert!(matches!(refused("note").problem, Problem::NoColumn { .. }));
    let header = |start: &[u8]| decode("log.mat", &[start, &[b' '; 600]].concat()).unwrap_err();
    let of_7_3 = header(b"MATLAB 7.3 MAT-file, Platform: GLNXA64");
    assert!(of_7_3.to_string().contains("save(\"log.mat\", \"-v7\")"), "{of_7_3}");
    assert!(matches!(header(&[0, 0, 0, 0, 6, 0, 0, 0]).problem, Problem::Mat(MatProblem::Version4)));
    assert!(matches!(header(b"PK").problem, Problem::Mat(MatProblem::NotMat(_))));
    assert!(matches!(decode("log.mat", b"").unwrap_err().problem, Problem::Empty));
}

/// A file of a big-endian machine, with leastaction's own names: an array q of two columns, and a step h.
fn big_endian() -> Vec<u8> {
    let element = |kind: u32, content: &[u8]| {
        let padding = vec![0; content.len().next_multiple_of(8) - content.len()];
        [&kind.to_be_bytes(), &(content.len() as u32).to_be_bytes(), content, &padding].concat()
    };
    let array = |name: &str, shape: [i32; 2], numbers: &[f64]| {
        let parts = [
            element(6, &[0, 0, 0, 6, 0, 0, 0, 0]),
            element(5, &shape.map(i32::to_be_bytes).concat()),
            // A name of one letter is in its tag.
            [&[0, 1, 0, 1], name.as_bytes(), &[0; 3]].concat(),
            element(9, &numbers.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>()),
        ];
        element(14, &parts.concat())
    };
    let mut header = vec![b' '; 124];
    header.extend([1, 0, b'M', b'I']);
    let q = array("q", [4, 2], &[1.0, 2.0, 3.0, 4.0, 0.1, 0.2, 0.3, 0.4]);
    [header, q, array("h", [1, 1], &[0.05])].concat()
}

#[test]
fn own_names_and_both_byte_orders_are_read() {
    let (data, _) = decode("log.mat", &big_endian()).unwrap();
    assert_eq!((data.n, data.h), (2, 0.05));
    assert_eq!(data.trajectories[0].q.as_flat(), [1.0, 0.1, 2.0, 0.2, 3.0, 0.3, 4.0, 0.4]);
    let missing = decode("log.mat", FILES[0]).unwrap_err();
    assert!(matches!(missing.problem, Problem::MissingPositions(_)) && missing.place == Place::File);
}

#[test]
fn truncated_files_are_refused_or_lack_arrays() {
    for end in 0..FILES[0].len() {
        let cut = read(&FILES[0][..end], columns(&["drive.motor.current", "wide[1]"], "big"));
        assert!(cut.is_err(), "{end}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// No bytes, at any place, end the reader; what it accepts is finite.
    #[test]
    fn changed_files_are_read_or_refused(
        file in 0..3_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let own = big_endian();
        let mut bytes = FILES.get(file).map_or(own, |bytes| bytes.to_vec());
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let own = decode("log.mat", &bytes).map(|(data, _)| data);
        for data in [read(&bytes, columns(&["enc"], "drive.tau")), own].into_iter().flatten() {
            prop_assert!(data.trajectories.iter().all(|motion| motion.q.as_flat().iter().all(|x| x.is_finite())));
        }
    }
}
