//! CSV logs: accepted files, and error messages.

use leastaction_core::forces::ControlKind;
use leastaction_data::{self as data, Dataset, Note, Place, Problem};

fn read(text: &[u8]) -> Result<(Dataset, Vec<Note>), data::DataError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    std::fs::write(&path, text).unwrap();
    data::read(&path)
}

fn accept(text: &str) -> Dataset {
    let (dataset, notes) = read(text.as_bytes()).unwrap();
    assert_eq!(notes, []);
    dataset
}

/// The error message after the file name.
fn refuse(text: &str) -> String {
    let message = read(text.as_bytes()).unwrap_err().to_string();
    message.split_once("log.csv").unwrap().1.to_owned()
}

#[test]
fn columns_come_in_any_order_with_comments_spaces_and_a_byte_order_mark() {
    let data = accept(
        "\u{feff}# a cart-pole\n\n u1, u0 ,t,_note,q1,q0\n-1, 1,0.0,first,3,2\n# between\n-2,2,0.05,,5,4\n-3,3,0.10,x,7,6\n",
    );
    assert_eq!((data.n, data.h, data.samples(), data.trajectories.len()), (2, 0.05, 3, 1));
    let motion = &data.trajectories[0];
    assert_eq!(motion.q.as_flat(), [2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    assert_eq!(motion.u.as_ref().unwrap().as_flat(), [1.0, -1.0, 2.0, -2.0, 3.0, -3.0]);
    assert_eq!((motion.id, motion.t0, motion.v.is_none(), motion.a.is_none()), (0, 0.0, true, true));
}

#[test]
fn one_coordinate_needs_no_number() {
    let data = accept("t,q,v,a,u\n0,1,2,3,4\n1,1,2,3,4\n2,1,2,3,5\n");
    let motion = &data.trajectories[0];
    assert_eq!((data.n, data.h), (1, 1.0));
    assert_eq!(motion.u.as_ref().unwrap().as_flat(), [4.0, 4.0, 5.0]);
    assert_eq!(accept("# h = 0.5\nq0\n1\n2\n3\n").h, 0.5);
}

#[test]
fn trajectories_keep_their_numbers_and_start_times() {
    let data = accept("trajectory,t,q\n7,5,0\n7.0,6,1\n7.00e+00,7,2\n-3,0,3\n-3,1,4\n-3,2,5\n-3,3,6\n");
    let summary: Vec<_> = data.trajectories.iter().map(|m| (m.id, m.t0, m.samples())).collect();
    assert_eq!(summary, [(7, 5.0, 3), (-3, 0.0, 4)]);
    assert_eq!(data.times(&data.trajectories[0]).collect::<Vec<_>>(), [5.0, 6.0, 7.0]);
    let (first, rest) = data.split(1);
    assert_eq!((first.samples(), rest.samples()), (3, 4));
    assert_eq!(data.truncated(1), first);
    assert_eq!(data.truncated(9), data);
}

#[test]
fn a_gap_splits_and_a_short_piece_is_left_out() {
    let text = "t,q,trajectory\n0,0,4\n.1,1,4\n.2,2,4\n.5,5,4\n.6,6,4\n.9,9,4\n1,10,4\n1.1,11,4\n";
    let (data, notes) = read(text.as_bytes()).unwrap();
    assert_eq!(data.h, 0.1);
    let summary: Vec<_> = data.trajectories.iter().map(|m| (m.id, m.t0, m.q.as_flat().to_vec())).collect();
    assert_eq!(summary, [(4, 0.0, vec![0.0, 1.0, 2.0]), (6, 0.9, vec![9.0, 10.0, 11.0])]);
    let cell = |line| Place::Cell { line, column: "t".to_owned() };
    let expected = [
        Note::Gap { place: cell(5), trajectory: 4, missing: 2, continues_as: 5 },
        Note::Dropped { place: cell(5), trajectory: 4, samples: 2 },
        Note::Gap { place: cell(7), trajectory: 4, missing: 2, continues_as: 6 },
    ];
    assert_eq!(notes, expected);
    assert_eq!(
        notes[0].to_string(),
        "trajectory 4, line 5, column t: samples missing: 2; it continues as trajectory 5"
    );
    assert_eq!(
        notes[1].to_string(),
        "trajectory 4, line 5, column t: left out a piece of 2 samples between gaps; 3 are needed"
    );
}

#[track_caller]
fn assert_refused(cases: &[(&str, &str)]) {
    for (text, message) in cases {
        assert_eq!(refuse(text), *message, "{text}");
    }
}

#[test]
fn what_the_control_does_is_a_comment() {
    let control = |comment: &str| accept(&format!("# h = 1\n{comment}q,u\n1,0\n2,0\n3,0\n")).control;
    assert_eq!(control("# control = held\n"), Some(ControlKind::Held));
    assert_eq!(control("# control = \"linear\"\n"), Some(ControlKind::Linear));
    assert_eq!(control("# control of the arm\n"), None);
    assert_refused(&[(
        "# h = 1\n# control = on\nq\n1\n2\n3\n",
        ", line 2: \"on\" is not what u does between samples; write \"held\" or \"linear\", or leave control out",
    )]);
}

#[test]
fn what_is_missing_is_named() {
    assert_refused(&[
        ("", ": no samples; at least 3 of them make a trajectory"),
        ("# only\n", ": no samples; at least 3 of them make a trajectory"),
        ("t,q\n", ": no samples; at least 3 of them make a trajectory"),
        ("t,v\n0,1\n1,1\n2,1\n", ", line 1: no positions; column q0 is needed"),
        ("q\n0\n1\n2\n", ": no time; give the stamps t or the step h (a comment line # h = 0.05)"),
    ]);
}

#[test]
fn columns_are_named_in_full_and_once() {
    assert_refused(&[
        ("t,q0,q2\n0,1,1\n", ", line 1: column q1 is missing; q needs 2 columns, q0 to q1"),
        ("t,q0,q1,v0\n0,1,1,1\n", ", line 1: column v1 is missing; v needs 2 columns, v0 to v1"),
        ("t,q,q0\n0,1,1\n", ", line 1: column q1 is missing; q needs 2 columns, q0 to q1"),
        ("t,q0,q0\n0,1,1\n", ", line 1: column q0 stands twice; remove one"),
        ("t,q,t\n0,1,1\n", ", line 1: column t stands twice; remove one"),
        ("t,q,q\n0,1,1\n", ", line 1: column q stands twice; remove one"),
        ("t,q1,q1\n0,1,1\n", ", line 1: column q1 stands twice; remove one"),
        ("t,q0,q1,q1\n0,1,1,1\n", ", line 1: column q1 stands twice; remove one"),
        ("t,q0,v,v\n0,1,1,1\n", ", line 1: column v stands twice; remove one"),
        (
            "t,q,velocity\n0,1,1\n",
            ", line 1: \"velocity\" is not a known name; known are q0…, v0…, a0…, u0…, t, trajectory; rename it, or put _ before it to have it ignored",
        ),
    ]);
}

#[test]
fn cells_are_refused_by_line_and_column() {
    assert_refused(&[
        ("t,q\n0,1\n1,x\n2,1\n", ", line 3, column q: \"x\" is not a number; write 1.5 or -2e-3"),
        ("t,q\n0,1\n,1\n2,1\n", ", line 3, column t: \"\" is not a number; write 1.5 or -2e-3"),
        (
            "# c\nt,q0\n0,1\n1,nan\n2,1\n",
            ", line 4, column q0: NaN is not finite; remove the sample (a gap in t splits the trajectory there)",
        ),
        (
            "t,q\n0,1\n-inf,1\n2,1\n",
            ", line 3, column t: -inf is not finite; remove the sample (a gap in t splits the trajectory there)",
        ),
        ("t,q\n0,1\n1,1,5\n2,1\n", ", line 3: 3 cells where the header names 2 columns"),
        ("t,q\n0,1\n1\n2,1\n", ", line 3: 1 cells where the header names 2 columns"),
    ]);
}

#[test]
fn stamps_and_the_step_must_agree() {
    assert_refused(&[
        (
            "t,q\n0,1\n2,1\n1,1\n",
            ", line 4, column t: time goes from 2 to 1 s; sort the samples, or number the trajectories",
        ),
        (
            "t,q\n0,1\n1,1\n2,1\n3.25,1\n4.25,1\n",
            ", line 5, column t: an interval of 1.25 s where the step is 1 s; resample to one step",
        ),
        (
            "# h = 0.1\nt,q\n0,1\n1,1\n2,1\n",
            ", line 1: h is 0.1 s but the stamps t are 1 s apart; remove the wrong one",
        ),
        ("# h = -1\nq\n0\n1\n2\n", ", line 1: the step h is -1 s; it must be positive and finite"),
        ("# h = ten\nq\n0\n1\n2\n", ", line 1: \"ten\" is not a number; write 1.5 or -2e-3"),
    ]);
}

#[test]
fn trajectories_are_whole_and_long_enough() {
    assert_refused(&[
        ("t,q\n0,1\n1,1\n", ", line 2: trajectory 0 has 2 samples; at least 3 are needed"),
        (
            "t,q,trajectory\n0,1,1\n1,1,1\n2,1,1\n0,1,2\n1,1,2\n2,1,2\n3,1,1\n4,1,1\n5,1,1\n",
            ", line 8, column trajectory: trajectory 1 was left and comes again; keep its samples together, or number it anew",
        ),
        (
            "t,q,trajectory\n0,1,1.5\n1,1,1\n2,1,1\n",
            ", line 2, column trajectory: 1.5 is not a whole number that fits 64 bits",
        ),
    ]);
}

#[test]
fn the_kind_of_file_and_its_absence_are_told() {
    let path = std::path::Path::new("/nowhere/log");
    let unknown = data::read(path.with_extension("txt")).unwrap_err();
    assert_eq!(
        unknown.to_string(),
        "/nowhere/log.txt: unknown kind of file; name it .npz, .csv, .mat, .mcap or .db3"
    );
    let absent = data::read(path.with_extension("CSV")).unwrap_err();
    assert!(
        matches!(&absent.problem, Problem::Io(e) if e.kind() == std::io::ErrorKind::NotFound),
        "{absent}"
    );
}

#[test]
fn stamps_printed_in_single_precision_are_uniform() {
    let mut text = "t,q\n".to_owned();
    for k in 0..2000 {
        text += &format!("{},0\n", 3.0_f32 + k as f32 * 0.01);
    }
    let data = accept(&text);
    assert_eq!((data.h, data.samples()), (0.01, 2000));
}

#[test]
fn semicolons_and_tabs_separate_as_commas_do() {
    let text = "# h = 0.5\n\"q0\",q1,_note,u0,u1\n1,2,a,3,-4.5\n5,6,b,7,8\n9,1,c,2,3e-1\n";
    let expected = accept(text);
    for separator in [";", "\t", " ; "] {
        assert_eq!(accept(&text.replace(',', separator)), expected, "{separator:?}");
    }
    // A single column needs no separator.
    assert_eq!(accept("# h = 1\n# a;b;c\nq\n1\n2\n3\n").n, 1);
    assert_eq!(refuse("t;q0;q0\n0;1;1\n"), ", line 1: column q0 stands twice; remove one");
}

#[test]
fn decimal_commas_are_read_where_they_can_be_nothing_else() {
    let expected = accept("t,q\n0.000,-1.25\n0.010,1.5e-3\n0.020,3\n");
    assert_eq!(accept("t;q\n0,000;-1,25\n0,010;1,5e-3\n0,020;3\n"), expected);
    assert_eq!(accept("t\tq\n0,000\t-1,25\n0,010\t1,5e-3\n0,020\t3\n"), expected);
    let doubt =
        "may be a decimal one or separate thousands; write decimal points and no thousands separators";
    assert_refused(&[
        ("t;q\n0;1\n1;1,500\n2;1\n", &format!(", line 3, column q: the comma of \"1,500\" {doubt}")),
        ("t;q\n0.5;1\n1,5;1\n2.5;1\n", &format!(", line 3, column t: the comma of \"1,5\" {doubt}")),
        ("t;q\n0;1.500,5\n1;1\n2;1\n", ", line 2, column q: \"1.500,5\" is not a number; write 1.5 or -2e-3"),
        (
            "t,q\n0,0,1,5\n0,1,2,5\n",
            ", line 2: 4 cells where the header names 2 columns; if they are decimal commas, write points, or separate the columns \
             by semicolons",
        ),
    ]);
}

/// UTF-16 with a byte order mark.
fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    [0xFEFF].into_iter().chain(text.encode_utf16()).flat_map(bytes).collect()
}

#[test]
fn utf_16_is_read_by_its_mark() {
    let text = "# Messung 3 µm\r\nt\tq\r\n0\t1\r\n1\t2\r\n2\t5\r\n";
    let expected = accept(text);
    for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        assert_eq!(read(&utf16(text, bytes)).unwrap().0, expected);
    }
}

#[test]
fn what_is_no_text_is_refused() {
    let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
    let whole = utf16("t,q\n0,1\n", u16::to_le_bytes);
    let cut = message(&whole[..whole.len() - 1]);
    assert!(cut.contains("(it begins as UTF-16 but does not go on so); save it as UTF-8"), "{cut}");
    let unmarked = message(&whole[2..]);
    assert!(unmarked.contains("not readable as text (it contains bytes that are zero)"), "{unmarked}");
}
