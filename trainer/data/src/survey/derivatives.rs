//! Columns without names: those whose derivatives are other columns are positions, with their velocities.

use super::{Clock, Guess, RawLog, Signal, time_unit};
use crate::columns::unit;

/// Number of stretches of a log over which increments are compared.
const STRETCHES: usize = 50;

/// Difference of a column's increments from the integral of another one, relative to their size, below which the other one is its
/// derivative.
const ALIKE: f64 = 0.2;

impl Guess {
    /// The guess with positions, velocities and forces of a file without a header. Forces are the other columns if these
    /// are as many as positions, or the first of several such groups, and a question names the others; otherwise
    /// nothing is guessed.
    pub(super) fn by_derivatives(self, logs: &[RawLog]) -> Self {
        let (Some(log), Some(t)) = (logs.first(), &self.t) else { return self };
        let Some(stamps) = seconds(log, t).filter(|_| t.starts_with('#')) else { return self };
        let moving: Vec<&String> = log.names.iter().filter(|name| *name != t && moves(log, name)).collect();
        let pairs = pairs(log, &moving, &stamps);
        let is_derived = |name: &String| pairs.iter().any(|(_, derivative)| *derivative == name);
        let of_positions: Vec<_> = pairs.iter().filter(|(position, _)| !is_derived(position)).collect();
        let is_position = |name: &String| of_positions.iter().any(|(position, _)| *position == name);
        let is_other = |name: &&String| *name != t && !is_derived(name) && !is_position(name);
        let others: Vec<String> = log.names.iter().filter(is_other).cloned().collect();
        let q: Vec<String> = of_positions.iter().map(|(position, _)| (*position).clone()).collect();
        let v = of_positions.iter().map(|(_, velocity)| (*velocity).clone()).collect();
        let Some(mut groups) = groups(log, &q, &others) else { return self };
        let u = if groups.is_empty() { Vec::new() } else { groups.remove(0) };
        let also = (!groups.is_empty()).then(|| question(&groups));
        Self { q, v, u, questions: self.questions.into_iter().chain(also).collect(), ..self }
    }
}

/// Columns in groups of one for every position, without groups that rest; `None` if they are not as many. Where positions stand side by
/// side, so do the columns of a group; elsewhere the columns of a joint do.
fn groups(log: &RawLog, q: &[String], others: &[String]) -> Option<Vec<Vec<String>>> {
    let moving = || others.iter().filter(|name| moves(log, name)).cloned().collect::<Vec<_>>();
    let (n, whole) = (q.len(), |count: usize| !q.is_empty() && count.is_multiple_of(q.len()));
    let others = if whole(others.len()) { others.to_vec() } else { moving() };
    if !whole(others.len()) {
        return None;
    }
    let places: Vec<_> =
        q.iter().filter_map(|name| log.names.iter().position(|known| known == name)).collect();
    let side_by_side = places.windows(2).all(|pair| pair[1] == pair[0] + 1);
    let count = others.len() / n;
    let of = |k: usize| match side_by_side {
        true => others[k * n..(k + 1) * n].to_vec(),
        false => others.iter().skip(k).step_by(count).cloned().collect(),
    };
    let all = (0..count).map(of);
    Some(all.filter(|group: &Vec<String>| group.iter().any(|name| moves(log, name))).collect())
}

/// Which columns may be forces instead.
fn question(groups: &[Vec<String>]) -> String {
    let numbers = |group: &Vec<String>| format!("[{}]", group.join(", ").replace('#', ""));
    let all: Vec<String> = groups.iter().map(numbers).collect();
    format!(
        "u: the log does not say which columns are forces (N m or N; currents need a scale); others are {}",
        all.join(", ")
    )
}

/// Stamps of a log, s.
fn seconds(log: &RawLog, t: &str) -> Option<Vec<f64>> {
    let stamps = log.column(t)?;
    let second = unit(time_unit(Clock::of(stamps)?.median))?;
    Some(stamps.iter().map(|t| second * t).collect())
}

fn moves(log: &RawLog, name: &str) -> bool {
    log.column(name).and_then(Signal::of).is_some_and(|signal| !signal.is_constant())
}

/// Columns, each with its derivative: of several columns with the same derivative the one that fits best.
fn pairs<'a>(log: &RawLog, names: &[&'a String], t: &[f64]) -> Vec<(&'a String, &'a String)> {
    let best = |derivative: &&'a String| {
        let others = names.iter().filter(|name| *name != derivative);
        let fit = |name: &&'a String| Some((*name, unlike(t, log.column(name)?, log.column(derivative)?)?));
        let (name, unlike) = others.filter_map(fit).min_by(|a, b| a.1.total_cmp(&b.1))?;
        (unlike < ALIKE).then_some((name, *derivative))
    };
    let mut found: Vec<_> = names.iter().filter_map(best).collect();
    found.sort_by_key(|(name, _)| names.iter().position(|known| known == name));
    found
}

