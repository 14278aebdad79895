//! Guesses of the meaning of columns from their names.

use super::{RawLog, Signal};

/// Columns that may be t, q, v and u; to be confirmed by a person.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Guess {
    /// Time.
    pub t: Option<String>,
    /// Positions.
    pub q: Vec<String>,
    /// Velocities; none, or one per position.
    pub v: Vec<String>,
    /// Drive forces; none, or one per position.
    pub u: Vec<String>,
    /// Alternatives for u, such as measured besides commanded forces.
    pub other_u: Vec<Vec<String>>,
}

/// The unit, named as in [`crate::unit`], in which this median interval corresponds to a sampling rate between 2 Hz and
/// 1 MHz.
#[must_use]
pub fn time_unit(median: f64) -> &'static str {
    match median {
        ..0.5 => "s",
        0.5..500.0 => "ms",
        500.0..5e5 => "us",
        _ => "ns",
    }
}

/// Names, and parts of names, of positions, velocities and forces; a full match takes precedence over a partial one.
const POSITIONS: [&str; 5] = ["q", "pos", "angle", "theta", "enc"];
const VELOCITIES: [&str; 5] = ["v", "vel", "qd", "dq", "speed"];
const FORCES: [&str; 5] = ["u", "tau", "torque", "effort", "force"];
const TIMES: [&str; 4] = ["t", "time", "stamp", "sec"];

/// Parts of names that decide between groups of equal rank: measured columns are preferred for motion, commanded ones
/// for forces.
const MEASURED: [&str; 2] = ["meas", "raw"];
const COMMANDED: [&str; 4] = ["con", "cmd", "com", "des"];

/// Columns whose names differ only in a number.
struct Group<'a> {
    stem: String,
    names: Vec<&'a str>,
}

impl Guess {
    /// The guess for the columns of a file.
    #[must_use]
    pub fn of(logs: &[RawLog]) -> Self {
        let groups = groups(logs);
        let t =
            groups.iter().filter(|group| is_time(logs, group)).min_by_key(|group| rank(&group.stem, &TIMES));
        let t = t.map(|group| group.names[0].to_owned());
        let all = |kind: &[&str], [prefer, avoid]: [&[&str]; 2], n: Option<usize>| -> Vec<Vec<String>> {
            let fits = |group: &&Group<'_>| {
                n.is_none_or(|n| group.names.len() == n)
                    && rank(&group.stem, kind).is_some()
                    && t.as_deref() != Some(group.names[0])
                    && moves(logs, group)
            };
            let has = |group: &Group<'_>, parts: &[&str]| parts.iter().any(|part| group.stem.contains(part));
            let mut found: Vec<&Group<'_>> = groups.iter().filter(fits).collect();
            found.sort_by_key(|group| (!has(group, prefer), has(group, avoid), rank(&group.stem, kind)));
            let names = |group: &Group<'_>| group.names.iter().map(|name| (*name).to_owned()).collect();
            found.into_iter().map(names).collect()
        };
        let first =
            |kind: &[&str], n| all(kind, [&MEASURED, &COMMANDED], n).into_iter().next().unwrap_or_default();
        let q = first(&POSITIONS, None);
        let n = Some(q.len()).filter(|n| *n > 0);
        if n.is_none() {
            return Self { t, ..Self::default() };
        }
        let mut u = all(&FORCES, [&COMMANDED, &[]], n).into_iter();
        let (v, first_u) = (first(&VELOCITIES, n), u.next().unwrap_or_default());
        Self { v, u: first_u, other_u: u.collect(), t, q }
    }
}

/// Groups columns whose names are equal without digits, brackets and word separators; columns of a topic are grouped by
/// field and topic.
fn groups(logs: &[RawLog]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for name in logs.iter().flat_map(|log| &log.names) {
        let stem: String = match by_topic(name) {
            Some((topic, field)) => letters(field) + &letters(topic),
            None => letters(name),
        };
        match groups.iter_mut().find(|group| group.stem == stem) {
            Some(group) if group.names.contains(&name.as_str()) => {}
            Some(group) => group.names.push(name),
            None => groups.push(Group { stem, names: vec![name] }),
        }
    }
    groups
}

fn letters(text: &str) -> String {
    text.chars().filter(|c| c.is_alphabetic()).collect::<String>().to_lowercase()
}

/// Topic and field of a column of an MCAP file.
fn by_topic(name: &str) -> Option<(&str, &str)> {
    let (joint, field) = name.rsplit_once('/')?;
    let (topic, _) = joint.rsplit_once('/')?;
    topic.starts_with('/').then_some((topic, field))
}

