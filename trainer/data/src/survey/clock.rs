//! Statistics of a log's time stamps.

use crate::intervals::Intervals;

/// The clock of a log, in the units of its stamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time from the first to the last stamp.
    pub duration: f64,
    /// Median interval.
    pub median: f64,
    /// Shortest interval above 0.
    pub shortest: f64,
    /// Longest interval that is not a gap.
    pub longest: f64,
    /// Root mean square of (interval − median)/median, without gaps.
    pub jitter: f64,
    /// Number of intervals of more than 2.5 medians.
    pub gaps: usize,
    /// Number of stamps equal to the one before.
    pub repeated: usize,
    /// Number of stamps smaller than the one before.
    pub backwards: usize,
}

impl Clock {
    /// The clock of these stamps; `None` if no stamp is greater than the one before.
    #[must_use]
    pub fn of(stamps: &[f64]) -> Option<Self> {
        Self::of_pieces([stamps])
    }

    /// The clock of stamps in several pieces, between which time may do anything.
    #[must_use]
    pub fn of_pieces<'s>(pieces: impl IntoIterator<Item = &'s [f64], IntoIter: Clone>) -> Option<Self> {
        let pieces = pieces.into_iter();
        let differences = pieces.clone().flat_map(|stamps| stamps.windows(2)).map(|pair| pair[1] - pair[0]);
        let intervals = || differences.clone().filter(|interval| interval.is_finite());
        let forward = Intervals::of(intervals().filter(|interval| *interval > 0.0))?;
        let (median, steps) = (forward.median, forward.steps());
        let square: f64 = steps.iter().map(|interval| (interval / median - 1.0).powi(2)).sum();
        Some(Self {
            duration: pieces.filter_map(|stamps| Some(stamps.last()? - stamps.first()?)).sum(),
            median,
            shortest: forward.shortest,
            longest: *steps.last()?,
            jitter: (square / steps.len() as f64).sqrt(),
            gaps: forward.count() - steps.len(),
            repeated: intervals().filter(|interval| *interval == 0.0).count(),
            backwards: intervals().filter(|interval| *interval < 0.0).count(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_repeats_and_jitter_are_counted() {
        let stamps = [0.0, 1.0, 2.1, 3.0, 3.0, 4.0, 9.0, 10.0, 9.5, 10.5];
        let clock = Clock::of(&stamps).unwrap();
        assert_eq!((clock.gaps, clock.repeated, clock.backwards), (1, 1, 1));
        assert_eq!(clock.median, 1.0);
        assert!((clock.longest - 1.1).abs() < 1e-12 && (clock.shortest - 0.9).abs() < 1e-12);
        assert!((clock.jitter - (0.02_f64 / 6.0).sqrt()).abs() < 1e-12, "{}", clock.jitter);
        let apart = Clock::of_pieces([&stamps[..8], &stamps[8..]]).unwrap();
        assert_eq!((apart.backwards, apart.median, apart.duration), (0, 1.0, 11.0));
        assert!(Clock::of(&[1.0, 1.0]).is_none() && Clock::of(&[]).is_none());
    }
}
