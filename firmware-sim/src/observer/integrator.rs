use crate::Mechanism;
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Newton, Order, Report, State, StepError};

/// A variational integrator whose order is chosen at run time.
#[derive(Clone, Copy, Debug)]
pub enum Integrator {
    /// Order 2.
    Midpoint(Del<f32, Midpoint>),
    /// Order 4.
    Galerkin(Del<f32, Galerkin>),
}

impl Integrator {
    /// An integrator of step h > 0, s.
    pub fn new(order: Order, h: f32, newton: Newton<f32>) -> Self {
        match order {
            Order::Two => Self::Midpoint(Del::with_newton(h, newton)),
            Order::Four => Self::Galerkin(Del::with_newton(h, newton)),
        }
    }

    /// h, s.
    pub fn h(&self) -> f32 {
        match self {
            Self::Midpoint(del) => del.h(),
            Self::Galerkin(del) => del.h(),
        }
    }

    /// Advances `state` by one step under a held force; on error it is what it was.
    pub fn step<M: Mechanism<N>, const N: usize>(
        &self,
        model: &M,
        state: &mut State<f32, N>,
        u: &[f32; N],
    ) -> Result<Report<f32>, StepError<f32>> {
        match self {
            Self::Midpoint(del) => model.del_step(del, state, u),
            Self::Galerkin(del) => model.del_step(del, state, u),
        }
    }

    /// The state at the second of two positions one step apart, and the force held between them.
    pub fn start<M: Mechanism<N>, const N: usize>(
        &self,
        model: &M,
        q: [&[f32; N]; 2],
        u: &[f32; N],
    ) -> Result<State<f32, N>, StepError<f32>> {
        match self {
            Self::Midpoint(del) => model.start(del, q, u),
            Self::Galerkin(del) => model.start(del, q, u),
        }
    }
}
