//! Discrete dynamics: the forced discrete Euler–Lagrange (DEL) equation in position–momentum form, of order 2 and 4.
//!
//! Over one step h the path is q(c) = q₀ + h(cw + β(c)s) with the increment w = (q₁ − q₀)/h and, at order 4, a bubble
//! s, β(c) = 4c(1 − c); its velocity is v(c) = w + γ(c)s, γ = β′. The action is summed over Gauss points c_i with weights
//! b_i, L_d = h Σ b_i L(q(c_i), v(c_i)). With F = L_q + Q + u(c) the step solves
//!
//! - momentum: p₀ + Σ b_i [h(1 − c_i) F_i − L_v,i] = 0, that is p₀ + D₁L_d + f⁻ = 0;
//! - bubble (order 4): Σ b_i [hβ_i F_i + γ_i L_v,i] = 0, that is D_mL_d + f_m = 0;
//!
//! and then p₁ = p₀ + h Σ b_i F_i. This equals D₂L_d + f⁺ if the momentum equation holds, and conserves the momentum of a cyclic coordinate
//! exactly. Order 2 has one point, the midpoint; with u linear between u₀ and u₁ its forces are SyMo's (h/4)(u₀ + u₁). Eliminating p gives
//! SyMo's three-point equation (its equations 9 and 10).
//!
//! The unknown is w, not q₁: in f32 the residual then falls to about 1e-6 instead of 1e-4.
//!
//! # Derivatives
//! [`Del::step_with_derivative`] also returns A = ∂(q₁, p₁)/∂(q₀, p₀) and B = ∂(q₁, p₁)/∂τ of the step that it takes: see [`StepDerivative`].
//!
//! # Newton's matrix
//! The matrix of the two equations leaves out L_qq. The missing part has a relative size of (hω)²/4, with ω the
//! fastest rate at which the system oscillates, and an update multiplies the error by about that. In return, one
//! evaluation of [`Lagrangian::linearization`] gives both the residual after an update and the matrix of the next,
//! systems of one or two coordinates compute their acceleration by the same function, and no family needs second
//! derivatives of its potential on a controller. The table gives the number of updates down to rounding, mean and
//! maximum, at order 2 and speeds up to 10 rad/s. It was measured on the exact systems of
//! [`trigonometric`](crate::energy::trigonometric) and on double pendulums of learned links
//! ([`modular`](crate::energy::modular)):
//!
//! | h | with L_qq, f32 | without, f32 | with L_qq, f64 | without, f64 |
//! |---|---|---|---|---|
//! | 1 ms, exact | 1.0, 2 | 1.0, 2 | 1.0, 2 | 2.0, 3 |
//! | 10 ms, exact | 1.0, 2 | 1.0, 2 | 1.9, 3 | 3.3, 5 |
//! | 50 ms, exact | 1.2, 2 | 2.1, 4 | 2.2, 3 | 5.9, 10 |
//! | 10 ms, learned links | 1.0, 2 | 1.2, 3 | 2.1, 3 | 4.0, 8 |
//! | 50 ms, learned links | 2.0, 5 | 2.9, 8 | 3.2, 6 | 7.5, 33 |
//!
//! Where the three exact systems differ, the table shows the cart-pole; the worst of the three needs 6.2
//! updates on average instead of 5.9, with the same maximum. A fixed number of updates leaves a larger error at
//! long steps: for the learned links in f32, two updates leave 9e-6 (relative to w) at 10 ms, and 7e-4 at 20
//! ms, where three should be taken.
//!
//! For a cart-pole of 2 × 32 units on a Cortex-M4F (`firmware-sim/chip/README.md`), two updates of order 2 take 54,500 instructions,
//! 1.9 kB of stack and, in an image with nothing else, 14.6 kB of code; with L_qq in the first of two updates they took 58,500, 3.1 kB and
//! 22.3 kB.
//!
//! # Friction
//!
//! Forces Q(q, v, τ) are evaluated at the Gauss points, f⁻ = h Σ b_i (1 − c_i) Q_i and f⁺ = h Σ b_i c_i Q_i; at
//! order 2 this is once, at the mean velocity w. A step therefore never gains energy by friction, but under
//! stiff friction the velocity decays too slowly. Near rest, a midpoint step turns v into v(1 − a)/(1 + a), a =
//! h c (M⁻¹)_ii/(2ε) ([`Coulomb::stiffness`](crate::forces::Coulomb::stiffness)). If a > 1, the sign changes at
//! every step: the velocity rings. A step of order 4 turns v into v(1 − a + a²/3)/(1 + a + a²/3), which keeps
//! its sign and is smallest at a = √3. The increment w, and with it the position, stays near 0 as it should.
//! The momentum, and any velocity computed from it, does not for a ≫ 1. If momentum or velocity is used, as in
//! control, keep a ≤ 1 (order 4: a ≤ 3) by a shorter step or a wider change of sign, ε ≥ h c (M⁻¹)_ii/2.
//!
//! Newton's method alone fails at the change of sign from about a = 2 on: tanh is flat on both sides, and
//! updates jump between them forever. An update that would reverse a velocity is therefore cut short where that
//! velocity is 0 ([`Forces::trusted_part`]); from there the method converges for any a. The table gives the
//! number of updates down to rounding, mean and maximum, over the steps in which a velocity changes its sign.
//! The runs are 4 s long, from six starts, with coordinate 0 driven. Friction is 0.5 N m for a pendulum, and
//! 0.3 N and 0.02 N m for a cart-pole; each entry is the larger number of the two systems:
//!
//! | h, a | order 2, f32 | order 4, f32 | order 2, f64 | order 4, f64 |
//! |---|---|---|---|---|
//! | 1 ms, 0.1 | 1.9, 3 | 2.0, 3 | 3.7, 4 | 3.6, 4 |
//! | 1 ms, 1 | 1.8, 4 | 1.9, 3 | 3.6, 5 | 3.8, 5 |
//! | 1 ms, 5 | 1.3, 5 | 1.4, 5 | 3.3, 7 | 3.3, 7 |
//! | 10 ms, 0.1 | 2.1, 3 | 2.2, 4 | 4.7, 5 | 4.3, 6 |
//! | 10 ms, 0.5 | 2.6, 4 | 2.7, 4 | 5.2, 7 | 4.9, 6 |
//! | 10 ms, 1 | 2.6, 4 | 2.6, 4 | 4.9, 7 | 4.8, 6 |
//! | 10 ms, 2 | 2.4, 4 | 2.6, 5 | 4.8, 7 | 4.7, 6 |
//! | 10 ms, 5 | 2.2, 5 | 2.5, 5 | 4.6, 7 | 4.5, 7 |
//! | 50 ms, 0.1 | 2.7, 4 | 2.8, 4 | 6.6, 8 | 5.8, 7 |
//! | 50 ms, 1 | 3.3, 5 | 3.3, 5 | 6.9, 9 | 6.3, 9 |
//! | 50 ms, 5 | 3.4, 5 | 3.3, 6 | 7.0, 10 | 6.4, 9 |
//!
//! [`Del::start`] at order 4 solves another equation, for the bubble alone between two given positions.
//! Friction at the early Gauss point helps that bubble grow. From about a = 3.5 on, the residual is therefore
//! no longer monotonic in the bubble where friction bends sharply; updates then leave out the derivative of the
//! early friction, and reach a solution.
//!
//! At a = 50, the maximum is 7 updates in f32 and 10 in f64. Without friction, or away from rest, the numbers are those of the first table.
//! The bound on updates ([`Newton::max_iterations`]) stays a bound: a step that is not solved within it is an error. With friction of a ≤
//! 1, allow four updates at 10 ms, where a system without friction would take two.
//!
//! Friction that sticks ([`Sticking`](crate::forces::Sticking)) is solved as the set-valued law that it is: a coordinate at rest has w_i = 0
//! exactly, keeps its position to the last bit, and neither rings nor creeps. It takes fewer updates than the smooth law: in motion 2.2 to
//! 3.0 in f64 and 1.0 to 1.1 in f32 on average, over random robots of one to seven joints at 1 to 10 ms, and at most 19 and 8
//! (`cargo test --package leastaction-core --test steps stick -- --nocapture`). Between events, order 2 and order 4 keep their orders; at an
//! event, the instant is off by a part of the step.
//!
//! Systems of any number of particles, with or without constraints, are stepped by [`rattle`].
//!
//! Sources: Marsden and West, "Discrete mechanics and variational integrators", Acta Numerica 2001, sections 1.5, 2.6
//! and 3.2; Ober-Blöbaum and Saake, "Construction and analysis of higher order Galerkin variational integrators", 2015.

