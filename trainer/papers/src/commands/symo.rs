//! `leastaction-papers symo`.

use super::selection::{Selection, cases, given};
use clap::{Args, ValueEnum};
use leastaction::cli::arguments::{order, positive};
use leastaction::cli::{Done, Failure, Output};
use leastaction_ground_truth::Mechanism;
use leastaction_learning::data::symo;
use leastaction_papers::SYMO;
use leastaction_papers::symo::{Case, Method, NOISE, SymoData, tasks};
use leastaction_papers::task::Task;
use std::path::PathBuf;

/// SyMo (Santos et al., L4DC 2022): pendulum, cart-pole and acrobot from positions and controls.
///
/// Learns every case that the options leave open (all: three systems, SyMo's two models of orders 2 and 4 and four baselines, 8 to 128
/// trajectories) and prints its errors beside those of the published program under equal conditions. With -o also writes a page with
/// pictures.
///
/// Example: leastaction-papers symo --system cartpole --model e2e-symo --order 4 --trajectories 32 --json
#[derive(Args)]
pub struct Symo {
    /// Only this mechanism.
    #[arg(long)]
    system: Option<System>,
    /// Only this model.
    #[arg(long)]
    model: Option<Method>,
    /// Only this order, 2 or 4.
    #[arg(long, value_parser = order)]
    order: Option<u8>,
    /// Only this number of training trajectories.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=TRAJECTORIES))]
    trajectories: Option<u32>,
    /// Standard deviation of the noise on the training and the test set. If nothing is chosen, the pendulum from 32 trajectories is also
    /// learned with 0.01, 0.05 and 0.1.
    #[arg(long, value_name = "SIGMA", value_parser = positive, conflicts_with = "data")]
    noise: Option<f64>,
    /// A data set in the layout of the SyMo authors (train_x, test_x, int_x, …) instead of a generated one; needs --system.
    #[arg(long, value_name = "FILE", requires = "system")]
    data: Option<PathBuf>,
    #[command(flatten)]
    selection: Selection,
}

#[derive(Clone, Copy, ValueEnum)]
enum System {
    /// A rod on a pivot, θ = 0 upright, torque u: θ̈ = 1.5 g sin θ + 3u.
    Pendulum,
    /// A pole on a cart, θ = 0 upright, force u on the cart.
    Cartpole,
    /// Two links hanging at 0, torque u at the second joint.
    Acrobot,
}

impl From<System> for Mechanism {
    fn from(system: System) -> Self {
        match system {
            System::Pendulum => Self::Pendulum,
            System::Cartpole => Self::Cartpole,
            System::Acrobot => Self::Acrobot,
        }
    }
}

/// Number of trajectories of a training set.
const TRAJECTORIES: i64 = 128;
/// Maximum number of iterations for a first look.
const QUICK: usize = 30;

impl Symo {
    /// Learns and prints.
    pub fn run(self, output: Output) -> Done {
        let mut tasks = Vec::new();
        for system in cases(self.system) {
            tasks.extend(self.tasks(system.into())?);
        }
        if let (Some(model), Some(order), true) = (self.model, self.order, tasks.is_empty()) {
            let orders = model.orders().iter().map(u8::to_string).collect::<Vec<_>>().join(" and ");
            return Err(Failure::Input(format!(
                "--order {order}: the integrator of this model has order {orders}"
            )));
        }
        self.selection.run(&SYMO, tasks, output)
    }

    fn tasks(&self, mechanism: Mechanism) -> Result<Vec<Task>, Failure> {
        let Some(file) = &self.data else {
            let all = self
                .selection
                .seeds()
                .flat_map(|seed| self.noises(mechanism).into_iter().map(move |noise| (seed, noise)));
            let of_data = |(seed, noise)| {
                let data = SymoData::generated(mechanism, seed, noise);
                tasks(&self.cases(mechanism, seed, noise), &data, &self.arguments())
            };
            return Ok(all.flat_map(of_data).collect());
        };
        let set = symo::read(file, mechanism.step(), mechanism.actuated())
            .map_err(|error| Failure::Input(error.to_string()))?;
        let available = set.train.trajectories.len();
        if let Some(wanted) = self.trajectories.filter(|wanted| *wanted as usize > available) {
            let file = file.display();
            return Err(Failure::Input(format!(
                "--trajectories {wanted}: {file} has {available} for training"
            )));
        }
        let data = SymoData::read(mechanism, file.display().to_string(), set);
        let mut cases: Vec<Case> =
            self.selection.seeds().flat_map(|seed| self.cases(mechanism, seed, 0.0)).collect();
        cases.retain(|case| case.trajectories <= available);
        Ok(tasks(&cases, &data, &self.arguments()))
    }

    /// Noise levels: the chosen one, or none and those of the authors' study of the pendulum.
    fn noises(&self, mechanism: Mechanism) -> Vec<f64> {
        let is_chosen = self.model.is_some() || self.order.is_some() || self.trajectories.is_some();
        match self.noise {
            Some(noise) => vec![noise],
            None if mechanism == Mechanism::Pendulum && !is_chosen => [vec![0.0], NOISE.to_vec()].concat(),
            None => vec![0.0],
        }
    }

    fn cases(&self, mechanism: Mechanism, seed: u64, noise: f64) -> Vec<Case> {
        let quick = self.selection.quick;
        let all: &[usize] = match (noise > 0.0, quick) {
            (true, _) => &[32],
            (false, true) => &[8, 32],
            (false, false) => &[8, 16, 32, 64, 128],
        };
        let sizes = self.trajectories.map_or_else(|| all.to_vec(), |only| vec![only as usize]);
        let usual = || {
            let all = Method::value_variants().iter().copied();
            all.filter(|model| noise > 0.0 || !model.is_for_noise()).collect()
        };
        let models: Vec<Method> = self.model.map_or_else(usual, |only| vec![only]);
        let is_wanted = |order: &&u8| self.order.is_none_or(|only| only == **order);
        let most_iterations = if quick { QUICK } else { usize::MAX };
        let mut cases = Vec::new();
        for trajectories in sizes {
            for model in &models {
                for order in model.orders().iter().filter(is_wanted) {
                    let (model, order) = (*model, *order);
                    cases.push(Case { mechanism, model, order, trajectories, seed, noise, most_iterations });
                }
            }
        }
        cases
    }

    /// Command-line options other than those that name a case.
    fn arguments(&self) -> String {
        given("data", self.data.as_ref().map(|file| file.display())) + &self.selection.arguments()
    }
}
