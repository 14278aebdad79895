//! CSV files as loggers lay them out: units, headers that come again, blanks between columns, no header, no time, time in
//! two columns or as dates, columns of several rates.

use leastaction_core::forces::ControlKind;
use leastaction_data::{
    Column, Columns, DataError, Dataset, LayoutNote, Note, Reading, Term, decode, decode_as,
};
use std::fmt::Write as _;

fn columns(t: &str, q: &str, u: &str) -> Columns {
    let (t, q, u) = (Column::si(t), vec![Column::si(q)], vec![Column::si(u)]);
    Columns { t, q, v: Vec::new(), u, actuation: None }
}

fn read_as(text: &str, reading: &Reading) -> Result<(Dataset, Vec<Note>), DataError> {
    decode_as("log.csv", text.as_bytes(), reading)
}

fn reading(columns: Columns) -> Reading {
    Reading { columns: Some(columns), ..Reading::default() }
}

fn read(text: &str) -> (Dataset, Vec<Note>) {
    read_as(text, &reading(columns("time", "pos", "tau"))).unwrap()
}

fn refused(text: &str, reading: &Reading) -> String {
    read_as(text, reading).unwrap_err().to_string()
}

const PLAIN: &str = "time,pos,tau\n0.00,1,4\n0.01,2,5\n0.02,3,6\n";

/// `numpy.savetxt` writes its header as a comment, separated as the numbers are.
#[test]
fn a_header_in_a_comment_names_the_columns() {
    let plain = read(PLAIN).0;
    for text in [
        "# a note\n# time,pos,tau\n0.00,1,4\n0.01,2,5\n0.02,3,6\n",
        "# time pos tau\n0.00 1 4\n0.01 2 5\n0.02 3 6\n",
        "#time\tpos\ttau\n0.00\t1\t4\n0.01\t2\t5\n0.02\t3\t6\n",
    ] {
        assert_eq!(read(text).0, plain, "{text}");
    }
    let numbered = reading(columns("#1", "#2", "#3"));
    for comment in ["# h = 0.05", "# written in three words more", "# 1 2 3"] {
        let text = PLAIN.replace("time,pos,tau", comment);
        let stated = read_as(&text, &numbered);
        assert!(stated.is_ok() || comment.contains('='), "{comment}: {stated:?}");
        assert!(refused(&text, &reading(columns("time", "pos", "tau"))).contains("no header"), "{comment}");
    }
    // A header that is none of a comment stays.
    let both = read(&format!("# x,y,z\n{PLAIN}")).0;
    assert_eq!(both, plain);
}

#[test]
fn cells_after_the_last_column_are_blank_or_refused() {
    let plain = read(PLAIN).0;
    assert_eq!(read("time,pos,tau\n0.00,1,4,\n0.01,2,5,\n0.02,3,6,\n").0, plain);
    assert_eq!(read("time,pos,tau,\n0.00,1,4,\n0.01,2,5\n0.02,3,6,\n,,,\n\n").0, plain);
    let native = decode("log.csv", b"t,q,u,\n0.00,1,4,\n0.01,2,5,\n0.02,3,6,\n").unwrap().0;
    assert_eq!(native, decode("log.csv", b"t,q,u\n0.00,1,4\n0.01,2,5\n0.02,3,6\n").unwrap().0);
    let beyond = refused("time,pos,tau\n0,1,4,7\n1,2,5\n2,3,6\n", &reading(columns("time", "pos", "tau")));
    assert!(beyond.contains("line 2: 4 cells where the header names 3"), "{beyond}");
}

#[test]
fn a_line_of_units_is_left_out() {
    let (data, notes) = read("time,pos,tau\ns,rad,Nm\n0.00,1,4\n0.01,2,5\n0.02,3,6\n");
    assert_eq!(data, read(PLAIN).0);
    let units = LayoutNote::UnitsLine { line: 2, units: "s, rad, Nm".to_owned() };
    assert_eq!(notes, [Note::Layout(units)]);
}

