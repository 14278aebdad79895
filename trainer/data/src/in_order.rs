//! Samples whose stamps are late: a busy logger stamped them after it was held up.

use crate::error::Fault;
use crate::intervals::{GAP, Intervals};
use crate::place::Place;
use crate::problem::Problem;

/// Largest number of samples in a row that are late.
const OVERTAKEN: usize = 3;
/// Largest fraction of samples that may be left out for their stamps; with more of them time is wrong altogether.
const MANY: f64 = 0.2;
/// Intervals before and after a sample, in median intervals, between which its stamp is late.
const LATE: [f64; 2] = [1.5, 0.5];

/// Samples of a trajectory in the order of time.
#[derive(Default)]
pub(crate) struct InOrder {
    pub(crate) t: Vec<f64>,
    pub(crate) rows: Vec<usize>,
    /// Number of samples with the stamp of the one before.
    pub(crate) repeated: usize,
    /// Number of samples with a stamp that is too late.
    pub(crate) late: usize,
}

impl InOrder {
    /// The samples whose stamps rise. Of equal stamps the first is kept. A stamp that lies after that of a following
    /// sample is late, and its sample is left out.
    ///
    /// # Errors
    /// [`Problem::Unsorted`] with the place at which time goes back for good.
    pub(crate) fn of(
        stamps: impl Iterator<Item = (usize, f64)>,
        place: impl Fn(usize) -> Place,
    ) -> Result<Self, Fault> {
        let (mut own, mut first) = (Self::default(), None);
        for (row, now) in stamps {
            if own.t.last() == Some(&now) {
                own.repeated += 1;
                continue;
            }
            let before = own.t.last().copied().unwrap_or(now);
            if now < before {
                first.get_or_insert((row, before, now));
            }
            if !own.leave_out_later_than(now) {
                return Err((place(row), Problem::Unsorted { before, after: now }));
            }
            own.t.push(now);
            own.rows.push(row);
        }
        let count = own.t.len() + own.repeated + own.late;
        match first.filter(|_| own.late as f64 > MANY * count as f64) {
            Some((row, before, after)) => Err((place(row), Problem::Unsorted { before, after })),
            None => {
                own.leave_out_between();
                Ok(own)
            }
        }
    }

    /// Leaves out the last samples if they are later than `now`; returns false if these are many.
    fn leave_out_later_than(&mut self, now: f64) -> bool {
        let later = self.t.iter().rev().take(OVERTAKEN + 1).take_while(|t| **t >= now).count();
        if later > OVERTAKEN {
            return false;
        }
        let kept = self.t.len() - later;
        self.t.truncate(kept);
        self.rows.truncate(kept);
        self.late += later;
        true
    }

    /// Leaves out samples that are late by less than a step, if they are few: where stamps jitter always, they are right.
    fn leave_out_between(&mut self) {
        let Some(Intervals { median, .. }) = Intervals::of(self.t.windows(2).map(|pair| pair[1] - pair[0]))
        else {
            return;
        };
        let [long, short] = LATE;
        let is_late = |k: usize| {
            let [before, after] = [self.t[k] - self.t[k - 1], self.t[k + 1] - self.t[k]];
            before > long * median && after < short * median && before + after < GAP * median
        };
        let late: Vec<usize> = (1..self.t.len().max(2) - 1).filter(|k| is_late(*k)).collect();
        if late.len() as f64 > 0.5 * MANY * self.t.len() as f64 {
            return;
        }
        let kept = |k: usize| late.binary_search(&k).is_err();
        self.t = (0..self.t.len()).filter(|k| kept(*k)).map(|k| self.t[k]).collect();
        self.rows = (0..self.rows.len()).filter(|k| kept(*k)).map(|k| self.rows[k]).collect();
        self.late += late.len();
    }
}