mod contact;
mod derivative;
mod interval;
mod motion;
mod newton;
mod order;
mod path;
pub mod rattle;
mod state;
mod sticking;
mod variation;

pub use crate::forces::Control;
pub use crate::newton::{Newton, Report, StepError};
pub use derivative::{EndDerivative, StepDerivative};
pub use interval::{Balance, BubbleDerivatives, Interval, Linearised};
pub use newton::Solved;
pub use order::Order;
pub use path::{Galerkin, GaussPoint, Midpoint, Path};
pub use state::{SavedState, State};
pub use variation::Variation;

use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::SolveError;
use crate::scalar::Real;
use core::marker::PhantomData;
use sticking::Ended;

/// A variational integrator: the step h, the path (which sets the order), and the bounds of Newton's method.
#[derive(Clone, Copy, Debug)]
pub struct Del<R, P> {
    h: R,
    newton: Newton<R>,
    path: PhantomData<P>,
}

impl<R: Real, P: Path> Del<R, P> {
    /// Creates an integrator of step h > 0, s, with the default bounds of Newton's method.
    pub fn new(h: R) -> Self {
        Self::with_newton(h, Newton::default())
    }

    /// Creates an integrator with the caller's bounds of Newton's method.
    pub const fn with_newton(h: R, newton: Newton<R>) -> Self {
        Self { h, newton, path: PhantomData }
    }

