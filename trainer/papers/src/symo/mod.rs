//! SyMo's experiments (Santos et al., L4DC 2022): pendulum, cart-pole and acrobot learned from 8 to 128 trajectories of positions and
//! controls. The control is linear between samples, as in the authors' equation; in each trajectory it is constant.

mod bodies;
mod figures;
mod floor;
mod portrait;
mod published;
mod states;
mod task;
mod windows;

pub(super) use figures::overview;
pub use published::NOISE;
pub use task::{SymoData, tasks};

use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::Mechanism;
use leastaction_learning::data::Dataset;
use leastaction_learning::data::symo::SymoSet;
use leastaction_learning::evaluate::{
    IntegrationErrors, energy_mse, inertia_mse, integration_errors, one_step_mse,
};
use leastaction_learning::training::{Levenberg, LossKind, Objective, Samples, objective};
use leastaction_models::{Architecture, Beginning, InertiaNetworkArchitecture, Model};
use serde::Serialize;

/// Model to learn: SyMo's two, and the baselines, some of which are stepped by Runge–Kutta from logged velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Minimises the DEL residual at logged positions.
    Symo,
    /// Minimises the error of the implicit step's next position.
    E2eSymo,
    /// Minimises the position error of Runge–Kutta steps of order 4 over whole trajectories with free start states,
    /// from positions alone; afterwards it is stepped by the same equation as the SyMo models.
    Windows,
    /// Like `windows`, but the mechanism is described as rigid bodies on joints with learned parameters.
    Bodies,
    /// SyMo's network; minimises the error of the next state by a Runge–Kutta step of order 4.
    LNodeRk4,
    /// SyMo's network; minimises the error of the next state by the explicit midpoint rule.
    LNodeMidpoint,
    /// A plain network for the acceleration, stepped like L-NODE of order 4.
    NodeRk4,
    /// A plain network for the acceleration, stepped by the explicit midpoint rule.
    NodeMidpoint,
}

impl Method {
    /// Whether it is stepped by the discrete Euler–Lagrange equation.
    pub fn is_discrete(self) -> bool {
        matches!(self, Self::Symo | Self::E2eSymo | Self::Windows | Self::Bodies)
    }

    /// Whether it is meant only for noisy data: without noise, single steps are just as informative.
    pub fn is_for_noise(self) -> bool {
        matches!(self, Self::Windows | Self::Bodies)
    }

    /// Orders of its integrators.
    pub fn orders(self) -> &'static [u8] {
        match self {
            Self::Symo | Self::E2eSymo => &[2, 4],
            Self::Windows | Self::Bodies | Self::LNodeRk4 | Self::NodeRk4 => &[4],
            Self::LNodeMidpoint | Self::NodeMidpoint => &[2],
        }
    }
}

/// One row of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Mechanism of the row.
    pub mechanism: Mechanism,
    /// Model of the row.
    pub model: Method,
    /// Order of the integrator, 2 (SyMo's) or 4.
    pub order: u8,
    /// Number of training trajectories.
    pub trajectories: usize,
    /// Seed of the initial weights.
    pub seed: u64,
    /// Standard deviation of the noise on the states of the training and of the test set, rad or m and per second.
    pub noise: f64,
    /// Maximum number of iterations of the recipe.
    pub most_iterations: usize,
}

/// Results of a case, in SyMo's measures under equal conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Name of the mechanism.
    pub system: &'static str,
    /// Model of the row.
    pub model: Method,
    /// Order of the integrator.
    pub order: u8,
    /// Number of training trajectories.
    pub trajectories: usize,
    /// Number of weights.
    pub parameters: usize,
    /// Mean squared error of the next position on the training set (m², rad²).
    pub train_mse: f64,
    /// Mean squared error of the next position on the test set (m², rad²).
    pub test_mse: f64,
    /// Mean squared position error over 16 × 500 free steps.
    pub integration_mse: f64,
    /// Median of this error over the 16 motions.
    pub integration_median: f64,
    /// Mean of this error over their first 100 steps.
    pub integration_mse_100: f64,
    /// Mean squared error of the true energy along these motions (J²).
    pub energy_mse: f64,
    /// Mean squared error of the inertia matrix on the test set; `None` for NODE.
    pub inertia_mse: Option<f64>,
    /// Training time, s.
    pub train_seconds: f64,
    /// Seed of the initial weights.
    pub seed: u64,
}

impl Outcome {
    /// The six measures of the tables: test, integration mean, median and first 100 steps, energy, inertia; NaN for a missing one.
    pub fn measures(&self) -> [f64; 6] {
        [
            self.test_mse,
            self.integration_mse,
            self.integration_median,
            self.integration_mse_100,
            self.energy_mse,
            self.inertia_mse.unwrap_or(f64::NAN),
        ]
    }
}

/// Inverse of the fraction of noisy trajectories that are held back for validation.
const JUDGES: usize = 4;

/// Settings for learning a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Recipe {
    /// Shape of the network.
    pub architecture: Architecture,
    /// Number of iterations on the order-2 DEL residual, which is finite for any weights, before the actual loss of a
    /// discrete model.
    pub warm_up: usize,
    /// Number of iterations on the loss.
    pub iterations: usize,
    /// Penalty on the weights.
    pub decay: f64,
    /// Number of training trajectories that are held back for validation.
    pub judges: usize,
}

impl Recipe {
    /// Runs the given number of iterations on an objective; returns the last weights, or those that are best according
    /// to another objective.
    fn minimise(
        &self,
        (objective, judge): (&dyn Objective, Option<&dyn Objective>),
        weights: Vec<f64>,
        iterations: usize,
        watch: &mut dyn FnMut(usize, f64),
    ) -> Vec<f64> {
        let levenberg = Levenberg::new(objective, weights).with_decay(self.decay);
        let watch = |iteration: usize, levenberg: &Levenberg| watch(iteration, levenberg.loss);
        match judge {
            Some(judge) => levenberg.best(objective, judge, iterations, watch),
            None => levenberg.run(objective, iterations, watch).weights,
        }
    }

