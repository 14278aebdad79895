//! Statistics of a column's values.

/// Tolerance within which a step between values counts as a whole multiple of the smallest step, relative to that step.
const ROUNDING: f64 = 0.02;

/// Largest number of values that are examined for a grid.
const LOOKED_AT: usize = 20_000;

/// Statistics of a column, in its units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal {
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub greatest: f64,
    /// Number of cells without a number.
    pub missing: usize,
    /// Smallest step of which all differences of values are multiples, as for an encoder.
    pub grid: Option<f64>,
    /// Standard deviation of the noise from sample to sample: a robust estimate from fourth differences, but for a
    /// rounded signal at least that of the rounding.
    pub noise: f64,
}

impl Signal {
    /// The statistics of these values; `None` if none is finite.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let known: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
        let least = known.iter().copied().min_by(f64::total_cmp)?;
        let greatest = known.iter().copied().max_by(f64::total_cmp)?;
        let grid = grid(&known);
        // The rounding error is uniformly distributed.
        let of_grid = grid.map_or(0.0, |grid| grid / 12f64.sqrt());
        let noise = noise(&known).max(of_grid);
        Some(Self { least, greatest, missing: values.len() - known.len(), grid, noise })
    }

    /// Whether all values are equal.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.least == self.greatest
    }
}

/// Step of the grid that the values lie on, if they do.
fn grid(values: &[f64]) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().take(LOOKED_AT).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.dedup();
    let range = sorted.last()? - sorted.first()?;
    let steps: Vec<f64> =
        sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 1e-9 * range).collect();
    let least = steps.iter().copied().min_by(f64::total_cmp)?;
    let whole = |step: &f64| (step / least - (step / least).round()).abs() <= ROUNDING;
    // A grid is only recognised with enough distinct values, which are clearly fewer than the samples.
    let many = steps.len() >= 8 && (steps.len() as f64) < 0.8 * values.len().min(LOOKED_AT) as f64;
    (many && steps.iter().all(whole)).then_some(least)
}

/// Noise from fourth differences, which nearly vanish for a smooth motion and have the variance 70 σ² for white noise
/// σ.
fn noise(values: &[f64]) -> f64 {
    let fourth = |x: &[f64]| (x[0] - 4.0 * x[1] + 6.0 * x[2] - 4.0 * x[3] + x[4]).abs();
    let mut sizes: Vec<f64> = values.windows(5).map(fourth).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    // The median absolute value of a normal distribution is 0.6745 σ.
    sizes.get(sizes.len() / 2).map_or(0.0, |median| median / 0.6745 / 70f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(k: usize) -> f64 {
        (0.01 * k as f64).sin() + 0.3 * (0.027 * k as f64).cos()
    }

    #[test]
    fn the_grid_of_an_encoder_is_found_and_its_noise() {
        let count = std::f64::consts::TAU / 4096.0;
        let values: Vec<f64> = (0..2000).map(|k| (motion(k) / count).round() * count).collect();
        let signal = Signal::of(&values).unwrap();
        assert!((signal.grid.unwrap() / count - 1.0).abs() < 1e-9, "{signal:?}");
        assert!(signal.noise >= count / 12f64.sqrt() && signal.noise < count, "{signal:?}");
    }

    #[test]
    fn noise_is_told_from_motion() {
        // A fixed uniform sequence with a standard deviation of 0.01.
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let values: Vec<f64> = (0..4000).map(|k| motion(k) + 0.01 * 12f64.sqrt() * uniform()).collect();
        let signal = Signal::of(&values).unwrap();
        assert!((0.009..0.011).contains(&signal.noise) && signal.grid.is_none(), "{signal:?}");
        let smooth: Vec<f64> = (0..4000).map(motion).collect();
        assert!(Signal::of(&smooth).unwrap().noise < 1e-6);
        assert!(Signal::of(&[2.0; 30]).unwrap().is_constant() && Signal::of(&[f64::NAN]).is_none());
    }
}
