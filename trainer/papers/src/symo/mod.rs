//! SyMo's experiments (Santos et al., L4DC 2022): pendulum, cart-pole and acrobot learned from 8 to 128 trajectories of
//! positions and controls. The control is linear between samples, as in the authors' equation; in each trajectory it is constant.

mod bodies;
mod figures;
mod floor;
mod portrait;
mod published;
mod states;
mod task;
mod windows;

pub use published::{NOISE, Published, published};
pub use states::CaseError;
pub use task::{SymoData, overview, tasks};

use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::Mechanism;
use leastaction_learning::data::Dataset;
use leastaction_learning::data::symo::SymoSet;
use leastaction_learning::evaluate::{energy_mse, inertia_mse, integration_errors, one_step_mse};
use leastaction_learning::training::{Levenberg, LossKind, Objective, Samples, objective};
use leastaction_models::{Architecture, InertiaNetworkArchitecture};
use leastaction_models::{Beginning, Model};
use serde::Serialize;

/// Which of the models: SyMo's two, and the baselines that are stepped by Runge–Kutta from logged velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The DEL residual at logged positions is minimised.
    Symo,
    /// The error of the implicit step's next position is minimised.
    E2eSymo,
    /// From positions alone over whole trajectories with free start states, the position error of Runge–Kutta steps of order 4 is minimised;
    /// stepped by the equation of the other two.
    Windows,
    /// As `windows`, but the mechanism is described as rigid bodies on joints, whose numbers are learned.
    Bodies,
    /// SyMo's network, the error of the next state by a Runge–Kutta step of order 4 is minimised.
    LNodeRk4,
    /// The same with the explicit midpoint rule.
    LNodeMidpoint,
    /// A plain network for the acceleration, stepped as L-NODE of order 4.
    NodeRk4,
    /// The same with the explicit midpoint rule.
    NodeMidpoint,
}

impl Method {
    /// Whether it is one of the discrete Euler–Lagrange equation, and not one that those are compared with.
    pub fn is_discrete(self) -> bool {
        matches!(self, Self::Symo | Self::E2eSymo | Self::Windows | Self::Bodies)
    }

    /// Whether it is for data with noise alone: without any, single steps say as much.
    pub fn is_for_noise(self) -> bool {
        matches!(self, Self::Windows | Self::Bodies)
    }

    /// Of its integrators.
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
    /// Which mechanism.
    pub mechanism: Mechanism,
    /// Which loss.
    pub model: Method,
    /// 2 (SyMo's) or 4.
    pub order: u8,
    /// Training trajectories.
    pub trajectories: usize,
    /// Of the initial weights.
    pub seed: u64,
    /// Standard deviation of the noise on the states of the training and of the test set, rad or m and per second.
    pub noise: f64,
    /// Iterations of the recipe at most.
    pub most_iterations: usize,
}

/// What a case gives, in SyMo's measures on equal terms.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Name of the mechanism.
    pub system: &'static str,
    /// Which loss.
    pub model: Method,
    /// Of the integrator.
    pub order: u8,
    /// Training trajectories.
    pub trajectories: usize,
    /// Weights.
    pub parameters: usize,
    /// Mean squared error of the next position, training set (m², rad²).
    pub train_mse: f64,
    /// The same, test set.
    pub test_mse: f64,
    /// Mean squared position error over 16 × 500 free steps.
    pub integration_mse: f64,
    /// Median over the 16.
    pub integration_median: f64,
    /// Mean over their first 100 steps.
    pub integration_mse_100: f64,
    /// Mean squared error of the true energy along them (J²).
    pub energy_mse: f64,
    /// Mean squared error of the inertia matrix on the test set; NODE has none.
    pub inertia_mse: Option<f64>,
    /// Training time, s.
    pub train_seconds: f64,
    /// Of the initial weights.
    pub seed: u64,
}

impl Outcome {
    /// The six measures of the tables: test, integration mean, median and first 100 steps, energy, inertia; not a number where
    /// there is none.
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

/// Of so many noisy trajectories one judges.
const JUDGES: usize = 4;

/// How a case is learned.
#[derive(Clone, Debug, PartialEq)]
pub struct Recipe {
    /// The network.
    pub architecture: Architecture,
    /// Iterations on the order-2 DEL residual, which is finite whatever the weights, before the loss of a discrete model itself.
    pub warm_up: usize,
    /// Iterations on the loss.
    pub iterations: usize,
    /// Penalty on the weights.
    pub decay: f64,
    /// Training trajectories that are held back to judge by.
    pub judges: usize,
}

impl Recipe {
    /// So many iterations on an objective; the last weights, or those that are best by another objective.
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

