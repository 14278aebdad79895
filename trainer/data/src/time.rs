//! Checks of the uniformity of time stamps.

use std::ops::Range;

use crate::problem::Problem;

/// Tolerance of an interval, relative to itself.
const TOLERANCE: f64 = 1e-6;

/// Number of equal intervals in a row, each of several steps, that indicate another step rather than gaps.
const STEP_RUN: usize = 3;

/// A row and its problem.
type RowFault = (usize, Problem);

/// Time stamps (s), and the largest rounding error of the difference of two stamps.
pub(crate) struct Stamps<'a> {
    t: &'a [f64],
    rounding: f64,
}

/// A row before which samples are missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Gap {
    pub(crate) row: usize,
    pub(crate) missing: u64,
}

impl<'a> Stamps<'a> {
    pub(crate) fn new(t: &'a [f64]) -> Self {
        let epsilon = if t.iter().all(|&t| is_single(t)) { f64::from(f32::EPSILON) } else { f64::EPSILON };
        let largest = t.iter().fold(0.0, |max: f64, t| max.max(t.abs()));
        // EPSILON is twice the relative error of one rounding. Each stamp is a rounded product that was rounded again
        // when it was stored.
        Self { t, rounding: 2.0 * epsilon * largest }
    }

    /// Rows of `run` from the second on, each with the stamp before it and its own.
    fn intervals(&self, run: &Range<usize>) -> impl Iterator<Item = (usize, f64, f64)> + use<'a> {
        let stamps = self.t.get(run.clone()).unwrap_or_default();
        (run.start + 1..).zip(stamps.windows(2)).filter_map(|(row, pair)| match *pair {
            [before, after] => Some((row, before, after)),
            _ => None,
        })
    }

    /// The median interval; an error unless all intervals are positive.
    pub(crate) fn median(&self, runs: &[Range<usize>]) -> Result<f64, RowFault> {
        let mut intervals = Vec::with_capacity(self.t.len());
        for (row, before, after) in runs.iter().flat_map(|run| self.intervals(run)) {
            if after <= before {
                return Err((row, Problem::Unsorted { before, after }));
            }
            intervals.push(after - before);
        }
        intervals.sort_unstable_by(f64::total_cmp);
        intervals.get(intervals.len() / 2).copied().ok_or((0, Problem::Empty))
    }

    /// The step: the mean of the intervals that agree with the median, as the shortest decimal number within rounding.
    pub(crate) fn step(&self, runs: &[Range<usize>]) -> Result<f64, RowFault> {
        let median = self.median(runs)?;
        // Rounding errors cancel between neighbouring intervals, so they count once per unbroken stretch.
        let (mut span, mut steps, mut stretches) = (0.0, 0.0, runs.len() as f64);
        for (_, before, after) in runs.iter().flat_map(|run| self.intervals(run)) {
            if matches!(self.steps(after - before, median), Ok(1)) {
                span += after - before;
                steps += 1.0;
            } else {
                stretches += 1.0;
            }
        }
        Ok(rounded(span / steps, self.rounding * stretches / steps))
    }

    /// Number of steps in an interval.
    fn steps(&self, interval: f64, h: f64) -> Result<u64, Problem> {
        let steps = (interval / h).round();
        let tolerance = TOLERANCE * interval + self.rounding.min(h / 4.0);
        if steps >= 1.0 && (interval - steps * h).abs() <= tolerance {
            Ok(steps as u64)
        } else if self.rounding > h / 4.0 {
            Err(Problem::CoarseTime { rounding: self.rounding, h })
        } else {
            Err(Problem::ChangingStep { found: interval, expected: h })
        }
    }

    /// The gaps of one trajectory.
    pub(crate) fn gaps(&self, run: &Range<usize>, h: f64) -> Result<Vec<Gap>, RowFault> {
        let mut gaps = Vec::new();
        let (mut last, mut equal) = (1, 0);
        for (row, before, after) in self.intervals(run) {
            let steps = self.steps(after - before, h).map_err(|problem| (row, problem))?;
            equal = if steps == last { equal + 1 } else { 1 };
            last = steps;
            if steps > 1 {
                gaps.push(Gap { row, missing: steps - 1 });
                if equal == STEP_RUN {
                    let problem = Problem::ChangingStep { found: after - before, expected: h };
                    return Err((row + 1 - STEP_RUN, problem));
                }
            }
        }
        Ok(gaps)
    }

    /// Checks that the median interval is the stated step.
    pub(crate) fn agree_with(&self, h: f64, runs: &[Range<usize>]) -> Result<(), RowFault> {
        let measured = self.median(runs)?;
        match self.steps(measured, h) {
            Ok(1) => Ok(()),
            Err(problem @ Problem::CoarseTime { .. }) => Err((0, problem)),
            _ => Err((0, Problem::StepMismatch { stated: h, measured })),
        }
    }
}

