//! Tests for the ownership of a folder by a run.

use super::tests::{Warned, config, data, scaled};
use super::*;
use crate::checkpoint::Trained;
use std::fs;
use std::path::PathBuf;

static GO: AtomicBool = AtomicBool::new(false);
static STOP: AtomicBool = AtomicBool::new(true);

fn plan() -> Plan {
    Plan::new(config(), &data(3, true)).unwrap()
}

/// A plan for positions that no step can reach.
fn hopeless() -> Plan {
    Plan::new(config(), &scaled(1e11)).unwrap()
}

/// A folder with a trained run.
fn trained() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    Run::begin(plan(), folder.path(), false).unwrap().train(&mut Warned::default(), &GO).unwrap();
    folder
}

/// All files of a folder but the lock.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = paths.filter(|path| !path.ends_with(crate::lock::FILE)).collect();
    files.sort();
    files.into_iter().map(|path| (path.clone(), fs::read(path).unwrap())).collect()
}

#[test]
fn one_run_at_a_time_writes_to_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let run = Run::begin(plan(), folder.path(), false).unwrap();
    for force in [false, true] {
        let error = Run::begin(plan(), folder.path(), force).err().unwrap().to_string();
        let path = folder.path().display().to_string();
        assert!(error.contains(&path) && error.contains("another process is writing"), "{error}");
        assert!(error.contains("wait until it has ended, or choose another folder"), "{error}");
    }
    assert!(matches!(Run::resume(plan(), folder.path()), Err(RunError::Folder { .. })));
    drop(run);
    Run::resume(plan(), folder.path()).unwrap();
}

#[test]
fn a_run_that_is_refused_leaves_no_lock() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing");
    assert!(matches!(Run::resume(plan(), &missing), Err(RunError::Resume(_))));
    fs::write(folder.path().join("mine"), "mine").unwrap();
    assert!(matches!(Run::begin(plan(), folder.path(), false), Err(RunError::Exists { .. })));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn the_earlier_run_stays_until_there_is_a_finite_loss() {
    let folder = trained();
    let before = files(folder.path());
    let mut stopped = Run::begin(plan(), folder.path(), true).unwrap();
    assert_eq!(stopped.train(&mut Warned::default(), &STOP).unwrap(), Ending::Interrupted);
    assert_eq!((stopped.saved(), files(folder.path())), (None, before.clone()));
    drop(stopped);
    let mut stuck = Run::begin(hopeless(), folder.path(), true).unwrap();
    assert!(matches!(stuck.train(&mut Warned::default(), &GO), Err(RunError::Stuck { .. })));
    drop(stuck);
    assert_eq!(files(folder.path()), before);
    let mut other = config();
    other.training.seed = 9;
    let other = || Plan::new(other.clone(), &data(3, true)).unwrap();
    let mut run = Run::begin(other(), folder.path(), true).unwrap();
    run.train(&mut Warned::default(), &GO).unwrap();
    let (replaced, fresh) = (run.state.clone(), tempfile::tempdir().unwrap());
    drop(run);
    assert_eq!(Run::resume(other(), folder.path()).unwrap().state, replaced);
    Run::begin(other(), fresh.path(), false).unwrap().train(&mut Warned::default(), &GO).unwrap();
    let [ours, theirs] = [folder.path(), fresh.path()].map(|path| Trained::read(path).unwrap());
    assert_eq!(ours, theirs);
    let rows = |path: &Path| fs::read_to_string(path.join("history.csv")).unwrap().lines().count();
    assert_eq!(rows(folder.path()), rows(fresh.path()));
}

#[test]
fn files_that_are_no_run_are_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("config.toml"), "mine").unwrap();
    let error = Run::begin(plan(), folder.path(), true).err().unwrap().to_string();
    assert!(error.contains("no run to replace") && error.contains("config.toml"), "{error}");
    assert_eq!(files(folder.path()).len(), 1);
}

#[test]
fn what_learned_nothing_is_no_model() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Run::begin(hopeless(), folder.path(), false).unwrap();
    run.train(&mut Warned::default(), &GO).unwrap_err();
    assert!(!Trained::read(folder.path()).unwrap().best.is_a_model());
    assert!(Trained::read(trained().path()).unwrap().best.is_a_model());
    for weight in [f64::NAN, f64::INFINITY] {
        let mut best = run.best().clone();
        (best.solves_nothing, best.train) = (false, 1.0);
        assert!(best.is_a_model());
        best.weights[0] = weight;
        assert!(!best.is_a_model());
        assert!(!Best { train: weight, ..run.best().clone() }.is_a_model());
    }
}
