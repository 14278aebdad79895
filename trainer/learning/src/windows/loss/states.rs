//! The start states of windows.

use super::WindowLoss;
use crate::training::Residuals;
use crate::windows::rollout::Lanes;
use crate::windows::starts;
use leastaction_programs::steps::State;
use leastaction_programs::{Row, WIDTH};

/// Largest number of Gauss–Newton steps of a new start state from its guess by a parabola.
const FIRST_STEPS: usize = 8;
/// Fractions of a window over which new start states are found before the whole window is used.
const GROWING: [f64; 2] = [0.25, 0.5];
/// Least number of steps in such a fraction.
const FEWEST_STEPS: usize = 5;

/// Number of alternations between fitting new start states and estimating the scales of residuals.
const ROUNDS: usize = 3;

impl WindowLoss {
    /// All parameters, with the start states and scales that fit the numbers best that all windows share. `weights` are these numbers alone,
    /// or all parameters, whose start states are where the search begins.
    pub fn settled(&self, weights: &[f64]) -> Vec<f64> {
        let is_complete = weights.len() == Residuals::parameters(self);
        let (mut weights, rounds) = if is_complete {
            (weights.to_vec(), 1)
        } else {
            (Residuals::enter(self, weights.to_vec()), ROUNDS)
        };
        for _ in 0..rounds {
            Residuals::settle(self, &mut weights);
            let _loss = Residuals::completed_loss(self, &mut weights);
        }
        weights
    }

    /// Keeps at most `most` windows, taken from all parts of the logs.
    #[must_use]
    pub fn with_at_most(mut self, most: usize) -> Self {
        let all = self.windows.len();
        if all > most {
            self.windows = (0..most).map(|k| self.windows[k * all / most]).collect();
        }
        self
    }

    /// The start states of the windows from `first` on.
    pub(super) fn starts(&self, weights: &[f64], first: usize) -> State {
        let last = self.windows.len() - 1;
        let of = |lane: usize, i: usize| weights[self.start((first + lane).min(last))][i];
        (0..2 * self.n()).map(|i| Row(std::array::from_fn(|lane| of(lane, i)))).collect()
    }

    /// Ends iterations that lower the loss by less than this part of it.
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// Replaces the start states of all windows by those of the blocks.
    pub(super) fn set_starts<'s>(&self, weights: &mut [f64], blocks: impl Iterator<Item = &'s State>) {
        for (block, starts) in blocks.enumerate() {
            for window in (block * WIDTH..self.windows.len()).take(WIDTH) {
                let place = &mut weights[self.start(window)];
                place.iter_mut().zip(starts).for_each(|(place, row)| *place = row.0[window % WIDTH]);
            }
        }
    }

    /// Completes these shared numbers with initial calibration numbers if they are missing, scales that equal the
    /// motion, and start states from parabolas.
    pub(super) fn with_guessed_starts(&self, mut weights: Vec<f64>) -> Vec<f64> {
        let n = self.n();
        weights.truncate(self.layout.end());
        if weights.len() < self.layout.end() {
            let known = weights.len().saturating_sub(self.layout.start);
            weights.extend(self.layout.initial().into_iter().skip(known));
        }
        weights.extend(&self.motion);
        for window in &self.windows {
            let guess: Vec<[f64; 2]> = (0..n).map(|i| self.logs.guess(*window, self.steps, i)).collect();
            let zero = |i: usize| weights[self.layout.zero(window.log, i)];
            let start: Vec<f64> = (0..n).map(|i| guess[i][0] - zero(i)).collect();
            weights.extend(start);
            weights.extend(guess.iter().map(|[_, slope]| slope));
        }
        weights
    }

    /// Replaces the start states by the best ones, found over successively longer parts of the windows.
    pub(super) fn with_best_starts(&self, mut weights: Vec<f64>) -> Vec<f64> {
        for steps in self.growing() {
            let solved = self.of_blocks(|first, _, stepper| {
                let lanes = Lanes { steps, ..self.lanes(&weights, first) };
                starts::solved(&lanes, stepper, &self.starts(&weights, first), FIRST_STEPS)
            });
            self.set_starts(&mut weights, solved.iter());
        }
        weights
    }

    /// Numbers of steps over which start states are found successively; the last is the whole window. Over a short part
    /// of a window, even a rough guess leads to the best state.
    fn growing(&self) -> impl Iterator<Item = usize> {
        let parts = GROWING.map(|part| self.pace.whole((part * self.steps as f64) as usize));
        let all = self.steps;
        parts.into_iter().filter(move |steps| (FEWEST_STEPS..all).contains(steps)).chain([all])
    }
}
