//! A zero-phase low-pass filter.

use std::f64::consts::{PI, TAU};

/// A digital Butterworth low-pass filter of even order, by the bilinear transform with prewarping, run forward and backward: no phase,
/// and twice the attenuation (−6 dB at the cut-off).
///
/// At each end the signal is extended by its odd reflection, 3 (order + 1) samples long, and the filter starts in the
/// steady state of the first extended sample, as in `scipy.signal.filtfilt`. The result is therefore less accurate near
/// the ends, for about one period of the cut-off frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Butterworth {
    sections: Vec<Section>,
}

/// A second-order section (b₀ + b₁z⁻¹ + b₂z⁻²)/(1 + a₁z⁻¹ + a₂z⁻²); in a low-pass filter b₁ = 2b₀ and b₂ = b₀.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Section {
    gain: f64,
    a1: f64,
    a2: f64,
}

impl Butterworth {
    /// A filter of this even order with this cut-off (Hz) at this step (s). `None` if the order is odd or 0, or if the cut-off is not
    /// between 0 and half the sampling rate.
    #[must_use]
    pub fn new(order: usize, cut_off: f64, step: f64) -> Option<Self> {
        let normalized = cut_off * step;
        if order == 0 || order % 2 == 1 || !(normalized > 0.0 && normalized < 0.5) {
            return None;
        }
        let warped = (PI * normalized).tan();
        let section = |k: usize| {
            // Twice the cosine of the angle between the pole and the negative real axis.
            let damping = 2.0 * (PI * (2 * k + 1) as f64 / (2 * order) as f64).sin();
            let scale = 1.0 + damping * warped + warped * warped;
            Section {
                gain: warped * warped / scale,
                a1: 2.0 * (warped * warped - 1.0) / scale,
                a2: (1.0 - damping * warped + warped * warped) / scale,
            }
        };
        Some(Self { sections: (0..order / 2).map(section).collect() })
    }

    /// Filters a signal.
    #[must_use]
    pub fn filter(&self, signal: &[f64]) -> Vec<f64> {
        let padding = (3 * (2 * self.sections.len() + 1)).min(signal.len().saturating_sub(1));
        let mut padded = odd_extension(signal, padding);
        for _ in 0..2 {
            self.sections.iter().for_each(|section| section.run(&mut padded));
            padded.reverse();
        }
        padded[padding..padded.len() - padding].to_vec()
    }

    /// Power gain |H|² at a frequency (Hz), which is the amplitude gain of [`Butterworth::filter`].
    #[must_use]
    pub fn gain(&self, frequency: f64, step: f64) -> f64 {
        let (cos, cos2) = ((TAU * frequency * step).cos(), (2.0 * TAU * frequency * step).cos());
        let of = |s: &Section| {
            let power = 1.0 + s.a1 * s.a1 + s.a2 * s.a2 + 2.0 * s.a1 * (1.0 + s.a2) * cos + 2.0 * s.a2 * cos2;
            s.gain * s.gain * (6.0 + 8.0 * cos + 2.0 * cos2) / power
        };
        self.sections.iter().map(of).product()
    }
}

impl Section {
    /// Filters a signal in place, in transposed direct form II, starting from the steady state of its first sample.
    fn run(&self, signal: &mut [f64]) {
        let Some(first) = signal.first().copied() else { return };
        let Self { gain, a1, a2 } = *self;
        // A low-pass section passes a constant unchanged.
        let mut second = (gain - a2) * first;
        let mut next = (2.0 * gain - a1) * first + second;
        for x in signal {
            let y = gain * *x + next;
            next = 2.0 * gain * *x - a1 * y + second;
            second = gain * *x - a2 * y;
            *x = y;
        }
    }
}

/// Extends a signal by `padding` samples at each end, by point reflection about its first and its last sample.
fn odd_extension(signal: &[f64], padding: usize) -> Vec<f64> {
    let (Some(first), Some(last)) = (signal.first(), signal.last()) else { return Vec::new() };
    let before = signal.iter().skip(1).take(padding).rev().map(|x| 2.0 * first - x);
    let after = signal.iter().rev().skip(1).take(padding).map(|x| 2.0 * last - x);
    before.chain(signal.iter().copied()).chain(after).collect()
}

/// dx/dt by central differences, one-sided at the ends.
pub(crate) fn derivative(signal: &[f64], step: f64) -> Vec<f64> {
    let last = signal.len().saturating_sub(1);
    let slope = |k: usize| {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
        (signal[to] - signal[from]) / ((to - from).max(1) as f64 * step)
    };
    (0..signal.len()).map(slope).collect()
}
