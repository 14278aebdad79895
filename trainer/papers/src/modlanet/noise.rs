//! Few and noisy samples, compared with a network that knows nothing of mechanics.

use super::recipe::best_of;
use super::{Experiment, Outcome, held_back};
use crate::baselines::{Mlp, PredictionModel};
use crate::task::TaskError;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::{ManyBody, noisy};
use leastaction_learning::data::Rows;
use leastaction_learning::data::modlanet::{ModlanetRows, ModlanetSet};
use leastaction_learning::training::{Levenberg, Samples, StateNoise, free_states_objective};
use leastaction_models::{Family, ModularArchitecture};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use std::time::Instant;

/// Total numbers of samples, including those held back for validation.
const SAMPLES: [usize; 3] = [100, 300, 1_000];
/// Standard deviations of the noise on positions (rad) and velocities (rad/s).
const NOISE: [f64; 2] = [0.0, 0.01];
/// Inverse of the fraction of the samples that are held back to choose the iteration: a fifth.
const JUDGES: usize = 5;
/// Kind of the model that is learned as if the logged states were exact.
const AT_LOGGED: &str = "at logged states";
/// Factors λ of the penalty λ|θ|². The objective is 1 if the model explains everything except the noise.
const DECAYS: [f64; 3] = [100.0, 10.0, 1.0];

/// A function that learns weights from some rows and chooses among them by means of other rows.
type Learning<'a> = dyn Fn([&ModlanetRows; 2]) -> Result<Vec<f64>, ModelError> + 'a;

impl Experiment<'_> {
    /// Learns the system from few samples, without and with noise, with the model and with an MLP of at least as many
    /// weights. Both are trained for the same number of iterations, and the iteration with the lowest error on a
    /// held-back, equally noisy fifth of the samples is kept. The test set has no noise.
    pub(super) fn noise(&self, system: ManyBody, set: &ModlanetSet) -> Result<Vec<Outcome>, TaskError> {
        let modular = self.architecture(system, set)?;
        let weights = Family::initial_weights(&modular, self.options.seed).len();
        let mlp = Mlp::with_weights(&modular.coordinates(), weights)?;
        let mut rows = Vec::new();
        for count in SAMPLES {
            for noise in NOISE {
                let train = few(&set.train, count, noise, self.options.seed);
                let mlp = mlp.clone().scaled_to(&Samples::modlanet(&train));
                let set = ModlanetSet { train, test: set.test.clone() };
                let mut learn = |kind, shape: &dyn PredictionModel, learned: &Learning| {
                    (self.tell)(&format!("{count} samples, noise {noise}: {kind}"));
                    let outcome = self.learn_judged(system, kind, &set, (shape, learned))?;
                    rows.push(Outcome { noise, ..outcome });
                    Ok::<_, TaskError>(())
                };
                let at_logged = |shape: &dyn PredictionModel, rows: [&ModlanetRows; 2]| {
                    best_of(shape, rows, shape.initial_weights(self.options.seed), self.iterations())
                };
                if noise > 0.0 {
                    learn("trained", &modular, &|rows| self.free_states(&modular, rows, noise))?;
                }
                let kind = if noise > 0.0 { AT_LOGGED } else { "trained" };
                learn(kind, &modular, &|rows| at_logged(&modular, rows))?;
                learn("mlp", &mlp, &|rows| at_logged(&mlp, rows))?;
            }
        }
        Ok(rows)
    }

    /// Learns with free states, with penalties on the weights from strong to weak, each starting from the best weights
    /// of the previous one. Returns the best of all these weights, by the likelihood of the validation rows.
    fn free_states(
        &self,
        modular: &ModularArchitecture,
        rows: [&ModlanetRows; 2],
        noise: f64,
    ) -> Result<Vec<f64>, ModelError> {
        let noise = StateNoise { q: noise, v: noise, a: 0.0 };
        let shape = modular.clone().into();
        let objective = |rows| free_states_objective(&shape, Samples::modlanet(rows), noise);
        let [rows, judges] = rows;
        let (objective, judge) = (objective(rows)?, objective(judges)?);
        let mut weights = Family::initial_weights(modular, self.options.seed);
        for decay in DECAYS {
            let levenberg = Levenberg::new(&*objective, weights).with_decay(decay);
            weights = levenberg.best(&*objective, &*judge, self.iterations(), |_, _| ());
        }
        weights.truncate(objective.shared());
        Ok(weights)
    }

    fn learn_judged(
        &self,
        system: ManyBody,
        kind: &'static str,
        set: &ModlanetSet,
        (shape, learned): (&dyn PredictionModel, &Learning),
    ) -> Result<Outcome, TaskError> {
        let clock = Instant::now();
        let [rows, judges] = held_back(&set.train, JUDGES);
        let weights = learned([&rows, &judges])?;
        self.outcome(system, kind, set, (shape, &weights), clock.elapsed().as_secs_f64())
    }
}

