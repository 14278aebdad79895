//! Fourier series of all coordinates: a periodic motion that starts and ends every period at rest if its coefficients are chosen so.

use crate::torque::Samples;
use leastaction_data::Rows;
use std::f64::consts::TAU;

/// A periodic motion of all coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Frequency f of the first harmonic (Hz).
    pub frequency: f64,
    /// Centre of every coordinate (rad, m).
    pub centre: Vec<f64>,
    /// Coefficients a and b of every harmonic, \[coordinates\]\[harmonics\] (rad, m).
    pub waves: Vec<Vec<[f64; 2]>>,
}

impl Series {
    /// Positions, velocities and accelerations at time t (s).
    #[must_use]
    pub fn at(&self, t: f64) -> [Vec<f64>; 3] {
        let n = self.centre.len();
        let mut state = [self.centre.clone(), vec![0.0; n], vec![0.0; n]];
        for (i, waves) in self.waves.iter().enumerate() {
            for (k, [a, b]) in waves.iter().enumerate() {
                let omega = TAU * self.frequency * (k + 1) as f64;
                let (sine, cosine) = (omega * t).sin_cos();
                let wave = a * cosine + b * sine;
                let terms = [wave, omega * (b * cosine - a * sine), -omega * omega * wave];
                state.iter_mut().zip(terms).for_each(|(state, term)| state[i] += term);
            }
        }
        state
    }

    /// States at `count` times from t = 0 on, `step` seconds apart, without torques.
    #[must_use]
    pub fn samples(&self, count: usize, step: f64) -> Samples {
        let t: Vec<f64> = (0..count).map(|k| k as f64 * step).collect();
        let states: Vec<[Vec<f64>; 3]> = t.iter().map(|t| self.at(*t)).collect();
        let n = self.centre.len();
        let rows = |part: usize| {
            let values = states.iter().flat_map(|state| state[part].iter().copied()).collect();
            Rows::from_flat(n, values).expect("n numbers a row")
        };
        let still = Rows::from_flat(n, vec![0.0; n * count]).expect("n numbers a row");
        Samples { q: rows(0), v: rows(1), a: rows(2), tau: still, t }
    }
}