    /// Of these trajectories those that are learned from, and those that judge: where none are held back, the same.
    fn split(&self, data: &Dataset) -> [Dataset; 2] {
        match self.judges {
            0 => [data.clone(), data.clone()],
            judges => data.split(data.trajectories.len().saturating_sub(judges)).into(),
        }
    }
}

impl Case {
    /// The recipe for a case. One wide layer is better conditioned than two narrow ones and generalises better from few
    /// trajectories; the acrobot wants the second layer where the data can fill it. The cart's position is known to be
    /// cyclic.
    pub fn recipe(&self) -> Recipe {
        let (coordinates, widths): (&[Coordinate], Vec<u16>) = match self.mechanism {
            Mechanism::Pendulum => (&[Coordinate::Angle], vec![40]),
            Mechanism::Cartpole => (&[Coordinate::Cyclic, Coordinate::Angle], vec![100]),
            Mechanism::Acrobot => (&[Coordinate::Angle; 2], self.acrobot_widths()),
        };
        let architecture =
            InertiaNetworkArchitecture { widths, ..InertiaNetworkArchitecture::new(coordinates, 0) }.into();
        // At order 2 the model cannot fit the motion exactly and soon learns the integrator's error by heart; that error, and
        // so the penalty that keeps the weights from it, is the largest at the pendulum's step of 0.1 s.
        let (iterations, decay) = match (self.order, self.mechanism) {
            (4, _) => (150, 0.0),
            (_, Mechanism::Pendulum) => (30, 1e-8),
            (_, Mechanism::Cartpole) => (30, 1e-9),
            (_, Mechanism::Acrobot) => (30, 0.0),
        };
        // What is learned by heart of noise shows on other trajectories.
        let judges = if self.noise > 0.0 { self.trajectories / JUDGES } else { 0 };
        Recipe { architecture, warm_up: 20, iterations: iterations.min(self.most_iterations), decay, judges }
    }

    fn acrobot_widths(&self) -> Vec<u16> {
        let few = if self.order == 4 { 8 } else { 32 };
        if self.trajectories <= few { vec![100] } else { vec![24, 24] }
    }

    fn loss(&self) -> LossKind {
        if self.model == Method::Symo { LossKind::DelResidual } else { LossKind::NextPosition }
    }

    /// The learned weights of a discrete model.
    ///
    /// # Errors
    /// Where the shape does not fit in itself or the data.
    pub fn train(
        &self,
        recipe: &Recipe,
        set: &SymoSet,
        mut watch: impl FnMut(usize, f64),
    ) -> Result<Vec<f64>, ModelError> {
        let architecture = &recipe.architecture;
        let [samples, judges] =
            recipe.split(&set.train.truncated(self.trajectories)).map(|data| Samples::triples(&data));
        let warm_up = objective(architecture, samples.clone(), LossKind::DelResidual, 2)?;
        let next = objective(architecture, samples.clone(), LossKind::NextPosition, self.order)?;
        let judge = objective(architecture, judges, LossKind::NextPosition, self.order)?;
        let loss = objective(architecture, samples, self.loss(), self.order)?;
        let weights = architecture.initial_weights(self.seed);
        let weights = recipe.minimise((&*warm_up, Some(&*next)), weights, recipe.warm_up, &mut watch);
        // On the same trajectories the next position would judge itself.
        let is_other = recipe.judges > 0 || self.model == Method::Symo;
        let judge = Some(&*judge).filter(|_| is_other);
        Ok(recipe.minimise((&*loss, judge), weights, recipe.iterations, &mut watch))
    }

    /// The measures of a discrete model.
    ///
    /// # Errors
    /// Where the shape does not fit in itself or the data.
    pub fn outcome(&self, model: &Model, set: &SymoSet, train_seconds: f64) -> Result<Outcome, ModelError> {
        let train = set.train.truncated(self.trajectories);
        let runs = model.rollout(self.order, (&set.integration, Beginning::Positions))?;
        let integration = integration_errors(&runs, &set.integration);
        Ok(Outcome {
            system: self.mechanism.name(),
            model: self.model,
            order: self.order,
            trajectories: self.trajectories,
            parameters: model.architecture.learned_parameters()?,
            train_mse: one_step_mse(model, self.order, &train)?.or_infinite(),
            test_mse: one_step_mse(model, self.order, &set.test)?.or_infinite(),
            integration_mse: integration.mean,
            integration_median: integration.median,
            integration_mse_100: integration.first_100,
            energy_mse: energy_mse(self.mechanism, &runs, &set.integration),
            inertia_mse: Some(inertia_mse(model, self.mechanism, &set.test)?),
            train_seconds,
            seed: self.seed,
        })
    }
}
