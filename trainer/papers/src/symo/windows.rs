//! Learning from positions alone over windows of many steps with free start states: noise averages out, and the effects
//! of forces add up.

use super::bodies::bodies;
use super::{Case, Method, Recipe};
use crate::task::TaskError;
use leastaction_core::model::ModelError;
use leastaction_learning::data::symo::SymoSet;
use leastaction_learning::data::{Dataset, Trajectory};
use leastaction_learning::run::{Fold, folds};
use leastaction_learning::training::{Levenberg, Objective};
use leastaction_learning::windows::{
    Calibration, Integrator, WindowLogs, WindowLoss, WindowModel, WindowSettings, first_guess,
};
use leastaction_models::{Architecture, InertiaNetworkArchitecture};
use std::ops::Range;
use std::sync::Arc;

/// Number of steps of the first windows: over so few steps motion is hardly chaotic, whatever the initial weights.
const SHORT: usize = 7;
/// Longest Runge–Kutta step of order 4, s: its error is far below the noise.
const LONGEST_STEP: f64 = 0.025;
/// Candidate hidden layers, by their units; without hidden layers, the potential and the factor of the inertia are
/// linear in the features.
const WIDTHS: [&[u16]; 2] = [&[], &[40]];
/// Candidate penalties on the weights of a hidden layer.
const DECAYS: [f64; 3] = [1e-6, 1e-5, 1e-4];
/// Fraction by which the error of a later candidate must be lower for it to be chosen.
const MARGIN: f64 = 0.02;

impl Case {
    /// Learns a discrete model; returns its shape and its weights.
    pub(super) fn learn(
        &self,
        recipe: Recipe,
        set: &SymoSet,
        watch: &mut dyn FnMut(usize, f64),
    ) -> Result<(Architecture, Vec<f64>), TaskError> {
        if self.model.is_for_noise() {
            return self.learn_over_windows(&recipe, set, watch);
        }
        let weights = self.train(&recipe, set, watch)?;
        Ok((recipe.architecture, weights))
    }

    /// Learns from all trajectories, first over short windows, then over their whole length. If there are several
    /// candidates for shape and penalty, those with the lowest error on held-back trajectories are used; each
    /// trajectory is held back once.
    fn learn_over_windows(
        &self,
        recipe: &Recipe,
        set: &SymoSet,
        watch: &mut dyn FnMut(usize, f64),
    ) -> Result<(Architecture, Vec<f64>), TaskError> {
        let data = set.train.truncated(self.trajectories);
        let candidates = self.candidates(recipe)?;
        let mut best = (f64::INFINITY, candidates.first().unwrap_or(recipe).clone());
        for candidate in candidates.iter().filter(|_| candidates.len() > 1) {
            let error = self.held_back_error(candidate, &data, watch)?;
            if error < (1.0 - MARGIN) * best.0 {
                best = (error, candidate.clone());
            }
        }
        let weights = self.over_windows(&best.1, &data, 0..data.trajectories.len(), watch)?;
        Ok((best.1.architecture, weights))
    }

    /// Candidate shapes: the bodies of the mechanism, or networks.
    fn candidates(&self, recipe: &Recipe) -> Result<Vec<Recipe>, ModelError> {
        if self.model != Method::Bodies {
            return Ok(networks(recipe));
        }
        let architecture = bodies(self.mechanism).ok_or(ModelError::OutOfRange { what: "tree" })?;
        Ok(vec![Recipe { architecture, ..recipe.clone() }])
    }

    /// Geometric mean over folds of the mean squared error over windows of a fold, with the model learned from the
    /// other folds.
    fn held_back_error(
        &self,
        recipe: &Recipe,
        data: &Dataset,
        watch: &mut dyn FnMut(usize, f64),
    ) -> Result<f64, TaskError> {
        let folds = folds(data);
        let mut logarithms = 0.0;
        for Fold { data, training } in &folds {
            let weights = self.over_windows(recipe, data, 0..*training, watch)?;
            let judge = windows(recipe, data, *training..data.trajectories.len(), whole(data))?;
            logarithms += Objective::held_back_loss(&judge, &weights).ln();
        }
        Ok((logarithms / folds.len() as f64).exp())
    }

