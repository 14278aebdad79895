mod economical;
mod plant;
mod robustness;
mod rules;

use super::policy::{Maker, Policy};
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
