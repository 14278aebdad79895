//! Logs as robots write them: names and units of their own, uneven stamps, several files.

use leastaction_core::forces::ControlKind;
use leastaction_data::{
    Column, Columns, Dataset, Join, LeftOut, Note, Problem, Reading, Rows, Trajectory, files, read_as,
    read_logs, unit, write,
};
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Two joints, with a drive on the first; degrees, milliseconds, the second encoder mounted backwards.
fn columns() -> Columns {
    let column = |name: &str, scale: f64| Column::scaled(name, scale);
    let deg = unit("deg").unwrap();
    Columns {
        t: column("time [ms]", 1e-3),
        q: vec![column("shoulder", deg), column("elbow", -deg)],
        v: Vec::new(),
        u: vec![Column::si("torque")],
        actuation: Some(vec![vec![1.0], vec![0.0]]),
    }
}

/// q₀ = t, q₁ = 2t, u = 3, at stamps that jitter by a tenth around 5 ms.
fn log(samples: usize, separator: char) -> String {
    let mut text = ["elbow", "mode", "time [ms]", "torque", "shoulder"].join(&separator.to_string()) + "\n";
    for k in 0..samples {
        let t = 5.0 * (k as f64 + 0.1 * ((k * 7 % 5) as f64 / 5.0));
        let degrees = |q: f64| (q * t / 1000.0).to_degrees();
        let cells = [-degrees(2.0), 7.0, t, 3.0, degrees(1.0)].map(|x| format!("{x:?}"));
        writeln!(text, "{}", cells.join(&separator.to_string())).unwrap();
    }
    text
}

fn written(folder: &Path, name: &str, text: &str) -> PathBuf {
    let file = folder.join(name);
    std::fs::write(&file, text).unwrap();
    file
}

fn reading() -> Reading {
    Reading { columns: Some(columns()), ..Reading::default() }
}

#[test]
fn columns_are_named_scaled_and_turned() {
    let folder = tempfile::tempdir().unwrap();
    for separator in [',', ';', '\t'] {
        let (data, notes) =
            read_as(&written(folder.path(), "a.csv", &log(80, separator)), &reading()).unwrap();
        assert_eq!((data.n, data.h), (2, 5e-3));
        let trajectory = &data.trajectories[0];
        for (t, q) in data.times(trajectory).zip(trajectory.q.iter()) {
            assert!((q[0] - t).abs() < 1e-12 && (q[1] - 2.0 * t).abs() < 1e-12, "{t}: {q:?}");
        }
        let u = trajectory.u.as_ref().unwrap();
        assert!(u.iter().all(|u| (u[0] - 3.0).abs() < 1e-12 && u[1] == 0.0));
        assert!(matches!(notes[..], [Note::Resampled(_)]), "{notes:?}");
    }
}

#[test]
fn files_of_a_pattern_are_one_log() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["10.csv", "02.csv", "other.txt"] {
        written(folder.path(), name, &log(50, ','));
    }
    let found = files(&[folder.path().join("*.csv")]).unwrap();
    let names: Vec<_> = found.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["02.csv", "10.csv"]);
    let (data, notes) = read_logs(&found, &reading()).unwrap();
    assert_eq!(data.trajectories.iter().map(|t| t.id).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(notes.iter().map(|(file, _)| file).collect::<Vec<_>>(), found.iter().collect::<Vec<_>>());
    let none = files(&[folder.path().join("*.npz")]).unwrap_err();
    assert!(matches!(none.problem, Problem::NoFile) && none.to_string().contains("*.npz"), "{none}");
}

