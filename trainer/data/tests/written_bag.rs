//! Bags that are written: our reader and another program's read back the numbers.

use leastaction_data::survey::RawLog;
use leastaction_data::{BagProblem, JointSample, JointTopic, Problem, write_bag};
use mcap::MessageStream;
use std::collections::BTreeMap;
use std::fs;

/// Three seconds past 1970-01-01 and more: the stamps have all digits.
const START: f64 = 3.25;

/// A topic of two joints, every 10 ms.
fn topic(name: &str, samples: usize, has_effort: bool) -> JointTopic {
    let state = |k: usize| {
        let x = k as f64;
        let effort = if has_effort { vec![7.0 + x, f64::NAN] } else { Vec::new() };
        JointSample { time: START + 0.01 * x, position: vec![0.5 * x, -x], velocity: Vec::new(), effort }
    };
    let joints = vec!["shoulder".to_owned(), "π".to_owned()];
    JointTopic { topic: name.to_owned(), joints, states: (0..samples).map(state).collect() }
}

#[test]
fn our_reader_has_the_numbers_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.mcap");
    // Several chunks: a message has some hundred bytes.
    let samples = 9000;
    write_bag(&path, &[topic("/measured", samples, true), topic("/predicted", 4, false)]).unwrap();
    let logs = RawLog::read(&path).unwrap();
    let topics: Vec<_> = logs.iter().map(|log| log.topic.as_deref().unwrap()).collect();
    assert_eq!(topics, ["/measured", "/predicted"]);
    let log = &logs[0];
    assert_eq!(log.samples(), samples);
    let column = |name: &str| log.column(&format!("/measured/{name}")).unwrap();
    for k in [0, 1, 4500, 8999] {
        let x = k as f64;
        assert!((log.column("t").unwrap()[k] - 0.01 * x).abs() < 1e-9);
        assert_eq!([column("shoulder/position")[k], column("π/position")[k]], [0.5 * x, -x]);
        assert_eq!(column("shoulder/effort")[k], 7.0 + x);
        assert!(column("π/effort")[k].is_nan());
    }
}

/// The mcap crate finds the messages by the summary and its indexes, and in the order of time.
#[test]
fn the_summary_leads_to_every_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.mcap");
    let topics = [topic("/measured", 9000, true), topic("/residual", 9000, false)];
    write_bag(&path, &topics).unwrap();
    let bytes = fs::read(&path).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let statistics = summary.stats.clone().unwrap();
    assert_eq!((statistics.message_count, statistics.channel_count), (18000, 2));
    assert_eq!(statistics.channel_message_counts, BTreeMap::from([(1, 9000), (2, 9000)]));
    assert_eq!(statistics.message_start_time, 3_250_000_000);
    assert!(statistics.chunk_count > 1 && summary.chunk_indexes.len() == statistics.chunk_count as usize);
    let mut found = 0;
    for index in &summary.chunk_indexes {
        let by_channel = summary.read_message_indexes(&bytes, index).unwrap();
        for (channel, entries) in by_channel {
            found += entries.len();
            // Each seek unpacks the chunk, so that few are enough.
            for entry in entries.into_iter().step_by(700) {
                let message = summary.seek_message(&bytes, index, &entry).unwrap();
                assert_eq!((&message.channel.topic, message.log_time), (&channel.topic, entry.log_time));
            }
        }
    }
    assert_eq!(found, 18000);
    let times: Vec<u64> =
        MessageStream::new(&bytes).unwrap().map(|message| message.unwrap().log_time).collect();
    assert!(times.is_sorted() && times.len() == 18000);
    let schema = summary.schemas.values().next().unwrap();
    assert_eq!((schema.name.as_str(), schema.encoding.as_str()), ("sensor_msgs/msg/JointState", "ros2msg"));
}

#[test]
fn times_that_no_stamp_holds_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for time in [-0.5, 3e9, f64::NAN] {
        let mut bad = topic("/measured", 1, false);
        bad.states[0].time = time;
        let error = write_bag(folder.path().join("out.mcap"), &[bad]).unwrap_err();
        assert!(matches!(error.problem, Problem::Bag(BagProblem::NoStamp(_))), "{error}");
    }
}
