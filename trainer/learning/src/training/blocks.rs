//! Sum of a loss over samples that are evaluated side by side.

use super::residuals::{ChunkRows, Failed, Residuals};
use super::{Bounds, NormalEquations, Samples};
use leastaction_models::parallel::Pool;
use leastaction_programs::losses::{Block, Derivatives, Loss};
use leastaction_programs::{Row, WIDTH};
use std::ops::Range;

/// Moves weights that have a range back into it.
type Projection = Box<dyn Fn(&mut [f64]) + Sync>;

/// Losses with their workspaces; each thread takes one.
type Losses = Pool<Box<dyn Loss>>;

/// Σ r² of a loss over samples.
pub(super) struct Blocks {
    losses: Losses,
    parameters: usize,
    components: usize,
    /// Positions of the weights whose derivatives are 0.
    fixed: Vec<usize>,
    samples: Samples,
    project: Projection,
    bounds: Bounds,
}

/// Residuals and derivatives of a block of samples.
struct Rows {
    residual: Vec<Row>,
    derivatives: Vec<Vec<Row>>,
}

impl Rows {
    fn new(components: usize, rows: usize, parameters: usize) -> Self {
        let zero = Row::default();
        Self { residual: vec![zero; components], derivatives: vec![vec![zero; parameters]; rows] }
    }
}

/// Σ r² of the first `count` samples, added sample by sample.
fn squares(residual: &[Row], count: usize) -> f64 {
    (0..count).flat_map(|k| residual.iter().map(move |r| r.0[k] * r.0[k])).sum()
}

/// Place of a block: its first sample, and the range of samples. The last sample of the range pads an incomplete block.
pub(super) type Place<'s> = (usize, &'s Range<usize>);

/// Σ r² of samples, block by block; `evaluate` writes the residuals of a block.
pub(super) fn sum_of_squares(
    components: usize,
    samples: &Range<usize>,
    mut evaluate: impl FnMut(Place, &mut [Row]) -> Result<(), Failed>,
) -> Result<f64, Failed> {
    let (mut residual, mut sum) = (vec![Row::default(); components], 0.0);
    for start in samples.clone().step_by(WIDTH) {
        evaluate((start, samples), &mut residual)?;
        sum += squares(&residual, (samples.end - start).min(WIDTH));
    }
    Ok(sum)
}

/// Writes residuals of samples and their derivatives, block by block, and passes them on; those with respect to `fixed` weights are zero.
/// `evaluate` writes the residuals of a block and adds its derivatives to rows of zeros.
pub(super) fn linearise_blocks(
    (components, parameters, fixed): (usize, usize, &[usize]),
    samples: &Range<usize>,
    (rows, add): (&mut ChunkRows, &mut dyn FnMut(&ChunkRows)),
    mut evaluate: impl FnMut(Place, &mut [Row], &mut [Vec<Row>]) -> Result<(), Failed>,
) -> Result<(), Failed> {
    let count = samples.len();
    rows.reset(count * components, parameters);
    let mut own = Rows::new(components, components, parameters);
    for start in (0..count).step_by(WIDTH) {
        own.derivatives.iter_mut().for_each(|row| row.fill(Row::default()));
        evaluate((samples.start + start, samples), &mut own.residual, &mut own.derivatives)?;
        for (i, (residual, derivatives)) in own.residual.iter().zip(&mut own.derivatives).enumerate() {
            fixed.iter().for_each(|position| derivatives[*position] = Row::default());
            let first = i * count + start;
            rows.store_rows(first..first + (count - start).min(WIDTH), residual, derivatives);
        }
    }
    add(rows);
    Ok(())
}

impl Blocks {
    /// The sum over these samples; `fixed` are the positions of known weights.
    pub fn new(
        make: impl Fn() -> Box<dyn Loss> + Send + Sync + 'static,
        (parameters, fixed): (usize, Vec<usize>),
        samples: Samples,
        project: Projection,
    ) -> Self {
        let components = make().components();
        let bounds = Bounds::default();
        Self { losses: Pool::new(make), parameters, components, fixed, samples, project, bounds }
    }

    /// Adds ranges of weights.
    pub fn with_bounds(self, bounds: Bounds) -> Self {
        Self { bounds, ..self }
    }

    /// Whether the weight at this position is not held.
    pub fn is_learned(&self, position: usize) -> bool {
        !self.fixed.contains(&position)
    }