#[test]
fn files_of_different_steps_need_one_named() {
    let folder = tempfile::tempdir().unwrap();
    let slow = "time [ms],shoulder,elbow,torque\n0,0,0,1\n10,1,1,1\n20,2,2,1\n30,3,3,1\n40,4,4,1\n";
    let all = [written(folder.path(), "a.csv", &log(50, ',')), written(folder.path(), "b.csv", slow)];
    let error = read_logs(&all, &reading()).unwrap_err();
    assert!(
        error.to_string().contains("b.csv: the step is 0.01 s where")
            && error.to_string().contains("step under [data]"),
        "{error}"
    );
    let (data, _) = read_logs(&all, &Reading { step: Some(0.01), ..reading() }).unwrap();
    assert_eq!(data.h, 0.01);
    assert!((data.trajectories[1].q[2][0] - 2.0 * PI / 180.0).abs() < 1e-15);
}

#[test]
fn what_is_not_there_is_named_with_what_is() {
    let folder = tempfile::tempdir().unwrap();
    let file = written(folder.path(), "a.csv", "time [ms],shoulder,torque\n0,1,2\n5,1,2\n10,1,2\n");
    let error = read_as(&file, &reading()).unwrap_err().to_string();
    assert!(
        error.contains("\"elbow\"") && error.contains("the file has time [ms], shoulder, torque"),
        "{error}"
    );
    let one = Columns { q: vec![Column::si("shoulder")], ..columns() };
    let error =
        read_as(&file, &Reading { columns: Some(one), ..Reading::default() }).unwrap_err().to_string();
    assert!(error.contains("actuation has 2 rows where 1 are needed"), "{error}");
    assert!(Columns { q: Vec::new(), ..columns() }.check().is_err());
    let nothing_left = Columns { q: vec![Column::scaled("shoulder", 0.0)], ..columns() };
    assert!(nothing_left.check().unwrap_err().contains("shoulder"));
}

#[test]
fn arrays_of_an_archive_are_named_with_an_index() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.npz");
    let q = Rows::from_rows(2, (0..40).map(|k| [f64::from(k), f64::from(2 * k)])).unwrap();
    let trajectory = Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u: None };
    write(&file, &Dataset { n: 2, h: 10.0, control: None, trajectories: vec![trajectory] }).unwrap();
    let of = |names: &[&str]| Columns {
        t: Column::scaled("t", 1e-3),
        q: names.iter().map(|name| Column::si(*name)).collect(),
        v: Vec::new(),
        u: Vec::new(),
        actuation: None,
    };
    let read = |names: &[&str]| {
        read_as(
            &file,
            &Reading { columns: Some(of(names)), control: Some(ControlKind::Linear), ..Reading::default() },
        )
    };
    let (all, _) = read(&["q"]).unwrap();
    let (turned, _) = read(&["q[1]", "q[0]"]).unwrap();
    assert_eq!((all.n, all.h, all.control), (2, 0.01, Some(ControlKind::Linear)));
    assert_eq!((&all.trajectories[0].q[3], &turned.trajectories[0].q[3]), (&[3.0, 6.0][..], &[6.0, 3.0][..]));
    let mut mixed = of(&["q", "q[0]"]);
    mixed.q[1].scale = -2.0;
    let (mixed, _) = read_as(&file, &Reading { columns: Some(mixed), ..Reading::default() }).unwrap();
    assert_eq!(mixed.trajectories[0].q[3], [3.0, 6.0, -6.0]);
    assert!(read(&["q[2]"]).unwrap_err().to_string().contains("there is no column 2; it has 2"));
    assert!(read(&["joint"]).unwrap_err().to_string().contains("the file has q, t, h, trajectory"));
}

