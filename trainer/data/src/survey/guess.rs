//! Guesses of the meaning of columns from their names.

use super::groups::{Group, groups};
use super::words::{Qualifier, Quantity, is_of_nanoseconds, words};
use super::{Clock, Goals, RawLog, Signal};

/// Columns that may be t, q, v and u; to be confirmed by a person.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Guess {
    /// Time.
    pub t: Option<String>,
    /// Nanoseconds to be added to the time, which has whole seconds.
    pub nanosec: Option<String>,
    /// Whether the time is written as dates.
    pub is_date: bool,
    /// Positions.
    pub q: Vec<String>,
    /// Velocities; none, or one per position.
    pub v: Vec<String>,
    /// Drive forces; none, or one per position.
    pub u: Vec<String>,
    /// Alternatives for u, such as measured besides commanded forces.
    pub other_u: Vec<Vec<String>>,
    /// Questions about the columns that no log answers, for the person who confirms them.
    pub questions: Vec<String>,
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

impl Guess {
    /// The guess for the columns of a file.
    #[must_use]
    pub fn of(logs: &[RawLog]) -> Self {
        if let Some(stated) = logs.iter().find_map(|log| log.stated.clone()) {
            return stated;
        }
        let groups = groups(logs);
        let time = Self::of_time(logs, &groups);
        let all_q =
            ranked(logs, &groups, Quantity::Position, |group| [!is_measured(group), is_commanded(group)]);
        let Some(q) = all_q.first() else { return time.by_derivatives(logs) };
        let joints: Vec<Vec<String>> = q.columns.iter().map(|column| column.joint.clone()).collect();
        let of_joints = |group: &Group<'_>| {
            let same_number = || Some(group.names()).filter(|names| names.len() == joints.len());
            group.of_joints(&joints).or_else(same_number)
        };
        let v = ranked(logs, &groups, Quantity::Velocity, |group| [!is_measured(group), is_commanded(group)]);
        let u = ranked(logs, &groups, Quantity::Force, |group| [!is_commanded(group), false]);
        let mut u = u.into_iter().filter_map(of_joints);
        let first_u = u.next();
        let v = v.into_iter().find_map(of_joints).unwrap_or_default();
        let goals = all_q.iter().skip(1).copied().filter(|group| is_commanded(group)).find_map(of_joints);
        let guess = Self { q: q.names(), v, other_u: u.collect(), ..time };
        match first_u {
            Some(u) => Self { u, ..guess },
            None => guess.with_goals(logs, goals.unwrap_or_default()),
        }
    }

    /// The guess with commanded positions for u, if positions follow them.
    fn with_goals(self, logs: &[RawLog], u: Vec<String>) -> Self {
        let logs: Vec<&RawLog> = logs.iter().collect();
        let with = Self { u, ..self.clone() };
        if Goals::of(&logs, &with).is_some_and(|goals| goals.are_positions()) { with } else { self }
    }

    /// The columns of time alone.
    fn of_time(logs: &[RawLog], groups: &[Group<'_>]) -> Self {
        if let Some(dates) = logs.iter().find_map(|log| log.dates.clone()) {
            return Self { t: Some(dates), is_date: true, ..Self::default() };
        }
        if let Some((sec, nanosec)) = seconds_and_nanoseconds(logs) {
            return Self { t: Some(sec), nanosec: Some(nanosec), ..Self::default() };
        }
        let times = groups.iter().filter(|group| group.quantity == Quantity::Time);
        let times = times.flat_map(|group| group.columns.iter().map(|column| (group.rank, column)));
        let rising = times.filter(|(_, column)| is_time(logs, column.name));
        let named = rising.min_by_key(|(rank, column)| (*rank, column.joint.len()));
        let t = named.map(|(_, column)| column.name.to_owned()).or_else(|| unnamed_time(logs));
        Self { t, ..Self::default() }
    }
}

/// Groups of a quantity of which some column changes, the best first; `preferred` comes before the words.
fn ranked<'g, 'a>(
    logs: &[RawLog],
    groups: &'g [Group<'a>],
    quantity: Quantity,
    preferred: fn(&Group<'_>) -> [bool; 2],
) -> Vec<&'g Group<'a>> {
    let fits = |group: &&Group<'_>| {
        group.quantity == quantity && !group.has(Qualifier::Computed) && moves(logs, group)
    };
    let mut found: Vec<&Group<'_>> = groups.iter().filter(fits).collect();
    found.sort_by_key(|group| (preferred(group), group.rank));
    found
}

fn is_measured(group: &Group<'_>) -> bool {
    group.has(Qualifier::Measured)
}

fn is_commanded(group: &Group<'_>) -> bool {
    group.has(Qualifier::Commanded)
}

/// The column of this name in the first log that has it.
fn column<'a>(logs: &'a [RawLog], name: &str) -> Option<&'a [f64]> {
    logs.iter().find_map(|log| log.column(name))
}

/// Whether a column rises mostly; one of nanoseconds must be a whole time.
fn is_time(logs: &[RawLog], name: &str) -> bool {
    let rises =
        |column: &[f64]| column.windows(2).filter(|pair| pair[1] > pair[0]).count() * 2 > column.len();
    let is_of_nanoseconds = words(name).iter().any(|word| is_of_nanoseconds(word));
    column(logs, name).is_some_and(if is_of_nanoseconds { is_whole_time } else { rises })
}

/// Whether nanoseconds are a whole time, not a part of a second.
fn is_whole_time(column: &[f64]) -> bool {
    column.windows(2).all(|pair| pair[1] >= pair[0]) && column.last().is_some_and(|last| *last >= SECOND)
}

