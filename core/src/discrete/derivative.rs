//! Derivatives of a step's end with respect to its start and to the control.
//!
//! A step maps (q₀, p₀, τ) to (q₁, p₁). With R_m = p₀ + d1_ld and R_b = dm_ld its equations in the increment w and the bubble s, a change of
//! the start or of τ moves the solution by
//!
//! R_w dw + R_s ds = −∂R,  dq₁ = dq₀ + h dw,  dp₁ = dp₀ + ∂impulse + impulse_w dw + impulse_s ds.
//!
//! Unlike Newton's matrix, the derivatives contain L_qq ([`Lagrangian::hessian`]). They are exact for the step as it is computed, so without
//! dissipation A = ∂(q₁, p₁)/∂(q₀, p₀) is symplectic, AᵀJA = J, to rounding. Only programs that call [`Interval::end_derivative`] contain
//! the code.

use super::variation::{PointDerivatives, Variation};
use super::{Control, Del, GaussPoint, Interval, Path, State, StepError};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{Matrix, SolveError, add_scaled_matrix, identity, product, solve_columns};
use crate::scalar::Real;

/// Derivative of a step's end with respect to one quantity; entry \[i\]\[j\] is that of component i in component j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndDerivative<R, const N: usize> {
    /// Derivative of the position q₁.
    pub q: Matrix<R, N>,
    /// Derivative of the momentum p₁.
    pub p: Matrix<R, N>,
}

impl<R: Real, const N: usize> EndDerivative<R, N> {
    /// The sum of two derivatives.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let add = |a, b| add_scaled_matrix(a, R::one(), b);
        Self { q: add(&self.q, &other.q), p: add(&self.p, &other.p) }
    }
}

/// Derivatives of a step's end (q₁, p₁).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepDerivative<R, const N: usize> {
    /// Derivative with respect to the position q₀.
    pub by_q: EndDerivative<R, N>,
    /// Derivative with respect to the momentum p₀.
    pub by_p: EndDerivative<R, N>,
    /// Derivative with respect to the control τ at the start of the step.
    pub by_start: EndDerivative<R, N>,
    /// Derivative with respect to the control τ at the end of the step.
    pub by_end: EndDerivative<R, N>,
}

impl<R: Real, const N: usize> StepDerivative<R, N> {
    /// B = ∂(q₁, p₁)/∂τ for a control that is held over the step.
    pub fn by_held(&self) -> EndDerivative<R, N> {
        self.by_start.plus(&self.by_end)
    }
}

/// Derivatives of the sums of an interval ([`Balance`](super::Balance)) with respect to one quantity.
#[derive(Clone, Copy, Debug)]
struct SumDerivatives<R, const N: usize> {
    d1_ld: Matrix<R, N>,
    dm_ld: Matrix<R, N>,
    impulse: Matrix<R, N>,
}

impl<R: Real, const N: usize> SumDerivatives<R, N> {
    fn zero() -> Self {
        let zero = [[R::zero(); N]; N];
        Self { d1_ld: zero, dm_ld: zero, impulse: zero }
    }

    /// Adds the share of a Gauss point that moves by `column`.
    #[inline(always)]
    fn add(
        &mut self,
        (point, h): (&GaussPoint<R>, R),
        d: &PointDerivatives<R, N>,
        column: Variation<R>,
        bubble: bool,
    ) {
        let (start, gain) = (Variation::start(point, h), Variation::impulse(h));
        d.add(point.weight, column, [(start, &mut self.d1_ld), (gain, &mut self.impulse)]);
        if bubble {
            d.add(point.weight, column, [(Variation::bubble(point, h), &mut self.dm_ld)]);
        }
    }

    /// Adds the share of a Gauss point at which the force changes by `force` of the control.
    #[inline(always)]
    fn add_force(&mut self, (point, h): (&GaussPoint<R>, R), force: &Matrix<R, N>, bubble: bool) {
        let b = point.weight;
        let add =
            |to: &mut Matrix<R, N>, row: Variation<R>| *to = add_scaled_matrix(to, b * row.force, force);
        add(&mut self.d1_ld, Variation::start(point, h));
        add(&mut self.impulse, Variation::impulse(h));
        if bubble {
            add(&mut self.dm_ld, Variation::bubble(point, h));
        }
    }
}

/// Derivatives of the sums of an interval with respect to all that determines them.
struct Derivatives<R, const N: usize> {
    by_q: SumDerivatives<R, N>,
    by_w: SumDerivatives<R, N>,
    by_s: SumDerivatives<R, N>,
    /// Derivatives with respect to τ at the start and at the end.
    by_tau: [SumDerivatives<R, N>; 2],
}

