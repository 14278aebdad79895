//! The true mechanism.

use crate::{Mechanism, Timeline};
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::{Control, Del, Galerkin, State, StepError};
use leastaction_core::forces::Forces;
use leastaction_core::scalar::all_finite;

/// A mechanism in motion, integrated by steps much finer than a tick: Runge–Kutta steps or, with friction that sticks or end stops,
/// variational steps of order 4, which solve these laws. Position and velocity are continuous where the mechanism changes.
#[derive(Clone, Debug)]
pub struct Plant<'a, M, const N: usize> {
    timeline: Timeline<'a, M>,
    /// Mechanism that acts now.
    mechanism: &'a M,
    state: ContinuousState<f32, N>,
    /// The state with its momentum, once variational steps have been taken.
    variational: Option<State<f32, N>>,
    substeps: u16,
}

impl<'a, M: Mechanism<N>, const N: usize> Plant<'a, M, N> {
    /// Creates a plant at (q, v), with the given number of integration steps (at least 1) in each call of [`Plant::advance`].
    pub fn new(timeline: impl Into<Timeline<'a, M>>, state: ContinuousState<f32, N>, substeps: u16) -> Self {
        debug_assert!(substeps >= 1, "setups without integration steps are refused");
        let timeline = timeline.into();
        let mechanism = timeline.at(0.0);
        Self { timeline, mechanism, state, variational: None, substeps: substeps.max(1) }
    }

    /// Lets the mechanism of time t, s, act from now on. The momentum jumps with the inertia, as in a load that is taken up in motion and
    /// already moves with the hand.
    pub fn change(&mut self, t: f32) {
        let mechanism = self.timeline.at(t);
        if !core::ptr::eq(mechanism, self.mechanism) {
            (self.mechanism, self.variational) = (mechanism, None);
        }
    }

    /// Position and velocity.
    pub fn state(&self) -> &ContinuousState<f32, N> {
        &self.state
    }

    /// Moves on for a time (s) under forces that are held over each of its steps; `u` is asked for them in turn, with the part of the time that
    /// each lasts. After an error the plant stays at the last finite state.
    pub fn advance(
        &mut self,
        duration: f32,
        mut u: impl FnMut(f32) -> [f32; N],
    ) -> Result<(), StepError<f32>> {
        if duration <= 0.0 {
            return Ok(());
        }
        let (h, part) = (duration / f32::from(self.substeps), f32::from(self.substeps).recip());
        for _ in 0..self.substeps {
            let force = u(part);
            if self.mechanism.system().forces.sticks() {
                self.step_with_contacts(h, &force)?;
                continue;
            }
            let next = self.mechanism.rk4_step(&self.state, &force, h)?;
            if !all_finite(&next.q) || !all_finite(&next.v) {
                return Err(StepError::NotFinite);
            }
            self.state = next;
        }
        Ok(())
    }

    /// Takes a variational step.
    fn step_with_contacts(&mut self, h: f32, u: &[f32; N]) -> Result<(), StepError<f32>> {
        let system = self.mechanism.system();
        let ContinuousState { q, v } = self.state;
        let mut state = match self.variational {
            Some(state) => state,
            None => State::new(&system.lagrangian, q, v)?,
        };
        Del::<f32, Galerkin>::new(h).step(system, &mut state, &Control::held(*u))?;
        self.state = ContinuousState { q: state.q(), v: state.velocity(&system.lagrangian)? };
        self.variational = Some(state);
        Ok(())
    }
}