/// Difference between increments of q and the integral of v over stretches of the log, relative to the increments.
/// Integrals bear noise that derivatives do not.
fn unlike(t: &[f64], q: &[f64], v: &[f64]) -> Option<f64> {
    let length = (t.len() / STRETCHES).max(1);
    let ends = (0..).step_by(length).take_while(|start| start + length < t.len());
    let (mut off, mut size) = (0.0, 0.0);
    for start in ends {
        let rows = start..start + length;
        let area: f64 = rows.clone().map(|k| 0.5 * (v[k] + v[k + 1]) * (t[k + 1] - t[k])).sum();
        let change = q[rows.end] - q[rows.start];
        if (area + change).is_finite() {
            off += (change - area).abs();
            size += change.abs();
        }
    }
    (size > 0.0).then_some(off / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A log at 200 Hz without a header, with these columns beside time.
    fn guess(columns: &[fn(f64) -> f64]) -> Guess {
        let t: Vec<f64> = (0..600).map(|k| 5.0 * f64::from(k)).collect();
        let of = |column: &fn(f64) -> f64| t.iter().map(|t| column(1e-3 * t)).collect::<Vec<_>>();
        let columns: Vec<Vec<f64>> = columns.iter().map(of).collect();
        let columns: Vec<Vec<f64>> = std::iter::once(t.clone()).chain(columns).collect();
        Guess::of(&[RawLog {
            names: (1..=columns.len()).map(|k| format!("#{k}")).collect(),
            columns,
            ..RawLog::default()
        }])
    }

    const POSITIONS: [fn(f64) -> f64; 2] =
        [|t| 0.5 * (3.0 * t).sin(), |t| (2.0 * t).cos() + 0.3 * (7.0 * t).sin()];
    const VELOCITIES: [fn(f64) -> f64; 2] =
        [|t| 1.5 * (3.0 * t).cos(), |t| 2.1 * (7.0 * t).cos() - 2.0 * (2.0 * t).sin()];
    const FORCES: [fn(f64) -> f64; 2] = [|t| 3.0 * (5.0 * t).cos(), |t| (11.0 * t).sin()];

    #[test]
    fn positions_and_velocities_are_told_by_their_derivatives() {
        let [[q0, q1], [v0, v1], [u0, u1]] = [POSITIONS, VELOCITIES, FORCES];
        let found = guess(&[q0, q1, v0, v1, u0, u1]);
        assert_eq!((found.t.as_deref(), &found.q[..]), (Some("#1"), &["#2".to_owned(), "#3".to_owned()][..]));
        assert_eq!(
            (found.v, found.u),
            (vec!["#4".to_owned(), "#5".into()], vec!["#6".to_owned(), "#7".into()])
        );
        // Accelerations are neither velocities nor forces; joints may stand one after the other.
        let acceleration: fn(f64) -> f64 = |t| -4.5 * (3.0 * t).sin();
        let found = guess(&[u0, v0, acceleration, q0]);
        assert_eq!(
            (found.q, found.v, found.u),
            (vec!["#5".to_owned()], vec!["#3".into()], vec!["#2".into()])
        );
    }

    #[test]
    fn several_groups_may_be_forces() {
        let [[q0, q1], [v0, v1], [u0, u1]] = [POSITIONS, VELOCITIES, FORCES];
        let names = |numbers: [u8; 2]| numbers.map(|k| format!("#{k}")).to_vec();
        let rest: fn(f64) -> f64 = |_| 0.5;
        let side_by_side = guess(&[q0, q1, v0, v1, rest, rest, u0, u1, u1, rest]);
        assert_eq!((side_by_side.q, side_by_side.u), (names([2, 3]), names([8, 9])));
        assert!(side_by_side.questions[0].ends_with("others are [10, 11]"), "{:?}", side_by_side.questions);
        let by_joint = guess(&[q0, v0, u0, u1, q1, v1, u1, u0]);
        assert_eq!((by_joint.q, by_joint.u), (names([2, 6]), names([4, 8])));
        assert!(by_joint.questions[0].ends_with("others are [5, 9]"), "{:?}", by_joint.questions);
    }

    #[test]
    fn nothing_is_guessed_where_nothing_shows_it() {
        let [[q0, q1], [v0, _], [u0, u1]] = [POSITIONS, VELOCITIES, FORCES];
        let [v1, both] = [VELOCITIES[1], |t| 3.0 * (3.0 * t).cos()];
        for columns in [&[q0, u0][..], &[q0, q1, u0, u1], &[q0, q1, v0, v1, u0, u1, both], &[q0, both]] {
            let found = guess(columns);
            assert_eq!((found.t.as_deref(), found.q.len(), found.u.len()), (Some("#1"), 0, 0));
        }
    }
}