#[test]
fn a_header_that_comes_again_begins_a_trajectory() {
    let text = format!("{PLAIN}time,pos,tau\n{PLAIN}");
    let (data, notes) = read(&text);
    assert_eq!(data.trajectories.iter().map(|t| (t.id, t.samples())).collect::<Vec<_>>(), [(0, 3), (1, 3)]);
    assert_eq!(data.trajectories[0].q, data.trajectories[1].q);
    assert_eq!(notes, [Note::Layout(LayoutNote::HeaderAgain { line: 5, times: 1 })]);
}

#[test]
fn a_last_line_that_was_cut_off_is_left_out() {
    for cut in ["0.03,", "0.03", "0.03,1,-", "0.03,1,2e"] {
        let (data, notes) = read(&format!("{PLAIN}{cut}"));
        assert_eq!(data, read(PLAIN).0, "{cut}");
        assert_eq!(notes, [Note::Layout(LayoutNote::CutOff { line: 5 })], "{cut}");
    }
    let within = refused(&format!("{PLAIN}0.03,1\n0.04,1,2\n"), &reading(columns("time", "pos", "tau")));
    assert!(within.contains("line 5: 2 cells where the header names 3"), "{within}");
}

#[test]
fn blanks_separate_where_nothing_else_does() {
    for blanks in [" ", "   ", "\t ", " \t"] {
        assert_eq!(read(&PLAIN.replace(',', blanks)).0, read(PLAIN).0, "{blanks:?}");
    }
    let aligned =
        "  time     pos    tau\n  0.00       1      4 \n  0.01       2      5\n\n  0.02       3      6\n";
    assert_eq!(read(aligned).0, read(PLAIN).0);
    assert_eq!(read("# of the arm\ntime pos\ttau\n0,00 1 4\n0,01 2 5\n0,02 3 6\n").0, read(PLAIN).0);
}

#[test]
fn columns_without_a_header_have_numbers() {
    let bare = PLAIN.split_once('\n').unwrap().1;
    let numbered = reading(columns("#1", "#2", "#3"));
    for text in [bare.to_owned(), bare.replace(',', " "), bare.replace(',', ";").replace('.', ",")] {
        assert_eq!(read_as(&text, &numbered).unwrap().0, read(PLAIN).0, "{text}");
    }
    assert_eq!(read_as(PLAIN, &numbered).unwrap().0, read(PLAIN).0);
    let named = refused(bare, &reading(columns("time", "pos", "tau")));
    assert!(named.contains("no header line that names \"pos\"") && named.contains("q = [2, 3]"), "{named}");
    let beyond = refused(bare, &reading(columns("#1", "#2", "#4")));
    assert!(beyond.contains("from 1 to 3"), "{beyond}");
    let native = decode("log.csv", bare.as_bytes()).unwrap_err().to_string();
    assert!(native.contains("no header line"), "{native}");
}

#[test]
fn a_rate_stands_in_for_time() {
    let text = "pos,tau\n1,4\n2,5\n3,6\n";
    let at = |rate| Reading { rate, ..reading(columns("t", "pos", "tau")) };
    let (data, _) = read_as(text, &at(Some(100.0))).unwrap();
    assert_eq!((data.h, &data.trajectories[0].q), (0.01, &read(PLAIN).0.trajectories[0].q));
    let missing = refused(text, &at(None));
    assert!(missing.contains("rate") && missing.contains("pos, tau"), "{missing}");
    let both = refused(&PLAIN.replace("time", "t"), &at(Some(100.0)));
    assert!(both.contains("the file has a time, \"t\""), "{both}");
    let native = Reading { rate: Some(100.0), ..Reading::default() };
    assert_eq!(read_as("q,u\n1,4\n2,5\n3,6\n", &native).unwrap().0.h, 0.01);
    assert!(refused("# h = 1\nq,u\n1,4\n2,5\n3,6\n", &native).contains("the file has a time, \"h\""));
}

