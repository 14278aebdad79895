use crate::angle::difference;
use crate::error::{SetupError, require};
use crate::tick::{Mode, Tick, TraceHash};
use leastaction_core::discrete::Report;
use leastaction_core::scalar::{Compensated, Scalar};

/// Goal of a run, met if the error stays within the tolerance over the last `hold` seconds, and the position within the bounds throughout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal<const N: usize> {
    /// Largest |error|, rad or m; infinite if it does not matter.
    pub tolerance: [f32; N],
    /// Duration, s; the whole run if longer than the run.
    pub hold: f32,
    /// Largest |q|, rad or m (the track of a cart); infinite if there is none.
    pub bounds: [f32; N],
}

impl<const N: usize> Goal<N> {
    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        for x in self.tolerance.iter().chain(&self.bounds).chain([&self.hold]) {
            require("goal", *x, *x >= 0.0, "not negative")?;
        }
        Ok(())
    }

    fn met(&self, error: &[f32; N]) -> bool {
        error.iter().zip(&self.tolerance).all(|(error, tolerance)| error.abs() <= *tolerance)
    }
}

/// Counts of incidents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Incidents {
    /// Encoder readings dropped.
    pub dropped: u32,
    /// Late ticks.
    pub late: u32,
    /// Missed ticks.
    pub missed: u32,
    /// Ticks in which the firmware commanded no force because its model failed.
    pub safe: u32,
    /// Errors of the model: refused steps, and commands that were not finite.
    pub model: u32,
    /// Refused moves of the plant, for instance if its state is no longer finite; it stays where it was.
    pub plant: u32,
}

/// Summary of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary<const N: usize> {
    /// Number of ticks run.
    pub ticks: u32,
    /// Whether the goal was reached.
    pub success: bool,
    /// Time at which the error came within the tolerance for good, s; `None` if it is outside at the end.
    pub settled_at: Option<f32>,
    /// Largest |q|, rad or m.
    pub max_q: [f32; N],
    /// Largest |error|, rad or m.
    pub max_error: [f32; N],
    /// Root mean square of the error, rad or m.
    pub rms_error: [f32; N],
    /// Root mean square of estimated minus true position, over the ticks with an estimate.
    pub rms_estimate_q: [f32; N],
    /// Root mean square of estimated minus true velocity, over the ticks with an estimate.
    pub rms_estimate_v: [f32; N],
    /// Largest |applied force|, N or N m.
    pub max_force: [f32; N],
    /// Largest number of Newton iterations and largest residual of an accepted step.
    pub newton: Report<f32>,
    /// Counts of incidents.
    pub incidents: Incidents,
    /// Fingerprint of the trace; see [`TraceHash`].
    pub hash: u64,
}

/// The sum of squares of a vector over time.
#[derive(Clone, Copy)]
struct Squares<const N: usize> {
    sum: [Compensated<f32>; N],
    count: u32,
}

impl<const N: usize> Squares<N> {
    fn new() -> Self {
        Self { sum: [Compensated::new(0.0); N], count: 0 }
    }

    fn add(&mut self, x: &[f32; N]) {
        self.count += 1;
        for (sum, x) in self.sum.iter_mut().zip(x) {
            *sum = sum.plus(x * x);
        }
    }

    fn root_mean(&self) -> [f32; N] {
        self.sum.map(|sum| Scalar::sqrt(sum.value() / self.count.max(1) as f32))
    }
}

/// Recorder that builds the summary of a run from its ticks.
#[derive(Clone)]
pub(crate) struct Recorder<const N: usize> {
    goal: Goal<N>,
    angle: [bool; N],
    error: Squares<N>,
    estimate_q: Squares<N>,
    estimate_v: Squares<N>,
    hash: TraceHash,
    out_of_bounds: bool,
    end: f32,
    summary: Summary<N>,
}

impl<const N: usize> Recorder<N> {
    pub(crate) fn new(goal: Goal<N>, angle: [bool; N]) -> Self {
        let zero = [0.0; N];
        let summary = Summary {
            ticks: 0,
            success: false,
            settled_at: None,
            max_q: zero,
            max_error: zero,
            rms_error: zero,
            rms_estimate_q: zero,
            rms_estimate_v: zero,
            max_force: zero,
            newton: Report { iterations: 0, residual: 0.0 },
            incidents: Incidents::default(),
            hash: 0,
        };
        let squares = Squares::new();
        Self {
            goal,
            angle,
            error: squares,
            estimate_q: squares,
            estimate_v: squares,
            hash: TraceHash::default(),
            out_of_bounds: false,
            end: 0.0,
            summary,
        }
    }

    /// Counts errors of the model and of the plant.
    pub(crate) fn errors(&mut self, model: u32, plant: u32) {
        self.summary.incidents.model += model;
        self.summary.incidents.plant += plant;
    }

    pub(crate) fn record(&mut self, tick: &Tick<N>) {
        self.hash.update(tick);
        self.update_goal(tick);
        self.measure(tick);
        self.count(tick);
    }

    /// Updates the time since which the error is within the tolerance, and whether the position has left its bounds.
    fn update_goal(&mut self, tick: &Tick<N>) {
        let settled_since = self.summary.settled_at.unwrap_or(tick.time);
        self.summary.settled_at = self.goal.met(&tick.error).then_some(settled_since);
        self.out_of_bounds |= tick.q.iter().zip(&self.goal.bounds).any(|(q, bound)| q.abs() > *bound);
        self.end = tick.time;
    }

    fn measure(&mut self, tick: &Tick<N>) {
        let summary = &mut self.summary;
        enlarge(&mut summary.max_q, &tick.q);
        enlarge(&mut summary.max_error, &tick.error);
        enlarge(&mut summary.max_force, &tick.applied);
        self.error.add(&tick.error);
        if !tick.missed && tick.mode != Mode::Wait {
            self.estimate_q.add(&difference(&tick.q_estimate, &tick.q, &self.angle));
            self.estimate_v.add(&difference(&tick.v_estimate, &tick.v, &[false; N]));
        }
    }

    fn count(&mut self, tick: &Tick<N>) {
        let Summary { ticks, incidents, newton, .. } = &mut self.summary;
        *ticks += 1;
        incidents.dropped += tick.dropped() as u32;
        incidents.late += u32::from(tick.lateness > 0.0);
        incidents.missed += u32::from(tick.missed);
        incidents.safe += u32::from(tick.mode == Mode::Safe && !tick.missed);
        newton.iterations = newton.iterations.max(tick.newton.iterations);
        newton.residual = newton.residual.max(tick.newton.residual);
    }

    pub(crate) fn finish(self) -> Summary<N> {
        let latest = (self.end - self.goal.hold).max(0.0);
        let held = self.summary.settled_at.is_some_and(|since| since <= latest);
        Summary {
            success: held && !self.out_of_bounds,
            rms_error: self.error.root_mean(),
            rms_estimate_q: self.estimate_q.root_mean(),
            rms_estimate_v: self.estimate_v.root_mean(),
            hash: self.hash.finish(),
            ..self.summary
        }
    }
}

/// Updates the largest magnitudes.
fn enlarge<const N: usize>(largest: &mut [f32; N], x: &[f32; N]) {
    for (largest, x) in largest.iter_mut().zip(x) {
        *largest = largest.max(x.abs());
    }
}
