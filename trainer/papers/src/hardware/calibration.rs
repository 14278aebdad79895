//! Zero offsets of the encoders, from the first seconds of a log, for any model.

use super::log::Log;
use super::machine::Machine;
use super::predictor::Predictor;
use super::rollout::{Run, roll_out};
use super::window::{CALIBRATED, Prediction, predictions, windows};
use leastaction_learning::data::Rows;
use leastaction_learning::evaluate::median;
use leastaction_learning::training::{ChunkRows, Failed, Levenberg, Residuals};
use std::ops::Range;

/// Number of steps of the windows to which offsets are fitted: 0.5 s.
const STEPS: usize = 50;
/// Maximum numbers of Gauss–Newton iterations, before and after the scale of the residuals is known.
const ITERATIONS: [usize; 2] = [8, 12];
/// Expected size of an offset, rad.
const OFFSET: f64 = 0.05;
/// Expected difference between a start state and that of the quadratic: position, rad, and velocity, rad/s.
const START: [f64; 2] = [0.05, 1.0];
/// Smallest scale of the residuals, rad; smaller ones are below the encoder's resolution.
const FINEST: f64 = 2e-4;
/// Change of a start state for a difference quotient, in units of [`START`].
const MOVE: f64 = 1e-5;

/// Returns the offsets z, rad, of a log's encoders, q̃ = q + z, from its first 2 s alone.
///
/// z and the start states of all windows of 0.5 s in this time minimise the pseudo-Huber sum of q̂ + z − q̃ under a
/// weak prior on each. A start state is a true position, so z is simply added to the prediction from it. Without
/// motion, z is 0.
pub fn zero_offsets(machine: Machine, predictor: &dyn Predictor, log: &Log) -> Vec<f64> {
    let mut windows = windows(machine, log, STEPS);
    let last =
        |window: usize| predictions(log, &[window], &[]).iter().any(|of| of.first + STEPS > CALIBRATED);
    windows.retain(|window| !last(*window));
    let n = log.joints();
    if windows.is_empty() {
        return vec![0.0; n];
    }
    let predictions = predictions(log, &windows, &vec![0.0; n]);
    let torques = predictor.torques(log);
    let mut problem = Offsets { predictor, log, torques, predictions, scale: f64::INFINITY };
    let mut unknown = vec![0.0; Residuals::parameters(&problem)];
    for iterations in ITERATIONS {
        let scale = problem.residual_scale(&unknown);
        let prior = scale * scale / (Residuals::samples(&problem) * problem.components()) as f64;
        unknown =
            Levenberg::new(&problem, unknown).with_decay(prior).run(&problem, iterations, |_, _| ()).weights;
        problem.scale = problem.residual_scale(&unknown);
    }
    unknown[..n].iter().map(|z| OFFSET * z).collect()
}

/// Unknowns as the weights of an objective: the offsets, in units of [`OFFSET`], and then for every window the
/// difference between its start state and that of the quadratic, in units of [`START`].
struct Offsets<'p> {
    predictor: &'p dyn Predictor,
    log: &'p Log,
    torques: Rows,
    predictions: Vec<Prediction>,
    /// Scale of the residuals, rad: larger residuals count linearly.
    scale: f64,
}

