//! A plain network from the state to the acceleration, which knows nothing of mechanics.

use super::batch::{Batched, Derivatives, InBatches, Layers, Pass, matrix};
use super::features::{count, fixed, inputs};
use super::{AccelerationModel, Follow, PredictionModel, coordinates_fit, layers_of, parameters_of};
use leastaction_core::model::ModelError;
use leastaction_core::network::{Activation, Jet, Mlp as Network};
use leastaction_learning::evaluate::prediction::{Prediction, Truth};
use leastaction_learning::training::{Objective, Samples};
use leastaction_models::random_layers;
use nalgebra::DMatrix;
use std::ops::Range;

/// Maximum number of units in a hidden layer.
pub const MAX_WIDTH: usize = 256;
/// Number of hidden layers, that of ModLaNet's authors.
const DEPTH: usize = 2;

/// Acceleration v̇ = αN(s(q), v/ν), with two hidden tanh layers of equal width. In s(q), coordinate by coordinate,
/// translations are unchanged and angles are replaced by cosine and sine.
///
/// ModLaNet's authors use angles wrapped to \[0, 2π), and unscaled velocities and accelerations (α = ν = 1). Cosine and
/// sine have no seam, and are also the inputs of the modular family. The scales α and ν give the network the best
/// possible conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct Mlp {
    coordinates: String,
    width: usize,
    /// Velocity scale ν, m/s or rad/s.
    velocity: f64,
    /// Acceleration scale α, m/s² or rad/s².
    acceleration: f64,
}

impl Mlp {
    /// Creates the narrowest network with at least the given number of weights and α = ν = 1. `coordinates` has one
    /// letter each: `a` for angles, any other letter for translations. An error if the network is wider than
    /// [`MAX_WIDTH`].
    pub fn with_weights(coordinates: &str, weights: usize) -> Result<Self, ModelError> {
        let of_width = |width| Self::unscaled(coordinates, width);
        let compiled = of_width(MAX_WIDTH).parameters();
        let enough = (1..=MAX_WIDTH).map(of_width).find(|mlp| mlp.parameters() >= weights);
        enough.ok_or(ModelError::Shape { what: "weights of an MLP", found: weights, compiled })
    }

    /// Creates the network with `width` units in each hidden layer and α = ν = 1; `coordinates` as in
    /// [`Mlp::with_weights`]. An error if it is wider than [`MAX_WIDTH`].
    pub fn of_width(coordinates: &str, width: usize) -> Result<Self, ModelError> {
        let error = ModelError::Shape { what: "units in a hidden layer", found: width, compiled: MAX_WIDTH };
        if width <= MAX_WIDTH { Ok(Self::unscaled(coordinates, width)) } else { Err(error) }
    }

    fn unscaled(coordinates: &str, width: usize) -> Self {
        Self { coordinates: coordinates.to_owned(), width, velocity: 1.0, acceleration: 1.0 }
    }

    /// Sets ν and α to the root mean squares of these samples.
    #[must_use]
    pub fn scaled_to(self, samples: &Samples) -> Self {
        let [_, velocity, acceleration] = samples.states.each_ref().map(|values| scale(values));
        Self { velocity, acceleration, ..self }
    }

    /// Length of the weight block, in numbers.
    pub fn parameters(&self) -> usize {
        parameters_of(&self.units())
    }

    /// Number of coordinates.
    fn n(&self) -> usize {
        self.coordinates.len()
    }

    /// Numbers of inputs, of units of the hidden layers, and of outputs.
    fn units(&self) -> [usize; DEPTH + 2] {
        [count(&self.coordinates), self.width, self.width, self.n()]
    }

    /// Inputs s(q) and v/ν of one sample.
    fn inputs(&self, q: &[f64], v: &[f64]) -> Vec<Jet<f64, 0>> {
        let state: Vec<_> = q.iter().copied().chain(v.iter().map(|v| v / self.velocity)).collect();
        inputs(&self.coordinates, &fixed(&state))
    }

    fn network<'w>(&self, mut weights: &'w [f64]) -> Option<Network<'w, f64, MAX_WIDTH, DEPTH>> {
        let [inputs, hidden @ .., outputs] = self.units();
        Network::take(&mut weights, inputs, &hidden, outputs, Activation::Tanh)
    }
}

/// Root mean square; 1 if it is 0.
pub(super) fn scale(values: &[f64]) -> f64 {
    let square = values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64;
    if square > 0.0 { square.sqrt() } else { 1.0 }
}

impl AccelerationModel for Mlp {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        random_layers(layers_of(&self.units()), seed)
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        let n = self.n();
        coordinates_fit(&samples, n)?;
        let [q, v, a] = samples.states;
        let states = q.chunks_exact(n).zip(v.chunks_exact(n));
        let inputs: Vec<_> = states.flat_map(|(q, v)| self.inputs(q, v)).map(|x| x.value).collect();
        let inputs = matrix(&inputs, count(&self.coordinates));
        Ok(Box::new(InBatches(Errors { mlp: self.clone(), inputs, targets: matrix(&a, n) })))
    }
}

impl PredictionModel for Mlp {
    fn predict(&self, weights: &[f64], truth: &Truth, follow: Follow) -> Result<Prediction, ModelError> {
        let short = ModelError::Shape { what: "weights", found: weights.len(), compiled: self.parameters() };
        let network = self.network(weights).ok_or(short)?;
        Ok(follow.compare(truth, |q, v, out| {
            let mut outputs = vec![Jet::zero(); self.n()];
            network.evaluate::<_, 0>(&self.inputs(q, v), &mut outputs);
            let scaled = outputs.iter().map(|y| self.acceleration * y.value);
            out.iter_mut().zip(scaled).for_each(|(out, y)| *out = y);
            Some(())
        }))
    }
}