/// Checks that the reader will find no gaps and no other step in the stamps of a trajectory without gaps.
pub(crate) fn check(t: &[f64], h: f64) -> Result<(), Problem> {
    let stamps = Stamps::new(t);
    let uniform = stamps.gaps(&(0..t.len()), h).is_ok_and(|gaps| gaps.is_empty());
    if uniform { Ok(()) } else { Err(Problem::CoarseTime { rounding: stamps.rounding, h }) }
}

/// Whether `t` is a single-precision number, or the shortest decimal notation of one.
fn is_single(t: f64) -> bool {
    let single = t as f32;
    f64::from(single) == t || single.to_string().parse() == Ok(t)
}

/// The decimal number with the fewest digits within `error` of `x`; `x` itself if there is none.
pub(crate) fn rounded(x: f64, error: f64) -> f64 {
    (0..17)
        .filter_map(|digits| format!("{x:.digits$e}").parse::<f64>().ok())
        .find(|candidate| (candidate - x).abs() <= error)
        .unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(t: &[f64]) -> f64 {
        Stamps::new(t).step(std::slice::from_ref(&(0..t.len()))).unwrap()
    }

    fn grid(h: f64, rows: usize) -> Vec<f64> {
        (0..rows).map(|k| k as f64 * h).collect()
    }

    #[test]
    fn the_step_is_the_decimal_behind_the_stamps() {
        assert_eq!(step(&grid(0.05, 34)), 0.05);
        assert_eq!(step(&grid(1e-3, 100_000)), 1e-3);
        let single: Vec<f64> = (0..400).map(|k| f64::from(k as f32 * 0.05_f32)).collect();
        assert_eq!(step(&single), 0.05);
        let third = step(&grid(1.0 / 3.0, 50));
        assert!((third - 1.0 / 3.0).abs() <= 1e-16, "{third:e}");
    }

    #[test]
    fn gaps_do_not_move_the_step() {
        let mut t = grid(0.01, 100);
        t.drain(40..47);
        assert_eq!(step(&t), 0.01);
        let gaps = Stamps::new(&t).gaps(&(0..t.len()), 0.01).unwrap();
        assert_eq!(gaps, [Gap { row: 40, missing: 7 }]);
    }

    #[test]
    fn an_interval_off_by_more_than_a_millionth_is_refused() {
        let mut t: Vec<f64> = grid(0.1, 20).iter().map(|t| t + 1.0 / 3.0).collect();
        for late in &mut t[10..] {
            *late += 0.9e-7;
        }
        assert!(Stamps::new(&t).gaps(&(0..20), 0.1).is_ok());
        for late in &mut t[10..] {
            *late += 0.2e-7;
        }
        let (row, problem) = Stamps::new(&t).gaps(&(0..20), 0.1).unwrap_err();
        assert!(matches!((row, problem), (10, Problem::ChangingStep { expected: 0.1, .. })));
    }

    #[test]
    fn a_doubled_step_is_no_series_of_gaps() {
        let t = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9, 1.1, 1.3];
        let (row, problem) = Stamps::new(&t).gaps(&(0..10), 0.1).unwrap_err();
        assert!(matches!((row, problem), (6, Problem::ChangingStep { expected: 0.1, .. })));
        assert_eq!(Stamps::new(&t[..8]).gaps(&(0..8), 0.1).unwrap().len(), 2);
    }

    #[test]
    fn equal_stamps_are_unsorted() {
        let stamps = [0.0, 0.1, 0.1, 0.2];
        let (row, problem) = Stamps::new(&stamps).median(std::slice::from_ref(&(0..4))).unwrap_err();
        assert!(matches!((row, problem), (2, Problem::Unsorted { before: 0.1, after: 0.1 })));
    }

    #[test]
    fn stamps_coarser_than_the_step_are_told_apart_from_a_changing_one() {
        let late: Vec<f64> = (0..9).map(|k| f64::from(2e4_f32 + k as f32 * 1e-3)).collect();
        let (_, problem) = Stamps::new(&late).gaps(&(0..9), 1e-3).unwrap_err();
        assert!(matches!(problem, Problem::CoarseTime { .. }));
    }
}