impl Offsets<'_> {
    /// Number of unknowns of the start of a window.
    fn of_start(&self) -> usize {
        2 * self.log.joints()
    }

    /// Position of the first unknown of a window's start.
    fn start_of(&self, window: usize) -> usize {
        self.log.joints() + window * self.of_start()
    }

    /// Run of a window, with one of its unknowns changed if `moved` names one.
    fn run(&self, unknown: &[f64], window: usize, moved: Option<usize>) -> Run<'_> {
        let (n, of) = (self.log.joints(), &self.predictions[window]);
        let own = &unknown[self.start_of(window)..][..2 * n];
        let at = |k: usize| own[k] + if moved == Some(k) { MOVE } else { 0.0 };
        let part = |part: usize| -> Vec<f64> {
            let starts = of.start[part].iter().enumerate();
            starts.map(|(i, x)| x + START[part] * at(part * n + i)).collect()
        };
        let torques = &self.torques.as_flat()[of.first * n..(of.first + STEPS) * n];
        Run { start: [part(0), part(1)], torques }
    }

    /// Residuals q̂ + z − q̃ of a window along a path.
    fn residuals(&self, unknown: &[f64], window: usize, path: &[f64]) -> Vec<f64> {
        let n = self.log.joints();
        let logged = &self.log.q.as_flat()[self.predictions[window].first * n..];
        let offset = |i: usize| OFFSET * unknown[i % n];
        path.iter().zip(logged).enumerate().map(|(i, (q, logged))| q + offset(i) - logged).collect()
    }

    /// Robust standard deviation of the residuals, rad: 1.4826 times their median magnitude.
    fn residual_scale(&self, unknown: &[f64]) -> f64 {
        let windows = 0..self.predictions.len();
        let runs: Vec<Run> = windows.clone().map(|window| self.run(unknown, window, None)).collect();
        let paths = roll_out(&mut *self.predictor.motion(), &runs);
        let all = windows.zip(&paths).flat_map(|(window, path)| self.residuals(unknown, window, path));
        let scale = 1.4826 * median(&all.map(f64::abs).collect::<Vec<_>>());
        if scale.is_finite() { scale.max(FINEST) } else { f64::INFINITY }
    }

    /// Square root of twice the pseudo-Huber function s²(√(1 + (r/s)²) − 1), with the sign of r, and its derivative.
    fn robust(&self, r: f64) -> [f64; 2] {
        let bent = (1.0 + (r / self.scale).powi(2)).sqrt();
        // √(2/(b + 1)) = √(2(b − 1)) s/|r|, which is 1 at 0.
        let part = (2.0 / (bent + 1.0)).sqrt();
        [r * part, 1.0 / (bent * part)]
    }
}

impl Residuals for Offsets<'_> {
    fn parameters(&self) -> usize {
        self.start_of(self.predictions.len())
    }

    fn samples(&self) -> usize {
        self.predictions.len()
    }

    fn components(&self) -> usize {
        (STEPS + 1) * self.log.joints()
    }

    fn squares(&self, unknown: &[f64], windows: Range<usize>) -> Result<f64, Failed> {
        let runs: Vec<Run> = windows.clone().map(|window| self.run(unknown, window, None)).collect();
        let paths = roll_out(&mut *self.predictor.motion(), &runs);
        let of = |(window, path): (usize, &Vec<f64>)| -> f64 {
            self.residuals(unknown, window, path).into_iter().map(|r| self.robust(r)[0].powi(2)).sum()
        };
        Ok(windows.zip(&paths).map(of).sum())
    }

    fn linearise(
        &self,
        unknown: &[f64],
        windows: Range<usize>,
        rows: &mut ChunkRows,
        add: &mut dyn FnMut(&ChunkRows),
    ) -> Result<(), Failed> {
        let (count, n, of_start) = (windows.len(), self.log.joints(), self.of_start());
        rows.reset(count * self.components(), unknown.len());
        (0..unknown.len()).for_each(|k| rows.column(k, 0..count * self.components()).fill(0.0));
        let moves = || std::iter::once(None).chain((0..of_start).map(Some));
        let all = windows.clone().flat_map(|window| moves().map(move |moved| (window, moved)));
        let runs: Vec<Run> = all.map(|(window, moved)| self.run(unknown, window, moved)).collect();
        let paths = roll_out(&mut *self.predictor.motion(), &runs);
        for (k, (window, paths)) in windows.zip(paths.chunks(1 + of_start)).enumerate() {
            for (i, r) in self.residuals(unknown, window, &paths[0]).into_iter().enumerate() {
                let ([value, slope], row) = (self.robust(r), i * count + k);
                rows.residual[row] = value;
                rows.column(i % n, row..row + 1)[0] = slope * OFFSET;
                for (j, path) in paths[1..].iter().enumerate() {
                    let rate = (path[i] - paths[0][i]) / MOVE;
                    rows.column(self.start_of(window) + j, row..row + 1)[0] = slope * rate;
                }
            }
        }
        if rows.residual.iter().any(|r| !r.is_finite()) {
            return Err(Failed);
        }
        add(rows);
        Ok(())
    }
}
