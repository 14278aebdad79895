mod fitted;
mod states;
mod zeros;

use super::calibration::{CalibrationLayout, Prior};
use super::logs::{TooShort, Window, WindowLogs};
use super::model::{Integrator, Projection, WindowModel, WindowSettings};
use super::pace::Pace;
use super::rollout::{In, Lanes, Learned, pseudo_huber};
use super::scales::Amounts;
use super::starts;
use crate::training::{Bounds, ChunkRows, Failed, NormalEquations, Residuals};
use leastaction_models::parallel::{self, Pool};
use leastaction_programs::steps::Steps;
use leastaction_programs::{Row, WIDTH};
use std::ops::Range;
use std::sync::Arc;

/// Least value of the relative decrease of the loss below which iterations stop.
const LEAST_TOLERANCE: f64 = 1e-6;
/// Largest value of that relative decrease.
const MOST_TOLERANCE: f64 = 1e-4;

/// The loss over windows ([`windows`](super)). Its parameters are the weight block, the calibration numbers, s of every
/// coordinate, and the start states (q, v) of all windows. All windows share the first two.
pub struct WindowLoss {
    logs: Arc<WindowLogs>,
    windows: Vec<Window>,
    steps: usize,
    pace: Pace,
    learned: Learned,
    layout: CalibrationLayout,
    /// Positions of the shared numbers that are held fixed.
    fixed: Vec<usize>,
    priors: Vec<Prior>,
    /// Sensor noise of every coordinate.
    noise: Vec<f64>,
    /// Size of the windows' motion in every coordinate.
    motion: Vec<f64>,
    steppers: Pool<Box<dyn Steps>>,
    bounds: Bounds,
    project: Projection,
    /// Relative decrease of the loss below which iterations stop, at least.
    tolerance: f64,
}

impl WindowLoss {
    /// The loss over some of these logs.
    ///
    /// # Errors
    /// [`TooShort`] if none of them is as long as a window.
    pub fn new(
        model: WindowModel,
        logs: &Arc<WindowLogs>,
        of: Range<usize>,
        settings: WindowSettings,
    ) -> Result<Self, TooShort> {
        let WindowModel { system, mut fixed, bounds, project } = model;
        let WindowSettings { steps, stride, integrator, longest_step, order, calibration } = settings;
        let (n, h, start) = (logs.n, logs.h, system.parameters());
        let layout = CalibrationLayout::new(start, logs, calibration);
        fixed.extend(layout.fixed(|log| of.contains(&log)));
        let noise: Vec<f64> = (0..n).map(|i| logs.noise(of.clone(), i)).collect();
        let pace = match integrator {
            Integrator::RungeKutta => Pace::new(logs, of.clone(), longest_step, &noise),
            Integrator::Del => Pace::of_samples(),
        };
        let steps = pace.whole(steps);
        let mut windows = logs.windows(of.clone(), (steps, stride.max(1)))?;
        let is_learned = |position: &usize| !fixed.contains(position);
        let learned = Learned {
            weights: (0..start).filter(is_learned).collect(),
            controls: (0..layout.controls()).filter(|number| is_learned(&(start + number))).collect(),
        };
        let (own, step) = (learned.weights.clone(), h / pace.steps_in_sample());
        let make = move || integrator.steps(&system, (step, order), own.clone());
        let motion: Vec<f64> = (0..n).map(|i| logs.motion(&windows, steps, i)).collect();
        // A mechanism at rest is held by stiction, which smooth friction does not model, so windows at rest are left
        // out.
        let moves = |window: &Window| logs.moves(*window, steps, &motion);
        if windows.iter().any(moves) {
            windows.retain(moves);
        }
        Ok(Self {
            logs: logs.clone(),
            windows,
            steps,
            pace,
            learned,
            layout,
            fixed,
            priors: layout.priors(logs, of),
            noise,
            motion,
            steppers: Pool::new(make),
            bounds,
            project,
            tolerance: 0.0,
        })
    }

    /// Layout of the calibration numbers.
    pub fn layout(&self) -> CalibrationLayout {
        self.layout
    }

    fn n(&self) -> usize {
        self.logs.n
    }

