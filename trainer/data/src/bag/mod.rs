//! Bags of ROS 2: `.mcap` and `.db3` files, and folders of them, with `sensor_msgs/JointState` messages in CDR.
//!
//! A column is a joint of a topic: `/joint_states/shoulder/position`, `…/velocity`, `…/effort`. Its time is the stamp in the message
//! headers; if any message of a topic lacks a stamp, the whole topic uses the time of recording, and a note says so. Time counts in s from
//! the first message with joints in the file.

mod cdr;
mod container;
mod db3;
mod files;
mod gathered;
mod record;
mod sqlite;
mod sqlite_record;
mod writing;
mod written_message;

use crate::Rows;
use crate::bag_problem::BagProblem;
use crate::columns::{Column, Columns};
use crate::error::Fault;
use crate::join::{Part, Wanted};
use crate::layout_note::LayoutNote;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::Origin;
pub(crate) use files::BagSource;
use gathered::{Bad, Gathered};
use std::collections::BTreeSet;
pub(crate) use writing::encoded;
pub use writing::{JointSample, JointTopic};

/// Fields of a message, in its order.
const FIELDS: [&str; 3] = ["position", "velocity", "effort"];

/// Joint data of a bag.
pub(crate) struct Bag {
    pub streams: Vec<Stream>,
    /// Topics without joint states.
    pub others: Vec<String>,
    bad: Vec<Bad>,
}

/// Messages of one topic with the same joints and the same fields.
pub(crate) struct Stream {
    pub topic: String,
    /// Joints in the order of the first message.
    joints: Vec<String>,
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

impl Bag {
    /// Reads all files of a bag.
    pub fn read(source: &mut BagSource<'_>) -> Result<Self, Fault> {
        let mut gathered = Gathered::default();
        source.messages(0, &mut |message| gathered.take(message))?;
        let Gathered { streams, others, bad, .. } = gathered;
        let others: Vec<String> = others.into_iter().collect();
        if !streams.is_empty() {
            return Ok(Self { streams, others, bad });
        }
        Err(match bad.into_iter().next() {
            Some(bad) => (Place::Message(bad.message), bad.problem),
            None => (Place::File, BagProblem::NoJointStates(others).into()),
        })
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

    /// The columns without velocities, if one of these has no number that is finite, and a note that says which.
    pub fn without_dead_velocities(&self, columns: &Columns) -> (Columns, Vec<Note>) {
        let Some(dead) = columns.v.iter().find(|column| self.is_dead(&column.name)) else {
            return (columns.clone(), Vec::new());
        };
        let note = LayoutNote::NoVelocity { column: dead.name.clone() };
        (Columns { v: Vec::new(), ..columns.clone() }, vec![Note::Layout(note)])
    }

    /// Whether a column is there but has no number that is finite.
    fn is_dead(&self, name: &str) -> bool {
        let place = |stream: &Stream| stream.names.iter().position(|known| known == name);
        let mut found = self.streams.iter().filter_map(|stream| Some((stream, place(stream)?))).peekable();
        let is_dead = |(stream, at): (&Stream, usize)| stream.column(at).iter().all(|x| !x.is_finite());
        found.peek().is_some() && found.all(is_dead)
    }

    /// Refuses a topic of which a message with wanted joints is bad.
    fn check(&mut self, topic: &str, wanted: &Wanted) -> Result<(), Fault> {
        let names = || wanted.iter().flat_map(|(_, column)| column.names());
        let asks_for = |joint: &String| {
            let of_joint =
                |name: &str| Some(name.strip_prefix(topic)?.strip_prefix('/')?.rsplit_once('/')?.0 == joint);
            names().any(|name| of_joint(name).unwrap_or_default())
        };
        let matters =
            |bad: &Bad| bad.topic == topic && (bad.joints.is_empty() || bad.joints.iter().any(asks_for));
        match self.bad.iter().position(matters) {
            Some(at) => {
                let bad = self.bad.swap_remove(at);
                Err((Place::Message(bad.message), bad.problem))
            }
            None => Ok(()),
        }
    }

    /// The wanted columns, grouped by topic, with notes on their clocks.
    pub fn parts(&mut self, columns: &Columns) -> Result<(Vec<Part>, Vec<Note>), Fault> {
        let known = || self.names().into_iter().chain(["t".to_owned()]).collect();
        let unknown = |name: &str| (Place::File, Problem::NoColumn { name: name.to_owned(), known: known() });
        if columns.t.name != "t" {
            return Err(unknown(&columns.t.name));
        }
        let mut topics: Vec<(String, Wanted)> = Vec::new();
        for (index, column) in columns.wanted().enumerate() {
            let with = |name: &str| {
                self.streams.iter().find(|stream| stream.names.iter().any(|known| known == name))
            };
            let stream = with(&column.name).ok_or_else(|| unknown(&column.name))?;
            if let Some(name) = column.names().find(|name| with(name).is_none()) {
                return Err(unknown(name));
            }
            match topics.iter_mut().find(|(topic, _)| *topic == stream.topic) {
                Some((_, wanted)) => wanted.push((index, column.clone())),
                None => topics.push((stream.topic.clone(), vec![(index, column.clone())])),
            }
        }
        topics.iter().try_for_each(|(topic, wanted)| self.check(topic, wanted))?;
        let clock = self.clock();
        let notes = topics.iter().filter(|(topic, _)| clock.unstamped.contains(topic));
        let notes = notes.map(|(topic, _)| Note::Unstamped { topic: topic.clone() }).collect();
        let part = |(topic, wanted): (String, Wanted)| self.part(&topic, wanted, &clock, &columns.t);
        Ok((topics.into_iter().map(part).collect::<Result<_, _>>()?, notes))
    }

    /// Columns of a topic. A message with none of these joints is taken as another sender's and skipped; a message with
    /// only some of them is an error.
    fn part(&self, topic: &str, wanted: Wanted, clock: &Clock, t: &Column) -> Result<Part, Fault> {
        let mut samples: Vec<(Time, Vec<f64>)> = Vec::new();
        for stream in self.of_topic(topic) {
            let at = |name: &str| stream.names.iter().position(|known| known == name);
            let places = |column: &Column| column.names().map(at).collect::<Vec<_>>();
            let places: Vec<Vec<Option<usize>>> = wanted.iter().map(|(_, column)| places(column)).collect();
            if places.iter().flatten().all(Option::is_none) {
                continue;
            }
            if let Some((_, missing)) =
                wanted.iter().find(|(_, column)| column.names().any(|name| at(name).is_none()))
            {
                let message = stream.times.first().map_or(1, |time| time.message);
                return Err((Place::Message(message), BagProblem::MissingJoint(missing.name.clone()).into()));
            }
            for (time, row) in stream.samples() {
                let value = |((_, column), places): (&(usize, Column), &Vec<Option<usize>>)| {
                    column.value(places.iter().flatten().filter_map(|place| row.get(*place)).copied())
                };
                let values = wanted.iter().zip(&places).map(value).collect::<Vec<_>>();
                if let Some(at) = values.iter().position(|value| !value.is_finite()) {
                    let (message, column) = (time.message, wanted[at].1.name.clone());
                    return Err((Place::Value { message, column }, Problem::NotFinite(values[at])));
                }
                samples.push((time, values));
            }
        }
        samples.sort_by_key(|(time, _)| time.message);
        let t = samples.iter().map(|(time, _)| t.value([clock.seconds(topic, *time)])).collect();
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
