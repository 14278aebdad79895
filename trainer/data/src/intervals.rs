//! Intervals between samples.

/// Ratio of an interval to the median interval above which the interval is a gap.
pub(crate) const GAP: f64 = 2.5;

/// Positive intervals in ascending order.
pub(crate) struct Intervals {
    sorted: Vec<f64>,
    pub(crate) median: f64,
    pub(crate) shortest: f64,
}

impl Intervals {
    /// Collects intervals; `None` if there are none.
    pub(crate) fn of(intervals: impl Iterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = intervals.collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let (median, shortest) = (*sorted.get(sorted.len() / 2)?, *sorted.first()?);
        Some(Self { sorted, median, shortest })
    }

    /// Number of intervals.
    pub(crate) fn count(&self) -> usize {
        self.sorted.len()
    }

    /// The intervals that are not gaps; at least one.
    pub(crate) fn steps(&self) -> &[f64] {
        self.up_to(GAP * self.median)
    }

    /// The intervals up to a limit.
    pub(crate) fn up_to(&self, limit: f64) -> &[f64] {
        &self.sorted[..self.sorted.partition_point(|interval| *interval <= limit)]
    }

    /// The mean step between samples; an interval of about twice the median counts as two steps.
    pub(crate) fn mean_step(&self) -> f64 {
        let of_one = |(span, steps): (f64, f64), interval: &f64| {
            (span + interval, steps + (interval / self.median).round().max(1.0))
        };
        let (span, steps) = self.steps().iter().fold((0.0, 0.0), of_one);
        span / steps
    }
}
