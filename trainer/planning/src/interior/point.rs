use super::Bounds;
use leastaction_core::control::{Decision, Diagonal, Limits, NodeModel, Plant, Problem, Transition, Value};
use leastaction_core::discrete::StepError;
use leastaction_core::linear::{SolveError, add_scaled, multiply, transpose};
use std::array::from_fn;

/// A problem with the number of ticks in a node.
pub type Running<'p, P, const D: usize, const N: usize> = (&'p Problem<P, f64, D, N>, u16);

/// State, control, course and end of a node.
#[derive(Clone, Copy, Debug)]
pub struct Iterate<const D: usize, const N: usize> {
    /// State at the start of the node.
    pub x: [f64; D],
    /// Control over the node.
    pub u: [f64; N],
    /// Course of the node, as its plant keeps it.
    pub course: [f64; D],
    /// State f(x, u) at the end of the node.
    pub end: [f64; D],
}

/// A node of the search. Its state is free: the end of the node before may differ from it, by a gap that the search closes.
#[derive(Clone, Debug)]
pub struct Point<const D: usize, const N: usize> {
    /// The node.
    pub now: Iterate<D, N>,
    /// The trial under way.
    pub trial: Iterate<D, N>,
    /// Limits of the state and of the control.
    pub bounds: (Bounds<D>, Bounds<N>),
    /// Multiplier y of the gap at the node's end.
    pub costate: [f64; D],
    /// Linear approximation.
    pub transition: Transition<f64, D, N>,
    /// Change of the control, and its gain.
    pub decision: Decision<f64, D, N>,
    /// Step of the state and of the control.
    pub step: ([f64; D], [f64; N]),
    /// Model of the cost to go in the state after this node.
    pub ahead: Value<f64, D>,
}

impl<const D: usize, const N: usize> Point<D, N> {
    /// Computes the end of the node.
    pub fn evaluate<P: Plant<f64, D, N>>(
        plant: &P,
        ticks: u16,
        iterate: &mut Iterate<D, N>,
    ) -> Result<(), StepError<f64>> {
        let mut state = plant.begin(&iterate.x)?;
        iterate.end = plant.advance(&mut state, (ticks, &iterate.u), &mut iterate.course)?;
        Ok(())
    }

    /// Gap to the state of the next node.
    pub fn gap(&self, next: &[f64; D]) -> [f64; D] {
        add_scaled(&self.now.end, -1.0, next)
    }

    /// Linearises the node.
    pub fn linearise<P: Plant<f64, D, N>>(&mut self, plant: &P, ticks: u16) -> Result<(), StepError<f64>> {
        let Iterate { x, u, course, end } = &self.now;
        let (start, stop) = (plant.frame(x), plant.frame(end));
        self.transition = plant.linearise([(x, &start), (end, &stop)], (ticks, u), course)?;
        Ok(())
    }

    /// Model of the cost to go at the node's start from that of the next state, to which there is a gap.
    ///
    /// # Errors
    /// [`SolveError`] if a number is not finite.
    pub fn backward<P>(
        &mut self,
        problem: Running<'_, P, D, N>,
        (ahead, next): (&Value<f64, D>, &[f64; D]),
        mu: f64,
    ) -> Result<Value<f64, D>, SolveError> {
        self.ahead = *ahead;
        let end = Value { slope: ahead.slope_at(&self.gap(next)), ..*ahead };
        let model = NodeModel::new(self.costs(problem, mu), &self.transition, &end);
        self.decision = model.decide_free(&moves(&problem.0.controls))?;
        Ok(model.value(&self.decision))
    }

    /// Slopes and curvatures of the barrier cost of state and control.
    fn costs<P>(
        &self,
        (problem, ticks): Running<'_, P, D, N>,
        mu: f64,
    ) -> (Diagonal<f64, D>, Diagonal<f64, N>) {
        let Iterate { x, u, .. } = &self.now;
        let (of_x, of_u) = (self.bounds.0.terms(x, mu), self.bounds.1.terms(u, mu));
        let ((slope, curvature), control) =
            (problem.running_slope(ticks, x), problem.control_slope(ticks, u));
        (
            (add_scaled(&slope, 1.0, &of_x.0), add_scaled(&curvature, 1.0, &of_x.1)),
            (add_scaled(&control.0, 1.0, &of_u.0), add_scaled(&control.1, 1.0, &of_u.1)),
        )
    }

    /// Takes the step from a change of the state; returns the change of the next one.
    pub fn forward(&mut self, dx: [f64; D], next: &[f64; D]) -> [f64; D] {
        let Decision { change, gain } = &self.decision;
        self.step = (dx, add_scaled(change, -1.0, &multiply(gain, &dx)));
        add_scaled(&self.transition.apply(&dx, &self.step.1), 1.0, &self.gap(next))
    }

    /// Slope of the barrier cost along the step.
    pub fn slope<P>(&self, problem: Running<'_, P, D, N>, mu: f64) -> f64 {
        let (of_x, of_u) = self.costs(problem, mu);
        let along = |slope: &[f64], step: &[f64]| slope.iter().zip(step).map(|(a, b)| a * b).sum::<f64>();
        along(&of_x.0, &self.step.0) + along(&of_u.0, &self.step.1)
    }

    /// Largest slope of the Lagrangian in state and control; `before` is the multiplier of the gap at the node's start, absent if its state
    /// is given.
    pub fn residual<P>(&self, (problem, ticks): Running<'_, P, D, N>, before: Option<&[f64; D]>) -> f64 {
        let Transition { a, b } = &self.transition;
        let (of_x, _) = problem.running_slope(ticks, &self.now.x);
        let (of_u, _) = problem.control_slope(ticks, &self.now.u);
        let (by_x, by_u) = (multiply(&transpose(a), &self.costate), multiply(&transpose(b), &self.costate));
        let (state, control) = (self.bounds.0.multiplier(), self.bounds.1.multiplier());
        let x = |before: &[f64; D]| largest((0..D).map(|i| of_x[i] + by_x[i] + state[i] - before[i]));
        let moves = moves(&problem.controls);
        let u = (0..N).filter(|j| moves[*j]).map(|j| of_u[j] + by_u[j] + control[j]);
        before.map_or(0.0, x).max(largest(u))
    }

    /// Tries a part of the step.
    ///
    /// # Errors
    /// [`StepError`] if the node cannot be computed.
    pub fn try_part<P: Plant<f64, D, N>>(
        &mut self,
        plant: &P,
        ticks: u16,
        part: f64,
    ) -> Result<(), StepError<f64>> {
        let Iterate { x, u, course, end } = &self.now;
        let (x, u) = (add_scaled(x, part, &self.step.0), add_scaled(u, part, &self.step.1));
        self.trial = Iterate { x, u, course: *course, end: *end };
        Self::evaluate(plant, ticks, &mut self.trial)
    }

    /// Makes the trial the present node, and takes parts of the changes of the multipliers.
    pub fn accept(&mut self, mu: f64, dual: f64) {
        let (now, trial, step) = (&self.now, &self.trial, &self.step);
        self.bounds.0.advance((&now.x, &step.0, &trial.x), mu, dual);
        self.bounds.1.advance((&now.u, &step.1, &trial.u), mu, dual);
        self.now = self.trial;
    }
}

/// Flags of the controls whose limits leave them room.
fn moves<const N: usize>(controls: &Limits<f64, N>) -> [bool; N] {
    from_fn(|j| controls.least[j] < controls.most[j])
}

/// Largest absolute value.
pub fn largest(each: impl Iterator<Item = f64>) -> f64 {
    each.map(f64::abs).fold(0.0, f64::max)
}
