use crate::discrete::{Control, Del, Galerkin, Midpoint, Newton, Order, Report, State, StepError};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::scalar::Real;

/// A variational integrator whose order is chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrator<R> {
    order: Order,
    h: R,
    newton: Newton<R>,
}

impl<R: Real> Integrator<R> {
    /// Creates an integrator of step h > 0, s.
    pub const fn new(order: Order, h: R, newton: Newton<R>) -> Self {
        Self { order, h, newton }
    }

    /// Order of the steps.
    pub const fn order(&self) -> Order {
        self.order
    }

    /// Step size h, s.
    pub const fn h(&self) -> R {
        self.h
    }

    /// Replaces the step size, s.
    #[must_use]
    pub const fn with_step(&self, h: R) -> Self {
        Self { order: self.order, h, newton: self.newton }
    }

    /// Advances `state` by one step.
    ///
    /// # Errors
    /// See [`Del::step`]; the state is then unchanged.
    pub fn step<L: Lagrangian<R, N>, F: Forces<R, N>, const N: usize>(
        &self,
        system: &System<L, F>,
        state: &mut State<R, N>,
        u: &Control<R, N>,
    ) -> Result<Report<R>, StepError<R>> {
        let Self { order, h, newton } = *self;
        match order {
            Order::Two => Del::<R, Midpoint>::with_newton(h, newton).step(system, state, u),
            Order::Four => Del::<R, Galerkin>::with_newton(h, newton).step(system, state, u),
        }
    }

    /// Returns the state at the second of two positions one step apart, given the force between them.
    ///
    /// # Errors
    /// See [`Del::start`].
    pub fn start<L: Lagrangian<R, N>, F: Forces<R, N>, const N: usize>(
        &self,
        system: &System<L, F>,
        [q0, q1]: [&[R; N]; 2],
        u: &Control<R, N>,
    ) -> Result<State<R, N>, StepError<R>> {
        let Self { order, h, newton } = *self;
        match order {
            Order::Two => Del::<R, Midpoint>::with_newton(h, newton).start(system, q0, q1, u),
            Order::Four => Del::<R, Galerkin>::with_newton(h, newton).start(system, q0, q1, u),
        }
    }
}
