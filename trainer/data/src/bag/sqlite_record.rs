//! Records of SQLite's tables, and names of their columns.

use super::sqlite::damaged;
use crate::error::Fault;

/// A value of a record.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'r> {
    Null,
    Integer(i64),
    Real(f64),
    Text(&'r str),
    Blob(&'r [u8]),
}

/// Takes a number of one to nine bytes off the front: seven bits in each, eight in the ninth.
pub(super) fn varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0_u64;
    for k in 0..9 {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        if k == 8 {
            return Some(value << 8 | u64::from(*byte));
        }
        value = value << 7 | u64::from(byte & 0x7F);
        if byte & 0x80 == 0 {
            break;
        }
    }
    Some(value)
}

/// The values of a record.
pub(super) fn values(record: &[u8]) -> Result<Vec<Value<'_>>, Fault> {
    let fields = Fields::new(record).and_then(Iterator::collect);
    fields.ok_or_else(|| damaged("a row is shorter than its fields, or has a text that is not UTF-8"))
}

/// The values of a record one by one; `None` for one that is cut off.
pub(super) struct Fields<'r> {
    types: &'r [u8],
    body: &'r [u8],
}

impl<'r> Fields<'r> {
    pub fn new(record: &'r [u8]) -> Option<Self> {
        let mut rest = record;
        let header = usize::try_from(varint(&mut rest)?).ok()?;
        let (types, body) = (record.get(record.len() - rest.len()..header)?, record.get(header..)?);
        Some(Self { types, body })
    }

    fn value(&mut self) -> Option<Value<'r>> {
        let kind = varint(&mut self.types)?;
        let length = match kind {
            0 | 8 | 9 => 0,
            1..=4 => kind,
            5 => 6,
            6 | 7 => 8,
            10 | 11 => return None,
            _ => (kind - 12) / 2,
        };
        let (own, rest) = self.body.split_at_checked(usize::try_from(length).ok()?)?;
        self.body = rest;
        Some(match kind {
            0 => Value::Null,
            8 | 9 => Value::Integer(kind as i64 - 8),
            1..=6 => Value::Integer(integer(own)),
            7 => Value::Real(f64::from_be_bytes(own.try_into().ok()?)),
            _ if kind % 2 == 0 => Value::Blob(own),
            _ => Value::Text(std::str::from_utf8(own).ok()?),
        })
    }
}

impl<'r> Iterator for Fields<'r> {
    type Item = Option<Value<'r>>;

    fn next(&mut self) -> Option<Self::Item> {
        (!self.types.is_empty()).then(|| self.value())
    }
}

/// A signed number, its highest byte first.
fn integer(bytes: &[u8]) -> i64 {
    let negative = bytes.first().is_some_and(|byte| byte & 0x80 != 0);
    bytes.iter().fold(if negative { -1 } else { 0 }, |value, byte| value << 8 | i64::from(*byte))
}

/// Names of the columns in `CREATE TABLE name(column TYPE …, …)`, unquoted.
pub(super) fn columns(sql: &str) -> Vec<String> {
    let inner = sql.split_once('(').map_or("", |(_, inner)| inner);
    let (mut depth, mut all) = (0_usize, vec![String::new()]);
    for letter in inner.chars() {
        match letter {
            '(' => depth += 1,
            ')' if depth == 0 => break,
            ')' => depth -= 1,
            ',' if depth == 0 => all.push(String::new()),
            _ => all.iter_mut().next_back().into_iter().for_each(|last| last.push(letter)),
        }
    }
    let name = |column: &String| {
        let word = column.split_whitespace().next().unwrap_or_default();
        word.trim_matches(['"', '`', '[', ']', '\'']).to_owned()
    };
    all.iter().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_seven_bits_a_byte_and_eight_in_the_ninth() {
        for (bytes, value) in [
            (&[0x7F][..], 0x7F),
            (&[0x81, 0x00], 0x80),
            (&[0xFF; 9], u64::MAX),
            (&[0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 5], 5),
        ] {
            let mut rest = bytes;
            assert_eq!((varint(&mut rest), rest), (Some(value), &[][..]));
            assert_eq!(varint(&mut &bytes[..bytes.len() - 1]), None);
        }
    }

    #[test]
    fn integers_are_signed_and_records_are_cut_nowhere() {
        assert_eq!([integer(&[0xFF]), integer(&[0x80, 0]), integer(&[0, 0x80, 0])], [-1, -32768, 32768]);
        let record = [6, 1, 0, 9, 19, 16, 0xFE, b'a', b'b', b'c', 7, 8];
        let expected =
            [Value::Integer(-2), Value::Null, Value::Integer(1), Value::Text("abc"), Value::Blob(&[7, 8])];
        assert_eq!(values(&record).unwrap(), expected);
        assert!((0..record.len()).all(|end| values(&record[..end]).is_err()));
    }

    #[test]
    fn columns_are_named_in_the_statement() {
        let sql = "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL, \"data\" BLOB (3,4) NOT NULL)";
        assert_eq!(columns(sql), ["id", "topic_id", "data"]);
        assert_eq!(columns("CREATE VIEW"), [""]);
    }
}
