//! Signs of drift in the windows of a log.

use super::mean;
use super::windows::{Coordinate, Windows};
use crate::deviations::lasting;

/// Signs of a coordinate: mean, direction, command, windows, ticks.
pub const SIGNS: usize = 5;
/// The squared error of windows among the signs of a coordinate.
pub const WINDOWS: usize = 3;

/// Whether a sign, counted over all coordinates, is a mean of squares.
pub fn is_square(sign: usize) -> bool {
    sign % SIGNS >= WINDOWS
}

/// Expected contribution of a sign without change: z² = 1 of a normal number z, and half of it if it counts where z is positive alone.
pub fn expected(sign: usize) -> f64 {
    if is_square(sign) { 0.5 } else { 1.0 }
}

/// Covariance of the contributions of two signs with the correlation ρ over blocks that have some degrees of freedom, by the expansion of z²
/// and max(z, 0)² in Hermite polynomials up to the third. Chance adds to a squared correlation, which is taken away.
pub fn covariance([a, b]: [usize; 2], correlation: f64, freedom: f64) -> f64 {
    let first = 2.0 / core::f64::consts::PI;
    let square = correlation * correlation;
    let shown = square - (1.0 - square) / (freedom - 1.0);
    match (is_square(a), is_square(b)) {
        (false, false) => 2.0 * shown,
        (true, true) => first * correlation + 0.5 * shown + first / 6.0 * correlation * square,
        _ => shown,
    }
}

/// Part of the speed's root mean square at which a motion is about half a direction.
const SLOW: f64 = 0.1;

/// Sizes of errors, speeds and commands along the reference, of every coordinate.
pub struct Scales(Vec<Scale>);

struct Scale {
    error: f64,
    slow: f64,
    command: [f64; 2],
    square: f64,
}

impl Scales {
    /// Measures the reference.
    pub fn new(reference: &Windows) -> Self {
        let n = reference.whole.first().map_or(0, Vec::len);
        Self((0..n).map(|i| Scale::new(&reference.whole, i)).collect())
    }

    /// Signs of drift: for every coordinate its [`SIGNS`], each with a value for every window.
    pub fn signs(&self, windows: &Windows) -> Vec<Vec<f64>> {
        let sign = |i: usize, sign: usize| {
            windows.whole.iter().map(|window| self.0[i].signs(&window[i])[sign]).collect()
        };
        (0..self.0.len()).flat_map(|i| (0..SIGNS).map(move |k| (i, k))).map(|(i, k)| sign(i, k)).collect()
    }
}

impl Scale {
    fn new(windows: &[Vec<Coordinate>], i: usize) -> Self {
        let of = |value: fn(&Coordinate) -> f64| {
            mean(&windows.iter().map(|window| value(&window[i])).collect::<Vec<_>>())
        };
        let command = of(|window| window.mean.command);
        Self {
            error: of(|window| window.mean.error.powi(2)).sqrt(),
            slow: SLOW * of(|window| window.mean.velocity.powi(2)).sqrt(),
            command: [
                command,
                (of(|window| window.mean.command.powi(2)) - command * command).max(0.0).sqrt(),
            ],
            square: of(|window| window.square),
        }
    }

    fn signs(&self, window: &Coordinate) -> [f64; SIGNS] {
        let part = |x: f64, size: f64| if size > 0.0 { x / size } else { 0.0 };
        let [middle, spread] = self.command;
        let (error, v) = (part(window.mean.error, self.error), window.mean.velocity);
        let direction = part(v, v.hypot(self.slow));
        let command = part(window.mean.command - middle, spread);
        [error, error * direction, error * command, error * error, part(window.square, self.square)]
    }
}

/// Course of a sign along the reference.
pub struct Sign {
    /// Mean over windows.
    pub mean: f64,
    /// Variance over windows.
    pub variance: f64,
    /// Windows as uncertain in their mean as one independent window, 1 + 2Σρ; the sum ends at the first correlation that is not positive.
    pub time: f64,
}

impl Sign {
    pub fn new(values: &[f64]) -> Self {
        let mean = mean(values);
        let product = |lag: usize| {
            let pairs = values.iter().zip(values.iter().skip(lag));
            pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / values.len() as f64
        };
        let variance = product(0);
        let correlated = lasting(values.len(), product);
        Self { mean, variance, time: if variance > 0.0 { 1.0 + 2.0 * correlated / variance } else { 1.0 } }
    }
}
