//! What the numbers of a column are like.

/// The steps between values of a grid may be off by this part.
const ROUNDING: f64 = 0.02;

/// Values that are looked at for a grid at most.
const LOOKED_AT: usize = 20_000;

/// The numbers of a column, in its units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal {
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
    /// Cells without a number.
    pub missing: usize,
    /// The step of which all values are multiples, as those of an encoder are.
    pub grid: Option<f64>,
    /// Standard deviation of what changes from sample to sample and is no motion: a robust one of fourth differences, of a rounded signal
    /// that of its rounding at least.
    pub noise: f64,
}

impl Signal {
    /// Of these numbers; `None` where there is none.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let known: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
        let least = known.iter().copied().min_by(f64::total_cmp)?;
        let greatest = known.iter().copied().max_by(f64::total_cmp)?;
        let grid = grid(&known);
        // A rounded value is off by a uniform error.
        let of_grid = grid.map_or(0.0, |grid| grid / 12f64.sqrt());
        let noise = noise(&known).max(of_grid);
        Some(Self { least, greatest, missing: values.len() - known.len(), grid, noise })
    }

    /// Whether it has one value throughout.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.least == self.greatest
    }
}

/// The largest step of which the differences of all values are multiples, if they are those of a grid.
fn grid(values: &[f64]) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().take(LOOKED_AT).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.dedup();
    let range = sorted.last()? - sorted.first()?;
    let steps: Vec<f64> =
        sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 1e-9 * range).collect();
    let least = steps.iter().copied().min_by(f64::total_cmp)?;
    let whole = |step: &f64| (step / least - (step / least).round()).abs() <= ROUNDING;
    // Of few values, or of one for nearly every sample, nothing can be said.
    let many = steps.len() >= 8 && (steps.len() as f64) < 0.8 * values.len().min(LOOKED_AT) as f64;
    (many && steps.iter().all(whole)).then_some(least)
}

/// A smooth motion has next to no fourth difference; of white noise σ its variance is 70 σ².
fn noise(values: &[f64]) -> f64 {
    let fourth = |x: &[f64]| (x[0] - 4.0 * x[1] + 6.0 * x[2] - 4.0 * x[3] + x[4]).abs();
    let mut sizes: Vec<f64> = values.windows(5).map(fourth).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    // Of a normal deviate the median size is 0.6745 σ.
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
        // A fixed sequence with a uniform distribution of deviation 0.01.
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
