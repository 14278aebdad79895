//! Data sets of LeRobot in a program without the reader of Parquet files.
#![cfg(not(feature = "lerobot"))]

use leastaction_data::survey::RawLog;
use leastaction_data::{LerobotProblem, Problem};
use std::path::Path;

#[test]
fn the_error_says_how_to_build_the_reader() {
    let set = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/lerobot/v30");
    let error = RawLog::read(&set).unwrap_err();
    assert!(
        matches!(&error.problem, Problem::Lerobot(problem) if matches!(**problem, LerobotProblem::NotBuilt)),
        "{error}"
    );
    assert!(error.to_string().contains("--features lerobot"), "{error}");
}
