//! Choice of the logs that are learned from and of those that are tested.

use super::error::HardwareError;
use super::machine::Machine;
use serde::Serialize;

/// Logs of a row, numbered from 0 in order of name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Split {
    /// Description in words.
    pub name: String,
    /// Logs that are tested after each training; the training uses all others.
    pub folds: Vec<Vec<usize>>,
}

impl Split {
    /// Creates a split that tests these logs, of `logs` in total.
    ///
    /// # Errors
    /// [`HardwareError::NoLog`], [`HardwareError::NoneLeft`].
    pub fn of(mut test: Vec<usize>, logs: usize) -> Result<Self, HardwareError> {
        test.sort_unstable();
        test.dedup();
        match test.last() {
            Some(&wanted) if wanted >= logs => Err(HardwareError::NoLog { wanted, found: logs }),
            _ if test.len() == logs => Err(HardwareError::NoneLeft(logs)),
            _ => Ok(Self { name: format!("logs {}", listed(&test, ", ")), folds: vec![test] }),
        }
    }

    /// Default splits of a machine. For the double pendulum, one tests the last 3 of 10 logs and the other the same
    /// number of odd logs; for the pendulum, each log is tested in turn.
    pub fn usual(machine: Machine, logs: usize) -> Vec<Self> {
        if machine == Machine::Pendulum {
            let name = "every log in turn".to_owned();
            return vec![Self { name, folds: (0..logs).map(|log| vec![log]).collect() }];
        }
        let count = (3 * logs / 10).max(1);
        let (late, mixed) = ((logs - count..logs).collect(), (0..count).map(|k| 2 * k + 1).collect());
        // For two or three logs the two splits may be equal.
        let mut splits: Vec<Self> =
            [late, mixed].into_iter().filter_map(|test| Self::of(test, logs).ok()).collect();
        splits.dedup();
        splits
    }

    /// All tested logs.
    pub fn tested(&self) -> Vec<usize> {
        self.folds.concat()
    }

    /// Label in the names of files and tasks: "1-3-5", or "each".
    pub fn label(&self) -> String {
        match &self.folds[..] {
            [test] => listed(test, "-"),
            _ => "each".to_owned(),
        }
    }
}

pub(super) fn listed(logs: &[usize], separator: &str) -> String {
    logs.iter().map(usize::to_string).collect::<Vec<_>>().join(separator)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_splits_of_ten_logs_are_the_late_and_the_mixed_ones() {
        let [late, mixed] = &Split::usual(Machine::DoublePendulum, 10)[..] else { panic!() };
        assert_eq!((late.label(), mixed.label()), ("7-8-9".to_owned(), "1-3-5".to_owned()));
        assert_eq!(Split::usual(Machine::DoublePendulum, 2).len(), 1);
        let [each] = &Split::usual(Machine::Pendulum, 4)[..] else { panic!() };
        assert_eq!((each.tested(), each.folds.len()), (vec![0, 1, 2, 3], 4));
    }

    #[test]
    fn logs_that_are_not_there_and_none_to_learn_from_are_refused() {
        let error = |test: &[usize]| Split::of(test.to_vec(), 3).unwrap_err().to_string();
        assert!(error(&[0, 7]).contains("--test 7: there are 3 logs"));
        assert!(error(&[2, 0, 1]).contains("none is left"));
        assert_eq!(Split::of(vec![2, 0, 2], 3).unwrap().folds, [[0, 2]]);
    }
}
