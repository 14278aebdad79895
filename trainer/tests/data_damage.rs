//! Damaged files: every truncation and every flipped bit gives an error or a data set that holds together.

use std::fs;

use leastaction::data::{self, Dataset, Rows, Trajectory};

fn small() -> Dataset {
    let rows =
        |offset: f64| Rows::from_flat(2, (0..6).map(|k| offset + f64::from(k) / 3.0).collect()).unwrap();
    let motion = |id| Trajectory { id, t0: id as f64, q: rows(1.0), v: None, a: None, u: Some(rows(-0.5)) };
    Dataset { n: 2, h: 0.05, trajectories: vec![motion(3), motion(1)] }
}

/// The whole file, and every damaged one that is accepted.
fn damaged(extension: &str, mut accepted: impl FnMut(usize, Dataset)) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log").with_extension(extension);
    data::write(&path, &small()).unwrap();
    let whole = fs::read(&path).unwrap();
    let mut attempt = |length: usize, bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        if let Ok((dataset, _)) = data::read(&path) {
            accepted(length, dataset);
        }
    };
    for length in 0..whole.len() {
        attempt(length, &whole[..length]);
    }
    for bit in 0..8 * whole.len() {
        let mut bytes = whole.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        attempt(bytes.len(), &bytes);
    }
    whole
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

/// The checksums of the container let nothing through but its own dates and flags.
#[test]
fn archives() {
    let mut accepted = Vec::new();
    let whole = damaged("npz", |length, data| {
        assert_eq!(data, small());
        accepted.push(length);
    });
    assert!(accepted.iter().all(|&length| length == whole.len()), "a cut archive was accepted");
}

/// Text has no checksum: what is accepted is another log, but a sound one.
#[test]
fn text() {
    let mut accepted = 0;
    let whole = damaged("csv", |_, data| {
        holds_together(&data);
        accepted += 1;
    });
    assert!(0 < accepted && accepted < 4 * whole.len(), "{accepted}");
}