    /// Returns the weights that are best over windows of the given trajectories.
    fn over_windows(
        &self,
        recipe: &Recipe,
        data: &Dataset,
        of: Range<usize>,
        watch: &mut dyn FnMut(usize, f64),
    ) -> Result<Vec<f64>, TaskError> {
        let mut weights = recipe.architecture.initial_weights(self.seed);
        let own = weights.len();
        for (k, steps) in [SHORT.min(whole(data)), whole(data)].into_iter().enumerate() {
            let loss = windows(recipe, data, of.clone(), steps)?;
            if k == 0 {
                let logs = WindowLogs::new(&data.truncated(of.end));
                weights = first_guess(&recipe.architecture, &logs, weights, &loss)?.weights;
            }
            let levenberg = Levenberg::new(&loss, weights).with_decay(recipe.decay);
            weights = levenberg.run(&loss, recipe.iterations, |k, state| watch(k, state.loss)).weights;
            weights.truncate(own);
        }
        Ok(weights)
    }
}

/// Returns every combination of width and penalty; without a hidden layer, no penalty is needed.
fn networks(recipe: &Recipe) -> Vec<Recipe> {
    let Some(inertia_network) = recipe.architecture.family.inertia_network() else { return Vec::new() };
    let of = |widths: &[u16]| -> Vec<Recipe> {
        let architecture = InertiaNetworkArchitecture { widths: widths.to_vec(), ..inertia_network.clone() };
        let decays = if widths.is_empty() { &[0.0][..] } else { &DECAYS };
        let one = |decay: &f64| Recipe {
            architecture: architecture.clone().into(),
            decay: *decay,
            ..recipe.clone()
        };
        decays.iter().map(one).collect()
    };
    WIDTHS.into_iter().flat_map(of).collect()
}

/// Number of steps of the shortest trajectory.
fn whole(data: &Dataset) -> usize {
    data.trajectories.iter().map(Trajectory::samples).min().unwrap_or(0).saturating_sub(1).max(1)
}

/// Loss over windows of `steps` steps, overlapping by half, of the given trajectories.
fn windows(recipe: &Recipe, data: &Dataset, of: Range<usize>, steps: usize) -> Result<WindowLoss, TaskError> {
    let settings = WindowSettings {
        steps,
        stride: steps.div_ceil(2),
        integrator: Integrator::RungeKutta,
        longest_step: LONGEST_STEP,
        order: 4,
        calibration: Calibration::default(),
    };
    let model = WindowModel::new(&recipe.architecture)?;
    Ok(WindowLoss::new(model, &Arc::new(WindowLogs::new(data)), of, settings)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_ground_truth::{Mechanism, symo_set};
    use leastaction_models::Model;

    fn case(mechanism: Mechanism, model: Method, noise: f64) -> Case {
        Case { mechanism, model, order: 4, trajectories: 16, seed: 1, noise, most_iterations: 30 }
    }

    /// If gravity or an axis had another direction, no masses would give the same motion.
    #[test]
    fn bodies_are_the_mechanisms() {
        // The tolerance of the acrobot is larger because it is chaotic.
        let cases = [
            (Mechanism::Pendulum, 1e-6, 1e-3),
            (Mechanism::Cartpole, 1e-5, 1e-3),
            (Mechanism::Acrobot, 1e-3, 0.5),
        ];
        for (mechanism, inertia, integration) in cases {
            let case = case(mechanism, Method::Bodies, 0.01);
            let set = symo_set(case.mechanism, case.seed, case.noise).unwrap();
            let (architecture, weights) = case.learn(case.recipe(), &set, &mut |_, _| ()).unwrap();
            let outcome = case.outcome(&Model::new(architecture, weights), &set, 0.0).unwrap();
            assert!(outcome.inertia_mse.unwrap() < inertia, "{outcome:?}");
            assert!(outcome.test_mse < 1.1 * 6.0 * 0.01 * 0.01, "{outcome:?}");
            assert!(outcome.integration_mse_100 < integration, "{outcome:?}");
        }
    }

    #[test]
    fn noise_of_positions_hardly_matters_over_windows() {
        let case = case(Mechanism::Pendulum, Method::Windows, 0.05);
        let set = symo_set(case.mechanism, case.seed, case.noise).unwrap();
        let recipe = Recipe { iterations: 30, ..networks(&case.recipe()).remove(0) };
        let weights = case.over_windows(&recipe, &set.train, 0..16, &mut |_, _| ()).unwrap();
        let outcome = case.outcome(&Model::new(recipe.architecture.clone(), weights), &set, 0.0).unwrap();
        // The position one step ahead of two noisy ones has an error of √6 times their noise.
        assert!(outcome.test_mse < 1.1 * 6.0 * 0.05 * 0.05, "{outcome:?}");
        assert!(outcome.inertia_mse.unwrap() < 1e-4, "{outcome:?}");
        assert!(outcome.integration_mse_100 < 0.2, "{outcome:?}");
    }
}
