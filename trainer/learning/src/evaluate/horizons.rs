//! Prediction errors along logs at several horizons, beside those of a constant velocity and the noise.
//!
//! A prediction starts in the middle of a parabola fitted to seven positions, under the forces that the model's
//! actuator produces from the logged control. It is integrated by fourth-order Runge–Kutta, with several steps per
//! sample. A model that was trained with the step of the logs is integrated with that step instead. The error at a
//! horizon is the root mean square over all samples from the start to the horizon, for each coordinate and for all
//! together. Even a perfect model errs by the noise, and by the effect of the noise on the start state.

use super::{median, percentile};
use crate::windows::{Integrator, WindowLogs};
use leastaction_core::model::ModelError;
use leastaction_models::parallel::{self, Pool};
use leastaction_models::{LaggingCommands, Model};
use leastaction_programs::steps::{State, Steps};
use leastaction_programs::{Row, WIDTH};

/// Prediction horizons, s.
pub const HORIZONS: [f64; 3] = [0.1, 0.5, 1.0];
/// Longest prediction horizon for a whole log, s.
pub const WHOLE: f64 = 30.0;

/// Samples on each side of a start that determine its state.
pub(super) const HALF: usize = 3;
/// Longest integration step, s.
const STEP: f64 = 0.0025;
/// Quantile of the errors that is reported.
const TENTH: f64 = 0.9;

/// Predicts along logs with a model.
#[derive(Clone, Copy, Debug)]
pub struct Predictor<'a> {
    /// Shape, weights, actuator and step.
    pub model: &'a Model,
    /// Zero offsets of the encoders, one list per log; missing entries count as 0.
    pub zeros: &'a [Vec<f64>],
    /// Logs: positions and commands.
    pub logs: &'a WindowLogs,
}

/// Predicted readings of encoders along a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// The log.
    pub log: usize,
    /// First sample.
    pub first: usize,
    /// (q, v) at the first sample, true positions.
    start: Vec<[f64; 2]>,
    /// \[samples\]\[n\], flat; NaN from the sample at which the prediction breaks off.
    pub path: Vec<f64>,
}

/// All predictions along logs.
#[derive(Clone, Debug, PartialEq)]
pub struct Predictions {
    /// Coordinates.
    pub n: usize,
    /// Time between samples, s.
    pub h: f64,
    /// Predictions that start throughout the logs, each up to the longest horizon or the end of the log.
    pub windows: Vec<Prediction>,
    /// Predictions over whole logs from their start, at most [`WHOLE`] long.
    pub logs: Vec<Prediction>,
}

/// Distribution of an error over many predictions, m or rad; infinite if predictions break off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The 90th percentile.
    pub percentile_90: f64,
}

/// Errors up to a horizon.
#[derive(Clone, Debug, PartialEq)]
pub struct HorizonErrors {
    /// The horizon, s; `None`: to the ends of the logs.
    pub seconds: Option<f64>,
    /// Number of predictions that reach the horizon.
    pub predictions: usize,
    /// Errors of the model: first over all coordinates together, then of each coordinate.
    pub model: Vec<Spread>,
    /// Errors of a constant velocity, in the same order.
    pub constant_velocity: Vec<Spread>,
}

