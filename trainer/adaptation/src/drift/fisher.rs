//! Fisher's F distribution.

/// Terms of the continued fraction, far more than it needs for any degrees of freedom here.
const TERMS: u32 = 10_000;
/// Relative accuracy of the continued fraction.
const ACCURACY: f64 = 1e-14;
/// Halvings of the interval of a quantile's logarithm.
const HALVINGS: u32 = 80;
/// Logarithm of the bounds of a quantile.
const FARTHEST: f64 = 200.0;

/// Value f of Fisher's F distribution with ν₁ and ν₂ degrees of freedom, each positive, for which P(F > f) is `tail`, within (0, 1).
pub fn quantile([first, second]: [f64; 2], tail: f64) -> f64 {
    let exceeds = |log: f64| above([first, second], log.exp()) > tail;
    let [mut low, mut high] = [-FARTHEST, FARTHEST];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if exceeds(middle) { low = middle } else { high = middle }
    }
    (0.5 * (low + high)).exp()
}

/// Probability P(F > f) = I_x(ν₂/2, ν₁/2), x = ν₂/(ν₂ + ν₁f).
pub fn above([first, second]: [f64; 2], f: f64) -> f64 {
    let x = second / (second + first * f);
    incomplete_beta([0.5 * second, 0.5 * first], x)
}

/// Regularised incomplete beta function I_x(a, b).
fn incomplete_beta([a, b]: [f64; 2], x: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    let scale = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p();
    if x < (a + 1.0) / (a + b + 2.0) {
        scale.exp() * fraction([a, b], x) / a
    } else {
        1.0 - scale.exp() * fraction([b, a], 1.0 - x) / b
    }
}

/// Continued fraction of the incomplete beta function, by Lentz's method (W. J. Lentz, Applied Optics 15, 1976).
fn fraction([a, b]: [f64; 2], x: f64) -> f64 {
    let away = |x: f64| if x.abs() < f64::MIN_POSITIVE { f64::MIN_POSITIVE } else { x };
    let mut d = 1.0 / away(1.0 - (a + b) * x / (a + 1.0));
    let [mut c, mut value] = [1.0, d];
    for m in (1..TERMS).map(f64::from) {
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = value;
        for term in [even, odd] {
            d = 1.0 / away(1.0 + term * d);
            c = away(1.0 + term / c);
            value *= c * d;
        }
        if (value / before - 1.0).abs() < ACCURACY {
            break;
        }
    }
    value
}

/// Logarithm of the gamma function of a positive number, by Stirling's series above 10.
fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut below) = (x, 0.0);
    while x < 10.0 {
        below += x.ln();
        x += 1.0;
    }
    let square = x * x;
    let series =
        (1.0 / 12.0 - (1.0 / 360.0 - (1.0 / 1260.0 - 1.0 / (1680.0 * square)) / square) / square) / x;
    (x - 0.5) * x.ln() - x + 0.5 * (2.0 * core::f64::consts::PI).ln() + series - below
}

#[cfg(test)]
mod tests {
    use super::{above, quantile};

    /// Tables of F: upper percentiles; with one degree of freedom it is the square of Student's t, with infinitely many it is χ²/ν.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (free, tail, expected) in [
            ([1.0, 10.0], 0.05, 4.9646),
            ([5.0, 10.0], 0.01, 5.6363),
            ([10.0, 5.0], 0.01, 10.051),
            ([4.0, 20.0], 0.001, 7.096),
            ([10.0, 1e9], 0.01, 2.3209),
        ] {
            let found = quantile(free, tail);
            assert!((found / expected - 1.0).abs() < 1e-3, "{free:?}, {tail}: {found} instead of {expected}");
        }
    }

    #[test]
    fn a_quantile_is_exceeded_as_often_as_it_says() {
        for free in [[0.7, 3.0], [12.5, 40.0], [300.0, 9.0]] {
            for tail in [0.5, 1e-3, 1e-9] {
                assert!((above(free, quantile(free, tail)) / tail - 1.0).abs() < 1e-6, "{free:?}, {tail}");
            }
        }
    }

    /// With two degrees of freedom each, P(F > f) = 1/(1 + f).
    #[test]
    fn tails_of_two_degrees_of_freedom_are_rational() {
        for f in [0.01, 1.0, 7.0, 1e6] {
            assert!((above([2.0; 2], f) * (1.0 + f) - 1.0).abs() < 1e-12, "{f}");
        }
    }
}