/// One second in ns.
const SECOND: f64 = 1e9;

/// Columns of whole seconds, and of the nanoseconds beside them, whose names differ in that word alone.
fn seconds_and_nanoseconds(logs: &[RawLog]) -> Option<(String, String)> {
    let is_seconds = |word: &str| matches!(word, "sec" | "secs" | "seconds" | "s");
    let names = || logs.iter().flat_map(|log| &log.names);
    let rest = |name: &str, is: &dyn Fn(&str) -> bool| {
        let (found, rest): (Vec<String>, Vec<String>) = words(name).into_iter().partition(|word| is(word));
        (!found.is_empty()).then_some(rest)
    };
    let within = |name: &&String| {
        let is_part = |x: &f64| x.is_nan() || (0.0..SECOND).contains(x);
        column(logs, name).is_some_and(|column| column.iter().all(is_part))
    };
    names().filter(within).find_map(|nanosec| {
        let others = rest(nanosec, &is_of_nanoseconds)?;
        let sec = names().find(|name| rest(name, &is_seconds).as_ref() == Some(&others))?;
        Some((sec.clone(), nanosec.clone()))
    })
}

/// The first column of a file without a header that rises as a clock does.
fn unnamed_time(logs: &[RawLog]) -> Option<String> {
    let names = logs.iter().flat_map(|log| &log.names).take_while(|name| name.starts_with('#'));
    let is_clock = |name: &&String| {
        let clock = column(logs, name).and_then(Clock::of);
        clock.is_some_and(|clock| clock.backwards == 0 && clock.repeated == 0 && clock.jitter < JITTER)
    };
    names.into_iter().find(is_clock).cloned()
}

/// Jitter of a clock below which a rising column may be time.
const JITTER: f64 = 0.5;

/// Whether any of the columns changes.
fn moves(logs: &[RawLog], group: &Group<'_>) -> bool {
    let changes =
        |name: &str| column(logs, name).and_then(Signal::of).is_some_and(|signal| !signal.is_constant());
    group.columns.iter().any(|column| changes(column.name))
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
            columns: names.iter().map(column).collect(),
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            ..RawLog::default()
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
    fn positions_to_go_to_are_commands_where_no_forces_are() {
        let names = ["time", "pos_des1", "pos_des2", "pos_meas1", "pos_meas2"];
        let guess = Guess::of(&[log(&names, &[])]);
        assert_eq!((&guess.q[0][..], &guess.u[..]), ("pos_meas1", &names.map(str::to_owned)[1..3]));
        let with_forces = [&names[..], &["tau1", "tau2"]].concat();
        assert_eq!(Guess::of(&[log(&with_forces, &[])]).u, ["tau1", "tau2"]);
        assert!(Guess::of(&[log(&names, &names[1..3])]).u.is_empty());
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
    fn joints_by_words_are_one_group() {
        let names = ["time", "shoulder_position", "elbow_position", "shoulder_effort", "elbow_effort"];
        let guess = Guess::of(&[log(&names, &[])]);
        assert_eq!(
            (guess.q, guess.u),
            (vec![names[1].into(), names[2].into()], vec![names[3].into(), names[4].into()])
        );
        assert!(guess.other_u.is_empty());
        let names = ["time", "a_position", "b_position", "b_effort", "a_effort"];
        assert_eq!(Guess::of(&[log(&names, &[])]).u, ["a_effort", "b_effort"]);
    }

    #[test]
    fn an_arm_is_taken_without_its_torso_and_wrists_with_their_shoulder() {
        let position = |joint: &str| format!("{joint}_joint_position");
        let arm: Vec<String> = (1..=7).map(|k| position(&format!("arm_{k}"))).collect();
        let others = ["torso_lift", "head_1", "head_2"].map(position);
        let all =
            ["time"].into_iter().chain(others.iter().chain(&arm).map(String::as_str)).collect::<Vec<_>>();
        assert_eq!(Guess::of(&[log(&all, &[])]).q, arm);
        let arm = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"].map(position);
        let all = ["time"].into_iter().chain(arm.iter().map(String::as_str)).collect::<Vec<_>>();
        assert_eq!(Guess::of(&[log(&all, &[])]).q, arm);
    }

    #[test]
    fn what_is_computed_is_not_measured() {
        let names = [
            "time",
            "q1",
            "q2",
            "tau1",
            "tau2",
            "tau_fric1",
            "tau_fric2",
            "friction_comp_torque1",
            "friction_comp_torque2",
        ];
        let guess = Guess::of(&[log(&names, &[])]);
        assert_eq!((guess.u, guess.other_u), (vec!["tau1".to_owned(), "tau2".to_owned()], Vec::new()));
    }

    #[test]
    fn nanoseconds_alone_are_no_time() {
        let pair = Guess::of(&[log(&["stamp.sec", "stamp.nanosec", "pos", "tau"], &[])]);
        assert_eq!((pair.t.as_deref(), pair.nanosec.as_deref()), (Some("stamp.sec"), Some("stamp.nanosec")));
        assert_eq!(Guess::of(&[log(&["nanosec", "pos", "tau"], &[])]).t, None);
        let bare = Guess::of(&[log(&["#1", "#2"], &[])]);
        assert_eq!((bare.t.as_deref(), bare.q.len()), (Some("#1"), 0));
    }

    #[test]
    fn the_unit_of_time_follows_from_the_interval() {
        assert_eq!(time_unit(2e-3), "s");
        assert_eq!(time_unit(2.0), "ms");
        assert_eq!(time_unit(2e3), "us");
        assert_eq!(time_unit(2e6), "ns");
    }
}
