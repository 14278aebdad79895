//! Windows side by side, from their start states to their ends.

use super::calibration::CalibrationLayout;
use super::elimination::Rows;
use super::logs::{Window, WindowLogs};
use leastaction_core::forces::ControlKind;
use leastaction_programs::dynamics::Failures;
use leastaction_programs::steps::{ControlTangent, ExplicitSteps, State, Tangents};
use leastaction_programs::{Row, WIDTH};

/// κ of the pseudo-Huber function: residuals beyond so many robust standard deviations count less than their square.
const KNEE: f64 = 2.0;

/// Windows side by side, with the numbers that their motion depends on.
pub(super) struct Lanes<'a> {
    pub logs: &'a WindowLogs,
    pub windows: [Window; WIDTH],
    /// Steps of each.
    pub steps: usize,
    /// Runge–Kutta steps in each of them.
    pub substeps: usize,
    pub layout: &'a CalibrationLayout,
    /// The weight block of the model, then the calibration's numbers.
    pub numbers: &'a [f64],
    /// s of every coordinate.
    pub scales: &'a [f64],
}

/// What residuals are differentiated in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum In {
    /// Start states alone.
    Starts,
    /// The weight block, g, o and d, z of a window's own log, and start states.
    All,
}

/// ρ(x).
pub(super) fn pseudo_huber(x: f64) -> f64 {
    let square = x * x;
    2.0 * square / ((1.0 + square / (KNEE * KNEE)).sqrt() + 1.0)
}

/// √(ρ′(x)/2x): by which rows of least squares are multiplied for the gradient of ρ.
fn share(x: f64) -> f64 {
    (1.0 + x * x / (KNEE * KNEE)).sqrt().sqrt().recip()
}

/// τ at the start and the end of a step, and how it moves with g, o and d.
type Acting = ([Vec<Row>; 2], Vec<ControlTangent>);

/// What acts over one of several equal parts of a step, linear over all of it.
fn part_of((tau, tangents): &Acting, part: usize, parts: usize) -> Acting {
    let ends = [part, part + 1].map(|end| end as f64 / parts as f64);
    let between =
        |a: &Row, b: &Row| ends.map(|c| Row(std::array::from_fn(|k| a.0[k] + c * (b.0[k] - a.0[k]))));
    let each: Vec<[Row; 2]> = tau[0].iter().zip(&tau[1]).map(|(a, b)| between(a, b)).collect();
    let moved = |tangent: &ControlTangent| {
        let [a, b] = &tangent.change;
        ControlTangent { change: between(a, b), ..tangent.clone() }
    };
    ([0, 1].map(|end| each.iter().map(|ends| ends[end]).collect()), tangents.iter().map(moved).collect())
}

/// ρ′(x)/2x, by which squares count in Gauss and Newton's matrix, and ρ″(x)/2, by which they count in the loss's own.
pub(super) fn curvatures(x: f64) -> [f64; 2] {
    let root = (1.0 + x * x / (KNEE * KNEE)).sqrt();
    [root.recip(), root.powi(3).recip()]
}

