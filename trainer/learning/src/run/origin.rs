//! Initial weights of a network that starts from another model.

use crate::data::Dataset;
use crate::training::{Covered, network_start};
use crate::windows::WindowLogs;
use leastaction_core::model::ModelError;
use leastaction_models::Architecture;
use leastaction_models::config::Origin;

/// Weights of a network that reproduce the energies of its starting model over the range of the data.
pub(super) fn at_origin(
    network: (&Architecture, Vec<f64>),
    data: &Dataset,
    origin: &Origin,
) -> Result<Vec<f64>, ModelError> {
    let n = data.n;
    let q: Vec<f64> = data.trajectories.iter().flat_map(|log| log.q.as_flat()).copied().collect();
    if q.is_empty() {
        return Ok(network.1);
    }
    let [_, v, a, _] = WindowLogs::new(data).smoothed();
    let sizes = [v, a].map(|all| {
        let square = |i: usize| all.iter().skip(i).step_by(n).map(|x| x * x).sum::<f64>();
        (0..n).map(|i| (square(i) / (all.len() / n).max(1) as f64).sqrt()).collect()
    });
    network_start(network, (&origin.0.architecture, &origin.0.weights), &Covered { q: &q, sizes })
}
