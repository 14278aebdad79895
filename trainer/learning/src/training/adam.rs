//! Adam with a decreasing learning rate, as in the papers; kept for comparison and for very large networks.
//!
//! Source: Kingma and Ba, "Adam: a method for stochastic optimization", ICLR 2015; the schedules are PyTorch's
//! `ReduceLROnPlateau` and `MultiStepLR`, the decay its `weight_decay`.

use super::{Bounds, NormalEquations, Objective, Progress};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use std::ops::Range;

const BETA_1: f64 = 0.9;
const BETA_2: f64 = 0.999;
const EPSILON: f64 = 1e-8;
/// Relative amount by which a loss must be below the best one to count as better (as in PyTorch).
const THRESHOLD: f64 = 1e-4;

/// Settings of Adam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdamSettings {
    /// Initial learning rate.
    pub learning_rate: f64,
    /// Batch size, in samples; 0: all samples.
    pub batch: usize,
    /// Schedule of the learning rate.
    pub schedule: Schedule,
    /// Weight decay λ: λθ is added to the gradient of the loss.
    pub decay: f64,
    /// Seed of the order of the batches.
    pub seed: u64,
}

/// Schedule of the learning rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Schedule {
    /// A constant learning rate.
    Constant,
    /// A decrease on every plateau.
    Plateau {
        /// Factor of the learning rate, below 1.
        factor: f64,
        /// Epochs without improvement before a decrease.
        patience: u32,
    },
    /// A decrease after each of the given epochs.
    Steps {
        /// Factor of the learning rate, below 1.
        factor: f64,
        /// The epochs.
        epochs: [u64; 3],
    },
}

impl AdamSettings {
    /// SyMo's settings: learning rate 1e-3, batches of 4 samples per trajectory, ×0.7 after 50 epochs without improvement.
    pub fn symo(trajectories: usize, seed: u64) -> Self {
        let schedule = Schedule::Plateau { factor: 0.7, patience: 50 };
        Self { learning_rate: 1e-3, batch: 4 * trajectories, schedule, decay: 0.0, seed }
    }
}

/// The state of an optimisation, sufficient to continue it bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adam {
    /// The weights after the last epoch.
    pub weights: Vec<f64>,
    /// Mean loss of the batches of the last epoch.
    pub loss: f64,
    settings: AdamSettings,
    rate: f64,
    mean: Vec<f64>,
    square: Vec<f64>,
    steps: u64,
    epoch: u64,
    best: f64,
    bad_epochs: u32,
}

impl Adam {
    /// Starts at these weights; weights outside their range or at its end are moved a little inside.
    pub fn new(objective: &dyn Objective, weights: Vec<f64>, settings: AdamSettings) -> Self {
        let weights = objective.bounds().within(weights);
        let zeros = vec![0.0; weights.len()];
        let loss = objective.loss(&weights);
        Self {
            weights,
            loss,
            settings,
            rate: settings.learning_rate,
            mean: zeros.clone(),
            square: zeros,
            steps: 0,
            epoch: 0,
            best: f64::INFINITY,
            bad_epochs: 0,
        }
    }

    /// The current learning rate.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Number of epochs done.
    pub fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Runs one epoch, in which every sample is used once.
    pub fn iterate(&mut self, objective: &dyn Objective) -> Progress {
        let (mut squares, mut rows) = (0.0, 0);
        for batch in self.batches(objective.samples()) {
            let Some(equations) = objective.gradient(&self.weights, batch) else { return Progress::Stuck };
            squares += equations.squares;
            rows += equations.rows;
            self.step(objective.bounds(), equations);
            objective.project(&mut self.weights);
        }
        self.loss = squares / rows as f64;
        self.epoch += 1;
        self.follow_schedule();
        Progress::Lower
    }

    /// Batches in an order that depends on the seed and the epoch alone.
    fn batches(&self, samples: usize) -> Vec<Range<usize>> {
        let size = if self.settings.batch == 0 { samples } else { self.settings.batch }.max(1);
        let mut batches: Vec<_> =
            (0..samples).step_by(size).map(|start| start..samples.min(start + size)).collect();
        batches.shuffle(&mut Pcg64::seed_from_u64(self.settings.seed.wrapping_add(self.epoch)));
        batches
    }

