//! The Hamiltonian neural network (Greydanus et al., 2019): a single network gives H(q, p).

mod momenta;
mod slopes;

pub use momenta::Momenta;

use super::batch::InBatches;
use super::features::{adjoint, count, fixed, inputs};
use super::{AccelerationModel, Follow, PredictionModel, coordinates_fit, layers_of, parameters_of};
use leastaction_core::model::ModelError;
use leastaction_core::network::{Activation, Jet, Mlp, Tape};
use leastaction_ground_truth::{IntegrationError, Start, follow_flow};
use leastaction_learning::evaluate::prediction::{Prediction, Truth};
use leastaction_learning::training::{Objective, Samples};
use leastaction_models::random_layers;
use slopes::Slopes;

/// Maximum number of units in a hidden layer.
pub const MAX_WIDTH: usize = 256;
/// Number of hidden layers, that of Greydanus et al.
const DEPTH: usize = 2;

/// Flow q̇ = H_p, ṗ = −H_q with H(q, p) = N(s(q), p): two hidden tanh layers of equal width.
///
/// Like ModLaNet's authors, we train it on q̇ and ṗ with equal weight, at canonical momenta p = M(q)v. This uses the
/// true mass matrix, which no other model is given. The motions are those used for the other models, while the authors
/// draw motions with p in ±10. Its accelerations follow from ṗ at the true velocity, v̇ = M⁻¹(−H_q − Ṁv): for bodies of
/// mass 1 (p = v) the error of v̇ is that of ṗ, which their program prints. Predictions follow the learned flow in (q,
/// p), which conserves H. The output's bias, one of the weights, is a constant of H that no motion determines; the
/// authors' second output, which is not used, is left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hnn {
    coordinates: String,
    width: usize,
    momenta: Momenta,
}

type Network<'w> = Mlp<'w, f64, MAX_WIDTH, DEPTH>;

impl Hnn {
    /// Creates the network with `width` units in each hidden layer. `coordinates` has one letter each: `a` for angles,
    /// any other letter for translations. An error if the network is wider than [`MAX_WIDTH`].
    pub fn new(coordinates: &str, width: usize, momenta: Momenta) -> Result<Self, ModelError> {
        let error = ModelError::Shape { what: "units in a hidden layer", found: width, compiled: MAX_WIDTH };
        let hnn = Self { coordinates: coordinates.to_owned(), width, momenta };
        if width <= MAX_WIDTH { Ok(hnn) } else { Err(error) }
    }

    /// Length of the weight block, in numbers.
    pub fn parameters(&self) -> usize {
        parameters_of(&self.units())
    }

    /// Numbers of inputs, of units of the hidden layers, and of outputs.
    fn units(&self) -> [usize; DEPTH + 2] {
        [count(&self.coordinates), self.width, self.width, 1]
    }

    /// Number of coordinates.
    fn n(&self) -> usize {
        self.coordinates.len()
    }

    fn network<'w>(&self, mut weights: &'w [f64]) -> Option<Network<'w>> {
        let inputs = count(&self.coordinates);
        Mlp::take(&mut weights, inputs, &[self.width; DEPTH], 1, Activation::Tanh)
    }

    /// Gradient (H_q, H_p) at (q, p).
    fn gradient(&self, network: &Network, state: &[f64]) -> Vec<f64> {
        let x = inputs(&self.coordinates, &fixed(state));
        let mut tape = Tape::<f64, 0, MAX_WIDTH, DEPTH>::default();
        let mut x_bar = vec![Jet::zero(); x.len()];
        network.forward(&x, &mut tape, &mut [Jet::zero()]);
        network.adjoint(&tape, &[Jet::<f64, 0>::constant(1.0)], &mut x_bar);
        adjoint(&self.coordinates, &x, &x_bar).into_iter().map(|bar| bar.value).collect()
    }

    /// Follows the learned motion in (q, p) from a start, and passes it on as (q, v).
    fn path(
        &self,
        network: &Network,
        start: &Start,
        truth: &Truth,
        follow: Follow,
        keep: &mut dyn FnMut(&[f64]),
    ) -> Result<(), IntegrationError> {
        let n = self.n();
        let rate = |state: &[f64], rate: &mut [f64]| {
            let gradient = self.gradient(network, state);
            let (h_q, h_p) = gradient.split_at(n);
            rate[..n].copy_from_slice(h_p);
            rate[n..].iter_mut().zip(h_q).for_each(|(rate, h_q)| *rate = -h_q);
            (!follow.is_late()).then_some(())
        };
        let keep = |state: &[f64]| {
            let (q, p) = state.split_at(n);
            let v = self.momenta.velocities(q, p).unwrap_or(vec![f64::NAN; n]);
            keep(&[q, &v].concat());
        };
        let state = [start.q.clone(), self.momenta.momenta(&start.q, &start.v)].concat();
        follow_flow(rate, |_| Some(()), state, (truth.horizon(), follow.tolerance), keep)
    }
}

impl AccelerationModel for Hnn {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        random_layers(layers_of(&self.units()), seed)
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.n())?;
        Ok(Box::new(InBatches(Slopes::accelerations(self, &samples))))
    }

    fn training(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.n())?;
        Ok(Box::new(InBatches(Slopes::rates(self, &samples))))
    }
}

impl PredictionModel for Hnn {
    fn predict(&self, weights: &[f64], truth: &Truth, follow: Follow) -> Result<Prediction, ModelError> {
        let short = ModelError::Shape { what: "weights", found: weights.len(), compiled: self.parameters() };
        let network = self.network(weights).ok_or(short)?;
        let path =
            |start: &Start, keep: &mut dyn FnMut(&[f64])| self.path(&network, start, truth, follow, keep);
        Ok(truth.compare_paths(follow.motion, path))
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
