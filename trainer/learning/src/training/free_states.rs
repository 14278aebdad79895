//! The acceleration loss for states that are logged with noise, in any order: the states are free variables.
//!
//! It is min over θ, q̂, v̂ of Σ |q̃ − q̂|²/σ_q² + |ṽ − v̂|²/σ_v² + |ã − v̇(q̂, v̂; θ)|²/σ_a², row by row. At a logged
//! state the acceleration has an error of the noise times ∂v̇/∂(q, v). A loss at logged states would mistake this error
//! for forces, and weight it most where motion is most violent.
//!
//! Before every iteration the states are re-estimated by Gauss–Newton: x̂ = x̃ − ΣJᵀC⁻¹r with J = ∂v̇/∂(q, v) at the
//! states, C = JΣJᵀ + σ_a², c = J(x̃ − x̂) and r = v̇(q̂, v̂) + c − ã. The remaining term of a row is rᵀC⁻¹r. An
//! iteration on the weights therefore minimises the squares of W(v̇(q̂, v̂; θ) + c − ã), WᵀW = C⁻¹, with x̂, c and W
//! fixed. Source: Boggs, Byrd and Schnabel, "A stable and efficient algorithm for nonlinear orthogonal distance
//! regression", 1987.

mod whitening;

use super::blocks::{Place, linearise_blocks, sum_of_squares};
use super::residuals::{ChunkRows, Failed, Residuals};
use super::{Bounds, Objective, Samples};
use leastaction_core::model::ModelError;
use leastaction_models::Architecture;
use leastaction_models::parallel::{self, Pool};
use leastaction_programs::dynamics::AccelerationSlopes;
use leastaction_programs::losses::{AccelerationLoss, Block, Derivatives, Loss};
use leastaction_programs::{Row, System, WIDTH};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use whitening::{numbers_below, solve, whiten, whitening};

/// Gauss–Newton steps of the states in each iteration.
const STEPS: usize = 3;
/// Gauss–Newton steps of the states when they start at the logged states.
const FIRST_STEPS: usize = 8;
/// Largest distance of a state from its logged value, in standard deviations.
const FURTHEST: f64 = 6.0;
/// Degrees of freedom of the Student distribution assumed for held-back rows, which gives single outliers little
/// influence.
const FREEDOM: f64 = 4.0;

/// Standard deviations of logged states; a quantity for which none is given counts as exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StateNoise {
    /// Standard deviation of positions, m or rad.
    pub q: f64,
    /// Standard deviation of velocities, m/s or rad/s.
    pub v: f64,
    /// Standard deviation of accelerations, m/s² or rad/s².
    pub a: f64,
}

impl StateNoise {
    /// Whether all numbers are finite and not negative, and at least one of positions and velocities is noisy.
    pub fn is_noise(&self) -> bool {
        let numbers = [self.q, self.v, self.a];
        numbers.iter().all(|x| x.is_finite() && *x >= 0.0) && self.q + self.v > 0.0
    }
}

/// Evaluates samples side by side.
struct Evaluator {
    loss: AccelerationLoss,
    slopes: AccelerationSlopes,
}

/// The loss. Its parameters are the weight block and then, for every row, q̂, v̂, c and W. W is stored row by row up to
/// its diagonal.
struct FreeStates {
    evaluators: Pool<Evaluator>,
    parameters: usize,
    fixed: Vec<usize>,
    samples: Samples,
    noise: StateNoise,
    architecture: Architecture,
    bounds: Bounds,
}

/// Rows side by side, linearised at their estimated states.
struct Linearised {
    /// v̇(q̂, v̂) + c − ã.
    residual: Vec<Row>,
    /// c = J(x̃ − x̂).
    shift: Vec<Row>,
    /// JΣ½, column by column.
    scaled: Vec<Row>,
}

/// The objective of the acceleration at noisy states with these standard deviations.
///
/// # Errors
/// [`ModelError`] if the shape is inconsistent or has rods.
pub fn free_states_objective(
    architecture: &Architecture,
    samples: Samples,
    noise: StateNoise,
) -> Result<Box<dyn Objective>, ModelError> {
    architecture.check_without_rods("rods under noisy states")?;
    let system = System::new(&*architecture.energies()?);
    let make =
        move || Evaluator { loss: AccelerationLoss::new(&system), slopes: AccelerationSlopes::new(&system) };
    Ok(Box::new(FreeStates {
        evaluators: Pool::new(make),
        parameters: architecture.parameters()?,
        fixed: architecture.fixed_positions(),
        samples,
        noise,
        bounds: architecture.bounds(),
        architecture: architecture.clone(),
    }))
}

impl FreeStates {
    fn n(&self) -> usize {
        self.samples.n
    }

    /// Positions of the parameters of a row.
    fn numbers(&self, row: usize) -> Range<usize> {
        let size = 3 * self.n() + numbers_below(self.n());
        let first = self.parameters + size * row;
        first..first + size
    }