    fn scales<'w>(&self, weights: &'w [f64]) -> &'w [f64] {
        &weights[self.layout.end()..self.layout.end() + self.n()]
    }

    /// Positions of a window's start state.
    fn start(&self, window: usize) -> Range<usize> {
        let (first, size) = (self.layout.end() + self.n(), 2 * self.n());
        first + size * window..first + size * (window + 1)
    }

    /// Windows side by side from `first` on, padded with the last.
    fn lanes<'a>(&'a self, weights: &'a [f64], first: usize) -> Lanes<'a> {
        let last = self.windows.len() - 1;
        Lanes {
            logs: &self.logs,
            windows: std::array::from_fn(|lane| self.windows[(first + lane).min(last)]),
            steps: self.steps,
            pace: self.pace,
            learned: &self.learned,
            layout: &self.layout,
            numbers: &weights[..self.layout.end()],
            scales: self.scales(weights),
        }
    }

    /// Results of `work` for all blocks of windows that are evaluated side by side, in order.
    fn of_blocks<T: Send>(&self, work: impl Fn(usize, usize, &mut dyn Steps) -> T + Sync) -> Vec<T> {
        parallel::map(self.windows.len().div_ceil(WIDTH), &|block| {
            let first = block * WIDTH;
            let count = (self.windows.len() - first).min(WIDTH);
            self.steppers.with(|stepper| work(first, count, &mut **stepper))
        })
    }

    /// Sets the scale s of every coordinate from the residuals.
    fn set_scales(&self, weights: &mut [f64]) {
        let n = self.n();
        let parts = self.of_blocks(|first, count, stepper| {
            let (residuals, _) = self.lanes(weights, first).residuals(stepper, &self.starts(weights, first));
            let mut amounts = vec![Amounts::new(); n];
            for rows in residuals.chunks_exact(n) {
                let each = amounts.iter_mut().zip(rows);
                each.for_each(|(amounts, row)| row.0[..count].iter().for_each(|x| amounts.add(*x)));
            }
            amounts
        });
        let mut all = vec![Amounts::new(); n];
        for part in &parts {
            all.iter_mut().zip(part).for_each(|(all, part)| all.merge(part));
        }
        let first = self.layout.end();
        for (i, amounts) in all.iter().enumerate() {
            let own = amounts.scale() * weights[first + i];
            weights[first + i] = own.max(self.noise[i]).max(f64::EPSILON * self.motion[i]);
        }
    }

    /// Mean square that corresponds to a unit of the loss, (m, rad)²: the geometric mean over coordinates.
    fn unit(&self, weights: &[f64]) -> f64 {
        let logarithms: f64 = self.scales(weights).iter().map(|s| s.ln()).sum();
        (2.0 * logarithms / self.n() as f64).exp()
    }

    /// Penalty Σ weight (w − centre)².
    fn penalty(&self, weights: &[f64]) -> f64 {
        self.priors.iter().map(|prior| prior.weight * (weights[prior.position] - prior.centre).powi(2)).sum()
    }
}

impl Residuals for WindowLoss {
    fn parameters(&self) -> usize {
        self.start(self.windows.len()).start
    }

    fn shared(&self) -> usize {
        self.layout.end()
    }

    fn weights(&self) -> usize {
        self.layout.start
    }

    fn samples(&self) -> usize {
        self.windows.len()
    }

    fn components(&self) -> usize {
        (self.steps + 1) * self.n()
    }

    fn chunk(&self) -> usize {
        WIDTH
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        let mut sum = 0.0;
        for first in samples.clone().step_by(WIDTH) {
            let lanes = self.lanes(weights, first);
            let starts = self.starts(weights, first);
            let (residuals, _) = self.steppers.with(|stepper| lanes.residuals(&mut **stepper, &starts));
            let count = (samples.end - first).min(WIDTH);
            sum += residuals.iter().flat_map(|row| &row.0[..count]).map(|x| pseudo_huber(*x)).sum::<f64>();
        }
        let penalty = if samples.start == 0 { self.penalty(weights) } else { 0.0 };
        Ok((sum + penalty) * self.unit(weights))
    }

    /// Sum over the windows that reach their ends, and the number of windows that do not.
    fn solved(&self, weights: &[f64], samples: Range<usize>) -> (f64, usize) {
        let (mut sum, mut unsolved) = (0.0, 0);
        for first in samples.clone().step_by(WIDTH) {
            let (lanes, starts) = (self.lanes(weights, first), self.starts(weights, first));
            let (residuals, failures) =
                self.steppers.with(|stepper| lanes.residuals(&mut **stepper, &starts));
            for lane in 0..(samples.end - first).min(WIDTH) {
                if failures.0[lane] {
                    unsolved += 1;
                } else {
                    sum += residuals.iter().map(|row| pseudo_huber(row.0[lane])).sum::<f64>();
                }
            }
        }
        (sum * self.unit(weights), unsolved)
    }

