//! Bags of ROS 2 in `.db3` files, which `golden/bags.py` wrote by Python's SQLite, and folders of them.

use leastaction_data::survey::{Guess, RawLog};
use leastaction_data::{
    BagProblem, Column, Columns, DataError, Dataset, Place, Problem, Reading, decode_as, read_as,
};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const PARTS: [&[u8]; 2] = [include_bytes!("golden/bag_0.db3"), include_bytes!("golden/bag_1.db3")];
const METADATA: &str = include_str!("golden/metadata.yaml");

/// Positions of both joints, and the force of the first.
fn reading() -> Reading {
    let name = |name: &str| Column::si(name);
    let columns = Columns {
        t: name("t"),
        q: vec![name("/joint_states/b/position"), name("/joint_states/a_joint_with_a_long_name/position")],
        v: Vec::new(),
        u: vec![name("/commands/a_joint_with_a_long_name/effort")],
        actuation: Some(vec![vec![0.0], vec![1.0]]),
    };
    Reading { columns: Some(columns), ..Reading::default() }
}

fn decoded(bytes: &[u8]) -> Result<Dataset, DataError> {
    decode_as("bag.db3", bytes, &reading()).map(|(data, _)| data)
}

/// A folder with these files.
fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, bytes)| fs::write(folder.path().join(name), bytes).unwrap());
    folder
}

/// The samples that the script wrote, from `first` on.
fn is_as_written(data: &Dataset, first: usize) {
    let motion = &data.trajectories[0];
    assert_eq!((data.trajectories.len(), data.h), (1, 0.01));
    for (k, q) in motion.q.iter().enumerate() {
        let k = (first + k) as f64;
        assert_eq!(q, [-k, 0.25 * k]);
    }
    // Held forces are averaged from sample to sample, in seconds with rounding errors.
    for (k, u) in motion.u.as_ref().unwrap().iter().enumerate() {
        assert!(u[0] == 0.0 && (u[1] - 10.0 - (first + k) as f64).abs() < 1e-12, "{k}: {u:?}");
    }
}

#[test]
fn a_file_has_the_numbers_that_were_recorded() {
    for (part, bytes) in PARTS.into_iter().enumerate() {
        let data = decoded(bytes).unwrap();
        assert_eq!(data.samples(), 5);
        is_as_written(&data, 5 * part);
    }
    let logs = RawLog::decode(Path::new("bag.db3"), PARTS[0]).unwrap();
    assert_eq!(logs[0].others, ["/camera"]);
    let guess = Guess::of(&logs);
    assert_eq!((guess.q.len(), guess.u.as_slice()), (2, &[][..]));
}

#[test]
fn parts_of_a_bag_are_one_log_in_the_order_of_time() {
    // The names of the parts say the contrary of their times.
    let other = METADATA.replace("bag_0", "z").replace("bag_1", "a");
    let files = [("z.db3", PARTS[0]), ("a.db3", PARTS[1]), ("metadata.yaml", other.as_bytes())];
    let bag = folder(&files);
    let (data, _) = read_as(bag.path(), &reading()).unwrap();
    assert_eq!(data.samples(), 10);
    is_as_written(&data, 0);
    let looked = RawLog::read(bag.path()).unwrap();
    assert_eq!((looked.len(), looked[0].samples()), (2, 10));
}

#[test]
fn what_belongs_to_a_bag_must_be_there() {
    let refused = |files: &[(&str, &[u8])]| {
        let bag = folder(files);
        read_as(bag.path(), &reading()).map(|_| ()).unwrap_err().problem.to_string()
    };
    let alone = refused(&[("bag_0.db3", PARTS[0]), ("metadata.yaml", METADATA.as_bytes())]);
    assert!(alone.contains("bag_1.db3, which is not in the folder"), "{alone}");
    assert!(refused(&[("log.csv", b"t,q\n")]).contains("neither .mcap nor .db3"));
    assert!(refused(&[("bag_0.db3.zstd", b"")]).contains("zstd -d bag_0.db3.zstd"));
    let cut = folder(&[("bag_0.db3", PARTS[0]), ("bag_1.db3", &PARTS[1][..1000])]);
    let error = read_as(cut.path(), &reading()).unwrap_err();
    assert!(matches!(&error.place, Place::PartOfBag { file, .. } if file == "bag_1.db3"), "{error}");
}

#[test]
fn a_bag_that_is_still_recorded_is_refused() {
    let path = |folder: &TempDir| -> PathBuf { folder.path().join("bag.db3") };
    let empty = folder(&[("bag.db3", PARTS[0]), ("bag.db3-wal", b"")]);
    is_as_written(&read_as(&path(&empty), &reading()).unwrap().0, 0);
    for journal in ["bag.db3-wal", "bag.db3-journal"] {
        let open = folder(&[("bag.db3", PARTS[0]), (journal, b"7")]);
        let error = read_as(&path(&open), &reading()).unwrap_err();
        assert!(
            matches!(&error.problem, Problem::Bag(BagProblem::Unfinished(name)) if name == journal),
            "{error}"
        );
    }
}

#[test]
fn what_is_no_bag_is_named() {
    for bytes in [&b""[..], b"SQLite format 3\0", &[0; 4096], &PARTS[0][..512], &PARTS[0][512..]] {
        let error = decoded(bytes).unwrap_err();
        assert!(matches!(error.problem, Problem::Bag(BagProblem::NotDb3(_))), "{error}");
    }
    let renamed = |from: &[u8], to: &[u8]| {
        let mut bytes = PARTS[0].to_vec();
        while let Some(at) = bytes.windows(from.len()).position(|window| window == from) {
            bytes[at..at + from.len()].copy_from_slice(to);
        }
        decoded(&bytes).unwrap_err().to_string()
    };
    assert!(renamed(b"messages", b"massages").contains("no table messages"));
    assert!(renamed(b"topic_id", b"topic_no").contains("no column topic_id"));
    let others = renamed(b"JointState", b"JointTrajs");
    assert!(others.contains("the file has /camera, /commands, /joint_states"), "{others}");
}

#[test]
fn messages_that_are_compressed_one_by_one_say_so() {
    // Messages begin with the header of CDR and their stamp in s.
    let begins = [&[0, 1, 0, 0][..], &1_700_000_000_i32.to_le_bytes()].concat();
    let mut bytes = PARTS[0].to_vec();
    while let Some(at) = bytes.windows(begins.len()).position(|window| window == begins) {
        bytes[at..at + 4].copy_from_slice(&[0x28, 0xB5, 0x2F, 0xFD]);
    }
    let error = decoded(&bytes).unwrap_err();
    assert!(matches!(error.problem, Problem::Bag(BagProblem::PackedMessage)), "{error}");
    assert!(error.to_string().contains("ros2 bag convert"), "{error}");
}

#[test]
fn truncated_files_are_refused() {
    for end in 0..PARTS[0].len() {
        assert!(decoded(&PARTS[0][..end]).is_err(), "{end}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// No bytes, at any place, end the reader; what it accepts is finite.
    #[test]
    fn changed_files_are_read_or_refused(
        part in 0..2_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        near in any::<bool>(),
    ) {
        let mut bytes = PARTS[part].to_vec();
        for (at, byte) in changes {
            // Headers of pages are where structure is.
            let at = at.index(bytes.len());
            let at = if near { at / 512 * 512 + at % 24 } else { at };
            if let Some(old) = bytes.get_mut(at) {
                *old = byte;
            }
        }
        if let Ok(data) = decoded(&bytes) {
            prop_assert!(data.trajectories.iter().all(|motion| motion.q.as_flat().iter().all(|x| x.is_finite())));
        }
    }
}
