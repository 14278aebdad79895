//! Bags of ROS 2: `.mcap` files with `sensor_msgs/JointState` messages in CDR.
//!
//! A column is a joint of a topic: `/joint_states/shoulder/position`, `…/velocity`, `…/effort`. Its time is the stamp in the message
//! headers; if any message of a topic lacks a stamp, the whole topic uses the time of recording, and a note says so. Time counts in s from
//! the first message with joints in the file.

mod cdr;
mod container;
mod record;

use crate::Rows;
use crate::columns::Columns;
use crate::error::Fault;
use crate::join::{Part, Wanted};
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::Origin;
use cdr::JointState;
use container::Message;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::Read;

/// Fields of a message, in its order.
const FIELDS: [&str; 3] = ["position", "velocity", "effort"];

/// Count of numbers that may be read from any file, however small; together they take 64 MiB.
const MOST_ANYWAY: u64 = 1 << 23;

/// Further count of numbers that may be read per byte of the file: stamps and noise do not compress to a hundredth.
const MOST_PER_BYTE: u64 = 12;

/// Joint data of a bag.
pub(crate) struct Bag {
    pub streams: Vec<Stream>,
    /// Topics without joint states.
    pub others: Vec<String>,
}

/// Messages of one topic with the same joints in the same order and the same fields.
pub(crate) struct Stream {
    pub topic: String,
    /// Names of the columns.
    pub names: Vec<String>,
    /// Rows of values, message by message.
    values: Vec<f64>,
    /// Times of the messages, ns.
    times: Vec<Time>,
}

/// Times of sending and of recording of a message, ns, and its number in the file, from 1.
#[derive(Clone, Copy)]
struct Time {
    stamp: i64,
    logged: i64,
    message: u64,
}

/// Key of a stream: channel, joints, fields.
type Key = (u16, String, [bool; 3]);

impl Bag {
    /// Reads a file sequentially.
    pub fn read(source: &mut dyn Read) -> Result<Self, Fault> {
        let mut gathered = Gathered::default();
        container::messages(source, &mut |message| gathered.take(message))?;
        let Gathered { streams, others, .. } = gathered;
        let others: Vec<String> = others.into_iter().collect();
        if streams.is_empty() {
            return Err((Place::File, Problem::NoJointStates(others)));
        }
        Ok(Self { streams, others })
    }

    /// All column names, without duplicates.
    pub fn names(&self) -> Vec<String> {
        let names: BTreeSet<&String> = self.streams.iter().flat_map(|stream| &stream.names).collect();
        names.into_iter().cloned().collect()
    }

    /// Whether any message of a topic lacks a stamp.
    pub fn is_unstamped(&self, topic: &str) -> bool {
        let mut times = self.of_topic(topic).flat_map(|stream| &stream.times);
        times.any(|time| time.stamp == 0)
    }

    fn of_topic(&self, topic: &str) -> impl Iterator<Item = &Stream> {
        self.streams.iter().filter(move |stream| stream.topic == topic)
    }

    /// The clock of all topics: which time each uses, and the earliest time.
    pub fn clock(&self) -> Clock {
        let topics: BTreeSet<&String> = self.streams.iter().map(|stream| &stream.topic).collect();
        let unstamped: BTreeSet<String> =
            topics.into_iter().filter(|topic| self.is_unstamped(topic)).cloned().collect();
        let mut clock = Clock { unstamped, start: 0 };
        let of = |stream: &Stream| stream.times.iter().map(|time| clock.of(&stream.topic, *time)).min();
        clock.start = self.streams.iter().filter_map(of).min().unwrap_or_default();
        clock
    }

    /// The wanted columns, grouped by topic, with notes on their clocks.
    pub fn parts(&self, columns: &Columns) -> Result<(Vec<Part>, Vec<Note>), Fault> {
        let known = || self.names().into_iter().chain(["t".to_owned()]).collect();
        let unknown = |name: &str| (Place::File, Problem::NoColumn { name: name.to_owned(), known: known() });
        if columns.t.name != "t" {
            return Err(unknown(&columns.t.name));
        }
        let mut topics: Vec<(String, Wanted)> = Vec::new();
        for (index, column) in columns.wanted().enumerate() {
            let has = |stream: &&Stream| stream.names.contains(&column.name);
            let stream = self.streams.iter().find(has).ok_or_else(|| unknown(&column.name))?;
            match topics.iter_mut().find(|(topic, _)| *topic == stream.topic) {
                Some((_, wanted)) => wanted.push((index, column.clone())),
                None => topics.push((stream.topic.clone(), vec![(index, column.clone())])),
            }
        }
        let clock = self.clock();
        let notes = topics.iter().filter(|(topic, _)| clock.unstamped.contains(topic));
        let notes = notes.map(|(topic, _)| Note::Unstamped { topic: topic.clone() }).collect();
        let part = |(topic, wanted): (String, Wanted)| self.part(&topic, wanted, &clock, columns.t.scale);
        Ok((topics.into_iter().map(part).collect::<Result<_, _>>()?, notes))
    }

