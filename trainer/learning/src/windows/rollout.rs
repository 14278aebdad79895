//! Rollout of windows side by side, from their start states to their ends.

use super::calibration::CalibrationLayout;
use super::control::{Acting, part_of};
use super::elimination::Rows;
use super::logs::{Window, WindowLogs};
use super::pace::{Pace, cubic};
use leastaction_programs::dynamics::Failures;
use leastaction_programs::steps::{State, Steps, Tangents, combine_positions};
use leastaction_programs::{Row, WIDTH};

/// κ of the pseudo-Huber function, in robust standard deviations: the contribution of larger residuals grows more
/// slowly than their square.
const KNEE: f64 = 2.0;

/// Windows side by side, with the numbers on which their motion depends.
pub(super) struct Lanes<'a> {
    pub logs: &'a WindowLogs,
    pub windows: [Window; WIDTH],
    /// Steps of each window.
    pub steps: usize,
    pub pace: Pace,
    /// Positions of learned numbers among the weights and among the numbers on which the control depends.
    pub learned: &'a Learned,
    pub layout: &'a CalibrationLayout,
    /// The weight block of the model, then the calibration numbers.
    pub numbers: &'a [f64],
    /// Scale s of every coordinate.
    pub scales: &'a [f64],
}

/// Numbers with respect to which residuals are differentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum In {
    /// Start states alone.
    Starts,
    /// The weight block, g, o, d and T, z of a window's own log, and start states.
    All,
}

/// The pseudo-Huber function ρ(x).
pub(super) fn pseudo_huber(x: f64) -> f64 {
    let square = x * x;
    2.0 * square / ((1.0 + square / (KNEE * KNEE)).sqrt() + 1.0)
}

/// √(ρ′(x)/2x), the factor of least-squares rows with which the rows give the gradient of ρ.
fn share(x: f64) -> f64 {
    (1.0 + x * x / (KNEE * KNEE)).sqrt().sqrt().recip()
}

/// Positions of learned numbers among those that windows share.
#[derive(Clone, Debug, Default)]
pub(super) struct Learned {
    /// Positions in the weight block.
    pub weights: Vec<usize>,
    /// Positions after the weight block, among the numbers on which the control depends.
    pub controls: Vec<usize>,
}

impl Learned {
    /// All positions, in the order of their columns.
    pub fn positions(&self, layout: &CalibrationLayout) -> Vec<usize> {
        let controls = self.controls.iter().map(|number| layout.start + number);
        self.weights.iter().copied().chain(controls).collect()
    }
}

/// ρ′(x)/2x, the weight of a row's square in the Gauss–Newton matrix, and ρ″(x)/2, its weight in the Hessian of the
/// loss.
pub(super) fn curvatures(x: f64) -> [f64; 2] {
    let root = (1.0 + x * x / (KNEE * KNEE)).sqrt();
    [root.recip(), root.powi(3).recip()]
}

/// States within a step, with their tangents.
struct Between {
    start: (State, Option<Tangents>),
    own: (State, Option<Tangents>),
}

impl Between {
    fn new(state: &State, tangents: Option<&Tangents>) -> Self {
        let both = (state.clone(), tangents.cloned());
        Self { start: both.clone(), own: both }
    }

    /// Begins a step that covers `samples` samples.
    fn begin(&mut self, state: &State, tangents: Option<&Tangents>, samples: usize) {
        if samples > 1 {
            self.start.0.clone_from(state);
            if let (Some(own), Some(of)) = (&mut self.start.1, tangents) {
                own.clone_from(of);
            }
        }
    }

    /// The positions from the cubic, given the weights of its start and end.
    fn at(
        &mut self,
        [start, end]: [[f64; 2]; 2],
        state: &State,
        tangents: Option<&Tangents>,
    ) -> (&State, Option<&Tangents>) {
        let n = state.len() / 2;
        combine_positions(&mut self.own.0[..n], [(&self.start.0, start), (state, end)]);
        if let (Some(own), Some(first), Some(last)) = (&mut self.own.1, &self.start.1, tangents) {
            own.combine_positions([(first, start), (last, end)]);
        }
        (&self.own.0, self.own.1.as_ref())
    }
}

