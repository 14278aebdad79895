//! NODE: a plain network from the state and the control to the acceleration, learned through the same integration steps
//! with which it is used.

use super::direct::Direct;
use super::features::seen;
use super::mlp::scale;
use super::{coordinates_fit, layers_of, parameters_of};
use leastaction_core::energy::inertia_network::{Coordinate, feature_count};
use leastaction_core::model::ModelError;
use leastaction_core::network::Activation;
use leastaction_learning::training::{Objective, Samples};
use leastaction_models::accelerations::Forced;
use leastaction_models::random_layers;
use leastaction_programs::energies::Network;
use leastaction_programs::losses::Block;
use leastaction_programs::steps::RungeKutta;
use leastaction_programs::{Builder, Node};

/// Acceleration v̇ = αN(s(q), v/ν, u/μ) with tanh layers. In s(q), coordinate by coordinate, translations are unchanged
/// and angles are replaced by cosine and sine; u is the control of the only actuated coordinate.
///
/// SyMo's authors use unscaled velocities and controls (α = ν = μ = 1), and cyclic coordinates as inputs, too.
#[derive(Clone, Debug, PartialEq)]
pub struct NeuralOde {
    /// Kinds of the coordinates.
    coordinates: Vec<Coordinate>,
    /// Numbers of units in the hidden layers.
    widths: Vec<usize>,
    /// The actuated coordinate.
    actuated: usize,
    /// Acceleration scale α, m/s² or rad/s².
    acceleration: f64,
    /// Velocity scale ν, m/s or rad/s.
    velocity: f64,
    /// Control scale μ, N or N m.
    control: f64,
}

impl NeuralOde {
    /// Creates the network with hidden layers of these widths and α = ν = μ = 1; `actuated` is the actuated coordinate.
    /// An error if it does not exist.
    pub fn new(coordinates: &[Coordinate], widths: &[usize], actuated: usize) -> Result<Self, ModelError> {
        if coordinates.len() <= actuated {
            let what = "coordinates";
            return Err(ModelError::Shape { what, found: coordinates.len(), compiled: actuated + 1 });
        }
        Ok(Self {
            coordinates: coordinates.to_vec(),
            widths: widths.to_vec(),
            actuated,
            acceleration: 1.0,
            velocity: 1.0,
            control: 1.0,
        })
    }

    /// Sets ν and μ to the root mean squares of these steps, and α to that of (v₊ − v)/h.
    #[must_use]
    pub fn scaled_to(self, samples: &Samples) -> Self {
        let [_, v, _] = &samples.states;
        let rates = samples.next_velocities.iter().zip(v).map(|(after, before)| (after - before) / samples.h);
        let controls = samples.controls[0].chunks_exact(self.n()).map(|u| u[self.actuated]);
        Self {
            acceleration: scale(&rates.collect::<Vec<_>>()),
            velocity: scale(v),
            control: scale(&controls.collect::<Vec<_>>()),
            ..self
        }
    }

    /// Number of coordinates.
    pub fn n(&self) -> usize {
        self.coordinates.len()
    }

    /// Length of the weight block, in numbers.
    pub fn parameters(&self) -> usize {
        parameters_of(&self.layers())
    }

    /// Random weights.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        random_layers(layers_of(&self.layers()), seed)
    }

    /// Mean squared error of position and velocity after a step, over [`Samples::next_states`].
    pub fn objective(&self, samples: Samples, method: RungeKutta) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.n())?;
        let step = Direct::new(self.n(), |builder, state| self.step(builder, state, (method, samples.h)));
        let logged = |block: &Block| [&block.states[2][..], &block.next_velocity].concat();
        Ok(step.error(self.parameters(), logged, samples))
    }

    /// Returns v̇(q, v, u) for these weights, m/s² or rad/s², as a function. u has a force for every coordinate, of
    /// which only that of the actuated coordinate counts; an empty u stands for no force.
    pub fn motion<'w>(&self, weights: &'w [f64]) -> Result<Box<Forced<'w>>, ModelError> {
        let write = |builder: &mut Builder, [q, v, u]: [Node; 3]| self.acceleration(builder, [q, v], u);
        Direct::new(self.n(), write).motion(self.n(), (weights, self.parameters()))
    }

    /// Acceleration v̇.
    fn acceleration(&self, builder: &mut Builder, [q, v]: [Node; 2], u: Node) -> Node {
        let v = builder.scaled(1.0 / self.velocity, v);
        let u = builder.part(u, self.actuated..self.actuated + 1);
        let u = builder.scaled(1.0 / self.control, u);
        let features = seen(builder, &self.coordinates, q);
        let inputs = builder.joined(&[features, v, u]);
        let y = self.network().output(builder, inputs);
        builder.scaled(self.acceleration, y)
    }

    /// Position and velocity after a step of h, s, under a held control.
    fn step(&self, builder: &mut Builder, [q, v, u]: [Node; 3], (method, h): (RungeKutta, f64)) -> Node {
        let mut rates: Vec<[Node; 2]> = Vec::new();
        let moved = |builder: &mut Builder, shares: &[f64], rates: &[[Node; 2]]| {
            shares.iter().zip(rates).fold([q, v], |state, (share, rate)| {
                [0, 1].map(|part| {
                    let own = builder.scaled(h * share, rate[part]);
                    builder.sum(state[part], own)
                })
            })
        };
        for shares in method.stages() {
            let state = moved(builder, shares, &rates);
            rates.push([state[1], self.acceleration(builder, state, u)]);
        }
        let end = moved(builder, method.end(), &rates);
        builder.joined(&end)
    }

    /// Numbers of inputs, of units of the hidden layers, and of outputs.
    fn layers(&self) -> Vec<usize> {
        let inputs = feature_count(&self.coordinates) + self.n() + 1;
        std::iter::once(inputs).chain(self.widths.iter().copied()).chain([self.n()]).collect()
    }

    fn network(&self) -> Network {
        let inputs = self.layers()[0];
        Network::of_widths(inputs, &self.widths, (self.n(), Activation::Tanh), 0)
    }
}

#[cfg(test)]
#[path = "node_tests.rs"]
mod tests;
