//! Data sets of LeRobot, as `golden/lerobot/make.py` wrote them by pyarrow: v2.1 in degrees, v3.0 in radians.
#![cfg(feature = "lerobot")]

use leastaction_data::survey::{Goals, RawLog};
use leastaction_data::{
    Column, Columns, DataError, Dataset, LerobotProblem, Place, Problem, Reading, read, read_as, unit,
};
use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const FRAMES: [usize; 3] = [150, 140, 130];
const FIRST: &str = "data/chunk-000/file-000.parquet";
const SECOND: &str = "data/chunk-000/file-001.parquet";
const INFO: &str = "meta/info.json";

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/lerobot").join(name)
}

/// A copy of a data set that may be damaged.
fn copy(name: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in [INFO, FIRST, SECOND] {
        fs::create_dir_all(folder.path().join(file).parent().unwrap()).unwrap();
        fs::copy(golden(name).join(file), folder.path().join(file)).unwrap();
    }
    folder
}

fn columns(q: &[&str], u: &[&str], scale: f64) -> Columns {
    let all = |names: &[&str]| names.iter().map(|name| Column::scaled(*name, scale)).collect();
    Columns { t: Column::si("timestamp"), q: all(q), v: Vec::new(), u: all(u), actuation: None }
}

fn whole() -> Columns {
    columns(&["observation.state"], &["action"], 1.0)
}

fn read_by(folder: &Path, columns: Columns) -> Result<Dataset, DataError> {
    let reading = Reading { columns: Some(columns), ..Reading::default() };
    read_as(folder, &reading).map(|(data, notes)| {
        assert_eq!(notes, []);
        data
    })
}

/// The problem with version 3.0 once a file of it was changed.
fn problem(file: &str, change: impl Fn(Vec<u8>) -> Vec<u8>) -> DataError {
    let folder = copy("v30");
    let path = folder.path().join(file);
    fs::write(&path, change(fs::read(&path).unwrap())).unwrap();
    read_by(folder.path(), whole()).unwrap_err()
}

fn with_info(from: &str, to: &str) -> DataError {
    problem(INFO, |text| {
        let text = String::from_utf8(text).unwrap();
        assert!(text.contains(from), "{from}");
        text.replace(from, to).into_bytes()
    })
}

fn says(error: &DataError, words: &[&str]) {
    let said = error.to_string();
    words.iter().for_each(|word| assert!(said.contains(word), "{word:?} is not in {said}"));
}

#[test]
fn numbers_are_exactly_those_of_the_csv() {
    let data = read_by(&golden("v30"), whole()).unwrap();
    assert_eq!((data.h, data.n), (1.0 / 30.0, 2));
    let lengths: Vec<_> = data.trajectories.iter().map(|log| (log.id, log.samples(), log.t0)).collect();
    assert_eq!(lengths, [(0, FRAMES[0], 0.0), (1, FRAMES[1], 0.0), (2, FRAMES[2], 0.0)]);
    let (csv, _) = read(golden("episode1.csv")).unwrap();
    let (of_csv, of_set) = (&csv.trajectories[0], &data.trajectories[1]);
    assert_eq!((&of_set.q, &of_set.u), (&of_csv.q, &of_csv.u));
    assert!((csv.h - data.h).abs() < 1e-6);
}

#[test]
fn elements_have_names_and_indices() {
    let expected = read_by(&golden("v30"), whole()).unwrap();
    let by_name =
        |feature: &str| ["shoulder_lift.pos", "elbow_flex.pos"].map(|joint| format!("{feature}.{joint}"));
    let [state, action] = ["observation.state", "action"].map(by_name);
    let names = |all: &'_ [String; 2]| [all[0].clone(), all[1].clone()];
    let (state, action) = (names(&state), names(&action));
    let named = columns(&state.each_ref().map(String::as_str), &action.each_ref().map(String::as_str), 1.0);
    assert_eq!(read_by(&golden("v30"), named.clone()).unwrap(), expected);
    let indexed =
        columns(&["observation.state[0]", "observation.state[1]"], &["action[0]", "action[1]"], 1.0);
    assert_eq!(read_by(&golden("v30"), indexed).unwrap(), expected);
    let no_time = Columns { t: Column::si("t"), ..named };
    assert_eq!(read_by(&golden("v30"), no_time).unwrap(), expected);
    let wrong = columns(&["observation.state.wrist.pos"], &["action[0]"], 1.0);
    says(
        &read_by(&golden("v30"), wrong).unwrap_err(),
        &["observation.state.wrist.pos", "observation.state.elbow_flex.pos"],
    );
}