    /// Runs all iterations on an objective; returns the last weights or, if trajectories are held back, those that are
    /// best on these.
    fn learn(
        &self,
        [loss, judge]: [&dyn Objective; 2],
        weights: Vec<f64>,
        watch: &mut dyn FnMut(usize, f64),
    ) -> Vec<f64> {
        let judge = Some(judge).filter(|_| self.judges > 0);
        self.minimise((loss, judge), weights, self.iterations, watch)
    }

    /// Splits trajectories into training and validation; both are all trajectories if none are held back.
    fn split(&self, data: &Dataset) -> [Dataset; 2] {
        match self.judges {
            0 => [data.clone(), data.clone()],
            judges => data.split(data.trajectories.len().saturating_sub(judges)).into(),
        }
    }
}

impl Case {
    /// Returns the recipe for a case. One wide layer is better conditioned than two narrow ones and generalises better
    /// from few trajectories; the acrobot needs the second layer once there is enough data. The cart's position is
    /// declared cyclic.
    pub fn recipe(&self) -> Recipe {
        let (coordinates, widths): (&[Coordinate], Vec<u16>) = match self.mechanism {
            Mechanism::Pendulum => (&[Coordinate::Angle], vec![40]),
            Mechanism::Cartpole => (&[Coordinate::Cyclic, Coordinate::Angle], vec![100]),
            Mechanism::Acrobot => (&[Coordinate::Angle; 2], self.acrobot_widths()),
        };
        let architecture =
            InertiaNetworkArchitecture { widths, ..InertiaNetworkArchitecture::new(coordinates, 0) }.into();
        // At order 2 the model cannot fit the motion exactly and soon overfits to the integrator's error. This error is
        // largest at the pendulum's step of 0.1 s, and so is the penalty on the weights against overfitting.
        let (iterations, decay) = match (self.order, self.mechanism) {
            (4, _) => (150, 0.0),
            (_, Mechanism::Pendulum) => (30, 1e-8),
            (_, Mechanism::Cartpole) => (30, 1e-9),
            (_, Mechanism::Acrobot) => (30, 0.0),
        };
        // Overfitting to noise shows on held-back trajectories.
        let judges = if self.noise > 0.0 { self.trajectories / JUDGES } else { 0 };
        Recipe { architecture, warm_up: 20, iterations: iterations.min(self.most_iterations), decay, judges }
    }

    fn acrobot_widths(&self) -> Vec<u16> {
        let few = if self.order == 4 { 8 } else { 32 };
        if self.trajectories <= few { vec![100] } else { vec![24, 24] }
    }

    /// Learns the weights of a discrete model.
    pub fn train(
        &self,
        recipe: &Recipe,
        set: &SymoSet,
        mut watch: impl FnMut(usize, f64),
    ) -> Result<Vec<f64>, ModelError> {
        let architecture = &recipe.architecture;
        let [samples, judges] =
            recipe.split(&set.train.truncated(self.trajectories)).map(|data| Samples::triples(&data));
        let is_symo = self.model == Method::Symo;
        let kind = if is_symo { LossKind::DelResidual } else { LossKind::NextPosition };
        let warm_up = objective(architecture, samples.clone(), LossKind::DelResidual, 2)?;
        let next = objective(architecture, samples.clone(), LossKind::NextPosition, self.order)?;
        let judge = objective(architecture, judges, LossKind::NextPosition, self.order)?;
        let loss = objective(architecture, samples, kind, self.order)?;
        let weights = architecture.initial_weights(self.seed);
        let weights = recipe.minimise((&*warm_up, Some(&*next)), weights, recipe.warm_up, &mut watch);
        // On the same trajectories the loss of the next position would be its own judge.
        let is_other = recipe.judges > 0 || is_symo;
        let judge = Some(&*judge).filter(|_| is_other);
        Ok(recipe.minimise((&*loss, judge), weights, recipe.iterations, &mut watch))
    }

    /// Measures of a discrete model.
    pub fn outcome(&self, model: &Model, set: &SymoSet, train_seconds: f64) -> Result<Outcome, ModelError> {
        let (train, free) = (set.train.truncated(self.trajectories), &set.integration);
        let runs = model.rollout(self.order, (free, Beginning::Positions))?;
        let one_step = |data| Ok::<_, ModelError>(one_step_mse(model, self.order, data)?.or_infinite());
        let energy = energy_mse(self.mechanism, &runs, free);
        Ok(Outcome {
            parameters: model.architecture.learned_parameters()?,
            inertia_mse: Some(inertia_mse(model, self.mechanism, &set.test)?),
            train_seconds,
            ..self.row([one_step(&train)?, one_step(&set.test)?], integration_errors(&runs, free), energy)
        })
    }

    /// Row with errors of the next position on the training and the test set, and those of positions and energy over free steps.
    fn row(&self, [train_mse, test_mse]: [f64; 2], free: IntegrationErrors, energy_mse: f64) -> Outcome {
        Outcome {
            system: self.mechanism.name(),
            model: self.model,
            order: self.order,
            trajectories: self.trajectories,
            parameters: 0,
            train_mse,
            test_mse,
            integration_mse: free.mean,
            integration_median: free.median,
            integration_mse_100: free.first_100,
            energy_mse,
            inertia_mse: None,
            train_seconds: 0.0,
            seed: self.seed,
        }
    }
}
