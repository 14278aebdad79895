//! A robust size of many residuals: the median of their amounts, by counting.

/// The standard deviation of a normal distribution over the median of its amounts.
pub(super) const OF_MEDIAN: f64 = 1.482_602_218_505_602;

/// The standard deviation that a normal distribution of the same median amount has, of amounts in any order; 0 where there are none.
pub(super) fn robust_deviation(mut amounts: Vec<f64>) -> f64 {
    if amounts.is_empty() {
        return 0.0;
    }
    let middle = amounts.len() / 2;
    let (_, median, _) = amounts.select_nth_unstable_by(middle, f64::total_cmp);
    OF_MEDIAN * *median
}

/// Counts of amounts, in classes of equal ratio: the sum of parts is the same in any order.
#[derive(Clone, Debug)]
pub(super) struct Amounts {
    counts: Vec<u64>,
}

/// Classes of a factor of ten.
const CLASSES: f64 = 32.0;
/// The smallest amount that is told from 0, as a power of ten, and the factors of ten above it.
const SMALLEST: f64 = -15.0;
const DECADES: usize = 30;

impl Amounts {
    /// None yet.
    pub fn new() -> Self {
        Self { counts: vec![0; DECADES * CLASSES as usize] }
    }

    /// Adds |x|; what is no number is large.
    pub fn add(&mut self, x: f64) {
        let last = self.counts.len() - 1;
        let class = (x.abs().log10() - SMALLEST) * CLASSES;
        let class = if class.is_nan() { last } else { class.clamp(0.0, last as f64) as usize };
        self.counts[class] += 1;
    }

    /// Adds those of another part.
    pub fn merge(&mut self, other: &Self) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(a, b)| *a += b);
    }

    /// The standard deviation that a normal distribution of the same median has; 0 where there are none.
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
