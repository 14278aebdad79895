//! The SyMo authors' data sets, in the folder that `LEASTACTION_REFERENCE` names.

use std::path::PathBuf;

use leastaction_data::symo::{self, SymoSet};
use leastaction_data::{self as data, Dataset, Place};

fn reference(name: &str) -> PathBuf {
    let folder =
        std::env::var_os("LEASTACTION_REFERENCE").expect("LEASTACTION_REFERENCE names the reference data");
    PathBuf::from(folder).join("symo").join(name)
}

/// Trajectories, samples of each, coordinates.
fn size(part: &Dataset) -> (usize, usize, usize) {
    let samples = part.trajectories[0].samples();
    assert!(part.trajectories.iter().all(|t| t.samples() == samples));
    (part.trajectories.len(), samples, part.n)
}

/// Largest difference between (q₊ − q₋)/2h and the given velocity, over all inner samples.
fn velocity_gap(part: &Dataset) -> f64 {
    let mut gap = 0.0_f64;
    for motion in &part.trajectories {
        let v = motion.v.as_ref().unwrap();
        for k in 1..motion.samples() - 1 {
            for i in 0..part.n {
                gap = gap.max(((motion.q[k + 1][i] - motion.q[k - 1][i]) / (2.0 * part.h) - v[k][i]).abs());
            }
        }
    }
    gap
}

fn check(set: &SymoSet, n: usize, actuated: usize) {
    assert_eq!(size(&set.train), (128, 34, n));
    assert_eq!(size(&set.test), (128, 34, n));
    assert_eq!(size(&set.integration), (16, 502, n));
    for motion in &set.train.trajectories {
        let u = motion.u.as_ref().unwrap();
        let control = u[0][actuated];
        assert!(control != 0.0 && control.abs() <= 2.0 && u.column(actuated).all(|x| x == control));
        assert!((0..n).filter(|&i| i != actuated).all(|i| u.column(i).all(|x| x == 0.0)));
    }
    let free = set
        .integration
        .trajectories
        .iter()
        .all(|t| t.u.as_ref().unwrap().as_flat().iter().all(|&u| u == 0.0));
    assert!(free);
}

#[test]
#[ignore = "needs the reference data"]
fn cart_pole() {
    let set = symo::read(reference("cartpole_h0.05_dataset.npz"), 0.05, 0).unwrap();
    check(&set, 2, 0);
    // Positions come first and h is right: central differences meet the velocities to second order.
    let gap = velocity_gap(&set.train);
    assert!(gap < 0.3, "{gap}");
}

#[test]
#[ignore = "needs the reference data"]
fn pendulum() {
    let set = symo::read(reference("pendulum_h0.1_dataset.npz"), 0.1, 0).unwrap();
    check(&set, 1, 0);
    let gap = velocity_gap(&set.train);
    assert!(gap < 0.6, "{gap}");
}

#[test]
#[ignore = "needs the reference data"]
fn written_back_it_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let set = symo::read(reference("cartpole_h0.05_dataset.npz"), 0.05, 0).unwrap();
    let path = folder.path().join("copy.npz");
    symo::write(&path, &set, 0).unwrap();
    assert_eq!(symo::read(&path, 0.05, 0).unwrap(), set);
    for name in ["part.npz", "part.csv"] {
        let path = folder.path().join(name);
        data::write(&path, &set.train).unwrap();
        assert_eq!(data::read(&path).unwrap(), (set.train.clone(), vec![]));
    }
}

#[test]
#[ignore = "needs the reference data"]
fn a_wrong_actuated_coordinate_or_step_is_refused() {
    let path = reference("cartpole_h0.05_dataset.npz");
    let error = symo::read(&path, 0.05, 2).unwrap_err();
    assert_eq!(error.place, Place::Key("train_u".to_owned()));
    assert!(symo::read(&path, 0.0, 0).is_err());
    let other = symo::read(reference("cartpole-SyMo-32.npz"), 0.05, 0).unwrap_err();
    assert!(other.to_string().ends_with(": train_x is missing"), "{other}");
}

#[test]
#[ignore = "needs the reference data"]
fn nothing_in_it_is_a_seam_or_in_doubt() {
    for (name, h, letters) in
        [("cartpole_h0.05_dataset.npz", 0.05, "ta"), ("pendulum_h0.1_dataset.npz", 0.1, "a")]
    {
        let set = symo::read(reference(name), h, 0).unwrap();
        for part in [&set.train, &set.test, &set.integration] {
            let mut straight = part.clone();
            assert_eq!(straight.unwrap_angles(letters), [], "{name}");
            assert_eq!(part.doubts(letters), [], "{name}");
        }
    }
}