impl Predictor<'_> {
    /// Predicts along all logs.
    ///
    /// # Errors
    /// [`ModelError`] if the shape is inconsistent or does not fit the weights.
    pub fn predict(&self) -> Result<Predictions, ModelError> {
        let logs = self.predict_from(self.log_starts(), WHOLE)?;
        Ok(Predictions { logs, ..self.predict_windows()? })
    }

    /// Predicts from starts throughout the logs, not over whole logs.
    ///
    /// # Errors
    /// [`ModelError`] as for [`Predictor::predict`].
    pub fn predict_windows(&self) -> Result<Predictions, ModelError> {
        let [.., longest] = HORIZONS;
        let windows = self.predict_from(self.starts(), longest)?;
        Ok(Predictions { n: self.logs.n, h: self.logs.h, windows, logs: Vec::new() })
    }

    /// Predicts from (log, sample) starts over at most `most` seconds.
    pub(super) fn predict_from(
        &self,
        starts: Vec<(usize, usize)>,
        most: f64,
    ) -> Result<Vec<Prediction>, ModelError> {
        let h = self.logs.h;
        let system = self.model.system()?;
        let step = self.model.facts.trained_step;
        let (integrator, order, parts) = Integrator::of_trained(step, &system, (h, STEP));
        let pool = Pool::new(move || integrator.steps(&system, (h / parts, order), Vec::new()));
        let most = (most / h).round() as usize;
        let lagging = self.lagging();
        let blocks: Vec<&[(usize, usize)]> = starts.chunks(WIDTH).collect();
        let rolled = parallel::map(blocks.len(), &|k| {
            pool.with(|stepper| self.roll(&mut **stepper, (blocks[k], &lagging, most), parts as usize))
        });
        Ok(rolled.into_iter().flatten().collect())
    }

    fn zero(&self, log: usize, i: usize) -> f64 {
        self.zeros.get(log).and_then(|zeros| zeros.get(i)).copied().unwrap_or(0.0)
    }

    /// (q, v) of the parabola through the samples around `middle`, with the encoder's zero offset subtracted from q.
    fn start(&self, log: usize, middle: usize, i: usize) -> [f64; 2] {
        const SHARES: [f64; 2 * HALF + 1] = [-2.0, 3.0, 6.0, 7.0, 6.0, 3.0, -2.0];
        let q = |k: usize| self.logs.position(log, middle + k - HALF, i);
        let value: f64 = SHARES.iter().enumerate().map(|(k, share)| share / 21.0 * q(k)).sum();
        let slope: f64 = (0..SHARES.len()).map(|k| (k as f64 - HALF as f64) / 28.0 * q(k)).sum();
        [value - self.zero(log, i), slope / self.logs.h]
    }

    /// Lagging commands along every log.
    fn lagging(&self) -> Vec<LaggingCommands> {
        let step = (self.logs.h, self.logs.control);
        let along = |log: usize| {
            let sizes = (self.logs.samples(log), self.logs.n);
            self.model.facts.actuator.lagging(step, sizes, |k, i| self.logs.command(log, k, i))
        };
        (0..self.logs.count()).map(along).collect()
    }

    /// Force τ_i at both ends of the step that begins at `sample`.
    fn force(&self, lagging: &[LaggingCommands], (log, sample): (usize, usize), i: usize) -> [f64; 2] {
        let step = (self.logs.h, self.logs.control);
        let command = |k| self.logs.command(log, k, i);
        self.model.facts.actuator.over_step(step, (sample, i), &lagging[log], command)
    }

    /// The force that is not exceeded at nine of ten samples, N or N m.
    pub fn largest_force(&self, i: usize) -> f64 {
        let lagging = self.lagging();
        let sample = |start: (usize, usize)| self.force(&lagging, start, i)[0].abs();
        Spread::of(self.starts().into_iter().map(sample).collect()).percentile_90
    }

    /// Range of coordinate i over all logs, m or rad.
    pub fn range(&self, i: usize) -> f64 {
        let logs = self.logs;
        let all =
            (0..logs.count()).flat_map(|log| (0..logs.samples(log)).map(move |k| logs.position(log, k, i)));
        let (least, most) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), q| (a.min(q), b.max(q)));
        most - least
    }

    /// Computes predictions side by side over at most `most` samples, with `parts` steps per sample.
    fn roll(
        &self,
        stepper: &mut dyn Steps,
        (starts, lagging, most): (&[(usize, usize)], &[LaggingCommands], usize),
        parts: usize,
    ) -> Vec<Prediction> {
        let n = self.logs.n;
        let steps = |(log, first): (usize, usize)| (self.logs.samples(log) - 1 - first).min(most);
        let longest = starts.iter().copied().map(steps).max().unwrap_or(0);
        let row = |of: &dyn Fn(usize, usize) -> f64| {
            Row(std::array::from_fn(|lane| {
                let (log, first) = starts[lane.min(starts.len() - 1)];
                of(log, first)
            }))
        };
        let part = |part: usize| (0..n).map(move |i| (i, part));
        let mut state: State = part(0)
            .chain(part(1))
            .map(|(i, part)| row(&|log, first| self.start(log, first, i)[part]))
            .collect();
        let prediction = |(log, first): (usize, usize)| Prediction {
            log,
            first,
            start: (0..n).map(|i| self.start(log, first, i)).collect(),
            path: Vec::new(),
        };
        let mut predictions: Vec<Prediction> = starts.iter().copied().map(prediction).collect();
        stepper.begin(&self.model.weights, &mut state, None);
        for step in 0..=longest {
            for (lane, own) in
                predictions.iter_mut().enumerate().filter(|(lane, _)| step <= steps(starts[*lane]))
            {
                own.path.extend((0..n).map(|i| state[i].0[lane] + self.zero(own.log, i)));
            }
            let tau = |end: usize| -> Vec<Row> {
                (0..n).map(|i| row(&|log, first| self.force(lagging, (log, first + step), i)[end])).collect()
            };
            let [start, end] = [tau(0), tau(1)];
            for k in 0..parts {
                let [from, to] = [k, k + 1].map(|k| between(&start, &end, k as f64 / parts as f64));
                // A lane that failed is NaN from here on.
                let _failures = stepper.step(&self.model.weights, &mut state, [&from, &to], None);
            }
        }
        predictions
    }
}

fn between(start: &[Row], end: &[Row], part: f64) -> Vec<Row> {
    start.iter().zip(end).map(|(start, end)| start.towards(end, part)).collect()
}

impl Prediction {
    /// (q, v) of every coordinate at the start: true positions, without encoder zeros.
    pub fn start(&self) -> &[[f64; 2]] {
        &self.start
    }

    /// Number of steps.
    pub fn steps(&self, n: usize) -> usize {
        (self.path.len() / n.max(1)).saturating_sub(1)
    }

