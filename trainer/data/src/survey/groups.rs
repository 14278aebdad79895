//! Groups of columns with the same quantity, one column of each joint.

use super::RawLog;
use super::words::{Qualifier, Quantity, qualifier, quantity, words};

/// Least number of joints that are numbered alike for them to be one limb beside other joints.
const LIMB: usize = 3;

/// Columns of one quantity of several joints.
pub(super) struct Group<'a> {
    pub quantity: Quantity,
    /// Rank of the word of the quantity, 0 for the best.
    pub rank: u8,
    /// Kind of the columns by their other words.
    pub qualifiers: Vec<Qualifier>,
    /// Common to all columns: topic, word of the quantity, qualifiers.
    key: String,
    pub columns: Vec<Named<'a>>,
}

/// A column, with the words of its joint.
#[derive(Clone)]
pub(super) struct Named<'a> {
    pub name: &'a str,
    pub joint: Vec<String>,
}

impl Named<'_> {
    /// The words of the joint without numbers.
    fn limb(&self) -> Vec<&String> {
        self.joint.iter().filter(|word| !is_digits(word)).collect()
    }
}

impl Group<'_> {
    pub fn has(&self, qualifier: Qualifier) -> bool {
        self.qualifiers.contains(&qualifier)
    }

    pub fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.to_owned()).collect()
    }

    /// The columns of these joints, in their order; `None` if there is none of some joint.
    pub fn of_joints(&self, joints: &[Vec<String>]) -> Option<Vec<String>> {
        let of = |joint: &Vec<String>| self.columns.iter().find(|column| column.joint == *joint);
        joints.iter().map(|joint| of(joint).map(|column| column.name.to_owned())).collect()
    }
}

/// The groups of all columns.
pub(super) fn groups(logs: &[RawLog]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for name in logs.iter().flat_map(|log| &log.names) {
        let Some(found) = of_name(name) else { continue };
        match groups.iter_mut().find(|group| group.key == found.key) {
            Some(group) if group.columns.iter().any(|column| column.name == name) => {}
            Some(group) => group.columns.extend(found.columns),
            None => groups.push(found),
        }
    }
    groups.into_iter().map(limb_alone).collect()
}

/// A group of one column; `None` if no word tells its quantity.
fn of_name(name: &str) -> Option<Group<'_>> {
    let (topic, joint, field) = by_topic(name).unwrap_or(("", name, ""));
    let (mut words, topic) = (words(joint), self::words(topic));
    words.extend(self::words(field));
    // The last of several words that fit equally well is the quantity: q in "joint_angle_q" as well as in "theta".
    let ranked = words.iter().enumerate().filter_map(|(at, word)| Some((quantity(word)?, at)));
    let ((rank, quantity), at) = ranked.min_by_key(|((rank, _), at)| (*rank, usize::MAX - at))?;
    let word = words.remove(at);
    let is_qualifier = |word: &&String| qualifier(word).is_some();
    let spoken: Vec<&String> = words.iter().chain(&topic).filter(is_qualifier).collect();
    let qualifiers = spoken.iter().filter_map(|word| qualifier(word)).collect();
    let of_column: Vec<&str> = words.iter().filter(is_qualifier).map(String::as_str).collect();
    let key = format!("{}/{word}/{}", topic.join(" "), of_column.join(" "));
    let joint = words.iter().filter(|word| !is_qualifier(word) && *word != "joint").cloned().collect();
    Some(Group { quantity, rank, qualifiers, key, columns: vec![Named { name, joint }] })
}

/// Topic, joint and field of a column of an MCAP file.
fn by_topic(name: &str) -> Option<(&str, &str, &str)> {
    let (joint, field) = name.rsplit_once('/')?;
    let (topic, joint) = joint.rsplit_once('/')?;
    topic.starts_with('/').then_some((topic, joint, field))
}

/// The numbered joints of the largest limb alone, if they are at least four or most of all joints: an arm without the
/// head and the torso beside it.
fn limb_alone(group: Group<'_>) -> Group<'_> {
    let size =
        |column: &Named<'_>| group.columns.iter().filter(|other| other.limb() == column.limb()).count();
    let Some(largest) = group.columns.iter().rev().max_by_key(|column| size(column)) else { return group };
    let (count, all) = (size(largest), group.columns.len());
    let has_numbers = largest.joint.iter().any(|word| is_digits(word));
    if !has_numbers || count <= LIMB && (count < LIMB || 2 * count <= all) {
        return group;
    }
    let columns = group.columns.iter().filter(|column| column.limb() == largest.limb()).cloned().collect();
    Group { columns, ..group }
}

fn is_digits(word: &str) -> bool {
    word.bytes().all(|byte| byte.is_ascii_digit())
}