impl Lanes<'_> {
    fn n(&self) -> usize {
        self.logs.n
    }

    fn of_windows(&self, number: impl Fn(&Window) -> f64) -> Row {
        Row(std::array::from_fn(|lane| number(&self.windows[lane])))
    }

    /// τ at the start and the end of a step, and how it moves with g, o and d.
    fn control(&self, step: usize) -> Acting {
        let (n, held) = (self.n(), self.logs.control == ControlKind::Held);
        let number = |position: usize| self.numbers[position];
        let mut tau = [vec![Row::default(); n], vec![Row::default(); n]];
        let mut tangents = Vec::new();
        for i in 0..n {
            let places = [self.layout.gain(i), self.layout.offset(i), self.layout.delay()];
            let [gain, offset, delay] = places.map(number);
            let mut change = [[Row::default(); 2]; 3];
            for end in 0..2 {
                let sample = step + if held { 0 } else { end };
                let mut u = [Row::default(); 2];
                for (lane, window) in self.windows.iter().enumerate() {
                    let of = self.logs.delayed_control(window.log, window.first + sample, i, delay);
                    (u[0].0[lane], u[1].0[lane]) = (of[0], of[1]);
                }
                tau[end][i] = Row(u[0].0.map(|u| gain * u + offset));
                change[0][end] = u[0];
                change[1][end] = Row::splat(1.0);
                change[2][end] = Row(u[1].0.map(|slope| gain * slope));
            }
            for (place, change) in places.into_iter().zip(change) {
                tangents.push(ControlTangent { number: place - self.layout.start, coordinate: i, change });
            }
        }
        (tau, tangents)
    }

    /// (q̂_i + z_i − q̃_i)/s_i at a sample.
    fn residual(&self, state: &State, sample: usize, i: usize) -> Row {
        let of = |window: &Window| {
            let zero = self.numbers[self.layout.zero(window.log, i)];
            zero - self.logs.position(window.log, window.first + sample, i)
        };
        let (measured, scale) = (self.of_windows(of), self.scales[i]);
        Row(std::array::from_fn(|lane| (state[i].0[lane] + measured.0[lane]) / scale))
    }

    /// Calls `visit` with every sample's state.
    fn roll(
        &self,
        stepper: &mut ExplicitSteps,
        starts: &State,
        mut tangents: Option<&mut Tangents>,
        mut visit: impl FnMut(usize, &State, Option<&Tangents>),
    ) -> Failures {
        let (mut state, mut failures) = (starts.clone(), Failures::default());
        visit(0, &state, tangents.as_deref());
        for step in 0..self.steps {
            let whole = self.control(step);
            for substep in 0..self.substeps {
                let (tau, controls) = part_of(&whole, substep, self.substeps);
                let carried = tangents.as_deref_mut().map(|tangents| {
                    let controls = if tangents.controls() > 0 { &controls[..] } else { &[] };
                    (tangents, controls)
                });
                let failed = stepper.step(self.numbers, &mut state, [&tau[0], &tau[1]], carried);
                failures = failures.or(failed);
            }
            visit(step + 1, &state, tangents.as_deref());
        }
        failures
    }

    /// Residuals, a row of all windows each: sample after sample, coordinate after coordinate. Those of windows that cannot be computed are
    /// of a constant velocity.
    pub fn residuals(&self, stepper: &mut ExplicitSteps, starts: &State) -> (Vec<Row>, Failures) {
        let n = self.n();
        let mut residuals = Vec::new();
        let failures = self.roll(stepper, starts, None, |sample, state, _| {
            residuals.extend((0..n).map(|i| self.residual(state, sample, i)));
        });
        self.replace_failed(starts, &failures, &mut residuals);
        (residuals, failures)
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

    /// Residuals and their derivatives, weighed so that their squares have the gradient of Σρ, and Σρ of every window. Columns: weight block,
    /// g, o, d, z, start states; or these alone. Windows that cannot be computed have rows of 0, and a sum that is no number.
    pub fn rows(&self, stepper: &mut ExplicitSteps, starts: &State, of: In) -> (Rows, Row) {
        let n = self.n();
        let (weights, controls, zeros) = match of {
            In::Starts => (0, 0, 0),
            In::All => (self.layout.start, self.layout.controls(), n),
        };
        let mut rows = Rows::new(weights + controls + zeros + 2 * n);
        let mut tangents = Tangents::at_start(n, weights, controls);
        let mut sums = Row::default();
        let failures = self.roll(stepper, starts, Some(&mut tangents), |sample, state, tangents| {
            for i in 0..n {
                let residual = self.residual(state, sample, i);
                sums = Row(std::array::from_fn(|lane| sums.0[lane] + pseudo_huber(residual.0[lane])));
                let share = Row(residual.0.map(share));
                rows.residual.push(residual.product(&share));
                let slope = Row(share.0.map(|share| share / self.scales[i]));
                let (before, starts) = tangents.map_or(&[][..], |t| t.of(i)).split_at(weights + controls);
                rows.jacobian.extend(before.iter().map(|x| x.product(&slope)));
                rows.jacobian.extend((0..zeros).map(|j| if i == j { slope } else { Row::default() }));
                rows.jacobian.extend(starts.iter().map(|x| x.product(&slope)));
            }
        });
        for lane in (0..WIDTH).filter(|lane| failures.0[*lane]) {
            rows.residual.iter_mut().chain(&mut rows.jacobian).for_each(|row| row.0[lane] = 0.0);
            sums.0[lane] = f64::NAN;
        }
        (rows, sums)
    }
}
