//! Baselines that are stepped by Runge–Kutta from logged states: L-NODE and NODE.

use super::{Case, Method, Outcome, Recipe};
use crate::baselines::NeuralOde;
use crate::task::TaskError;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::energy::trigonometric::Trigonometric;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::Exact;
use leastaction_learning::data::symo::SymoSet;
use leastaction_learning::evaluate::states::{Stepper, positions, state_energy_mse};
use leastaction_learning::evaluate::{inertia_mse, integration_errors};
use leastaction_learning::runge_kutta::RungeKutta;
use leastaction_learning::training::{LossKind, Samples, objective};
use leastaction_models::Model;
use leastaction_models::accelerations::Forced;
use std::time::Instant;

/// Learned model of a baseline.
enum Learned {
    /// A Lagrangian.
    LNode(Box<Model>),
    /// An acceleration.
    NeuralOde(NeuralOde),
}

impl Learned {
    fn with_forced<T>(&self, weights: &[f64], then: impl FnOnce(&Forced) -> T) -> Result<T, ModelError> {
        match self {
            Self::LNode(model) => model.with_forced(then),
            Self::NeuralOde(node) => Ok(then(&*node.motion(weights)?)),
        }
    }
}

impl Case {
    /// Learns and evaluates a baseline.
    pub(super) fn run_from_states(
        &self,
        set: &SymoSet,
        watch: &mut dyn FnMut(usize, f64),
    ) -> Result<Outcome, TaskError> {
        let (clock, recipe) = (Instant::now(), self.recipe());
        let [rows, judges] = recipe.split(&set.train.truncated(self.trajectories));
        let samples = [Samples::next_states(&rows)?, Samples::next_states(&judges)?];
        let (learned, weights) = self.learn_from_states(recipe, samples, watch)?;
        let seconds = clock.elapsed().as_secs_f64();
        let inertia_mse = match &learned {
            Learned::LNode(model) => Some(inertia_mse(model, self.mechanism, &set.test)?),
            Learned::NeuralOde(_) => None,
        };
        let outcome = learned.with_forced(&weights, |forced| match self.mechanism.exact() {
            Exact::One(exact) => self.stepped(&exact, forced, set),
            Exact::Two(exact) => self.stepped(&exact, forced, set),
        })?;
        Ok(Outcome { inertia_mse, parameters: weights.len(), train_seconds: seconds, ..outcome })
    }

    /// Learns by the recipe of SyMo's models, with the same network, number of iterations on the loss, penalty and
    /// validation. The loss is finite for any initial weights, so there is no warm-up.
    fn learn_from_states(
        &self,
        recipe: Recipe,
        [samples, judges]: [Samples; 2],
        watch: &mut dyn FnMut(usize, f64),
    ) -> Result<(Learned, Vec<f64>), ModelError> {
        let architecture = &recipe.architecture;
        if matches!(self.model, Method::LNodeRk4 | Method::LNodeMidpoint) {
            let weights = architecture.initial_weights(self.seed);
            let loss = |samples| objective(architecture, samples, LossKind::NextState, self.order);
            let (loss, judge) = (loss(samples)?, loss(judges)?);
            let weights = recipe.learn([&*loss, &*judge], weights, watch);
            return Ok((Learned::LNode(Box::new(Model::new(recipe.architecture, weights.clone()))), weights));
        }
        let coordinates: Vec<_> =
            architecture.coordinates().chars().filter_map(Coordinate::from_letter).collect();
        let node = NeuralOde::new(&coordinates, &architecture.widths(), self.mechanism.actuated())?;
        let node = node.scaled_to(&samples);
        let loss = |samples| node.objective(samples, RungeKutta::of_order(self.order));
        let (loss, judge) = (loss(samples)?, loss(judges)?);
        let weights = recipe.learn([&*loss, &*judge], node.initial_weights(self.seed), watch);
        Ok((Learned::NeuralOde(node), weights))
    }

    /// Measures of learned accelerations.
    fn stepped<const N: usize>(&self, exact: &Trigonometric<N>, forced: &Forced, set: &SymoSet) -> Outcome {
        let acceleration = |q: &[f64; N], v: &[f64; N], u: &[f64; N]| {
            let mut out = [0.0; N];
            forced(q, v, u, &mut out).map(|()| out)
        };
        let stepper = Stepper { method: RungeKutta::of_order(self.order), acceleration };
        let runs = stepper.rollout(&set.integration);
        let one_step =
            [&set.train.truncated(self.trajectories), &set.test].map(|data| stepper.one_step_mse(data));
        let free = integration_errors(&positions(&runs), &set.integration);
        self.row(one_step, free, state_energy_mse(exact, &runs, &set.integration))
    }
}
