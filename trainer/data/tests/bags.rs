//! Bags of ROS 2: topics with clocks of their own, read as one log.

mod bag;

use bag::{Chunks, Joints, bag};
use leastaction_core::forces::ControlKind;
use leastaction_data::survey::{Guess, RawLog};
use leastaction_data::{
    BagProblem, Column, Columns, DataError, Dataset, Note, Place, Problem, Reading, decode_as,
};

const JOINTS: [&str; 2] = ["shoulder", "elbow"];

/// Start of the robot's clock, ns since 1970.
const START: i64 = 1_790_000_000_000_000_000;

/// q₀ = t, q₁ = 2t at 100 Hz; u of the shoulder rises by 1 every 4 ms, at 250 Hz, from 2 ms on.
fn recording() -> Vec<(i64, Vec<f64>, Vec<f64>, bool)> {
    let states = (0..60).map(|k| {
        let t = 0.01 * f64::from(k);
        (START + 10_000_000 * i64::from(k), vec![t, 2.0 * t], vec![1.0, 2.0], true)
    });
    let commands =
        (0..150).map(|k| (START + 2_000_000 + 4_000_000 * i64::from(k), vec![], vec![f64::from(k)], false));
    let mut all: Vec<_> = states.chain(commands).collect();
    all.sort_by_key(|(stamp, ..)| *stamp);
    all
}

fn messages(recording: &[(i64, Vec<f64>, Vec<f64>, bool)]) -> Vec<Joints<'_>> {
    recording
        .iter()
        .map(|(stamp, q, other, is_state)| {
            if *is_state {
                Joints { topic: "/joint_states", stamp: *stamp, names: &JOINTS, fields: [q, other, &[]] }
            } else {
                Joints { topic: "/commands", stamp: *stamp, names: &JOINTS[..1], fields: [&[], &[], other] }
            }
        })
        .collect()
}

fn column(name: &str) -> Column {
    Column::si(name)
}

fn reading() -> Reading {
    let columns = Columns {
        t: column("t"),
        q: vec![
            Column::scaled("/joint_states/elbow/position", -1.0),
            column("/joint_states/shoulder/position"),
        ],
        v: Vec::new(),
        u: vec![column("/commands/shoulder/effort")],
        actuation: Some(vec![vec![0.0], vec![1.0]]),
    };
    Reading { columns: Some(columns), ..Reading::default() }
}

fn read(bytes: &[u8]) -> Result<(Dataset, Vec<Note>), DataError> {
    decode_as("a.mcap", bytes, &reading())
}