#[test]
fn a_file_of_each_episode_and_degrees_are_the_same_log() {
    let expected = read_by(&golden("v30"), whole()).unwrap();
    let motors = ["observation.state.main_shoulder_lift", "observation.state.main_elbow_flex"];
    let data = read_by(&golden("v21"), columns(&motors, &["action"], unit("deg").unwrap())).unwrap();
    assert_eq!((data.h, data.trajectories.len()), (expected.h, 3));
    for (found, truth) in data.trajectories.iter().zip(&expected.trajectories) {
        let pairs = found.q.as_flat().iter().zip(truth.q.as_flat());
        let off = pairs.map(|(found, truth)| (found - truth).abs()).fold(0.0, f64::max);
        assert!(found.id == truth.id && off < 2e-7, "{off}");
    }
}

#[test]
fn look_knows_positions_commands_and_episodes() {
    let [log] = &RawLog::read(&golden("v30")).unwrap()[..] else { panic!("one log") };
    assert_eq!((log.samples(), log.pieces().len(), &log.starts[..]), (420, 3, &[150, 290][..]));
    assert_eq!(log.others, ["observation.images.front"]);
    let stated = log.stated.clone().unwrap();
    assert_eq!(stated.q, ["observation.state.shoulder_lift.pos", "observation.state.elbow_flex.pos"]);
    assert_eq!(stated.u, ["action.shoulder_lift.pos", "action.elbow_flex.pos"]);
    assert!(log.units.is_empty() && stated.questions[0].contains("as radians do"), "{stated:?}");
    assert!(Goals::of(&[log], &stated).unwrap().are_positions());
    let [log] = &RawLog::read(&golden("v21")).unwrap()[..] else { panic!("one log") };
    assert_eq!(log.units[0], ("observation.state.main_shoulder_lift".to_owned(), "deg"));
    assert!(log.stated.clone().unwrap().questions[0].contains("normalised to ±100"), "{:?}", log.stated);
}

#[test]
fn features_without_names_have_indices() {
    let folder = copy("v30");
    let path = folder.path().join(INFO);
    let text = fs::read_to_string(&path).unwrap();
    let mut info: serde_json::Value = serde_json::from_str(&text).unwrap();
    info["features"]["observation.state"]["names"] = serde_json::Value::Null;
    info["features"]["action"]["names"] = "motors".into();
    fs::write(&path, info.to_string()).unwrap();
    let [log] = &RawLog::read(folder.path()).unwrap()[..] else { panic!("one log") };
    assert_eq!(log.stated.clone().unwrap().u, ["action[0]", "action[1]"]);
    assert_eq!(read_by(folder.path(), whole()).unwrap(), read_by(&golden("v30"), whole()).unwrap());
}

#[test]
fn descriptions_that_cannot_be_read_say_why() {
    for key in ["codebase_version", "fps", "data_path", "features", "total_frames", "total_episodes"] {
        says(&with_info(&format!("{key:?}"), "\"other\""), &["meta/info.json", "missing field", key]);
    }
    says(&with_info("v3.0", "v1.6"), &["\"v1.6\"", "v2.0, v2.1 and v3.0 are read"]);
    says(&with_info("\"fps\": 30", "\"fps\": 0"), &["fps is 0"]);
    says(&with_info("{file_index:03d}", "000"), &["data_path", "{file_index} is missing"]);
    says(&with_info("420", "421"), &["420 frames", "is 421"]);
    says(&problem(INFO, |_| b"{".to_vec()), &["meta/info.json", "EOF"]);
    let no_width = with_info("\"shape\": [\n    2\n   ]", "\"shape\": [\n    3\n   ]");
    says(&no_width, &["row 0 of data/chunk-000/file-000.parquet has not 3 numbers"]);
}

