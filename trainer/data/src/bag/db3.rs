//! Messages of a `.db3` file, in which ROS 2 records by SQLite.

use super::container::{Message, Visit};
use super::record::Channel;
use super::sqlite::{Database, Row, Source, Table, damaged};
use super::sqlite_record::{Value, values};
use crate::error::Fault;
use crate::place::Place;
use std::collections::HashMap;

/// A topic with the name of its type.
struct Topic {
    channel: Channel,
    kind: String,
}

/// Positions of columns in the table of messages.
struct Layout {
    topic: usize,
    timestamp: usize,
    data: usize,
}

/// Passes every message of a type that `wanted` names to `visit`; of others one of each topic, without its content. Returns the number of
/// all messages, of which the first is the one after `before`.
pub(super) fn messages(
    file: &mut dyn Source,
    before: u64,
    wanted: fn(&str) -> bool,
    visit: Visit<'_>,
) -> Result<u64, Fault> {
    let mut database = Database::open(file)?;
    let topics = topics(&mut database)?;
    let table = table(&mut database, "messages")?;
    let layout = Layout::of(&table)?;
    let (mut number, mut read) = (before, 0);
    let done = database.rows(&table, &mut |database, row| {
        number += 1;
        let topic = layout.topic(database, row)?;
        let Some(topic) = topics.get(&topic) else {
            return Err(damaged("a message is of a topic that the file does not name"));
        };
        let is_wanted = wanted(&topic.kind);
        let record = if is_wanted { database.whole(row)? } else { Vec::new() };
        let (log_time, content) = if is_wanted { layout.message(&record)? } else { (0, &[][..]) };
        read += record.len() as u64;
        visit(&Message { number, read, channel: &topic.channel, schema: &topic.kind, log_time, content })
    });
    done.map_err(|(place, problem)| match place {
        Place::File => (Place::Message(number.max(before + 1)), problem),
        place => (place, problem),
    })?;
    Ok(number)
}

/// The time of recording of the first message, ns; `None` if there is none that can be read.
pub(super) fn first_time(file: &mut dyn Source) -> Option<u64> {
    let mut database = Database::open(file).ok()?;
    let table = table(&mut database, "messages").ok()?;
    let layout = Layout::of(&table).ok()?;
    let mut first = None;
    let stop = || damaged("the first message is enough");
    let _stopped = database.rows(&table, &mut |_, row| {
        first = row.integer(layout.timestamp);
        Err(stop())
    });
    first.and_then(|time| u64::try_from(time).ok())
}

fn table(database: &mut Database<'_>, name: &str) -> Result<Table, Fault> {
    let missing = || damaged(&format!("it has no table {name}, as bags of ROS 2 have"));
    database.table(name)?.ok_or_else(missing)
}

fn position(table: &Table, column: &str) -> Result<usize, Fault> {
    let missing = || damaged(&format!("its table {} has no column {column}", table.name));
    table.columns.iter().position(|name| name == column).ok_or_else(missing)
}

/// All topics by their number.
fn topics(database: &mut Database<'_>) -> Result<HashMap<i64, Topic>, Fault> {
    let table = table(database, "topics")?;
    let [name, kind, encoding] = ["name", "type", "serialization_format"].map(|name| position(&table, name));
    let at = [name?, kind?, encoding?];
    let mut topics = HashMap::new();
    database.rows(&table, &mut |database, row| {
        let record = database.whole(row)?;
        let values = values(&record)?;
        let text = |column: usize| match values.get(column) {
            Some(Value::Text(text)) => Ok((*text).to_owned()),
            _ => Err(damaged("a topic has no name, type or encoding")),
        };
        let [topic, kind, encoding] = at.map(text);
        let id = (topics.len() % usize::from(u16::MAX)) as u16;
        let channel = Channel { id, schema: 0, topic: topic?, encoding: encoding? };
        topics.insert(row.id, Topic { channel, kind: kind? });
        Ok(())
    })?;
    Ok(topics)
}

impl Layout {
    fn of(table: &Table) -> Result<Self, Fault> {
        let at = |name| position(table, name);
        Ok(Self { topic: at("topic_id")?, timestamp: at("timestamp")?, data: at("data")? })
    }

    /// The number of a message's topic, if possible without its content.
    fn topic(&self, database: &mut Database<'_>, row: &Row<'_>) -> Result<i64, Fault> {
        if let Some(topic) = row.integer(self.topic) {
            return Ok(topic);
        }
        let record = database.whole(row)?;
        match values(&record)?.get(self.topic) {
            Some(Value::Integer(topic)) => Ok(*topic),
            _ => Err(damaged("a message has no topic")),
        }
    }

    /// Time of recording and content of a message.
    fn message<'r>(&self, record: &'r [u8]) -> Result<(u64, &'r [u8]), Fault> {
        let values = values(record)?;
        match [values.get(self.timestamp), values.get(self.data)] {
            [Some(Value::Integer(time)), Some(Value::Blob(content))] if *time >= 0 => {
                Ok((*time as u64, content))
            }
            _ => Err(damaged("a message has no time, or no content")),
        }
    }
}