/// The column of this name in the first log that has it.
fn column<'a>(logs: &'a [RawLog], name: &str) -> Option<&'a [f64]> {
    logs.iter().find_map(|log| log.column(name))
}

/// Rank of a match: 0 if the stem is one of the words, 1 if it begins with a word of more than one letter, 2 if it contains such a word;
/// otherwise `None`.
fn rank(stem: &str, words: &[&str]) -> Option<u8> {
    let long = || words.iter().filter(|word| word.len() > 1);
    if words.contains(&stem) {
        Some(0)
    } else if long().any(|word| stem.starts_with(word)) {
        Some(1)
    } else {
        long().any(|word| stem.contains(word)).then_some(2)
    }
}

fn is_time(logs: &[RawLog], group: &Group<'_>) -> bool {
    let rises =
        |column: &[f64]| column.windows(2).filter(|pair| pair[1] > pair[0]).count() * 2 > column.len();
    group.names.len() == 1
        && rank(&group.stem, &TIMES).is_some()
        && column(logs, group.names[0]).is_some_and(rises)
}

/// Whether any of the columns changes.
fn moves(logs: &[RawLog], group: &Group<'_>) -> bool {
    let changes =
        |name: &&str| column(logs, name).and_then(Signal::of).is_some_and(|signal| !signal.is_constant());
    group.names.iter().any(changes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(names: &[&str], constant: &[&str]) -> RawLog {
        let column = |name: &&str| -> Vec<f64> {
            let slope = if constant.contains(name) { 0.0 } else { 1.0 };
            (0..20).map(|k| slope * f64::from(k)).collect()
        };
        RawLog {
            topic: None,
            columns: names.iter().map(column).collect(),
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            others: Vec::new(),
        }
    }

    #[test]
    fn a_drive_with_commanded_and_measured_torques() {
        let names = [
            "time",
            "pos_filt1",
            "pos_filt2",
            "pos_meas1",
            "pos_meas2",
            "vel_meas1",
            "vel_meas2",
            "tau_fric1",
            "tau_fric2",
            "tau_meas1",
            "tau_meas2",
            "tau_con1",
            "tau_con2",
        ];
        let guess = Guess::of(&[log(&names, &["tau_fric1", "tau_fric2"])]);
        assert_eq!(guess.t.as_deref(), Some("time"));
        assert_eq!(
            (guess.q, guess.v),
            (vec!["pos_meas1".into(), "pos_meas2".into()], vec!["vel_meas1".into(), "vel_meas2".into()])
        );
        assert_eq!(guess.u, ["tau_con1", "tau_con2"]);
        assert_eq!(guess.other_u, [["tau_meas1", "tau_meas2"]]);
    }

    #[test]
    fn names_of_other_habits() {
        let guess = Guess::of(&[log(&["t", "q[0]", "q[1]", "q[2]", "tau[0]", "tau[1]", "tau[2]"], &[])]);
        assert_eq!((guess.q.len(), guess.v.len(), guess.u.len()), (3, 0, 3));
        let guess = Guess::of(&[log(&["stamp_ns", "position", "velocity", "effort"], &[])]);
        assert_eq!(
            (guess.t.as_deref(), &guess.q[..], &guess.u[..]),
            (Some("stamp_ns"), &["position".into()][..], &["effort".into()][..])
        );
        let guess = Guess::of(&[log(&["temperature", "mode"], &[])]);
        assert_eq!(guess, Guess::default());
    }

    #[test]
    fn topics_of_measured_and_of_commanded_joints() {
        let names =
            |topic: &str, field: &str| ["shoulder", "elbow"].map(|joint| format!("{topic}/{joint}/{field}"));
        let topic = |topic: &str| {
            let names = [names(topic, "position"), names(topic, "velocity"), names(topic, "effort")].concat();
            log(&std::iter::once("t").chain(names.iter().map(String::as_str)).collect::<Vec<_>>(), &[])
        };
        let guess = Guess::of(&[topic("/joint_commands"), topic("/arm/joint_states")]);
        assert_eq!(guess.t.as_deref(), Some("t"));
        assert_eq!(guess.q, names("/arm/joint_states", "position"));
        assert_eq!(guess.v, names("/arm/joint_states", "velocity"));
        assert_eq!(guess.u, names("/joint_commands", "effort"));
        assert_eq!(guess.other_u, [names("/arm/joint_states", "effort")]);
    }

    #[test]
    fn the_unit_of_time_follows_from_the_interval() {
        assert_eq!(time_unit(2e-3), "s");
        assert_eq!(time_unit(2.0), "ms");
        assert_eq!(time_unit(2e3), "us");
        assert_eq!(time_unit(2e6), "ns");
    }
}