#[test]
fn version_2_0_is_laid_out_as_2_1() {
    let folder = tempfile::tempdir().unwrap();
    for entry in ["meta", "data/chunk-000"] {
        fs::create_dir_all(folder.path().join(entry)).unwrap();
        for file in fs::read_dir(golden("v21").join(entry)).unwrap().flatten() {
            fs::copy(file.path(), folder.path().join(entry).join(file.file_name())).unwrap();
        }
    }
    let path = folder.path().join(INFO);
    fs::write(&path, fs::read_to_string(&path).unwrap().replace("v2.1", "v2.0")).unwrap();
    assert_eq!(read_by(folder.path(), whole()).unwrap(), read_by(&golden("v21"), whole()).unwrap());
    fs::remove_file(folder.path().join("data/chunk-000/episode_000001.parquet")).unwrap();
    says(
        &read_by(folder.path(), whole()).unwrap_err(),
        &["there is no data/chunk-000/episode_000001.parquet"],
    );
}

#[test]
fn files_that_are_not_there_are_missed() {
    for (file, words) in
        [(FIRST, "there is no data/chunk-000/file-000"), (SECOND, "its data files have 290 frames")]
    {
        let folder = copy("v30");
        fs::remove_file(folder.path().join(file)).unwrap();
        says(&read_by(folder.path(), whole()).unwrap_err(), &[words]);
    }
    let unnamed = read(golden("v30")).unwrap_err();
    says(&unnamed, &["which features are the coordinates", "observation.state"]);
}

#[test]
fn other_compressions_are_named() {
    let packed = fs::read(golden("zstd.parquet")).unwrap();
    let error = problem(SECOND, |_| packed.clone());
    says(&error, &["data/chunk-000/file-001.parquet is compressed by ZSTD", "Snappy"]);
}

/// Writes a file of one feature per column, all of them numbers that are there or not.
fn write(path: &Path, positions: &[Option<f32>], episodes: &[i64]) {
    use parquet::column::writer::ColumnWriter;
    use parquet::file::{properties::WriterProperties, writer::SerializedFileWriter};
    use parquet::schema::parser::parse_message_type;
    use std::sync::Arc;
    let schema = "message m { required float timestamp; optional float action; required int64 episode_index; \
                  required group observation.state (LIST) { repeated group list { optional float element; } } }";
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let properties =
        Arc::new(WriterProperties::builder().set_compression(parquet::basic::Compression::SNAPPY).build());
    let mut file = SerializedFileWriter::new(fs::File::create(path).unwrap(), schema, properties).unwrap();
    let mut group = file.next_row_group().unwrap();
    let there: Vec<f32> = positions.iter().flatten().copied().collect();
    let defined = |most: i16| positions.iter().map(|x| most - i16::from(x.is_none())).collect::<Vec<_>>();
    let mut at = 0;
    while let Some(mut column) = group.next_column().unwrap() {
        let t: Vec<f32> = (0..positions.len()).map(|k| k as f32 / 30.0).collect();
        match (at, column.untyped()) {
            (0, ColumnWriter::FloatColumnWriter(writer)) => writer.write_batch(&t, None, None),
            (1, ColumnWriter::FloatColumnWriter(writer)) => {
                writer.write_batch(&there, Some(&defined(1)), None)
            }
            (2, ColumnWriter::Int64ColumnWriter(writer)) => writer.write_batch(episodes, None, None),
            (_, ColumnWriter::FloatColumnWriter(writer)) => {
                writer.write_batch(&there, Some(&defined(2)), Some(&vec![0; positions.len()]))
            }
            _ => unreachable!("no such column"),
        }
        .unwrap();
        column.close().unwrap();
        at += 1;
    }
    group.close().unwrap();
    file.close().unwrap();
}