    fn linearise(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        add: &mut dyn FnMut(&ChunkRows),
    ) -> Result<(), Failed> {
        let (n, count) = (self.n(), samples.len());
        let lanes = self.lanes(weights, samples.start);
        let starts = self.starts(weights, samples.start);
        let (mut own, _) = self.steppers.with(|stepper| lanes.rows(&mut **stepper, &starts, In::All));
        own.eliminate(2 * n);
        let unit = self.unit(weights).sqrt();
        let scaled = |row: &Row| Row(row.0.map(|x| unit * x));
        let before = self.learned.positions(&self.layout);
        let zeros = self.zeros_of(&lanes.windows[..count]);
        rows.reset_to(
            count * self.components(),
            before.iter().copied().chain(zeros.iter().map(|zero| zero.position)),
        );
        let all = 0..count * self.components();
        (before.len()..before.len() + zeros.len())
            .for_each(|column| rows.column(column, all.clone()).fill(0.0));
        for (component, residual) in own.residual.iter().enumerate() {
            let place = component * count..(component + 1) * count;
            let derivatives = own.row(component);
            rows.residual[place.clone()].copy_from_slice(&scaled(residual).0[..count]);
            for (column, row) in derivatives[..before.len()].iter().enumerate() {
                rows.column(column, place.clone()).copy_from_slice(&scaled(row).0[..count]);
            }
            for (column, zero) in zeros.iter().enumerate() {
                let row = scaled(&derivatives[before.len() + zero.coordinate]);
                let own = place.start + zero.windows.start..place.start + zero.windows.end;
                rows.column(before.len() + column, own).copy_from_slice(&row.0[zero.windows.clone()]);
            }
        }
        add(rows);
        Ok(())
    }

    fn add_penalty(&self, weights: &[f64], sum: &mut NormalEquations) {
        let unit = self.unit(weights);
        for Prior { position, centre, weight } in self.priors.iter().copied() {
            if !self.fixed.contains(&position) {
                sum.add_penalty(position, unit * weight, weights[position] - centre);
            }
        }
    }

    fn enter(&self, weights: Vec<f64>) -> Vec<f64> {
        self.with_best_starts(self.with_guessed_starts(weights))
    }

    fn settle(&self, weights: &mut [f64]) -> bool {
        self.set_scales(weights);
        true
    }

    fn completed_loss(&self, weights: &mut [f64]) -> f64 {
        let stepped = self.of_blocks(|first, count, stepper| {
            let starts = self.starts(weights, first);
            let (starts, sums) = starts::stepped(&self.lanes(weights, first), stepper, &starts);
            (starts, sums.0[..count].iter().sum::<f64>())
        });
        self.set_starts(weights, stepped.iter().map(|(starts, _)| starts));
        let sum = stepped.iter().map(|(_, sum)| sum).sum::<f64>() + self.penalty(weights);
        let loss = sum * self.unit(weights) / (self.windows.len() * self.components()) as f64;
        if loss.is_finite() { loss } else { f64::INFINITY }
    }

    /// The geometric mean over windows of [`WindowLoss::held_back_errors`].
    fn held_back_loss(&self, weights: &[f64]) -> Option<f64> {
        let logarithms: f64 = self.held_back_errors(weights).iter().map(|(_, logarithm)| logarithm).sum();
        Some((logarithms / self.windows.len() as f64).exp())
    }

    fn is_of_many_units(&self) -> bool {
        true
    }

    /// Smaller decreases do not matter: if a learned number is off by one standard error, the loss rises by about one
    /// residual's share.
    fn tolerance(&self) -> f64 {
        let own = 0.03 / (self.windows.len() * self.components()) as f64;
        own.clamp(LEAST_TOLERANCE, MOST_TOLERANCE).max(self.tolerance)
    }

    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn project(&self, weights: &mut [f64]) {
        (self.project)(&mut weights[..self.layout.start]);
        self.layout.project(weights);
    }
}