    /// The numbers of rows side by side from `start` on, padded with the last of `samples`.
    fn gathered(&self, weights: &[f64], (start, samples): Place) -> Vec<Row> {
        let at = |k: usize, i: usize| weights[self.numbers((start + k).min(samples.end - 1)).start + i];
        (0..self.numbers(0).len()).map(|i| Row(std::array::from_fn(|k| at(k, i)))).collect()
    }

    /// The rows from `start` on at their estimated states, with ã − c in place of ã.
    fn block(&self, numbers: &[Row], place: Place) -> Block {
        let n = self.n();
        let mut block = self.samples.block(place.0, place.1);
        let [q, v, a] = &mut block.states;
        q.copy_from_slice(&numbers[..n]);
        v.copy_from_slice(&numbers[n..2 * n]);
        a.iter_mut().zip(&numbers[2 * n..]).for_each(|(a, c)| a.add_scaled(-1.0, c));
        block
    }

    /// Writes W(v̇ + c − ã) of the rows from `start` on, and its derivatives into buffers that are 0 before.
    fn evaluate(
        &self,
        evaluator: &mut Evaluator,
        weights: &[f64],
        place: Place,
        (residual, derivatives): (&mut [Row], Option<&mut [Vec<Row>]>),
    ) -> Result<(), Failed> {
        let numbers = self.gathered(weights, place);
        let block = self.block(&numbers, place);
        let (n, own) = (self.n(), &weights[..self.parameters]);
        let w = &numbers[3 * n..];
        let failures = match derivatives {
            None => evaluator.loss.evaluate(own, &block, residual, Derivatives::None),
            Some(rows) => {
                let failures =
                    evaluator.loss.evaluate(own, &block, residual, Derivatives::Jacobian(&mut *rows));
                let mut column = vec![Row::default(); n];
                for position in 0..own.len() {
                    column.iter_mut().zip(&*rows).for_each(|(x, row)| *x = row[position]);
                    whiten(w, &mut column);
                    rows.iter_mut().zip(&column).for_each(|(row, x)| row[position] = *x);
                }
                failures
            }
        };
        whiten(w, residual);
        let count = (place.1.end - place.0).min(WIDTH);
        let finite = residual.iter().all(|r| r.0[..count].iter().all(|r| r.is_finite()));
        if finite && !failures.any(count) { Ok(()) } else { Err(Failed) }
    }

    /// Linearises the rows of a block at these states (q, v).
    fn linearised(
        &self,
        evaluator: &mut Evaluator,
        weights: &[f64],
        (logged, states): (&Block, &[Row]),
    ) -> Linearised {
        let n = self.n();
        let (mut residual, mut scaled) = (vec![Row::default(); n], vec![Row::default(); 2 * n * n]);
        let at = [&states[..n], &states[n..], &logged.controls[0]];
        // Lanes that fail are NaN from here on.
        evaluator.slopes.evaluate(&weights[..self.parameters], at, &mut residual, &mut scaled);
        let mut shift = vec![Row::default(); n];
        let from = logged.states[0].iter().chain(&logged.states[1]).zip(states);
        for (column, (logged, state)) in scaled.chunks_exact(n).zip(from) {
            let mut away = *logged;
            away.add_scaled(-1.0, state);
            shift.iter_mut().zip(column).for_each(|(shift, slope)| shift.add_product(slope, &away));
        }
        for ((residual, shift), a) in residual.iter_mut().zip(&shift).zip(&logged.states[2]) {
            residual.add_scaled(1.0, shift);
            residual.add_scaled(-1.0, a);
        }
        for (i, column) in scaled.chunks_exact_mut(n).enumerate() {
            column.iter_mut().for_each(|x| x.0.iter_mut().for_each(|x| *x *= self.deviation(i)));
        }
        Linearised { residual, shift, scaled }
    }

    /// Standard deviation σ of entry i of (q, v).
    fn deviation(&self, i: usize) -> f64 {
        if i < self.n() { self.noise.q } else { self.noise.v }
    }

    /// The most likely states of rows, x̃ − ΣJᵀC⁻¹r, limited in their distance from x̃; x̃ itself if the result is NaN.
    fn likely(&self, logged: &Block, at: &Linearised) -> Vec<Row> {
        let n = self.n();
        let w = whitening(&at.scaled, n, self.noise.a);
        let force = solve(&w, &at.residual);
        let logged = logged.states[0].iter().chain(&logged.states[1]);
        let columns = at.scaled.chunks_exact(n).zip(logged).enumerate();
        columns
            .map(|(i, (column, logged))| {
                let mut away = Row::default();
                column.iter().zip(&force).for_each(|(slope, force)| away.add_product(slope, force));
                let moved = |away: f64| {
                    let own = if away.is_finite() { away.clamp(-FURTHEST, FURTHEST) } else { 0.0 };
                    -self.deviation(i) * own
                };
                let mut state = *logged;
                state.add_scaled(1.0, &Row(away.0.map(moved)));
                state
            })
            .collect()
    }

