//! The meaning of the columns of LeRobot's data sets, which their names state.

use super::words::{Quantity, quantity, words};
use super::{Guess, RawLog};
use crate::lerobot::TIME;
use std::f64::consts::TAU;

/// Features of positions, and of the positions that are commanded.
const STATE: &str = "observation.state";
const ACTION: &str = "action";

/// Largest number of a joint that is normalised to ±100, or of a gripper from 0 to 100, which a little more may be logged of.
const NORMALISED: f64 = 101.0;

impl RawLog {
    /// The log with its positions and commands: the state, and the action of as many joints.
    pub(super) fn stated_by_lerobot(self) -> Self {
        let q = self.joints(STATE);
        let of = |joint: &String| joint.strip_prefix(STATE).map(|joint| format!("{ACTION}{joint}"));
        let u: Option<Vec<String>> = q.iter().map(|q| of(q).filter(|u| self.names.contains(u))).collect();
        let actions = self.joints(ACTION);
        let u = u.unwrap_or(if actions.len() == q.len() { actions } else { Vec::new() });
        let most = q.iter().filter_map(|name| self.column(name)).flatten();
        let most = most.filter(|x| x.is_finite()).fold(0.0, |most: f64, x| most.max(x.abs()));
        let unit = (most > TAU).then_some("deg");
        let units = q.iter().chain(&u).filter_map(|name| Some((name.clone(), unit?))).collect();
        let questions = questions(most);
        let stated = Guess { t: Some(TIME.to_owned()), q, u, questions, ..Guess::default() };
        Self { stated: Some(stated), units, ..self }
    }

    /// Columns of a feature, without those whose names say that they are no positions.
    fn joints(&self, feature: &str) -> Vec<String> {
        let is_of = |name: &str| {
            name.strip_prefix(feature).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        let is_no_position = |name: &str| {
            let others = [Quantity::Velocity, Quantity::Force, Quantity::Other];
            let word =
                |word: &String| quantity(word).is_some_and(|(rank, of)| rank == 0 && others.contains(&of));
            words(name.strip_prefix(feature).unwrap_or_default()).iter().any(word)
        };
        self.names.iter().filter(|name| is_of(name) && !is_no_position(name)).cloned().collect()
    }
}

/// Whatever only a person knows of the units, given the largest position.
fn questions(most: f64) -> Vec<String> {
    let [mut first, second] = if most <= TAU {
        ["as radians do. Are they?", ""]
    } else if most <= NORMALISED {
        [
            "as degrees do, or numbers normalised to ±100 (use_degrees = false). Which?",
            "If normalised (a gripper always is, to 0..100), give scale = radians per unit, of each joint, in place of unit.",
        ]
    } else {
        ["as degrees do. Are they?", "A gripper from 0 to 100 is none: leave it out, or give its scale."]
    }
    .map(str::to_owned);
    first = format!("units: LeRobot states none; positions reach {most:.2}, {first}");
    [first, second].into_iter().filter(|line| !line.is_empty()).collect()
}