    /// Columns of a topic. A message with none of these joints is taken as another sender's and skipped; a message with
    /// only some of them is an error.
    fn part(&self, topic: &str, wanted: Wanted, clock: &Clock, scale: f64) -> Result<Part, Fault> {
        let mut samples: Vec<(Time, Vec<f64>)> = Vec::new();
        for stream in self.of_topic(topic) {
            let at = |name: &str| stream.names.iter().position(|known| known == name);
            let places: Vec<usize> = wanted.iter().filter_map(|(_, column)| at(&column.name)).collect();
            if places.is_empty() {
                continue;
            }
            if let Some((_, missing)) = wanted.iter().find(|(_, column)| at(&column.name).is_none()) {
                let message = stream.times.first().map_or(1, |time| time.message);
                return Err((Place::Message(message), Problem::MissingJoint(missing.name.clone())));
            }
            for (time, row) in stream.samples() {
                let pairs = wanted.iter().zip(&places);
                let values = pairs.map(|((_, column), place)| row[*place] * column.scale).collect::<Vec<_>>();
                if let Some(at) = values.iter().position(|value| !value.is_finite()) {
                    let (message, column) = (time.message, wanted[at].1.name.clone());
                    return Err((Place::Value { message, column }, Problem::NotFinite(values[at])));
                }
                samples.push((time, values));
            }
        }
        samples.sort_by_key(|(time, _)| time.message);
        let t = samples.iter().map(|(time, _)| scale * clock.seconds(topic, *time)).collect();
        let origin = Origin::Messages(samples.iter().map(|(time, _)| time.message).collect());
        let values = Rows::from_rows(wanted.len(), samples.iter().map(|(_, values)| values));
        let values = values.ok_or((Place::File, Problem::Empty))?;
        Ok(Part { t, values, wanted, origin, control: None })
    }
}

/// Time base of messages.
pub(crate) struct Clock {
    /// Topics that use the time of recording.
    unstamped: BTreeSet<String>,
    /// Start of time, ns.
    start: i64,
}

impl Clock {
    fn of(&self, topic: &str, time: Time) -> i64 {
        if self.unstamped.contains(topic) { time.logged } else { time.stamp }
    }

    /// Time since the first message, s.
    fn seconds(&self, topic: &str, time: Time) -> f64 {
        // The difference may not fit 64 bits; as an f64 it is exact for a hundred days.
        (i128::from(self.of(topic, time)) - i128::from(self.start)) as f64 / 1e9
    }
}

impl Stream {
    fn samples(&self) -> impl Iterator<Item = (Time, &[f64])> {
        self.times.iter().copied().zip(self.values.chunks_exact(self.names.len()))
    }

    /// Times of the messages, s.
    pub fn seconds(&self, clock: &Clock) -> Vec<f64> {
        self.times.iter().map(|time| clock.seconds(&self.topic, *time)).collect()
    }

    /// The values of a column.
    pub fn column(&self, index: usize) -> Vec<f64> {
        self.values.iter().skip(index).step_by(self.names.len()).copied().collect()
    }
}

/// Streams under construction.
#[derive(Default)]
struct Gathered {
    streams: Vec<Stream>,
    of: HashMap<Key, usize>,
    others: BTreeSet<String>,
    numbers: u64,
}

impl Gathered {
    fn take(&mut self, message: &Message<'_>) -> Result<(), Fault> {
        let channel = message.channel;
        let joints = matches!(message.schema, "sensor_msgs/msg/JointState" | "sensor_msgs/JointState");
        if !joints || channel.encoding != "cdr" {
            if !self.others.contains(&channel.topic) {
                self.others.insert(channel.topic.clone());
            }
            return Ok(());
        }
        self.joints(message).map_err(|problem| (Place::Message(message.number), problem))
    }

    fn joints(&mut self, message: &Message<'_>) -> Result<(), Problem> {
        let state = JointState::parse(message.content)?;
        let present = state.fields.each_ref().map(|field| !field.is_empty());
        if present == [false; 3] {
            return Ok(());
        }
        self.numbers += state.fields.iter().map(Vec::len).sum::<usize>() as u64 + 1;
        let most = MOST_PER_BYTE.saturating_mul(message.read).saturating_add(MOST_ANYWAY);
        if self.numbers > most {
            return Err(Problem::TooLarge { numbers: self.numbers, most });
        }
        let logged = i64::try_from(message.log_time).map_err(|_| Problem::BadTime(message.log_time))?;
        let key = (message.channel.id, state.names.join("\0"), present);
        let at = match self.of.get(&key) {
            Some(at) => *at,
            None => {
                self.streams.push(Stream::new(&message.channel.topic, &state, present)?);
                *self.of.entry(key).or_insert(self.streams.len() - 1)
            }
        };
        let Some(stream) = self.streams.get_mut(at) else { return Ok(()) };
        stream.times.push(Time { stamp: state.stamp, logged, message: message.number });
        stream.values.extend(state.fields.iter().flatten());
        Ok(())
    }
}

impl Stream {
    fn new(topic: &str, state: &JointState<'_>, present: [bool; 3]) -> Result<Self, Problem> {
        let mut seen = BTreeMap::new();
        if let Some(twice) = state.names.iter().find(|name| seen.insert(**name, ()).is_some()) {
            return Err(Problem::Duplicate(format!("joint {twice}")));
        }
        let fields = FIELDS.into_iter().zip(present).filter(|(_, present)| *present);
        let of_field = |(field, _)| state.names.iter().map(move |joint| format!("{topic}/{joint}/{field}"));
        let names = fields.flat_map(of_field).collect();
        Ok(Self { topic: topic.to_owned(), names, values: Vec::new(), times: Vec::new() })
    }
}