/// Returns `count` rows drawn at random by the seed, with noise on their positions and velocities. A larger selection
/// begins with the same rows, and for other noise levels the noise differs only in its size. Accelerations stay exact.
fn few(rows: &ModlanetRows, count: usize, noise: f64, seed: u64) -> ModlanetRows {
    let mut order: Vec<usize> = (0..rows.q.len()).collect();
    order.shuffle(&mut Pcg64::seed_from_u64(seed));
    order.truncate(count);
    // Separate random streams make the noise independent of the number of rows.
    let disturbed = |values: &Rows, stream| {
        let mut stream = Pcg64::new(u128::from(seed), stream);
        values.select(&order).map(|x| noisy([x], noise, &mut stream)[0])
    };
    let (q, v) = (disturbed(&rows.q, 1), disturbed(&rows.v, 2));
    ModlanetRows { q, v, a: rows.a.select(&order), t: None, energy: None }
}

#[cfg(test)]
mod tests {
    use super::super::{Case, Options, run};
    use super::*;
    use leastaction_ground_truth::{ModlanetSettings, modlanet_set_of};

    /// A data set with 202 rows for training and 101 for testing.
    fn set() -> ModlanetSet {
        let settings = ModlanetSettings::published(ManyBody::Pendulum(2), 5);
        modlanet_set_of(&ModlanetSettings { trajectories: 3, ..settings }).unwrap()
    }

    #[test]
    fn samples_are_drawn_by_the_seed_and_positions_and_velocities_alone_are_noisy() {
        let rows = set().train;
        let (exact, noisy) = (few(&rows, 200, 0.0, 1), few(&rows, 200, 0.01, 1));
        assert_eq!(exact.q.slice(0..100), few(&rows, 100, 0.0, 1).q);
        assert_eq!(noisy.q.slice(0..100), few(&rows, 100, 0.01, 1).q);
        assert_ne!(exact.q, few(&rows, 200, 0.0, 2).q);
        assert_eq!(exact.a, noisy.a);
        let state = exact.a.iter().map(|a| rows.a.iter().position(|b| a == b).unwrap());
        assert!(state.zip(exact.v.iter()).all(|(k, v)| rows.v[k] == *v));
        for (exact, noisy) in [(exact.q, noisy.q), (exact.v, noisy.v)] {
            let pairs = exact.as_flat().iter().zip(noisy.as_flat());
            let square = pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / exact.as_flat().len() as f64;
            // The standard deviation of 400 numbers is tested to within a sixth, more than four times its own standard
            // deviation.
            assert!((square.sqrt() - 0.01).abs() < 0.01 / 6.0, "{square}");
        }
    }

    #[test]
    fn the_model_is_better_than_a_network_of_its_size() {
        let options = Options { iterations: Some(8), ..Options::new(0) };
        let rows = run((Case::Noise, None), &options, Some(&set()), &|_| ()).unwrap();
        let conditions: Vec<_> = rows.iter().map(|row| (row.samples, row.noise, row.kind)).collect();
        let expected = [(0.0, "trained"), (0.0, "mlp"), (0.01, "trained"), (0.01, AT_LOGGED), (0.01, "mlp")];
        let expected =
            SAMPLES.into_iter().flat_map(|count| expected.map(|(noise, kind)| (count.min(202), noise, kind)));
        assert_eq!(conditions, expected.collect::<Vec<_>>());
        for rows in rows.chunks_exact(5) {
            let [exact, plain, free, at_logged, noisy_plain] = rows else { panic!() };
            assert_eq!((exact.parameters, free.parameters, plain.parameters), (172, 172, 173));
            assert!(exact.test_mse < 0.5 * plain.test_mse, "{exact:?}");
            assert!(at_logged.test_mse < 0.5 * noisy_plain.test_mse, "{at_logged:?}");
            // Noise of states is not mistaken for forces.
            assert!(3.0 * free.test_mse < at_logged.test_mse, "{free:?} {at_logged:?}");
        }
        let [exact, noisy] = [&rows[5], &rows[8]];
        assert!(exact.train_mse < noisy.train_mse, "{exact:?} {noisy:?}");
    }
}
