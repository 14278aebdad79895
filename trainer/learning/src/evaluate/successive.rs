//! Predictions one after the other, which together cover logs.

use super::horizons::{HALF, Prediction, Predictor};
use leastaction_core::model::ModelError;

impl Predictor<'_> {
    /// Predictions over `seconds` each (s), one after the other: each starts where the one before ends. The few samples at both ends of a
    /// log that no start state is known for have none before the first.
    ///
    /// # Errors
    /// [`ModelError`] as for [`Predictor::predict`].
    pub fn successive(&self, seconds: f64) -> Result<Vec<Prediction>, ModelError> {
        let steps = ((seconds / self.logs.h).round() as usize).max(1);
        let of = |log: usize| {
            let starts = (HALF..self.logs.samples(log).saturating_sub(HALF)).step_by(steps);
            starts.map(move |first| (log, first))
        };
        self.predict_from((0..self.logs.count()).flat_map(of).collect(), seconds)
    }
}
