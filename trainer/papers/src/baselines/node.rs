//! NODE: a plain network from the state and the control to the acceleration, learned through the steps that it is run with.

use super::mlp::{MAX_WIDTH, scale};
use super::{layers_of, parameters_of};
use leastaction::architecture::random_layers;
use leastaction::runge_kutta::{RungeKutta, Stage, State};
use leastaction::training::{ChunkRows, Failed, Objective, Residuals, Samples, Steps};
use leastaction_core::energy::rigid::{Coordinate, feature_count};
use leastaction_core::model::ModelError;
use leastaction_core::network::{Activation, Jet, Mlp as Network, Tape};
use leastaction_core::scalar::{LANES, Lanes, Scalar};
use std::ops::Range;

/// Hidden layers at most.
const DEPTH: usize = 2;
/// Coordinates at most.
const MAX_COORDINATES: usize = 4;

/// v̇ = αN(s(q), v/ν, u/μ) with tanh layers; s(q) are the translations and the cosine and sine of the angles, coordinate by
/// coordinate, and u the control of the one coordinate that has it.
///
/// SyMo's authors feed velocities and the control as they are (α = ν = μ = 1) and cyclic coordinates too.
#[derive(Clone, Debug, PartialEq)]
pub struct NeuralOde {
    /// What each coordinate is.
    coordinates: Vec<Coordinate>,
    /// Units of the hidden layers.
    widths: Vec<usize>,
    /// The coordinate that the control acts on.
    actuated: usize,
    /// α, m/s² or rad/s².
    acceleration: f64,
    /// ν, m/s or rad/s.
    velocity: f64,
    /// μ, N or N m.
    control: f64,
}

/// A feature of a coordinate and its derivative.
struct Feature<S> {
    coordinate: usize,
    value: S,
    slope: S,
}

type Jets<S> = Vec<Jet<S, 0>>;

impl NeuralOde {
    /// Hidden layers of these units, α = ν = μ = 1; `actuated` is the coordinate with the control.
    ///
    /// # Errors
    /// [`ModelError::Shape`] for more coordinates, layers or units than are compiled, or fewer coordinates than `actuated` needs.
    pub fn new(coordinates: &[Coordinate], widths: &[usize], actuated: usize) -> Result<Self, ModelError> {
        let shape = |what, found, compiled| Err(ModelError::Shape { what, found, compiled });
        let width = widths.iter().copied().max().unwrap_or(0);
        match coordinates.len() {
            n if n <= actuated || n > MAX_COORDINATES => shape("coordinates", n, MAX_COORDINATES),
            _ if widths.len() > DEPTH => shape("hidden layers", widths.len(), DEPTH),
            _ if width > MAX_WIDTH => shape("units in a hidden layer", width, MAX_WIDTH),
            _ => Ok(Self {
                coordinates: coordinates.to_vec(),
                widths: widths.to_vec(),
                actuated,
                acceleration: 1.0,
                velocity: 1.0,
                control: 1.0,
            }),
        }
    }

    /// The same with root mean squares of these steps as ν and μ, and that of (v₊ − v)/h as α.
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

    /// Coordinates.
    pub fn n(&self) -> usize {
        self.coordinates.len()
    }

    /// Numbers in the weight block.
    pub fn parameters(&self) -> usize {
        parameters_of(&self.layers())
    }