impl Lanes<'_> {
    fn n(&self) -> usize {
        self.logs.n
    }

    fn of_windows(&self, number: impl Fn(&Window) -> f64) -> Row {
        Row(std::array::from_fn(|lane| number(&self.windows[lane])))
    }

    /// Scaled residual (q̂_i + z_i − q̃_i)/s_i at a sample.
    fn residual(&self, state: &State, sample: usize, i: usize) -> Row {
        let of = |window: &Window| {
            let zero = self.numbers[self.layout.zero(window.log, i)];
            zero - self.logs.position(window.log, window.first + sample, i)
        };
        let (measured, scale) = (self.of_windows(of), self.scales[i]);
        Row(std::array::from_fn(|lane| (state[i].0[lane] + measured.0[lane]) / scale))
    }

    /// Calls `visit` with the state at every sample; at samples within a step only the positions are valid.
    fn roll(
        &self,
        stepper: &mut dyn Steps,
        starts: &State,
        mut tangents: Option<Tangents>,
        mut visit: impl FnMut(usize, &State, Option<&Tangents>),
    ) -> Failures {
        let (mut state, mut failures) = (starts.clone(), Failures::default());
        stepper.begin(self.numbers, &mut state, tangents.as_mut());
        let mut between = Between::new(starts, tangents.as_ref());
        let moves = tangents.as_ref().is_some_and(|tangents| tangents.controls() > 0);
        visit(0, &state, tangents.as_ref());
        let lagging = self.lagging();
        for sample in (0..self.steps).step_by(self.pace.samples) {
            let whole = self.acting(lagging.as_ref(), (sample, self.pace.samples), moves);
            between.begin(&state, tangents.as_ref(), self.pace.samples);
            for substep in 0..self.pace.substeps {
                let Acting { tau, tangents: controls } = part_of(&whole, substep, self.pace.substeps);
                let carried = tangents.as_mut().map(|tangents| (tangents, &controls[..]));
                let failed = stepper.step(self.numbers, &mut state, [&tau[0], &tau[1]], carried);
                failures = failures.or(failed);
            }
            for k in 1..self.pace.samples {
                let shares =
                    cubic(k as f64 / self.pace.samples as f64, self.pace.samples as f64 * self.logs.h);
                let (state, tangents) = between.at(shares, &state, tangents.as_ref());
                visit(sample + k, state, tangents);
            }
            visit(sample + self.pace.samples, &state, tangents.as_ref());
        }
        failures
    }

    /// Residuals, sample by sample and coordinate by coordinate; each row has one residual per window. Windows that
    /// cannot be computed have the residuals of a constant velocity.
    pub fn residuals(&self, stepper: &mut dyn Steps, starts: &State) -> (Vec<Row>, Failures) {
        let n = self.n();
        let mut residuals = Vec::new();
        let failures = self.roll(stepper, starts, None, |sample, state, _| {
            residuals.extend((0..n).map(|i| self.residual(state, sample, i)));
        });
        self.replace_failed(starts, &failures, &mut residuals);
        (residuals, failures)
    }

    /// Σρ of every window.
    pub fn sums(&self, stepper: &mut dyn Steps, starts: &State) -> Row {
        let mut sums = Row::default();
        for residual in self.residuals(stepper, starts).0 {
            sums.0.iter_mut().zip(residual.0).for_each(|(sum, x)| *sum += pseudo_huber(x));
        }
        sums
    }

    fn replace_failed(&self, starts: &State, failures: &Failures, residuals: &mut [Row]) {
        let n = self.n();
        if !failures.any(WIDTH) {
            return;
        }
        for (sample, residuals) in residuals.chunks_exact_mut(n).enumerate() {
            let mut straight = starts.clone();
            for i in 0..n {
                straight[i].add_scaled(sample as f64 * self.logs.h, &starts[n + i]);
            }
            for (i, residual) in residuals.iter_mut().enumerate() {
                let own = self.residual(&straight, sample, i);
                (0..WIDTH).filter(|lane| failures.0[*lane]).for_each(|lane| residual.0[lane] = own.0[lane]);
            }
        }
    }

    /// Residuals and their derivatives, weighted so that the sum of their squares has the gradient of Σρ, and Σρ of
    /// every window. The columns are the learned numbers of the weight block and of g, o and d, then z, then start
    /// states; or start states alone. Windows that cannot be computed have rows of 0 and a sum of NaN.
    pub fn rows(&self, stepper: &mut dyn Steps, starts: &State, of: In) -> (Rows, Row) {
        let n = self.n();
        let (weights, controls, zeros) = match of {
            In::Starts => (0, 0, 0),
            In::All => (self.learned.weights.len(), self.learned.controls.len(), n),
        };
        let before = weights + controls;
        let mut rows = Rows::new(before + zeros + 2 * n);
        rows.reserve((self.steps + 1) * n);
        let tangents = Tangents::at_start(n, weights, controls);
        let mut sums = Row::default();
        let failures = self.roll(stepper, starts, Some(tangents), |sample, state, tangents| {
            for i in 0..n {
                let residual = self.residual(state, sample, i);
                sums = Row(std::array::from_fn(|lane| sums.0[lane] + pseudo_huber(residual.0[lane])));
                let share = Row(residual.0.map(share));
                rows.residual.push(residual.product(&share));
                let slope = Row(share.0.map(|share| share / self.scales[i]));
                let Some(tangents) = tangents else { continue };
                let scaled = |moved: &[Row]| moved[i].product(&slope);
                rows.jacobian.extend(tangents.each().take(before).map(scaled));
                rows.jacobian.extend((0..zeros).map(|j| if i == j { slope } else { Row::default() }));
                rows.jacobian.extend(tangents.each().skip(before).map(scaled));
            }
        });
        for lane in (0..WIDTH).filter(|lane| failures.0[*lane]) {
            rows.residual.iter_mut().chain(&mut rows.jacobian).for_each(|row| row.0[lane] = 0.0);
            sums.0[lane] = f64::NAN;
        }
        (rows, sums)
    }
}