#[test]
fn seconds_and_nanoseconds_are_one_time() {
    let mut text = "sec,nanosec,pos,tau\n".to_owned();
    for k in 0..250 {
        let (sec, nanosec) = (1_700_000_000 + k / 100, k % 100 * 10_000_000);
        writeln!(text, "{sec},{nanosec},{k},1").unwrap();
    }
    let plus = vec![Term { name: "nanosec".to_owned(), scale: 1e-9 }];
    let t = Column { plus, ..Column::si("sec") };
    let (data, notes) = read_as(&text, &reading(Columns { t, ..columns("", "pos", "tau") })).unwrap();
    assert_eq!((data.h, data.samples(), notes), (0.01, 250, Vec::new()));
}

#[test]
fn dates_are_time() {
    let stamps = ["23:59:59.98Z", "23:59:59.99Z", "24:00:00Z"].map(|time| format!("2023-12-31T{time}"));
    let stamps = [&stamps[0], &stamps[1], "2024-01-01 02:00:00,00+02:00"].map(|stamp| format!("\"{stamp}\""));
    let text = format!("time,pos,tau\n{},1,4\n{},2,5\n{},3,6\n", stamps[0], stamps[1], stamps[2]);
    let (data, _) = read(&text);
    assert_eq!((data.h, data.trajectories[0].t0), (0.01, 1_704_067_199.98));
    assert_eq!(data.trajectories[0].q, read(PLAIN).0.trajectories[0].q);
}

/// A log of two sensors at 100 Hz, the second 3 ms after the first, below this header; `before` begins each line.
fn of_two_rates(header: &str, before: &str) -> String {
    let mut text = format!("{header}\n");
    for k in 0..100 {
        writeln!(text, "{before}{:.3},{k},,", 0.01 * f64::from(k)).unwrap();
        writeln!(text, "{before}{:.3},,{},", 0.01 * f64::from(k) + 0.003, 2 * k).unwrap();
    }
    text
}

fn linear() -> Reading {
    Reading { control: Some(ControlKind::Linear), ..reading(columns("time", "pos", "tau")) }
}

#[test]
fn columns_of_several_rates_are_joined() {
    let (text, linear) = (of_two_rates("time,pos,tau,mode", ""), linear());
    let (data, notes) = read_as(&text, &linear).unwrap();
    let motion = &data.trajectories[0];
    assert_eq!((data.h, motion.samples(), motion.q[0][0]), (0.01, 99, 1.0));
    let u = motion.u.as_ref().unwrap();
    assert!((0..99).all(|k| (u[k][0] - (2.0 * (k as f64 + 1.0) - 0.6)).abs() < 1e-9), "{u:?}");
    let blanks = |column: &str| {
        Note::Layout(LayoutNote::Blanks { column: column.to_owned(), numbers: 100, rows: 200 })
    };
    assert_eq!(notes, [blanks("pos"), blanks("tau"), Note::Uncovered { samples: 1 }]);
}

#[test]
fn columns_of_several_rates_are_joined_in_every_trajectory() {
    let one = of_two_rates("time,pos,tau,mode", "");
    let single = read_as(&one, &linear()).unwrap().0;
    let (data, notes) = read_as(&format!("{one}{one}"), &linear()).unwrap();
    assert_eq!(data.trajectories.iter().map(|t| t.id).collect::<Vec<_>>(), [0, 1]);
    for motion in &data.trajectories {
        assert_eq!((&motion.q, &motion.u), (&single.trajectories[0].q, &single.trajectories[0].u));
        assert_eq!(motion.t0, 0.01);
    }
    assert_eq!(notes.first(), Some(&Note::Layout(LayoutNote::HeaderAgain { line: 202, times: 1 })));
    assert_eq!(notes.last(), Some(&Note::Uncovered { samples: 2 }));
    let without: String = one
        .lines()
        .filter(|line| !line.trim_end_matches(',').contains(",,"))
        .fold(String::new(), |all, line| all + line + "\n");
    let dead = refused(&format!("{one}{without}"), &linear());
    assert!(dead.contains("line 203: tau has no numbers from here"), "{dead}");
}