#[test]
fn files_of_mixed_columns_are_refused_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let first = written(folder.path(), "a.csv", &log(50, ','));
    let said = |text: &str| {
        let second = written(folder.path(), "b.csv", text);
        read_logs(&[first.clone(), second], &reading()).unwrap_err().to_string()
    };
    let missing = said("time [ms],shoulder,torque\n0,1,2\n5,1,2\n10,1,2\n");
    assert!(missing.contains("b.csv, line 1: there is no column \"elbow\""), "{missing}");
    let wider = said("time [ms],shoulder,elbow,torque\n0,1,2,3\n5,1,2,3\n10,1,2,3,4\n");
    assert!(wider.contains("b.csv, line 4: 5 cells where the header names 4 columns"), "{wider}");
    let twice = said("time [ms],shoulder,elbow,elbow,torque\n0,1,2,3,4\n");
    assert!(twice.contains("b.csv, line 1: column elbow stands twice"), "{twice}");
    let unknown = written(folder.path(), "c.log", "");
    assert!(
        read_logs(&[first, unknown], &reading())
            .unwrap_err()
            .to_string()
            .contains("name it .npz, .csv, .mat, .mcap or .db3")
    );
}

#[test]
fn absurd_rates_and_spans_of_stamps_are_refused_or_bounded() {
    let folder = tempfile::tempdir().unwrap();
    let with = |stamps: &[f64], step: Option<f64>| {
        let mut text = "time [ms],shoulder,elbow,torque\n".to_owned();
        stamps.iter().for_each(|t| writeln!(text, "{t:e},1,2,3").unwrap());
        read_as(&written(folder.path(), "a.csv", &text), &Reading { step, ..reading() })
    };
    let years: Vec<f64> = (0..9).map(|k| 1e13 * f64::from(k)).collect();
    let error = with(&years, Some(1e-6)).unwrap_err().to_string();
    assert!(error.contains("less than a tenth of the"), "{error}");
    let mixed: Vec<f64> = (0..9).map(|k| 1e-3 * f64::from(k)).chain([1e300, 2e300]).collect();
    let (data, _) = with(&mixed, Some(2e-6)).unwrap();
    assert!(data.samples() <= 9, "{}", data.samples());
    assert!(with(&[0.0, 1e-300, 2e-300, 3e-300], Some(0.01)).is_err());
    assert!(with(&[0.0, 0.0, 0.0, 0.0], None).is_err());
}

#[test]
fn files_of_one_recording_are_joined() {
    let folder = tempfile::tempdir().unwrap();
    for run in 1..=2 {
        let (mut encoders, mut torques) = ("t,q\n".to_owned(), "stamp,tau\n".to_owned());
        (0..50).for_each(|k| writeln!(encoders, "{},{k}", 0.01 * f64::from(k)).unwrap());
        (0..260).for_each(|k| writeln!(torques, "{},{}", 2 * k, run * k).unwrap());
        written(folder.path(), &format!("encoders-{run}.csv"), &encoders);
        written(folder.path(), &format!("torques-{run}.csv"), &torques);
    }
    let columns = Columns {
        t: Column::si("t"),
        q: vec![Column::si("q")],
        v: Vec::new(),
        u: vec![Column::scaled("torque:tau", 0.5)],
        actuation: None,
    };
    let t = Column::scaled("stamp", 1e-3);
    let join =
        Join { name: "torque".to_owned(), replace: "encoders".to_owned(), by: "torques".to_owned(), t };
    let reading = Reading { columns: Some(columns), joins: vec![join], ..Reading::default() };
    let all = files(&[folder.path().join("encoders-*.csv")]).unwrap();
    let (data, notes) = read_logs(&all, &reading).unwrap();
    assert_eq!((data.h, data.trajectories.len(), notes.len()), (0.01, 2, 0));
    for (run, motion) in (1..).zip(&data.trajectories) {
        // The mean of 5k, …, 5k + 4, times the number of the run, in half newton metres.
        let u = motion.u.as_ref().unwrap();
        assert!((u[7][0] - 0.5 * f64::from(run) * 37.0).abs() < 1e-12, "{}", u[7][0]);
    }
    written(folder.path(), "torques-2.csv", "stamp,tau\n0,1\n2,x\n");
    let error = read_logs(&all, &reading).unwrap_err().to_string();
    assert!(error.contains("torques-2.csv, line 3, column tau"), "{error}");
    let other = written(folder.path(), "positions.csv", "t,q\n0,1\n1,2\n2,3\n");
    let error = read_as(&other, &reading).unwrap_err().to_string();
    assert!(error.contains("\"encoders\" is not in its name") && error.contains("\"torque\""), "{error}");
}