/// Error of v̇ over fixed inputs.
struct Errors {
    mlp: Mlp,
    /// Inputs: \[samples\]\[inputs\].
    inputs: DMatrix<f64>,
    /// Targets v̇: \[samples\]\[coordinates\].
    targets: DMatrix<f64>,
}

impl Batched for Errors {
    type Trace = Pass;

    fn units(&self) -> [usize; 4] {
        self.mlp.units()
    }

    fn samples(&self) -> usize {
        self.inputs.nrows()
    }

    fn components(&self) -> usize {
        self.targets.ncols()
    }

    fn residuals(&self, layers: &Layers, samples: &Range<usize>) -> (Pass, DMatrix<f64>) {
        let rows = |matrix: &'_ DMatrix<f64>| matrix.rows_range(samples.clone()).into_owned();
        let pass = layers.forward(rows(&self.inputs));
        let residuals = &pass.outputs * self.mlp.acceleration - rows(&self.targets);
        (pass, residuals)
    }

    fn derive(
        &self,
        layers: &Layers,
        (pass, _): (&Pass, &Range<usize>),
        y: &DMatrix<f64>,
        then: impl FnOnce(&Derivatives),
    ) {
        then(&pass.derivatives(&layers.adjoint(pass, y * self.mlp.acceleration)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::oracle::{check_normal_equations, features, network};
    use leastaction_learning::training::{Adam, AdamSettings, Levenberg};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Two angles and a length between them; 21 samples, which is not divisible by the number of lanes.
    const COORDINATES: &str = "ata";
    const SAMPLES: usize = 21;

    fn mlp() -> Mlp {
        Mlp::with_weights(COORDINATES, 90).unwrap().scaled_to(&samples())
    }

    fn samples() -> Samples {
        let mut stream = Pcg64::seed_from_u64(3);
        let states = [3.0, 2.0, 5.0]
            .map(|range: f64| (0..3 * SAMPLES).map(|_| stream.random_range(-range..range)).collect());
        Samples { n: 3, states, ..Samples::default() }
    }

    /// The network in plain loops, and the errors of all samples.
    fn errors(weights: &[f64], samples: &Samples, mlp: &Mlp) -> Vec<f64> {
        let row = |x: &Vec<f64>, k: usize| [x[3 * k], x[3 * k + 1], x[3 * k + 2]];
        let mut errors = Vec::new();
        for k in 0..SAMPLES {
            let [q, v, a] = samples.states.each_ref().map(|x| row(x, k));
            let state = [q, v.map(|v| v / mlp.velocity)].concat();
            let x = network(weights, features(COORDINATES, &state), [mlp.width, 3], f64::tanh);
            errors.extend(x.iter().zip(a).map(|(x, a)| mlp.acceleration * x - a));
        }
        errors
    }

    #[test]
    fn it_is_the_narrowest_that_is_large_enough() {
        let mlp = Mlp::with_weights("aa", 172).unwrap();
        assert_eq!((mlp.width, mlp.parameters()), (9, 7 * 9 + 10 * 9 + 10 * 2));
        assert!(Mlp { width: 8, ..mlp.clone() }.parameters() < 172);
        assert_eq!(mlp.initial_weights(0).len(), mlp.parameters());
        assert!(matches!(
            Mlp::with_weights("aa", 1_000_000),
            Err(ModelError::Shape { found: 1_000_000, .. })
        ));
    }

    #[test]
    fn loss_and_normal_equations_are_those_of_plain_loops_and_differences() {
        let (mlp, samples) = (mlp(), samples());
        let objective = mlp.objective(samples.clone()).unwrap();
        check_normal_equations(&*objective, (&mlp.initial_weights(1), 1e-6), |weights| {
            errors(weights, &samples, &mlp)
        });
    }

    #[test]
    fn both_optimisers_train_it() {
        let (mlp, samples) = (mlp(), samples());
        let objective = mlp.objective(samples).unwrap();
        let start = mlp.initial_weights(2);
        let before = objective.loss(&start);
        let levenberg = Levenberg::new(&*objective, start.clone()).run(&*objective, 60, |_, _| ());
        assert!(levenberg.loss < 1e-3 * before, "{} {before}", levenberg.loss);
        let settings = AdamSettings { learning_rate: 1e-2, ..AdamSettings::symo(1, 0) };
        let mut adam = Adam::new(&*objective, start, settings);
        (0..60).for_each(|_| {
            adam.iterate(&*objective);
        });
        assert!(objective.loss(&adam.weights) < 0.8 * before);
    }

    #[test]
    fn scales_are_root_mean_squares() {
        let states = [vec![7.0], vec![-2.0], vec![0.0]];
        let mlp = mlp().scaled_to(&Samples { n: 1, states, ..samples() });
        assert_eq!((mlp.velocity, mlp.acceleration), (2.0, 1.0));
    }

    #[test]
    fn samples_of_another_system_are_refused() {
        let narrow = Samples { n: 1, ..samples() };
        let shape = |error| matches!(error, ModelError::Shape { found: 1, compiled: 3, .. });
        assert!(mlp().objective(narrow).err().is_some_and(shape));
    }
}