impl<R: Real, const N: usize> Derivatives<R, N> {
    /// Adds the share of a Gauss point from the derivatives there and from 1 + ∂Q/∂τ.
    #[inline(always)]
    fn add<P: Path>(
        &mut self,
        (point, h): (&GaussPoint<R>, R),
        d: &PointDerivatives<R, N>,
        force_tau: &Matrix<R, N>,
    ) {
        let at = (point, h);
        self.by_q.add(at, d, Variation::shift(), P::BUBBLE);
        self.by_w.add(at, d, Variation::end(point, h), P::BUBBLE);
        if P::BUBBLE {
            self.by_s.add(at, d, Variation::bubble(point, h), true);
        }
        for (sums, share) in self.by_tau.iter_mut().zip([R::one() - point.c, point.c]) {
            sums.add_force(at, &force_tau.map(|row| row.map(|x| share * x)), P::BUBBLE);
        }
    }

    /// dp₁ − dp₀ and dw that follow from the change `by` of the sums.
    fn response<P: Path>(&self, by: &SumDerivatives<R, N>) -> Result<[Matrix<R, N>; 2], SolveError> {
        let minus = -R::one();
        if !P::BUBBLE {
            let dw = solve_columns(self.by_w.d1_ld, &by.d1_ld)?.map(|row| row.map(|x| -x));
            return Ok([add_scaled_matrix(&by.impulse, R::one(), &product(&self.by_w.impulse, &dw)), dw]);
        }
        let free = solve_columns(self.by_s.dm_ld, &by.dm_ld)?;
        let slaved = solve_columns(self.by_s.dm_ld, &self.by_w.dm_ld)?;
        let reduced = add_scaled_matrix(&self.by_w.d1_ld, minus, &product(&self.by_s.d1_ld, &slaved));
        let right = add_scaled_matrix(&product(&self.by_s.d1_ld, &free), minus, &by.d1_ld);
        let dw = solve_columns(reduced, &right)?;
        let ds = add_scaled_matrix(&free, R::one(), &product(&slaved, &dw)).map(|row| row.map(|x| -x));
        let dp = add_scaled_matrix(&by.impulse, R::one(), &product(&self.by_w.impulse, &dw));
        Ok([add_scaled_matrix(&dp, R::one(), &product(&self.by_s.impulse, &ds)), dw])
    }
}

impl<R: Real, P: Path, const N: usize> Interval<R, P, N> {
    /// Derivatives of the end (q₁, p₁) of a solved path. Takes one evaluation of [`Lagrangian::hessian`] at each Gauss point.
    ///
    /// # Errors
    /// [`SolveError`] if the matrix of the step is singular or a number is not finite.
    pub fn end_derivative<L, F>(&self, system: &System<L, F>) -> Result<StepDerivative<R, N>, SolveError>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let (h, zero) = (self.h, SumDerivatives::zero());
        let mut sums = Derivatives { by_q: zero, by_w: zero, by_s: zero, by_tau: [zero; 2] };
        for point in P::points().as_ref() {
            let ((q, v), tau) = (self.point(point), self.u.at(point.c));
            let hessian = system.lagrangian.hessian(&q, &v);
            let (l, forces) = (hessian.into(), system.forces.derivatives(&q, &v, &tau));
            let d = PointDerivatives { l: &l, l_qq: Some(&hessian.l_qq), forces };
            let load = system.forces.load_derivative(&q, &v, &tau);
            sums.add::<P>((point, h), &d, &add_scaled_matrix(&identity(), R::one(), &load));
        }
        let (none, one) = ([[R::zero(); N]; N], identity());
        let by_p = SumDerivatives { d1_ld: one, ..zero };
        let end = |by: &SumDerivatives<R, N>, q0: &Matrix<R, N>, p0: &Matrix<R, N>| {
            let [dp, dw] = sums.response::<P>(by)?;
            Ok(EndDerivative { q: add_scaled_matrix(q0, h, &dw), p: add_scaled_matrix(p0, R::one(), &dp) })
        };
        let [start, at_end] = &sums.by_tau;
        Ok(StepDerivative {
            by_q: end(&sums.by_q, &one, &none)?,
            by_p: end(&by_p, &none, &one)?,
            by_start: end(start, &none, &none)?,
            by_end: end(at_end, &none, &none)?,
        })
    }
}

impl<R: Real, P: Path> Del<R, P> {
    /// Advances `state` by one step like [`Del::step`], and returns the derivatives of the step's end.
    ///
    /// # Errors
    /// See [`Del::step`]. An error leaves the state unchanged.
    pub fn step_with_derivative<L, F, const N: usize>(
        &self,
        system: &System<L, F>,
        state: &mut State<R, N>,
        u: &Control<R, N>,
    ) -> Result<StepDerivative<R, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        Ok(self.advanced(system, state, u, |path| path.end_derivative(system))?.1)
    }
}
