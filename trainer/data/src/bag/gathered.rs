//! Messages with joints, gathered into streams.

use super::cdr::JointState;
use super::container::Message;
use super::{FIELDS, Stream, Time};
use crate::bag_problem::BagProblem;
use crate::error::Fault;
use crate::place::Place;
use crate::problem::Problem;
use std::collections::{BTreeSet, HashMap};

/// Count of numbers that may be read from any file, however small; together they take 64 MiB.
const MOST_ANYWAY: u64 = 1 << 23;

/// Further count of numbers that may be read per byte of the file: stamps and noise do not compress to a hundredth.
const MOST_PER_BYTE: u64 = 12;

/// Key of a stream: topic, joints in alphabetical order, fields.
type Key = (String, String, [bool; 3]);

/// Whether a type, as ROS names it, is of joints.
pub(super) fn is_of_joints(schema: &str) -> bool {
    matches!(schema, "sensor_msgs/msg/JointState" | "sensor_msgs/JointState")
}

/// A message that cannot be read; it matters only to those who ask for its joints.
pub(super) struct Bad {
    pub topic: String,
    /// Names of its joints; empty if not even they can be read.
    pub joints: Vec<String>,
    /// Number of the message in the file, from 1.
    pub message: u64,
    pub problem: Problem,
}

/// Streams under construction.
#[derive(Default)]
pub(super) struct Gathered {
    pub streams: Vec<Stream>,
    /// Topics without joint states.
    pub others: BTreeSet<String>,
    /// The first bad message of each topic and set of joints.
    pub bad: Vec<Bad>,
    of: HashMap<Key, usize>,
    numbers: u64,
}

impl Gathered {
    pub fn take(&mut self, message: &Message<'_>) -> Result<(), Fault> {
        let channel = message.channel;
        if !is_of_joints(message.schema) || channel.encoding != "cdr" {
            if !self.others.contains(&channel.topic) {
                self.others.insert(channel.topic.clone());
            }
            return Ok(());
        }
        let state = match JointState::parse(message.content) {
            Ok(state) => state,
            Err(problem) => {
                self.note_bad(message, &[], problem);
                return Ok(());
            }
        };
        let logged =
            i64::try_from(message.log_time).map_err(|_| BagProblem::BadTime(message.log_time).into());
        match state.check().and(logged) {
            Ok(logged) => {
                let time = Time { stamp: state.stamp, logged, message: message.number };
                self.joints(message, &state, time)
                    .map_err(|problem| (Place::Message(message.number), problem))
            }
            Err(problem) => {
                self.note_bad(message, &state.names, problem);
                Ok(())
            }
        }
    }

    fn note_bad(&mut self, message: &Message<'_>, joints: &[&str], problem: Problem) {
        let topic = &message.channel.topic;
        let is_known = |bad: &Bad| bad.topic == *topic && bad.joints.iter().eq(joints);
        if !self.bad.iter().any(is_known) {
            let joints = joints.iter().map(|joint| (*joint).to_owned()).collect();
            self.bad.push(Bad { topic: topic.clone(), joints, message: message.number, problem });
        }
    }

    fn joints(&mut self, message: &Message<'_>, state: &JointState<'_>, time: Time) -> Result<(), Problem> {
        let present = state.fields.each_ref().map(|field| !field.is_empty());
        if present == [false; 3] {
            return Ok(());
        }
        self.numbers += state.fields.iter().map(Vec::len).sum::<usize>() as u64 + 1;
        let most = MOST_PER_BYTE.saturating_mul(message.read).saturating_add(MOST_ANYWAY);
        if self.numbers > most {
            return Err(Problem::TooLarge { numbers: self.numbers, most });
        }
        let mut sorted = state.names.clone();
        sorted.sort_unstable();
        let key = (message.channel.topic.clone(), sorted.join("\0"), present);
        let at = *self.of.entry(key).or_insert_with(|| {
            self.streams.push(Stream::new(&message.channel.topic, state, present));
            self.streams.len() - 1
        });
        if let Some(stream) = self.streams.get_mut(at) {
            stream.push(state, time);
        }
        Ok(())
    }
}

impl Stream {
    fn new(topic: &str, state: &JointState<'_>, present: [bool; 3]) -> Self {
        let fields = FIELDS.into_iter().zip(present).filter(|(_, present)| *present);
        let of_field = |(field, _)| state.names.iter().map(move |joint| format!("{topic}/{joint}/{field}"));
        let names = fields.flat_map(of_field).collect();
        let joints = state.names.iter().map(|joint| (*joint).to_owned()).collect();
        Self { topic: topic.to_owned(), joints, names, values: Vec::new(), times: Vec::new() }
    }

    /// Adds a message; joints in another order are put into that of the first message.
    fn push(&mut self, state: &JointState<'_>, time: Time) {
        self.times.push(time);
        if state.names.iter().eq(&self.joints) {
            self.values.extend(state.fields.iter().flatten());
            return;
        }
        let place = |joint: &String| state.names.iter().position(|name| name == joint);
        let order: Vec<usize> = self.joints.iter().filter_map(place).collect();
        for field in state.fields.iter().filter(|field| !field.is_empty()) {
            self.values.extend(order.iter().filter_map(|at| field.get(*at)));
        }
    }
}