/// A data set of a single joint.
fn set_of(positions: &[Option<f32>], episodes: &[i64]) -> TempDir {
    let folder = copy("v30");
    fs::remove_file(folder.path().join(SECOND)).unwrap();
    write(&folder.path().join(FIRST), positions, episodes);
    let path = folder.path().join(INFO);
    let mut info: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    info["total_frames"] = positions.len().into();
    for feature in ["observation.state", "action"] {
        info["features"][feature]["shape"] = serde_json::json!([1]);
    }
    fs::write(&path, info.to_string()).unwrap();
    folder
}

fn single(positions: &[Option<f32>], episodes: &[i64]) -> Result<Dataset, DataError> {
    read_by(set_of(positions, episodes).path(), whole())
}

#[test]
fn missing_numbers_and_short_episodes_are_refused() {
    let smooth: Vec<Option<f32>> = (0..8).map(|k| Some(0.1 * k as f32)).collect();
    let data = single(&smooth, &[4, 4, 4, 7, 7, 7, 7, 7]).unwrap();
    assert_eq!(
        data.trajectories.iter().map(|log| (log.id, log.samples())).collect::<Vec<_>>(),
        [(4, 3), (7, 5)]
    );
    assert_eq!(data.trajectories[1].q[0], [f64::from(0.1_f32 * 3.0)]);
    let short = single(&smooth, &[0, 0, 0, 0, 0, 0, 1, 1]).unwrap_err();
    assert!(matches!(short.problem, Problem::TooShort { id: 1, samples: 2 }), "{short}");
    for bad in [None, Some(f32::NAN)] {
        let mut broken = smooth.clone();
        broken[5] = bad;
        let error = single(&broken, &[0; 8]).unwrap_err();
        assert!(matches!(&error.problem, Problem::NotFinite(x) if x.is_nan()), "{error}");
        assert_eq!(error.place, Place::Row { key: "q".to_owned(), row: 5 });
    }
}

/// A small file of a data set with one, compressed as LeRobot's are, and a copy of that data set for each thread.
fn small() -> (Vec<u8>, impl Fn() -> TempDir + Sync) {
    let positions: Vec<Option<f32>> = (0..12).map(|k| Some((0.3 * k as f32).sin())).collect();
    let set = move || set_of(&positions, &[[1; 6], [2; 6]].concat());
    (fs::read(set().path().join(FIRST)).unwrap(), set)
}

/// The log of a damaged file.
fn damaged(folder: &Path, bytes: &[u8]) -> Result<Dataset, DataError> {
    fs::write(folder.join(FIRST), bytes).unwrap();
    let reading = Reading { columns: Some(whole()), ..Reading::default() };
    read_as(folder, &reading).map(|(data, _)| data)
}

#[test]
fn a_file_that_is_cut_off_anywhere_is_refused() {
    let (bytes, folder) = small();
    assert!(damaged(folder().path(), &bytes).is_ok());
    (0..bytes.len()).into_par_iter().for_each_init(&folder, |folder, length| {
        let error = damaged(folder.path(), &bytes[..length]).unwrap_err();
        let is_parquet = |problem: &LerobotProblem| matches!(problem, LerobotProblem::NotParquet { file, .. } if file == FIRST);
        let is_parquet = matches!(&error.problem, Problem::Lerobot(problem) if is_parquet(problem));
        assert!(is_parquet, "{length}: {error}");
    });
}

/// Parquet has no checksums, so that a number may become another one; but nothing panics, although the library does.
#[test]
fn a_flipped_bit_anywhere_never_panics() {
    let (bytes, folder) = small();
    let flips = (0..8 * bytes.len()).into_par_iter().map_init(&folder, |folder, bit| {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        damaged(folder.path(), &flipped).is_err_and(|error| !error.to_string().is_empty())
    });
    let refused = flips.filter(|is_refused| *is_refused).count();
    assert!(refused > bytes.len(), "{refused} of {} bits", 8 * bytes.len());
}