fn refused(messages: &[Joints<'_>]) -> (Place, String) {
    let error = read(&bag(messages, Chunks::Plain)).unwrap_err();
    (error.place.clone(), error.to_string())
}

#[test]
fn topics_of_different_clocks_are_one_log_however_chunks_are_compressed() {
    let recording = recording();
    let messages = messages(&recording);
    for chunks in [Chunks::No, Chunks::Plain, Chunks::Zstd, Chunks::Lz4] {
        let (data, notes) = read(&bag(&messages, chunks)).unwrap();
        assert_eq!((data.n, data.h, data.trajectories.len()), (2, 0.01, 1), "{chunks:?}");
        // The first command is 2 ms after the first state.
        assert!(matches!(notes[..], [Note::Uncovered { samples: 1 }]), "{notes:?}");
        let motion = &data.trajectories[0];
        assert!((motion.t0, motion.samples()) == (0.01, 59), "{} {}", motion.t0, motion.samples());
        for (k, (q, u)) in motion.q.iter().zip(motion.u.as_ref().unwrap()).enumerate() {
            let t = 0.01 * (k + 1) as f64;
            assert!((q[0] + 2.0 * t).abs() < 1e-12 && (q[1] - t).abs() < 1e-12, "{t} {q:?}");
            // The mean command over [t, t + 10 ms] follows a straight line, except for the jumps of the command.
            assert!(u[0] == 0.0 && (u[1] - (250.0 * (t + 0.005) - 1.0)).abs() < 0.5 + 1e-9, "{t} {u:?}");
        }
    }
}

#[test]
fn impulses_of_held_commands_stay() {
    let recording = recording();
    let (data, _) = read(&bag(&messages(&recording), Chunks::Plain)).unwrap();
    let u = data.trajectories[0].u.as_ref().unwrap();
    let found: f64 = u.column(1).take(50).map(|u| 0.01 * u).sum();
    // From 10 ms to 510 ms: command k acts from 2 + 4k ms for 4 ms.
    let acts =
        |k: i32| (510.0_f64.min(6.0 + 4.0 * f64::from(k)) - 10.0_f64.max(2.0 + 4.0 * f64::from(k))).max(0.0);
    let expected: f64 = (0..150).map(|k| 1e-3 * acts(k) * f64::from(k)).sum();
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    let linear = Reading { control: Some(ControlKind::Linear), ..reading() };
    let (data, _) = decode_as("a.mcap", &bag(&messages(&recording), Chunks::Plain), &linear).unwrap();
    let u = data.trajectories[0].u.as_ref().unwrap();
    assert!((u[3][1] - (250.0 * 0.038)).abs() < 1e-6, "{}", u[3][1]);
}

#[test]
fn messages_without_stamps_have_the_time_of_the_recorder() {
    let recording = recording();
    let mut messages = messages(&recording);
    let contents: Vec<_> = messages
        .iter_mut()
        .map(|joints| {
            let logged = joints.stamp + 1_000_000;
            if joints.topic == "/commands" {
                joints.stamp = 0;
            }
            (joints.topic, logged, joints.cdr())
        })
        .collect();
    let (data, notes) = read(&bag::file(&contents, "sensor_msgs/msg/JointState", Chunks::Plain)).unwrap();
    assert!(matches!(&notes[0], Note::Unstamped { topic } if topic == "/commands"), "{notes:?}");
    assert!(notes[0].to_string().contains("/commands has messages without a stamp"));
    assert_eq!(data.h, 0.01);
}

#[test]
fn what_is_wrong_with_a_message_is_said_with_its_number() {
    let recording = recording();
    let sound = messages(&recording);
    let at = |k: usize, change: fn(&mut Joints<'_>)| {
        let mut changed = sound.clone();
        change(&mut changed[k]);
        refused(&changed)
    };
    let state = sound.iter().rposition(|joints| joints.topic == "/joint_states").unwrap();
    let number = state as u64 + 1;
    let (place, said) = at(state, |joints| joints.fields[0] = &[0.0, f64::NAN]);
    let column = "/joint_states/elbow/position".to_owned();
    assert!(
        place == Place::Value { message: number, column } && said.contains("NaN is not finite"),
        "{said}"
    );
    let (place, said) = at(state, |joints| joints.stamp -= 500_000_000);
    assert!(
        matches!(place, Place::Value { message, .. } if message == number) && said.contains("time goes from"),
        "{said}"
    );
    let (place, said) = at(state, |joints| joints.fields[0] = &[0.0]);
    assert!(
        place == Place::Message(number) && said.contains("other numbers of names and of values"),
        "{said}"
    );
    let (place, said) = at(state, |joints| joints.names = &["shoulder", "shoulder"]);
    assert!(place == Place::Message(number) && said.contains("joint shoulder stands twice"), "{said}");
    let (place, said) = at(state, |joints| joints.names = &["shoulder", "wrist"]);
    assert!(
        place == Place::Message(number)
            && said.contains("/joint_states/elbow/position is missing, though other"),
        "{said}"
    );
}

#[test]
fn another_sender_on_the_topic_and_another_order_do_no_harm() {
    let recording = recording();
    let mut messages = messages(&recording);
    let turned: Vec<Vec<f64>> =
        recording.iter().map(|(_, q, ..)| q.iter().rev().copied().collect()).collect();
    let (expected, _) = read(&bag(&messages, Chunks::Plain)).unwrap();
    for (k, joints) in messages.iter_mut().enumerate() {
        if joints.topic == "/joint_states" && k % 3 == 0 {
            joints.names = &["elbow", "shoulder"];
            joints.fields[0] = &turned[k];
        }
    }
    let gripper = Joints { names: &["finger"], fields: [&[0.1], &[], &[]], ..messages[40].clone() };
    messages.insert(40, Joints { topic: "/joint_states", ..gripper });
    let (found, _) = read(&bag(&messages, Chunks::Plain)).unwrap();
    assert_eq!(found, expected);
}

#[test]
fn other_bags_are_refused_in_words() {
    let image = ("/camera", START, vec![0, 1, 0, 0]);
    let error = read(&bag::file(&[image], "sensor_msgs/msg/Image", Chunks::Plain)).unwrap_err();
    assert!(error.to_string().contains("the file has /camera"), "{error}");
    let recording = recording();
    let bytes = bag(&messages(&recording), Chunks::Plain);
    let unnamed = leastaction_data::decode("a.mcap", &bytes).unwrap_err();
    assert!(matches!(unnamed.problem, Problem::Bag(BagProblem::Unnamed)));
    let mut other = reading();
    other.columns.as_mut().unwrap().q[0].name = "/joint_states/wrist/position".to_owned();
    let error = decode_as("a.mcap", &bytes, &other).unwrap_err().to_string();
    assert!(error.contains("wrist") && error.contains("/joint_states/shoulder/position, "), "{error}");
    let mut later = messages(&recording);
    later
        .iter_mut()
        .filter(|joints| joints.topic == "/commands")
        .for_each(|joints| joints.stamp += 3_600_000_000_000);
    let (_, said) = refused(&later);
    assert!(said.contains("of 60 samples of the coordinates 0 lie where"), "{said}");
    assert!(leastaction_data::write("a.mcap", &read(&bytes).unwrap().0).is_err());
}

#[test]
fn a_look_sees_every_topic() {
    let folder = tempfile::tempdir().unwrap();
    let recording = recording();
    let file = folder.path().join("a.mcap");
    std::fs::write(&file, bag(&messages(&recording), Chunks::Zstd)).unwrap();
    let logs = RawLog::read(&file).unwrap();
    let topics: Vec<_> = logs.iter().map(|log| (log.topic.as_deref().unwrap(), log.samples())).collect();
    assert_eq!(topics, [("/joint_states", 60), ("/commands", 150)]);
    assert_eq!(logs[1].column("t").unwrap()[1], 0.006);
    let guess = Guess::of(&logs);
    assert_eq!(guess.q, JOINTS.map(|joint| format!("/joint_states/{joint}/position")));
    assert!(guess.u.is_empty(), "one drive was taken for two: {guess:?}");
}

#[test]
fn messages_that_nobody_asked_for_may_be_bad() {
    let recording = recording();
    let mut all = messages(&recording);
    let sound = read(&bag(&all, Chunks::Plain)).unwrap();
    let (bad, other) = ([0.0, 1.0], ["gripper"]);
    for topic in ["/joint_states", "/gripper"] {
        let gripper = Joints { topic, stamp: START, names: &other, fields: [&bad, &[], &[]] };
        all.insert(7, gripper);
    }
    assert_eq!(read(&bag(&all, Chunks::Plain)).unwrap(), sound);
    assert_eq!(RawLog::decode("a.mcap".as_ref(), &bag(&all, Chunks::Plain)).unwrap().len(), 2);
}

#[test]
fn joints_in_turning_order_are_one_stream() {
    let recording = recording();
    let sound = messages(&recording);
    let turned: Vec<Vec<f64>> =
        recording.iter().map(|(_, q, ..)| q.iter().rev().copied().collect()).collect();
    let (names, velocities, none) = ([JOINTS[1], JOINTS[0]], vec![2.0, 1.0], Vec::new());
    let mut all = sound.clone();
    for (k, joints) in
        all.iter_mut().enumerate().filter(|(_, joints)| joints.topic == "/joint_states").step_by(2)
    {
        joints.names = &names;
        joints.fields = [&turned[k], &velocities, &none];
    }
    let (sound, all) = (bag(&sound, Chunks::Plain), bag(&all, Chunks::Plain));
    assert_eq!(read(&all).unwrap(), read(&sound).unwrap());
    let looked = RawLog::decode("a.mcap".as_ref(), &all).unwrap();
    let columns = |logs: &[RawLog], joint: &str| {
        logs[0].column(&format!("/joint_states/{joint}/velocity")).unwrap().to_vec()
    };
    assert_eq!((looked.len(), columns(&looked, "elbow")), (2, vec![2.0; 60]));
}

#[test]
fn velocities_without_numbers_are_left_out() {
    let recording = recording();
    let mut all = messages(&recording);
    for joints in all.iter_mut().filter(|joints| joints.topic == "/joint_states") {
        joints.fields[1] = &[f64::NAN, f64::NAN];
    }
    let velocities = JOINTS.map(|joint| column(&format!("/joint_states/{joint}/velocity")));
    let columns = reading().columns.map(|columns| Columns { v: velocities.to_vec(), ..columns });
    let (data, notes) =
        decode_as("a.mcap", &bag(&all, Chunks::Plain), &Reading { columns, ..reading() }).unwrap();
    assert!(data.trajectories[0].v.is_none());
    assert!(matches!(notes[0], Note::Layout(_)), "{notes:?}");
}
