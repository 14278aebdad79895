//! NPZ logs: accepted files, and error messages. The arrays are built by hand, after NumPy's format description.

mod sizes;

#[path = "../common/npy.rs"]
mod npy;

use std::io::{Cursor, Write};

use leastaction_core::forces::ControlKind;
use leastaction_data::{self as data, Dataset, Note};
use npy::{f8, npy};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Names and arrays.
type Arrays<'a> = Vec<(&'a str, Vec<u8>)>;

fn pack(arrays: &[(&str, Vec<u8>)], method: CompressionMethod) -> Vec<u8> {
    let files: Vec<_> = arrays.iter().map(|(name, bytes)| (format!("{name}.npy"), bytes)).collect();
    zip_up(&files, method)
}

fn zip_up(files: &[(String, &Vec<u8>)], method: CompressionMethod) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(name, SimpleFileOptions::default().compression_method(method)).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn read_bytes(bytes: &[u8]) -> Result<(Dataset, Vec<Note>), data::DataError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.npz");
    std::fs::write(&path, bytes).unwrap();
    data::read(&path)
}

fn accept(arrays: &[(&str, Vec<u8>)]) -> Dataset {
    let (dataset, notes) = read_bytes(&pack(arrays, CompressionMethod::Stored)).unwrap();
    assert_eq!(notes, []);
    dataset
}

/// The error message after the file name.
fn refuse(arrays: &[(&str, Vec<u8>)]) -> String {
    let message = read_bytes(&pack(arrays, CompressionMethod::Stored)).unwrap_err().to_string();
    message.split_once("log.npz").unwrap().1.to_owned()
}

fn q3() -> (&'static str, Vec<u8>) {
    ("q", f8("(3, 2)", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))
}

fn h() -> (&'static str, Vec<u8>) {
    ("h", f8("()", &[0.05]))
}