#[test]
fn intervals_of_time_are_left_out_as_gaps_are() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["a.csv", "b.csv"];
    let all = names.map(|name| written(folder.path(), name, &log(200, ',')));
    let of = |file: Option<&str>, from: f64, to: f64| LeftOut { file: file.map(PathBuf::from), from, to };
    // Samples are 5 ms apart, with a jitter of less than half a millisecond.
    let leave_out =
        vec![of(None, 0.2, 0.2995), of(Some("b.csv"), 0.5, f64::INFINITY), of(Some("c.csv"), 0.0, 9.0)];
    let reading = Reading { leave_out, ..reading() };
    let (data, notes) = read_logs(&all, &reading).unwrap();
    let spans: Vec<_> = data.trajectories.iter().map(|motion| (motion.t0, motion.samples())).collect();
    let starts: Vec<_> = spans.iter().map(|(t0, _)| (t0 / 5e-3).round()).collect();
    assert_eq!(starts, [0.0, 60.0, 0.0, 60.0], "{spans:?}");
    assert!(spans[1].1 > 138 && (39..=40).contains(&spans[3].1), "{spans:?}");
    let said: Vec<String> = notes.iter().map(|(_, note)| note.to_string()).collect();
    assert!(said.iter().any(|said| said.starts_with("left out 20 samples by time")), "{said:?}");
    assert!(said.iter().any(|said| said.starts_with("left out 120 samples by time")), "{said:?}");
    for motion in &data.trajectories {
        for (t, q) in data.times(motion).zip(motion.q.iter()) {
            assert!((q[0] - t).abs() < 1e-12, "positions of both sides of an interval were mixed");
        }
    }
    let nothing = Reading { leave_out: vec![of(None, -1.0, 99.0)], ..reading };
    assert!(read_as(&all[0], &nothing).unwrap_err().to_string().contains("no samples are left outside"));
}

#[test]
fn an_interval_shorter_than_a_gap_splits_as_well() {
    let folder = tempfile::tempdir().unwrap();
    let file = written(folder.path(), "a.csv", &log(100, ','));
    let leave_out = vec![LeftOut { file: None, from: 0.099, to: 0.101 }];
    for step in [None, Some(0.01)] {
        let (data, _) = read_as(&file, &Reading { leave_out: leave_out.clone(), step, ..reading() }).unwrap();
        assert_eq!(data.trajectories.len(), 2, "{step:?}");
        let end = data.times(&data.trajectories[0]).last().unwrap();
        assert!(end < 0.099 && data.trajectories[1].t0 > 0.101);
    }
}

#[test]
#[ignore = "reads LEASTACTION_REFERENCE"]
fn hardware_logs_are_read_as_they_are() {
    let folder =
        PathBuf::from(std::env::var_os("LEASTACTION_REFERENCE").unwrap()).join("hardware/double-pendulum");
    let all = files(&[folder.join("*.csv")]).unwrap();
    let columns = Columns {
        t: Column::si("time"),
        q: vec![Column::si("pos_meas1"), Column::si("pos_meas2")],
        v: Vec::new(),
        u: vec![Column::si("tau_con1"), Column::si("tau_con2")],
        actuation: None,
    };
    let (data, notes) = read_logs(&all, &Reading { columns: Some(columns), ..Reading::default() }).unwrap();
    assert_eq!((all.len(), data.n, data.h), (10, 2, 2e-3));
    assert!(notes.iter().any(|(_, note)| matches!(note, Note::Resampled(_))));
    let seconds: f64 = data.trajectories.iter().map(|t| t.samples() as f64 * data.h).sum();
    assert!((60.0..100.0).contains(&seconds), "{seconds}");
}