#[test]
fn blanks_below_names_of_our_own_are_read_as_below_others() {
    let named = read_as(&of_two_rates("time,pos,tau,mode", ""), &linear()).unwrap().0;
    let native = Reading { columns: None, ..linear() };
    let (data, notes) = read_as(&of_two_rates("t,q,u,_mode", ""), &native).unwrap();
    assert_eq!(data, named);
    assert_eq!(notes.last(), Some(&Note::Uncovered { samples: 1 }));
    let parted = of_two_rates("trajectory,t,q,u,", "7,") + &of_two_rates("", "9,");
    let (data, _) = read_as(&parted, &native).unwrap();
    assert_eq!(data.trajectories.iter().map(|t| (t.id, t.samples())).collect::<Vec<_>>(), [(7, 99), (9, 99)]);
    assert_eq!(data.trajectories[1].u, named.trajectories[0].u);
    // Velocities and accelerations stay apart.
    let rows = "t,q0,v0,a0,u0\n0,1,2,3,\n1,2,3,4,7\n2,3,4,5,8\n3,4,5,6,9\n";
    let (data, _) = read_as(rows, &native).unwrap();
    let motion = &data.trajectories[0];
    let flat = |rows: &Option<leastaction_data::Rows>| rows.as_ref().unwrap().as_flat().to_vec();
    assert_eq!(
        (motion.q.as_flat(), flat(&motion.v), flat(&motion.a), flat(&motion.u)),
        (&[2.0, 3.0, 4.0][..], vec![3.0, 4.0, 5.0], vec![4.0, 5.0, 6.0], vec![7.0, 8.0, 9.0])
    );
    let stepless = refused("q,u\n1,\n2,3\n3,4\n", &native);
    assert!(stepless.contains("# h = 0.05"), "{stepless}");
}

#[test]
fn a_column_without_numbers_is_left_out_if_it_is_a_velocity() {
    let with_v = Columns { v: vec![Column::si("vel")], ..columns("time", "pos", "tau") };
    for dead in ["nan", ""] {
        let text = format!("time,pos,vel,tau\n0.00,1,{dead},4\n0.01,2,{dead},5\n0.02,3,{dead},6\n");
        let (data, notes) = read_as(&text, &reading(with_v.clone())).unwrap();
        assert_eq!(data, read(PLAIN).0);
        assert_eq!(notes, [Note::Layout(LayoutNote::NoVelocity { column: "vel".to_owned() })]);
        let needed = refused(&text, &reading(columns("time", "vel", "tau")));
        assert!(
            needed.contains("vel") && (needed.contains("has no numbers") || needed.contains("NaN")),
            "{needed}"
        );
    }
    let once = refused("time,pos,vel,tau\n0,1,nan,4\n1,2,3,5\n2,3,4,6\n", &reading(with_v));
    assert!(once.contains("line 2, column vel: NaN is not finite"), "{once}");
}

#[test]
fn sums_of_columns_and_offsets() {
    let wrist = Column {
        offset: -0.5,
        plus: vec![Term { name: "m5".to_owned(), scale: -1.0 }],
        ..Column::scaled("m6", 0.5)
    };
    let columns = Columns { q: vec![wrist], ..columns("time", "", "tau") };
    let text = "time,m5,m6,tau\n0.00,1,8,4\n0.01,2,8,5\n0.02,3,16,6\n";
    let (data, _) = read_as(text, &reading(columns)).unwrap();
    assert_eq!(data.trajectories[0].q.as_flat(), [2.5, 1.5, 4.5]);
}
