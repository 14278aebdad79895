//! Damaged files: every truncation and every flipped bit gives an error or a consistent data set.

use std::fs;

use leastaction_core::forces::ControlKind;
use leastaction_data::{self as data, Dataset, Rows, Trajectory};
use rayon::prelude::*;

fn small() -> Dataset {
    let rows =
        |offset: f64| Rows::from_flat(2, (0..6).map(|k| offset + f64::from(k) / 3.0).collect()).unwrap();
    let motion = |id| Trajectory { id, t0: id as f64, q: rows(1.0), v: None, a: None, u: Some(rows(-0.5)) };
    Dataset { n: 2, h: 0.05, control: Some(ControlKind::Linear), trajectories: vec![motion(3), motion(1)] }
}

/// The whole file, and the length and content of every damaged file that is accepted.
fn damaged(extension: &str) -> (Vec<u8>, Vec<(usize, Dataset)>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log").with_extension(extension);
    data::write(&path, &small()).unwrap();
    let whole = fs::read(&path).unwrap();
    let accepted = |bytes: &[u8]| Some((bytes.len(), data::decode(&path, bytes).ok()?.0));
    let cut = (0..whole.len()).into_par_iter().filter_map(|length| accepted(&whole[..length]));
    let flipped = (0..8 * whole.len()).into_par_iter().filter_map(|bit| {
        let mut bytes = whole.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        accepted(&bytes)
    });
    let all = cut.chain(flipped).collect();
    (whole, all)
}

fn holds_together(data: &Dataset) {
    assert!(data.n > 0 && data.h.is_finite() && data.h > 0.0 && !data.trajectories.is_empty());
    for motion in &data.trajectories {
        assert!(motion.samples() >= data::MIN_SAMPLES && motion.t0.is_finite());
        for rows in
            [Some(&motion.q), motion.v.as_ref(), motion.a.as_ref(), motion.u.as_ref()].into_iter().flatten()
        {
            assert_eq!((rows.width(), rows.len()), (data.n, motion.samples()));
            assert!(rows.as_flat().iter().all(|x| x.is_finite()));
        }
    }
}

/// The container's checksums detect every change except those of its own dates and flags.
#[test]
fn archives() {
    let (whole, accepted) = damaged("npz");
    assert!(accepted.iter().all(|(_, data)| *data == small()));
    assert!(accepted.iter().all(|(length, _)| *length == whole.len()), "a cut archive was accepted");
}

/// Text has no checksum: an accepted file is another log, but a consistent one.
#[test]
fn text() {
    let (whole, accepted) = damaged("csv");
    accepted.iter().for_each(|(_, data)| holds_together(data));
    assert!(!accepted.is_empty() && accepted.len() < 4 * whole.len(), "{}", accepted.len());
}

/// Uneven stamps, named columns, and surveys give the same guarantees.
#[test]
fn logs_of_robots() {
    const WHOLE: &str = "time;enc;tau;mode\n0.00;100;0.5;on\n0.01;101;0.5;on\n0.021;103;-1;on\n0.03;104;-1;on\n0.041;106;2;on\n0.08;107;2;on\n";
    let folder = tempfile::tempdir().unwrap();
    let columns = data::Columns {
        t: data::Column::si("time"),
        q: vec![data::Column::scaled("enc", 1e-3)],
        v: Vec::new(),
        u: vec![data::Column::si("tau")],
        actuation: None,
    };
    let reading = data::Reading { columns: Some(columns), ..data::Reading::default() };
    let read = |bit: usize| {
        let mut bytes = WHOLE.as_bytes().to_vec();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let path = folder.path().join(format!("{bit}.csv"));
        fs::write(&path, bytes).unwrap();
        let looked = data::survey::RawLog::read(&path);
        assert!(looked.is_err() || looked.is_ok_and(|logs| data::survey::Guess::of(&logs).q.len() <= 4));
        data::read_as(&path, &reading).ok()
    };
    let accepted: Vec<_> = (0..8 * WHOLE.len()).into_par_iter().filter_map(read).collect();
    accepted.iter().for_each(|(data, _)| holds_together(data));
    assert!(!accepted.is_empty() && accepted.len() < 8 * WHOLE.len(), "{}", accepted.len());
}

/// Robot logs cut off at any place, surveyed and read by names.
#[test]
fn cut_logs_of_robots() {
    let folder = tempfile::tempdir().unwrap();
    let columns = |names: [&str; 3]| data::Columns {
        t: data::Column::si(names[0]),
        q: vec![data::Column::si(names[1])],
        v: Vec::new(),
        u: vec![data::Column::si(names[2])],
        actuation: None,
    };
    let text = "time;enc;tau\n0.00;100;0.5\n0.01;101;0.5\n0.021;103;-1\n0.03;104;-1\n0.041;106;2\n";
    let archive = folder.path().join("whole.npz");
    data::write(&archive, &small()).unwrap();
    let archive = fs::read(&archive).unwrap();
    for (whole, extension, names) in
        [(text.as_bytes(), "csv", ["time", "enc", "tau"]), (&archive, "npz", ["t", "q[0]", "u[1]"])]
    {
        let reading = data::Reading { columns: Some(columns(names)), ..data::Reading::default() };
        let accepted = (0..whole.len()).into_par_iter().filter_map(|length| {
            let path = folder.path().join(format!("{length}.{extension}"));
            fs::write(&path, &whole[..length]).unwrap();
            let looked = data::survey::RawLog::read(&path);
            assert!(looked.is_err() || looked.is_ok_and(|logs| data::survey::Guess::of(&logs).q.len() <= 4));
            match data::read_as(&path, &reading) {
                Ok((data, _)) => Some(data),
                Err(error) => {
                    assert!(error.to_string().contains(&format!("{length}.{extension}")), "{error}");
                    None
                }
            }
        });
        let accepted: Vec<_> = accepted.collect();
        accepted.iter().for_each(holds_together);
        assert!(accepted.len() < whole.len() / 2 && (extension == "csv" || accepted.is_empty()));
    }
}
