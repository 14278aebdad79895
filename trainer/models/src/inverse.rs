//! Inverse dynamics along motions.

use crate::Model;
use crate::parallel::{self, Pool};
use leastaction_core::model::ModelError;
use leastaction_programs::dynamics::InverseDynamics;
use leastaction_programs::{Row, WIDTH};

impl Model {
    /// Returns the commands u of inverse dynamics at states \[samples\]\[n\] (q, v and v̇, flat): with them the
    /// actuator's output τ = g u + o causes the acceleration; its delay and its lag are ignored. If friction grows with the load, τ
    /// is the solution of an implicit equation. A command that does not exist is NaN.
    ///
    /// # Errors
    /// See [`Model::system`]; [`ModelError::Shape`] if the states have different lengths.
    pub fn inverse_dynamics(&self, states: [&[f64]; 3]) -> Result<Vec<f64>, ModelError> {
        let (system, n) = (self.system()?, self.n());
        let count = states[0].len() / n.max(1);
        for found in states.map(<[f64]>::len) {
            if found != count * n {
                return Err(ModelError::Shape { what: "numbers of the states", found, compiled: count * n });
            }
        }
        let pool = Pool::new(move || InverseDynamics::new(&system));
        let blocks = parallel::map(count.div_ceil(WIDTH), &|block| {
            let first = block * WIDTH;
            let [q, v, a] = states.map(|all| side_by_side(all, n, (first, count)));
            let mut tau = vec![Row::default(); n];
            // A command that does not exist is NaN, so the failures need no handling.
            let _failures = pool.with(|own| own.evaluate(&self.weights, [&q, &v, &a], &mut tau));
            let lanes = WIDTH.min(count - first);
            (0..lanes).flat_map(|lane| tau.iter().map(move |tau| tau.0[lane])).collect::<Vec<f64>>()
        });
        let actuator = &self.facts.actuator;
        let command = |(k, tau): (usize, f64)| (tau - actuator.offset(k % n)) / actuator.gain(k % n);
        Ok(blocks.into_iter().flatten().enumerate().map(command).collect())
    }
}

/// States from `first` on as rows with one state per lane; lanes beyond the last state repeat it.
fn side_by_side(all: &[f64], n: usize, (first, count): (usize, usize)) -> Vec<Row> {
    let at = |lane: usize, i: usize| all[(first + lane).min(count - 1) * n + i];
    (0..n).map(|i| Row(std::array::from_fn(|lane| at(lane, i)))).collect()
}
