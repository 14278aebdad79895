//! The models that are learned, and the training.

use crate::baselines::{AccelerationModel, PredictionModel};
use leastaction_core::energy::List;
use leastaction_core::energy::modular::{
    Input, ModularShape, NetworkShape, PairInput, PairShape, TransformShape, TypeShape,
};
use leastaction_core::model::ModelError;
use leastaction_core::network::Activation;
use leastaction_ground_truth::ManyBody;
use leastaction_learning::data::modlanet::ModlanetRows;
use leastaction_learning::training::{Levenberg, Samples};
use leastaction_models::{Architecture, Model, ModularArchitecture, NamedTree, NamedType, Number};

/// Numbers of hidden units of the pendulum's position; its potential is linear in the position, as in the authors' model.
const POSITION: [u16; 4] = [32, 0, 0, 0];
/// Numbers of hidden units of the bodies' pair potential. With the reciprocal distance as input it is linear, w/r + b:
/// the form of the law is known and its strength learned. Only in this form does it hold at encounters closer than any
/// in the data.
const fn pair_widths(input: PairInput) -> [u16; 4] {
    match input {
        PairInput::Concat => [24, 24, 0, 0],
        PairInput::Difference | PairInput::Distance => [16, 16, 0, 0],
        PairInput::InverseDistance => [0; 4],
    }
}

/// Approximate number of accelerations in a picture.
const SHOWN: usize = 400;

/// Returns a model with one element type of mass 1, and the tree of the system.
pub fn architecture(system: ManyBody, pair: PairInput) -> ModularArchitecture {
    match system {
        ManyBody::Pendulum(_) => pendulum(),
        ManyBody::Bodies(_) => bodies(pair),
    }
    .with_tree(tree(system))
}

/// Returns the tree of a system whose elements all have the first type.
pub fn tree(system: ManyBody) -> NamedTree {
    let kinds = vec![0; system.count()];
    match system {
        ManyBody::Pendulum(_) => NamedTree::chain("chain", &kinds),
        ManyBody::Bodies(_) => NamedTree::apart("bodies", &kinds),
    }
}

fn pendulum() -> ModularArchitecture {
    let mut shape = ModularShape { networks: List::default(), types: List::default(), pair: None };
    let activation = Activation::Tanh;
    shape.networks.slots[0] = Some(NetworkShape { inputs: 2, widths: POSITION, outputs: 2, activation });
    shape.networks.slots[1] = Some(NetworkShape { inputs: 2, widths: [0; 4], outputs: 1, activation });
    let transform = TransformShape::Network { position: 0, velocity: None, input: Input::Angle };
    shape.types.slots[0] = Some(TypeShape { transform, potential: Some(1) });
    one_type(shape, "bob")
}

fn bodies(input: PairInput) -> ModularArchitecture {
    let mut shape = ModularShape { networks: List::default(), types: List::default(), pair: None };
    let widths = pair_widths(input);
    let inputs = input.features() as u8;
    shape.networks.slots[0] = Some(NetworkShape { inputs, widths, outputs: 1, activation: Activation::Tanh });
    shape.types.slots[0] = Some(TypeShape { transform: TransformShape::Free, potential: None });
    shape.pair = Some(PairShape { network: 0, input });
    one_type(shape, "body")
}

/// Returns a model with only known numbers: a point of mass 1 without damping, c₁ = c₂ = 1. The networks contain the
/// scales, and the known mass fixes the scale of L, which accelerations do not determine.
fn one_type(shape: ModularShape, name: &str) -> ModularArchitecture {
    let numbers = [1.0, 0.0, 1.0, 1.0, 0.0].map(Number::known);
    let types = vec![NamedType { name: name.to_owned(), numbers }];
    ModularArchitecture::new(shape, types, [Number::known(1.0); 2], Vec::new())
}

/// A trained model.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedTree {
    /// Shape of the model.
    pub architecture: ModularArchitecture,
    /// Weight block of the model.
    pub weights: Vec<f64>,
}

impl LearnedTree {
    /// Returns the model with the same elements in another tree.
    #[must_use]
    pub fn extended(&self, system: ManyBody) -> Self {
        Self { architecture: self.architecture.with_tree(tree(system)), weights: self.weights.clone() }
    }

    /// Accelerations of rows, true and learned; if there are many, an evenly spaced selection.
    pub fn accelerations(&self, rows: &ModlanetRows) -> Result<Vec<(f64, f64)>, ModelError> {
        let apart = (rows.q.len() * rows.q.width()).div_ceil(SHOWN).max(1);
        Model::new(Architecture::from(self.architecture.clone()), self.weights.clone()).with_accelerations(
            |accelerations| {
                let of_row = |k: usize| {
                    let mut learned = vec![0.0; rows.q.width()];
                    accelerations(&rows.q[k], &rows.v[k], &mut learned)?;
                    Some(rows.a[k].iter().copied().zip(learned))
                };
                (0..rows.q.len()).step_by(apart).filter_map(of_row).flatten().collect()
            },
        )
    }

    /// Returns the learned model and its weights.
    pub fn learned(&self) -> (&dyn PredictionModel, &[f64]) {
        (&self.architecture, &self.weights)
    }
}

/// Learns from accelerations by Levenberg–Marquardt; `watch` is called with the iteration and the loss.
pub fn train(
    architecture: ModularArchitecture,
    rows: &ModlanetRows,
    iterations: usize,
    seed: u64,
    mut watch: impl FnMut(usize, f64),
) -> Result<LearnedTree, ModelError> {
    let objective = architecture.objective(Samples::modlanet(rows))?;
    let levenberg = Levenberg::new(&*objective, architecture.initial_weights(seed));
    let levenberg = levenberg.run(&*objective, iterations, |iteration, state| watch(iteration, state.loss));
    Ok(LearnedTree { architecture, weights: levenberg.weights })
}

/// Continues from these weights by Levenberg–Marquardt on `rows`. Returns the weights with the lowest error on
/// `validation` among all iterations, including the start, so the model never becomes worse on `validation`.
pub(super) fn best_of(
    shape: &dyn PredictionModel,
    [rows, validation]: [&ModlanetRows; 2],
    weights: Vec<f64>,
    iterations: usize,
) -> Result<Vec<f64>, ModelError> {
    let objective = shape.objective(Samples::modlanet(rows))?;
    let judge = shape.objective(Samples::modlanet(validation))?;
    Ok(Levenberg::new(&*objective, weights).best(&*objective, &*judge, iterations, |_, _| ()))
}