    /// Reading predicted by a constant velocity k samples after the start.
    pub fn straight(&self, k: usize, i: usize, h: f64) -> f64 {
        // The first predicted reading includes the zero of the encoder.
        let zero = self.path[i] - self.start[i][0];
        self.start[i][0] + zero + k as f64 * h * self.start[i][1]
    }
}

impl Predictions {
    /// Errors at every horizon that fits into a log, and over whole logs.
    pub fn errors(&self, logs: &WindowLogs) -> Vec<HorizonErrors> {
        let mut all = Vec::new();
        for seconds in HORIZONS {
            let steps = (seconds / self.h).round() as usize;
            let far: Vec<_> =
                self.windows.iter().filter(|own| steps > 0 && own.steps(self.n) >= steps).collect();
            all.extend(self.errors_to(logs, (Some(seconds), &far), |_| steps));
        }
        let whole: Vec<_> = self.logs.iter().collect();
        all.extend(self.errors_to(logs, (None, &whole), |own| own.steps(self.n)));
        all
    }

    fn errors_to(
        &self,
        logs: &WindowLogs,
        (seconds, predictions): (Option<f64>, &[&Prediction]),
        steps: impl Fn(&Prediction) -> usize,
    ) -> Option<HorizonErrors> {
        let spreads = |of: &dyn Fn(&Prediction, usize, usize) -> f64| -> Vec<Spread> {
            let squares: Vec<Vec<f64>> =
                predictions.iter().map(|own| self.mean_squares(logs, own, steps(own), of)).collect();
            let column = |c: usize| squares.iter().map(|row| row[c].sqrt()).collect::<Vec<f64>>();
            (0..=self.n).map(|c| Spread::of(column(c))).collect()
        };
        (!predictions.is_empty()).then(|| HorizonErrors {
            seconds,
            predictions: predictions.len(),
            model: spreads(&|own, k, i| own.path[k * self.n + i]),
            constant_velocity: spreads(&|own, k, i| own.straight(k, i, self.h)),
        })
    }

    /// Mean squared errors: first over all coordinates together, then of each coordinate; infinite if the prediction
    /// breaks off.
    fn mean_squares(
        &self,
        logs: &WindowLogs,
        own: &Prediction,
        steps: usize,
        of: &dyn Fn(&Prediction, usize, usize) -> f64,
    ) -> Vec<f64> {
        let square = |k: usize, i: usize| (of(own, k, i) - logs.position(own.log, own.first + k, i)).powi(2);
        let mean = |i: usize| (0..=steps).map(|k| square(k, i)).sum::<f64>() / (steps + 1) as f64;
        let each: Vec<f64> = (0..self.n).map(mean).collect();
        let together = each.iter().sum::<f64>() / self.n as f64;
        std::iter::once(together).chain(each).map(|x| if x.is_finite() { x } else { f64::INFINITY }).collect()
    }

    /// Growth of the error: the median over predictions of the error over all coordinates, k samples after the start,
    /// up to the longest horizon. Each entry has the error of the model and that of a constant velocity.
    pub fn growth(&self, logs: &WindowLogs) -> Vec<[f64; 2]> {
        let longest = self.windows.iter().map(|own| own.steps(self.n)).max().unwrap_or(0);
        let at = |k: usize| {
            let far: Vec<&Prediction> = self.windows.iter().filter(|own| own.steps(self.n) >= k).collect();
            let error = |of: &dyn Fn(&Prediction, usize) -> f64| {
                let own = |own: &&Prediction| {
                    let square = |i: usize| (of(own, i) - logs.position(own.log, own.first + k, i)).powi(2);
                    ((0..self.n).map(square).sum::<f64>() / self.n as f64).sqrt()
                };
                median(&far.iter().map(own).collect::<Vec<_>>())
            };
            [error(&|own, i| own.path[k * self.n + i]), error(&|own, i| own.straight(k, i, self.h))]
        };
        (0..=longest).map(at).collect()
    }

    /// The largest speed of coordinate i at a start, m/s or rad/s.
    pub fn fastest(&self, i: usize) -> f64 {
        let speeds = self.windows.iter().chain(&self.logs).map(|own| own.start[i][1].abs());
        speeds.fold(0.0, f64::max)
    }

    /// The window whose error is at the quantile `part` of all errors.
    pub fn window_at(&self, logs: &WindowLogs, part: f64) -> Option<&Prediction> {
        let error = |own: &Prediction| {
            self.mean_squares(logs, own, own.steps(self.n), &|own, k, i| own.path[k * self.n + i])[0]
        };
        let mut order: Vec<(f64, &Prediction)> = self.windows.iter().map(|own| (error(own), own)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = (part * order.len().saturating_sub(1) as f64).round() as usize;
        order.get(at).map(|(_, own)| *own)
    }
}

impl Spread {
    fn of(values: Vec<f64>) -> Self {
        Self { median: median(&values), percentile_90: percentile(&values, TENTH) }
    }
}