#[test]
fn positions_and_a_step_are_enough() {
    let data = accept(&[q3(), h()]);
    assert_eq!((data.n, data.h, data.trajectories.len()), (2, 0.05, 1));
    let motion = &data.trajectories[0];
    assert_eq!((motion.id, motion.t0), (0, 0.0));
    assert_eq!(motion.q.as_flat(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert!(motion.v.is_none() && motion.a.is_none() && motion.u.is_none());
}

#[test]
fn element_type_byte_order_memory_order_and_compression_do_not_matter() {
    let expected = accept(&[q3(), h()]);
    let values = [1_u8, 2, 3, 4, 5, 6];
    let bytes = |f: fn(u8) -> Vec<u8>| values.iter().flat_map(|&x| f(x)).collect::<Vec<u8>>();
    let variants = [
        npy("'<f4'", false, "(3, 2)", &bytes(|x| f32::from(x).to_le_bytes().to_vec())),
        npy("'>f4'", false, "(3, 2)", &bytes(|x| f32::from(x).to_be_bytes().to_vec())),
        npy("'>f8'", false, "(3, 2)", &bytes(|x| f64::from(x).to_be_bytes().to_vec())),
        npy("'<i8'", false, "(3, 2)", &bytes(|x| i64::from(x).to_le_bytes().to_vec())),
        npy("'>i4'", false, "(3, 2)", &bytes(|x| i32::from(x).to_be_bytes().to_vec())),
        npy("'<i2'", false, "(3, 2)", &bytes(|x| i16::from(x).to_le_bytes().to_vec())),
        npy("'|i1'", false, "(3, 2)", &values),
        npy("'<u8'", false, "(3, 2)", &bytes(|x| u64::from(x).to_le_bytes().to_vec())),
        npy("'<u4'", false, "(3, 2)", &bytes(|x| u32::from(x).to_le_bytes().to_vec())),
        npy("'>u2'", false, "(3, 2)", &bytes(|x| u16::from(x).to_be_bytes().to_vec())),
        npy("'|u1'", false, "(3, 2)", &values),
        npy("'|u1'", true, "(3, 2)", &[1, 3, 5, 2, 4, 6]),
    ];
    for q in variants {
        assert_eq!(accept(&[("q", q.clone()), h()]), expected);
        let packed = pack(&[("q", q), h()], CompressionMethod::Deflated);
        assert_eq!(read_bytes(&packed).unwrap().0, expected);
    }
}

#[test]
fn one_coordinate_may_be_one_dimensional() {
    let data = accept(&[("q", f8("(3,)", &[1.0, 2.0, 3.0])), ("u", f8("(3, 1)", &[4.0, 5.0, 6.0])), h()]);
    assert_eq!((data.n, data.trajectories[0].u.as_ref().unwrap().as_flat()), (1, &[4.0, 5.0, 6.0][..]));
}

#[test]
fn trajectories_and_single_precision_stamps_are_read() {
    let stamps: Vec<u8> = [0.0_f32, 0.05, 0.1, 3.3, 3.35, 3.4].iter().flat_map(|t| t.to_le_bytes()).collect();
    let data = accept(&[
        ("q", f8("(6,)", &[0.0; 6])),
        ("t", npy("'<f4'", false, "(6,)", &stamps)),
        ("trajectory", f8("(6,)", &[9.0, 9.0, 9.0, 2.0, 2.0, 2.0])),
        ("_made_by", f8("(1,)", &[1.0])),
    ]);
    assert_eq!(data.h, 0.05);
    let summary: Vec<_> = data.trajectories.iter().map(|m| (m.id, m.t0)).collect();
    assert_eq!(summary, [(9, 0.0), (2, f64::from(3.3_f32))]);
}

fn t(values: &[f64]) -> (&'static str, Vec<u8>) {
    ("t", f8(&format!("({},)", values.len()), values))
}

/// Checks the error message after the file name in every case.
#[track_caller]
fn assert_refused(cases: &[(Arrays<'_>, &str)]) {
    for (arrays, message) in cases {
        assert_eq!(refuse(arrays), *message);
    }
}

#[test]
fn what_is_missing_or_unknown_is_named() {
    assert_refused(&[
        (vec![h()], ": no positions; the key q is needed"),
        (vec![], ": no positions; the key q is needed"),
        (vec![q3()], ": no time; give the stamps t or the step h (one number under the key h)"),
        (
            vec![q3(), h(), ("velocity", f8("(1,)", &[1.0]))],
            ": \"velocity\" is not a known name; known are q, v, a, u, t, h, trajectory, control; rename it, or put _ before it to have it ignored",
        ),
    ]);
}

/// A string of NumPy's type U, in this byte order.
fn string(text: &str, order: char, shape: &str) -> Vec<u8> {
    let letters = text.chars().map(u32::from);
    let bytes: Vec<u8> = if order == '>' {
        letters.flat_map(u32::to_be_bytes).collect()
    } else {
        letters.flat_map(u32::to_le_bytes).collect()
    };
    npy(&format!("'{order}U{}'", text.len()), false, shape, &bytes)
}

#[test]
fn what_the_control_does_is_a_string() {
    let control = |array: Vec<u8>| accept(&[q3(), h(), ("control", array)]).control;
    assert_eq!(control(string("held", '<', "()")), Some(ControlKind::Held));
    assert_eq!(control(string("linear", '>', "(1,)")), Some(ControlKind::Linear));
    assert_eq!(control(npy("'|S8'", false, "()", b"linear\0\0")), Some(ControlKind::Linear));
    assert_eq!(accept(&[q3(), h()]).control, None);
    assert_refused(&[
        (
            vec![q3(), h(), ("control", string("hold", '<', "()"))],
            ", key control: \"hold\" is not what u does between samples; write \"held\" or \"linear\", or leave control out",
        ),
        (
            vec![q3(), h(), ("control", f8("()", &[0.0]))],
            ", key control: elements of type <f8 in shape []; store one string",
        ),
        (
            vec![q3(), h(), ("control", string("heldheld", '<', "(2,)"))],
            ", key control: elements of type <U8 in shape [2]; store one string",
        ),
    ]);
}

#[test]
fn values_are_refused_by_key_and_row() {
    assert_refused(&[
        (
            vec![q3(), h(), ("v", f8("(3, 2)", &[1.0, 1.0, 1.0, f64::NAN, 1.0, 1.0]))],
            ", key v, row 1: NaN is not finite; remove the sample (a gap in t splits the trajectory there)",
        ),
        (
            vec![q3(), t(&[0.0, 1.0, f64::INFINITY])],
            ", key t, row 2: inf is not finite; remove the sample (a gap in t splits the trajectory there)",
        ),
    ]);
}

#[test]
fn stamps_and_the_step_must_agree() {
    assert_refused(&[
        (
            vec![q3(), t(&[0.0, 1.0, 1.0])],
            ", key t, row 2: time goes from 1 to 1 s; sort the samples, or number the trajectories",
        ),
        (
            vec![("q", f8("(5,)", &[0.0; 5])), t(&[0.0, 1.0, 2.0, 3.5, 4.5])],
            ", key t, row 3: an interval of 1.5 s where the step is 1 s; resample to one step",
        ),
        (
            vec![q3(), h(), t(&[0.0, 0.1, 0.2])],
            ", key h: h is 0.05 s but the stamps t are 0.1 s apart; remove the wrong one",
        ),
        (vec![q3(), ("h", f8("()", &[0.0]))], ", key h: the step h is 0 s; it must be positive and finite"),
        (vec![q3(), ("h", f8("(2,)", &[1.0, 1.0]))], ", key h: shape [2] where one number is needed"),
    ]);
}

#[test]
fn shapes_must_agree() {
    assert_refused(&[
        (
            vec![q3(), h(), t(&[0.0, 1.0])],
            ", key t: shape [2] where [3], one for each sample of q, is needed",
        ),
        (
            vec![q3(), h(), ("v", f8("(2, 3)", &[0.0; 6]))],
            ", key v: shape [2, 3] where [3, 2] as of q is needed",
        ),
        (vec![q3(), h(), ("u", f8("(3,)", &[0.0; 3]))], ", key u: shape [3] where [3, 2] as of q is needed"),
        (
            vec![("q", f8("(1, 3, 2)", &[0.0; 6])), h()],
            ", key q: shape [1, 3, 2] where [samples, n] with n ≥ 1 is needed",
        ),
        (
            vec![("q", f8("(3, 0)", &[])), h()],
            ", key q: shape [3, 0] where [samples, n] with n ≥ 1 is needed",
        ),
    ]);
}

#[test]
fn trajectories_are_whole_and_long_enough() {
    assert_refused(&[
        (vec![("q", f8("(0, 2)", &[])), h()], ": no samples; at least 3 of them make a trajectory"),
        (
            vec![("q", f8("(2, 2)", &[0.0; 4])), h()],
            ", key q, row 0: trajectory 0 has 2 samples; at least 3 are needed",
        ),
        (
            vec![
                ("q", f8("(7,)", &[0.0; 7])),
                h(),
                ("trajectory", f8("(7,)", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0])),
            ],
            ", key trajectory, row 6: trajectory 1 was left and comes again; keep its samples together, or number it anew",
        ),
        (
            vec![q3(), h(), ("trajectory", f8("(3,)", &[1.0, 1.5, 2.0]))],
            ", key trajectory: 1.5 is not a whole number that fits 64 bits",
        ),
        (
            vec![q3(), h(), ("trajectory", npy("'<u8'", false, "(3,)", &[255; 24]))],
            ", key trajectory: 18446744073709551615 is not a whole number that fits 64 bits",
        ),
    ]);
}

#[test]
fn elements_are_plain_numbers() {
    assert_refused(&[
        (
            vec![("q", npy("'|b1'", false, "(3,)", &[1; 3])), h()],
            ", key q: elements are of type |b1; store float64, float32 or integers",
        ),
        (
            vec![("q", npy("'<c16'", false, "(3,)", &[0; 48])), h()],
            ", key q: elements are of type <c16; store float64, float32 or integers",
        ),
        (
            vec![("q", npy("'|O'", false, "(3,)", &[0; 48])), h()],
            ", key q: elements are of type |O; store float64, float32 or integers",
        ),
        (
            vec![("q", npy("'<f8'", false, "(4,)", &[0; 24])), h()],
            ", key q: not a readable array (24 bytes of data for shape [4] of f8); write it again, as plain numbers",
        ),
    ]);
}

#[test]
fn files_that_are_no_archives_are_refused() {
    let message = |bytes: &[u8]| read_bytes(bytes).unwrap_err().to_string();
    assert!(message(b"").ends_with("log.npz: no samples; at least 3 of them make a trajectory"));
    assert!(message(b"t,q\n0,1\n").contains("log.npz: not a readable .npz file ("));
    assert!(message(&q3().1).contains("log.npz: not a readable .npz file ("));
}

#[test]
fn an_array_that_stands_twice_is_refused() {
    let mut bytes = pack(&[q3(), ("x", q3().1), h()], CompressionMethod::Stored);
    let places: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i..].starts_with(b"x.npy")).collect();
    assert_eq!(places.len(), 2);
    places.into_iter().for_each(|i| bytes[i] = b'q');
    let error = read_bytes(&bytes).unwrap_err().to_string();
    assert!(error.ends_with("log.npz: an array stands twice; remove one"), "{error}");
    let both = zip_up(&[("q".to_owned(), &q3().1), ("q.npy".to_owned(), &q3().1)], CompressionMethod::Stored);
    let error = read_bytes(&both).unwrap_err().to_string();
    assert!(error.ends_with("log.npz, key q: the array stands twice; remove one"), "{error}");
}

#[test]
fn forged_headers_neither_exhaust_memory_nor_the_stack() {
    let deep = |open: &str| npy("'<f8'", false, &open.repeat(9000), &[]);
    let huge_length = [b"\x93NUMPY\x02\x00", &[255; 4][..], &[b' '; 64]].concat();
    let forged = [
        npy("'<f8'", false, "(18446744073709551615, 2)", &[0; 48]),
        npy("'<f8'", false, "(2305843009213693952, 8)", &[0; 48]),
        npy("'<f8'", false, "(99999999999999999999999999, 2)", &[0; 48]),
        npy("'<f8'", false, "(-3, 2)", &[0; 48]),
        npy("'f99999999999'", false, "(3, 2)", &[0; 48]),
        npy("[('x', '<f8')]", false, "(3, 2)", &[0; 48]),
        npy("''", false, "(3, 2)", &[0; 48]),
        deep("("),
        deep("["),
        deep("{"),
        huge_length,
        b"\x93NUMPY\x01\x00".to_vec(),
        Vec::new(),
    ];
    for q in forged {
        assert!(refuse(&[("q", q), h()]).starts_with(", key q: "));
    }
}