    /// Random weights.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        random_layers(layers_of(&self.layers()), seed)
    }

    /// The mean squared error of position and velocity after a step, over [`Samples::next_states`].
    ///
    /// # Errors
    /// [`ModelError::Shape`] for samples of other coordinates.
    pub fn objective(&self, samples: Samples, method: RungeKutta) -> Result<Box<dyn Objective>, ModelError> {
        let (node, n) = (self.clone(), self.n());
        if samples.n != n {
            return Err(ModelError::Shape { what: "coordinates", found: samples.n, compiled: n });
        }
        Ok(match n {
            1 => Box::new(NextState::<1> { node, samples, method }),
            2 => Box::new(NextState::<2> { node, samples, method }),
            3 => Box::new(NextState::<3> { node, samples, method }),
            _ => Box::new(NextState::<MAX_COORDINATES> { node, samples, method }),
        })
    }

    /// Writes v̇(q, v, u), m/s² or rad/s², u a force on every coordinate of which one is felt; `None` where a slice is too short.
    pub fn acceleration(&self, weights: &[f64], [q, v, u]: [&[f64]; 3], out: &mut [f64]) -> Option<()> {
        let network = self.network(weights).ok()?;
        let inputs = self.inputs(q, v, *u.get(self.actuated)?);
        let mut outputs: Jets<f64> = vec![Jet::zero(); self.n()];
        network.evaluate::<_, 0>(&inputs, &mut outputs);
        for (i, output) in outputs.iter().enumerate() {
            *out.get_mut(i)? = self.acceleration * output.value;
        }
        Some(())
    }

    /// Inputs, units of the hidden layers, outputs.
    fn layers(&self) -> Vec<usize> {
        let inputs = feature_count(&self.coordinates) + self.n() + 1;
        std::iter::once(inputs).chain(self.widths.iter().copied()).chain([self.n()]).collect()
    }

    fn network<'w>(&self, mut weights: &'w [f64]) -> Result<Network<'w, f64, MAX_WIDTH, DEPTH>, Failed> {
        let inputs = self.layers()[0];
        Network::take(&mut weights, inputs, &self.widths, self.n(), Activation::Tanh).ok_or(Failed)
    }

    /// s(q).
    fn features<S: Scalar>(&self, q: &[S]) -> Vec<Feature<S>> {
        let of = |(coordinate, (kind, q)): (usize, (&Coordinate, &S))| match kind {
            Coordinate::Translation => vec![Feature { coordinate, value: *q, slope: S::one() }],
            Coordinate::Angle => {
                let (sin, cos) = q.sin_cos();
                let feature = |value, slope| Feature { coordinate, value, slope };
                vec![feature(cos, -sin), feature(sin, cos)]
            }
            Coordinate::Cyclic => Vec::new(),
        };
        self.coordinates.iter().zip(q).enumerate().flat_map(of).collect()
    }

    fn inputs<S: Scalar>(&self, q: &[S], v: &[S], u: S) -> Jets<S> {
        let features = self.features(q).into_iter().map(|feature| feature.value);
        let velocities = v.iter().map(|v| *v / S::constant(self.velocity));
        features.chain(velocities).chain([u / S::constant(self.control)]).map(Jet::constant).collect()
    }
}

/// The squared error of the next state.
struct NextState<const N: usize> {
    node: NeuralOde,
    samples: Samples,
    method: RungeKutta,
}

/// What a stage leaves for its adjoint.
struct Trace {
    inputs: Jets<Lanes>,
    tape: Tape<Lanes, 0, MAX_WIDTH, DEPTH>,
}

impl<const N: usize> NextState<N> {
    /// v̇ of eight samples.
    fn outputs(&self, outputs: &[Jet<Lanes, 0>]) -> [Lanes; N] {
        let scale = Lanes::constant(self.node.acceleration);
        std::array::from_fn(|i| scale * outputs[i].value)
    }

    fn errors(&self, network: &Network<f64, MAX_WIDTH, DEPTH>, steps: &Steps<N>) -> State<Lanes, N> {
        let u = steps.control[self.node.actuated];
        let mut outputs = [Jet::zero(); N];
        let Ok(stages) = self.method.stages(self.samples.h, &steps.start, |q, v| {
            network.evaluate::<_, 0>(&self.node.inputs(q, v, u), &mut outputs);
            Ok::<_, std::convert::Infallible>(self.outputs(&outputs))
        });
        steps.errors(&self.method.end(self.samples.h, &steps.start, &stages))
    }

