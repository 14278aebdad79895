mod economical;
mod plant;
mod robustness;
mod rules;

use super::policy::{Maker, Policy};
use leastaction_core::control::Plant;
use std::array::from_fn;
use std::sync::{Arc, Mutex};

/// Call of a policy: time, positions, velocities.
pub type Call = (f64, [f64; 2], [f64; 2]);

/// A law of one line, whose calls are recorded.
#[derive(Clone)]
pub struct Recorded {
    pub law: fn(f64, [f64; 2], [f64; 2]) -> f64,
    pub calls: Arc<Mutex<Vec<Call>>>,
}

impl Recorded {
    pub fn new(law: fn(f64, [f64; 2], [f64; 2]) -> f64) -> Self {
        Self { law, calls: Arc::default() }
    }

    /// A maker of this law.
    pub fn maker(law: fn(f64, [f64; 2], [f64; 2]) -> f64) -> Maker<'static> {
        Box::new(move || Box::new(Self::new(law)))
    }

    pub fn calls(&self) -> Vec<Call> {
        self.calls.lock().unwrap().clone()
    }
}

impl Policy for Recorded {
    fn reset(&mut self) {
        self.calls.lock().unwrap().clear();
    }

    fn torque(&mut self, t: f64, q: [f64; 2], v: [f64; 2]) -> f64 {
        self.calls.lock().unwrap().push((t, q, v));
        (self.law)(t, q, v)
    }
}

/// Compares the derivatives of a node of 3 ticks with differences, relative to 1 and their size.
pub fn check_derivatives<P: Plant<f64, D, 1>, const D: usize>(
    plant: &P,
    x: &[f64; D],
    u: f64,
    tolerance: f64,
) {
    let end = |x: &[f64; D], u: f64| {
        let mut motion = plant.begin(x).unwrap();
        plant.advance(&mut motion, (3, &[u]), &mut [0.0; D]).unwrap()
    };
    let found = plant.linearise_at(x, (3, &[u])).unwrap();
    for j in 0..=D {
        let unit = |i: usize| f64::from(u8::from(i == j));
        let d = 1e-6;
        let moved = |d: f64| end(&from_fn(|i| x[i] + d * unit(i)), u + d * unit(D));
        let (more, less) = (moved(d), moved(-d));
        for i in 0..D {
            let wanted = (more[i] - less[i]) / (2.0 * d);
            let got = if j < D { found.a[i][j] } else { found.b[i][0] };
            assert!((got - wanted).abs() < tolerance * (1.0 + wanted.abs()), "{i} {j}: {got} {wanted}");
        }
    }
}