    /// One step of θ along the gradient of the mean squared residual.
    fn step(&mut self, bounds: &Bounds, mut equations: NormalEquations) {
        let scale = 2.0 / equations.rows as f64;
        let mut theta = bounds.free(&self.weights);
        equations.bring_to_free(bounds, &theta);
        self.steps += 1;
        let power = self.steps.min(100_000) as i32;
        let (correction_1, correction_2) = (1.0 - BETA_1.powi(power), 1.0 - BETA_2.powi(power));
        for (((w, m), s), g) in
            theta.iter_mut().zip(&mut self.mean).zip(&mut self.square).zip(&equations.gradient)
        {
            let g = scale * g + self.settings.decay * *w;
            *m = BETA_1 * *m + (1.0 - BETA_1) * g;
            *s = BETA_2 * *s + (1.0 - BETA_2) * g * g;
            *w -= self.rate * (*m / correction_1) / ((*s / correction_2).sqrt() + EPSILON);
        }
        self.weights = bounds.weights(&theta);
    }

    fn follow_schedule(&mut self) {
        match self.settings.schedule {
            Schedule::Constant => {}
            Schedule::Plateau { factor, patience } => self.follow_plateau(factor, patience),
            Schedule::Steps { factor, epochs } => {
                if epochs.contains(&self.epoch) {
                    self.rate *= factor;
                }
            }
        }
    }

    fn follow_plateau(&mut self, factor: f64, patience: u32) {
        if self.loss < self.best * (1.0 - THRESHOLD) {
            (self.best, self.bad_epochs) = (self.loss, 0);
            return;
        }
        self.bad_epochs += 1;
        if self.bad_epochs > patience {
            self.rate *= factor;
            self.bad_epochs = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// A loss that does not depend on the weights.
    struct Flat;

    impl Objective for Flat {
        fn parameters(&self) -> usize {
            2
        }
        fn samples(&self) -> usize {
            1
        }
        fn loss(&self, _: &[f64]) -> f64 {
            1.0
        }
        fn normal_equations(&self, _: &[f64]) -> Option<NormalEquations> {
            None
        }
        fn gradient(&self, _: &[f64], _: Range<usize>) -> Option<NormalEquations> {
            Some(NormalEquations {
                gram: DMatrix::zeros(0, 0),
                gradient: vec![0.0; 2],
                squares: 1.0,
                rows: 1,
            })
        }
        fn project(&self, _: &mut [f64]) {}
    }

    fn adam(schedule: Schedule, decay: f64) -> Adam {
        let settings = AdamSettings { learning_rate: 0.1, batch: 0, schedule, decay, seed: 0 };
        Adam::new(&Flat, vec![1.0, -3.0], settings)
    }

    #[test]
    fn decay_pulls_weights_to_zero_and_none_leaves_them() {
        let mut adam_with = adam(Schedule::Constant, 1e-2);
        adam_with.iterate(&Flat);
        // The first step of Adam has the length of the learning rate, whatever the size of the gradient.
        assert!((adam_with.weights[0] - 0.9).abs() < 1e-6 && (adam_with.weights[1] + 2.9).abs() < 1e-6);
        let mut without = adam(Schedule::Constant, 0.0);
        without.iterate(&Flat);
        assert_eq!(without.weights, [1.0, -3.0]);
    }

    #[test]
    fn rates_fall_when_the_schedule_says() {
        let rates = |schedule| {
            let mut adam = adam(schedule, 0.0);
            std::array::from_fn::<f64, 6, _>(|_| {
                adam.iterate(&Flat);
                adam.rate()
            })
        };
        assert_eq!(rates(Schedule::Constant), [0.1; 6]);
        let steps = Schedule::Steps { factor: 0.5, epochs: [2, 5, 9] };
        assert_eq!(rates(steps), [0.1, 0.05, 0.05, 0.05, 0.025, 0.025]);
        let plateau = Schedule::Plateau { factor: 0.5, patience: 1 };
        assert_eq!(rates(plateau), [0.1, 0.1, 0.05, 0.05, 0.025, 0.025]);
    }
}
