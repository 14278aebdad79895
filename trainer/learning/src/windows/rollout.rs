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
        let mut all: Acting = Default::default();
        for i in 0..self.n() {
            let (tau, tangents) = self.control_of(step, i);
            all.0.iter_mut().zip(tau).for_each(|(ends, tau)| ends.push(tau));
            all.1.extend(tangents);
        }
        all
    }

    /// That of one coordinate.
    fn control_of(&self, step: usize, i: usize) -> ([Row; 2], [ControlTangent; 3]) {
        let places = [self.layout.gain(i), self.layout.offset(i), self.layout.delay()];
        let [gain, offset, delay] = places.map(|position| self.numbers[position]);
        let held = self.logs.control == ControlKind::Held;
        let at = |end: usize| {
            let sample = step + if held { 0 } else { end };
            let u = |window: &Window| self.logs.delayed_control(window.log, window.first + sample, i, delay);
            [0, 1].map(|part| self.of_windows(|window| u(window)[part]))
        };
        let ends = [at(0), at(1)];
        let tau = ends.map(|[u, _]| Row(u.0.map(|u| gain * u + offset)));
        let changes = [
            ends.map(|[u, _]| u),
            [Row::splat(1.0); 2],
            ends.map(|[_, slope]| Row(slope.0.map(|slope| gain * slope))),
        ];
        let tangent = |k: usize| {
            let number = places[k] - self.layout.start;
            ControlTangent { number, coordinate: i, change: changes[k] }
        };
        (tau, [0, 1, 2].map(tangent))
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