    /// Takes `steps` steps of the states of all rows and stores the result. Returns −2 ln p per component for each row,
    /// up to a constant.
    fn solve_states(&self, weights: &mut [f64], steps: usize) -> Vec<f64> {
        let (n, all) = (self.n(), 0..self.samples.len());
        let of_block = |block: usize| {
            let place = (block * WIDTH, &all);
            let logged = self.samples.block(place.0, place.1);
            let mut numbers = self.gathered(weights, place);
            numbers.truncate(2 * n);
            self.evaluators.with(|evaluator| {
                let mut at = self.linearised(evaluator, weights, (&logged, &numbers));
                for _ in 0..steps {
                    numbers = self.likely(&logged, &at);
                    at = self.linearised(evaluator, weights, (&logged, &numbers));
                }
                let w = whitening(&at.scaled, n, self.noise.a);
                whiten(&w, &mut at.residual);
                let unlikely = unlikelihoods(&w, &at.residual);
                numbers.extend(at.shift);
                numbers.extend(w);
                (numbers, unlikely)
            })
        };
        let blocks = parallel::map(all.len().div_ceil(WIDTH), &of_block);
        for row in all.clone() {
            let place = &mut weights[self.numbers(row)];
            let numbers = &blocks[row / WIDTH].0;
            place.iter_mut().zip(numbers).for_each(|(place, number)| *place = number.0[row % WIDTH]);
        }
        all.map(|row| blocks[row / WIDTH].1.0[row % WIDTH]).collect()
    }

    /// The weights, followed by the rows as they were logged.
    fn as_logged(&self, mut weights: Vec<f64>) -> Vec<f64> {
        weights.truncate(self.parameters);
        let n = self.n();
        for row in 0..self.samples.len() {
            let own = weights.len()..weights.len() + self.numbers(0).len();
            weights.resize(own.end, 0.0);
            let (q, v) = weights[own].split_at_mut(n);
            q.copy_from_slice(&self.samples.states[0][row * n..][..n]);
            v[..n].copy_from_slice(&self.samples.states[1][row * n..][..n]);
        }
        weights
    }
}

/// −2 ln p per component of rows with these whitened residuals, under Student's distribution, up to a constant.
fn unlikelihoods(w: &[Row], whitened: &[Row]) -> Row {
    let n = whitened.len();
    let of = |lane: usize| {
        let square: f64 = whitened.iter().map(|r| r.0[lane] * r.0[lane]).sum();
        let scale: f64 = (0..n).map(|i| w[numbers_below(i) + i].0[lane].ln()).sum();
        ((FREEDOM + n as f64) * (square / FREEDOM).ln_1p() - 2.0 * scale) / n as f64
    };
    Row(std::array::from_fn(of))
}

impl Residuals for FreeStates {
    fn parameters(&self) -> usize {
        self.numbers(self.samples.len()).start
    }

    fn shared(&self) -> usize {
        self.parameters
    }

    fn samples(&self) -> usize {
        self.samples.len()
    }

    fn components(&self) -> usize {
        self.n()
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        self.evaluators.with(|evaluator| {
            sum_of_squares(self.n(), &samples, |place, residual| {
                self.evaluate(evaluator, weights, place, (residual, None))
            })
        })
    }

    fn linearise(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        add: &mut dyn FnMut(&ChunkRows),
    ) -> Result<(), Failed> {
        let shape = (self.n(), self.parameters, &self.fixed[..]);
        self.evaluators.with(|evaluator| {
            linearise_blocks(shape, &samples, (rows, add), |place, residual, derivatives| {
                self.evaluate(evaluator, weights, place, (residual, Some(derivatives)))
            })
        })
    }

    fn enter(&self, weights: Vec<f64>) -> Vec<f64> {
        let mut weights = self.as_logged(weights);
        self.solve_states(&mut weights, FIRST_STEPS);
        weights
    }

    fn settle(&self, weights: &mut [f64]) -> bool {
        self.solve_states(weights, STEPS);
        true
    }

    /// The exponential of the mean of −2 ln p per component of the logged accelerations. If C is the same in all rows
    /// and the model is correct, it is proportional to the variance of the acceleration errors, (m/s²)² or (rad/s²)².
    fn held_back_loss(&self, weights: &[f64]) -> Option<f64> {
        let mut weights = self.as_logged(weights.to_vec());
        let unlikely = self.solve_states(&mut weights, FIRST_STEPS);
        let mean = unlikely.iter().sum::<f64>() / unlikely.len() as f64;
        Some(if mean.is_finite() { mean.exp() } else { f64::INFINITY })
    }

    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn project(&self, weights: &mut [f64]) {
        self.architecture.project(&mut weights[..self.parameters]);
    }
}
