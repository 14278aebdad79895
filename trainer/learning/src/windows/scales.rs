//! Robust scale of many residuals: the median of their absolute values, by counting.

/// Ratio of the standard deviation of a normal distribution to the median of its absolute values.
pub(super) const OF_MEDIAN: f64 = 1.482_602_218_505_602;

/// Robust standard deviation: that of a normal distribution with the same median absolute value; 0 if there are no values.
pub(super) fn robust_deviation(mut amounts: Vec<f64>) -> f64 {
    if amounts.is_empty() {
        return 0.0;
    }
    let middle = amounts.len() / 2;
    let (_, median, _) = amounts.select_nth_unstable_by(middle, f64::total_cmp);
    OF_MEDIAN * *median
}

/// Histogram of absolute values in bins of equal ratio; the order in which values are added does not matter.
#[derive(Clone, Debug)]
pub(super) struct Amounts {
    counts: Vec<u64>,
}

/// Bins per factor of ten.
const CLASSES: f64 = 32.0;
/// Smallest value that is distinguished from 0, as a power of ten.
const SMALLEST: f64 = -15.0;
/// Number of decades above it.
const DECADES: usize = 30;

impl Amounts {
    /// An empty histogram.
    pub fn new() -> Self {
        Self { counts: vec![0; DECADES * CLASSES as usize] }
    }

    /// Adds |x|; NaN counts as a large value.
    pub fn add(&mut self, x: f64) {
        let last = self.counts.len() - 1;
        let class = (x.abs().log10() - SMALLEST) * CLASSES;
        let class = if class.is_nan() { last } else { class.clamp(0.0, last as f64) as usize };
        self.counts[class] += 1;
    }

    /// Adds another histogram.
    pub fn merge(&mut self, other: &Self) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(a, b)| *a += b);
    }

    /// The standard deviation of a normal distribution with the same median absolute value; 0 if there are no values.
    pub fn scale(&self) -> f64 {
        let all: u64 = self.counts.iter().sum();
        let mut below = 0;
        for (class, count) in self.counts.iter().enumerate() {
            below += count;
            if all > 0 && 2 * below >= all {
                return OF_MEDIAN * 10_f64.powf(SMALLEST + (class as f64 + 0.5) / CLASSES);
            }
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_large_ones_do_not_matter() {
        let mut amounts = [Amounts::new(), Amounts::new()];
        for k in 0..1000 {
            amounts[k % 2].add(if k < 100 { 1e3 } else { 1e-3 * k as f64 });
        }
        amounts[1].add(f64::NAN);
        let [mut all, other] = amounts;
        all.merge(&other);
        let expected = OF_MEDIAN * 0.6;
        assert!((all.scale() / expected - 1.0).abs() < 0.05, "{}", all.scale());
        assert_eq!(Amounts::new().scale(), 0.0);
    }
}