    /// Step size h, s.
    pub const fn h(&self) -> R {
        self.h
    }

    /// This integrator with another step h > 0, s.
    pub const fn with_step(&self, h: R) -> Self {
        Self::with_newton(h, self.newton)
    }

    /// Advances `state` by one step under the control `u`: initial guess → residual → Newton → update.
    ///
    /// An error leaves the state unchanged.
    pub fn step<L, F, const N: usize>(
        &self,
        system: &System<L, F>,
        state: &mut State<R, N>,
        u: &Control<R, N>,
    ) -> Result<Report<R>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        Ok(self.advanced(system, state, u, |_| Ok(()))?.0)
    }

    /// Advances `state` by one step, and returns what `look` sees in the solved path.
    #[inline(always)]
    fn advanced<L, F, T, const N: usize>(
        &self,
        system: &System<L, F>,
        state: &mut State<R, N>,
        u: &Control<R, N>,
        look: impl FnOnce(&Interval<R, P, N>) -> Result<T, SolveError>,
    ) -> Result<(Report<R>, T), StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let (guess, target) = (state.initial_guess::<P>(self.h, u), state.target());
        if system.forces.sticks() {
            let Ended { solved, end } = self.newton.solve_sticking(system, state.rested(guess), &target)?;
            let seen = look(&solved.interval)?;
            state.advance_to(self.h, &solved, &end)?;
            return Ok((solved.report, seen));
        }
        let solved = self.newton.solve_target(system, guess, &target)?;
        let seen = look(&solved.interval)?;
        state.advance(self.h, &solved)?;
        Ok((solved.report, seen))
    }

    /// Returns the state at q₁ that follows from two consecutive positions and the control between them: p₁ = D₂L_d(q₀, q₁) + f⁺. No
    /// velocity is needed.
    pub fn start<L, F, const N: usize>(
        &self,
        system: &System<L, F>,
        q0: &[R; N],
        q1: &[R; N],
        u: &Control<R, N>,
    ) -> Result<State<R, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let w = core::array::from_fn(|i| (q1[i] - q0[i]) / self.h);
        let guess = Interval::<R, P, N>::new(*q0, w, self.h, *u);
        if system.forces.sticks() {
            return State::with_momentum(*q1, self.newton.solve_sticking_ends(system, guess)?, w);
        }
        let solved = self.newton.solve_bubble(system, guess)?;
        State::with_momentum(*q1, solved.balance.end_momentum(), w)
    }
}