    /// The stages of eight steps, and what leads back through them.
    fn traced(
        &self,
        network: &Network<f64, MAX_WIDTH, DEPTH>,
        steps: &Steps<N>,
    ) -> (Vec<Stage<Lanes, N>>, Vec<Trace>) {
        let u = steps.control[self.node.actuated];
        let mut traces = Vec::new();
        let Ok(stages) = self.method.stages(self.samples.h, &steps.start, |q, v| {
            let mut trace = Trace { inputs: self.node.inputs(q, v, u), tape: Tape::default() };
            let mut outputs = [Jet::zero(); N];
            network.forward(&trace.inputs, &mut trace.tape, &mut outputs);
            traces.push(trace);
            Ok::<_, std::convert::Infallible>(self.outputs(&outputs))
        });
        (stages, traces)
    }

    /// (y·∂v̇/∂q, y·∂v̇/∂v) of a stage; adds y·∂v̇/∂θ.
    fn pull(
        &self,
        network: &Network<f64, MAX_WIDTH, DEPTH>,
        (stage, trace): (&Stage<Lanes, N>, &Trace),
        y: &[Lanes; N],
        gradient: &mut [Lanes],
    ) -> State<Lanes, N> {
        let y_bar = y.map(|y| Jet::constant(Lanes::constant(self.node.acceleration) * y));
        let mut x_bar = vec![Jet::zero(); trace.inputs.len()];
        let mut start = network.len();
        network.adjoint_with_layers(
            &trace.tape,
            (&trace.inputs, &mut x_bar),
            &y_bar,
            |layer, inputs, outputs| {
                start -= layer.len();
                layer.series_gradient(inputs, outputs, |position, g| gradient[start + position] += g);
            },
        );
        let features = self.node.features(&stage.state[0]);
        let mut q_bar = [Lanes::zero(); N];
        for (feature, bar) in features.iter().zip(&x_bar) {
            q_bar[feature.coordinate] += feature.slope * bar.value;
        }
        let velocity = Lanes::constant(self.node.velocity);
        [q_bar, std::array::from_fn(|i| x_bar[features.len() + i].value / velocity)]
    }
}

impl<const N: usize> Residuals for NextState<N> {
    fn parameters(&self) -> usize {
        self.node.parameters()
    }

    fn samples(&self) -> usize {
        self.samples.len()
    }

    fn components(&self) -> usize {
        2 * N
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        let network = self.node.network(weights)?;
        let mut sum = 0.0;
        for start in samples.clone().step_by(LANES) {
            let errors = self.errors(&network, &Steps::from_samples(&self.samples, start, &samples));
            for error in errors.as_flattened() {
                sum += error.0.iter().take(samples.end - start).map(|r| r * r).sum::<f64>();
            }
        }
        Ok(sum)
    }

    fn linearise(&self, weights: &[f64], samples: Range<usize>, rows: &mut ChunkRows) -> Result<(), Failed> {
        let network = self.node.network(weights)?;
        let (count, h) = (samples.len(), self.samples.h);
        rows.reset(count * 2 * N, weights.len());
        for start in samples.clone().step_by(LANES) {
            let steps = Steps::from_samples(&self.samples, start, &samples);
            let (stages, traces) = self.traced(&network, &steps);
            let errors = steps.errors(&self.method.end(h, &steps.start, &stages));
            let own = (samples.end - start).min(LANES);
            for (component, error) in errors.as_flattened().iter().enumerate() {
                let row = component * count + start - samples.start;
                rows.residual[row..row + own].copy_from_slice(&error.0[..own]);
                let mut end_bar = [[Lanes::zero(); N]; 2];
                end_bar.as_flattened_mut()[component] = Lanes::one();
                rows.reset_buffer(weights.len());
                let buffer = &mut rows.buffer;
                self.method
                    .adjoint(h, &end_bar, |k, y| self.pull(&network, (&stages[k], &traces[k]), y, buffer));
                rows.store(row, own);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "node_tests.rs"]
mod tests;