    /// Evaluates the block from `start` on, padded with the last of `samples`. The residual of a sample that cannot be
    /// computed is that of a prediction by a constant velocity, whatever the weights.
    fn evaluate(
        &self,
        loss: &mut dyn Loss,
        weights: &[f64],
        (start, samples): Place,
        (residual, derivatives): (&mut [Row], Derivatives),
    ) -> Result<(), Failed> {
        let block = self.samples.block(start, samples);
        let failures = loss.evaluate(weights, &block, residual, derivatives);
        let count = (samples.end - start).min(WIDTH);
        if failures.any(count) {
            let straight = loss.of_constant_velocity(&block).ok_or(Failed)?;
            for sample in (0..count).filter(|sample| failures.0[*sample]) {
                residual.iter_mut().zip(&straight).for_each(|(r, own)| r.0[sample] = own.0[sample]);
            }
        }
        let finite = residual.iter().all(|r| r.0[..count].iter().all(|r| r.is_finite()));
        if finite { Ok(()) } else { Err(Failed) }
    }
}

impl Residuals for Blocks {
    fn parameters(&self) -> usize {
        self.parameters
    }

    fn samples(&self) -> usize {
        self.samples.len()
    }

    fn components(&self) -> usize {
        self.components
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        self.losses.with(|loss| {
            sum_of_squares(self.components, &samples, |place, residual| {
                self.evaluate(loss.as_mut(), weights, place, (residual, Derivatives::None))
            })
        })
    }

    fn solved(&self, weights: &[f64], samples: Range<usize>) -> (f64, usize) {
        let mut residual = vec![Row::default(); self.components];
        self.losses.with(|loss| {
            let (mut sum, mut unsolved) = (0.0, 0);
            for start in samples.clone().step_by(WIDTH) {
                let block = self.samples.block(start, &samples);
                let failures = loss.evaluate(weights, &block, &mut residual, Derivatives::None);
                for k in 0..(samples.end - start).min(WIDTH) {
                    let own = residual.iter().map(|r| r.0[k] * r.0[k]).sum::<f64>();
                    let is_solved = !failures.0[k] && own.is_finite();
                    sum += if is_solved { own } else { 0.0 };
                    unsolved += usize::from(!is_solved);
                }
            }
            (sum, unsolved)
        })
    }

    fn squares_of_constant_velocity(&self, samples: Range<usize>) -> Option<f64> {
        self.losses.with(|loss| {
            let of = |start: usize| {
                let straight = loss.of_constant_velocity(&self.samples.block(start, &samples))?;
                Some(squares(&straight, (samples.end - start).min(WIDTH)))
            };
            samples.clone().step_by(WIDTH).map(of).sum()
        })
    }

    fn linearise(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        add: &mut dyn FnMut(&ChunkRows),
    ) -> Result<(), Failed> {
        let shape = (self.components, weights.len(), &self.fixed[..]);
        self.losses.with(|loss| {
            linearise_blocks(shape, &samples, (rows, add), |place, residual, derivatives| {
                self.evaluate(loss.as_mut(), weights, place, (residual, Derivatives::Jacobian(derivatives)))
            })
        })
    }

    fn add_gradient(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        _: &mut ChunkRows,
        sum: &mut NormalEquations,
    ) -> Result<(), Failed> {
        let mut own = Rows::new(self.components, 1, weights.len());
        self.losses.with(|loss| {
            for start in samples.clone().step_by(WIDTH) {
                let count = (samples.end - start).min(WIDTH);
                let [row] = &mut own.derivatives[..] else { return Err(Failed) };
                if count < WIDTH {
                    // Padding lanes must not be added: a padded block is summed separately, over its own lanes only.
                    sum.add_row(row, WIDTH);
                    row.fill(Row::default());
                }
                let into = (&mut own.residual[..], Derivatives::Gradient(row));
                self.evaluate(loss.as_mut(), weights, (start, &samples), into)?;
                sum.squares += squares(&own.residual, count);
                if count < WIDTH {
                    sum.add_row(row, count);
                    row.fill(Row::default());
                }
            }
            let [row] = &own.derivatives[..] else { return Err(Failed) };
            sum.add_row(row, WIDTH);
            self.fixed.iter().for_each(|position| sum.gradient[*position] = 0.0);
            sum.rows += samples.len() * self.components;
            Ok(())
        })
    }

    /// Numbers after the weight block belong to other losses.
    fn enter(&self, mut weights: Vec<f64>) -> Vec<f64> {
        weights.truncate(self.parameters);
        weights
    }

    fn project(&self, weights: &mut [f64]) {
        (self.project)(weights);
    }

    fn bounds(&self) -> &Bounds {
        &self.bounds
    }
}

impl Samples {
    /// A block of samples side by side from `start` on, padded with the last of `samples`.
    pub(super) fn block(&self, start: usize, samples: &Range<usize>) -> Block {
        let rows = |x: &Vec<f64>| -> Vec<Row> {
            let at = |k: usize, i: usize| x[(start + k).min(samples.end - 1) * self.n + i];
            (0..if x.is_empty() { 0 } else { self.n })
                .map(|i| Row(std::array::from_fn(|k| at(k, i))))
                .collect()
        };
        Block {
            states: self.states.each_ref().map(rows),
            next_velocity: rows(&self.next_velocities),
            controls: self.controls.each_ref().map(rows),
            control: self.control,
        }
    }
}
