use super::*;
use crate::baselines::Mlp;
use crate::folder::FolderError;
use leastaction_learning::checksummed::ReadError;
use leastaction_learning::training::Schedule;
use std::fs;

/// Nineteen samples of one coordinate.
fn samples() -> Samples {
    let states = [0.1, 0.7, 1.3].map(|rate: f64| (0..19).map(|k| (rate * f64::from(k)).sin()).collect());
    Samples { n: 1, states, ..Samples::default() }
}

/// Recipe with five samples per step, so that their order matters.
const RECIPE: Recipe = Recipe {
    epochs: 9,
    adam: AdamSettings { learning_rate: 1e-2, batch: 5, schedule: Schedule::Constant, decay: 0.0, seed: 3 },
};

fn train(limits: Limits, interrupted: Option<&Interrupted>) -> Result<Trained, TaskError> {
    let mlp = Mlp::of_width("a", 7).unwrap();
    RECIPE.train(&mlp, samples(), (2, Bounds { limits, interrupted }), &|_| ())
}

/// Trains the first four epochs, and leaves them in a folder.
fn interrupt(folder: &tempfile::TempDir) -> Interrupted {
    let interrupted = Interrupted::new(folder.path(), "mlp", "settings".to_owned());
    let first = train(Limits { epochs: Some(4), time: None }, Some(&interrupted)).unwrap();
    assert_eq!((first.epochs, first.ending), (4, Ending::Complete));
    interrupted
}

#[test]
fn interrupted_training_ends_with_the_bits_of_uninterrupted() {
    let folder = tempfile::tempdir().unwrap();
    let interrupted = interrupt(&folder);
    let before = interrupted.read().unwrap().unwrap();
    assert_eq!(before.adam.epoch(), 4);
    let resumed = train(Limits::default(), Some(&interrupted)).unwrap();
    let whole = train(Limits::default(), None).unwrap();
    assert_eq!((resumed.epochs, resumed.ending), (9, Ending::Complete));
    assert_eq!(resumed.weights, whole.weights);
    assert_ne!(before.adam.weights, whole.weights);
    assert!(resumed.seconds > before.spent.as_secs_f64());
}

#[test]
fn time_is_that_of_all_parts() {
    let folder = tempfile::tempdir().unwrap();
    let interrupted = interrupt(&folder);
    let limits = Limits { epochs: None, time: Some(Duration::from_nanos(1)) };
    assert_eq!(train(limits, Some(&interrupted)).unwrap().ending, Ending::OutOfTime { epoch: 4 });
}

#[test]
fn what_is_done_leaves_no_file_and_what_failed_keeps_it() {
    let folder = tempfile::tempdir().unwrap();
    let interrupted = interrupt(&folder);
    let resume = |run: fn() -> Result<u8, FolderError>| {
        Interrupted::resume(Some(folder.path()), "mlp", "settings".to_owned(), |_| run())
    };
    let failed = resume(|| Err(ReadError::Damaged { file: "x".into() }.into()));
    assert!(failed.is_err() && interrupted.read().unwrap().is_some());
    assert_eq!(resume(|| Ok(7)).unwrap(), 7);
    assert!(interrupted.read().unwrap().is_none());
    // Without a state there is nothing to remove.
    assert_eq!(resume(|| Ok(8)).unwrap(), 8);
}

#[test]
fn files_of_other_options_and_damaged_ones_are_refused_and_stay() {
    let folder = tempfile::tempdir().unwrap();
    interrupt(&folder);
    let other = Interrupted::new(folder.path(), "mlp", "others".to_owned());
    let refused = train(Limits::default(), Some(&other)).err().unwrap().to_string();
    assert!(refused.contains("mlp.interrupted: made with other options"), "{refused}");
    let (file, this) = (
        folder.path().join("mlp.interrupted"),
        Interrupted::new(folder.path(), "mlp", "settings".to_owned()),
    );
    let bytes = fs::read(&file).unwrap();
    for k in 0..bytes.len() {
        let flipped = bytes.iter().enumerate().map(|(i, byte)| if i == k { byte ^ 16 } else { *byte });
        fs::write(&file, flipped.collect::<Vec<_>>()).unwrap();
        assert!(matches!(this.read(), Err(FolderError::Interrupted(ReadError::Damaged { .. }))), "byte {k}");
        fs::write(&file, &bytes[..k]).unwrap();
        assert!(matches!(this.read(), Err(FolderError::Interrupted(ReadError::Damaged { .. }))), "{k} bytes");
    }
    fs::write(&file, &bytes).unwrap();
    assert_eq!(this.read().unwrap().unwrap().adam.epoch(), 4);
}
