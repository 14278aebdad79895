use super::variation::{PointDerivatives, Variation};
use super::{GaussPoint, Path};
use crate::forces::{Control, Forces, System};
use crate::lagrangian::{Gradient, Lagrangian, Linearization};
use crate::linear::{Matrix, add_scaled, add_scaled_matrix};
use crate::scalar::Real;
use core::marker::PhantomData;

/// The path of one step: its start q₀, increment w and bubble s, and the control along it.
#[derive(Clone, Copy, Debug)]
pub struct Interval<R, P, const N: usize> {
    q0: [R; N],
    w: [R; N],
    s: [R; N],
    pub(super) h: R,
    pub(super) u: Control<R, N>,
    path: PhantomData<P>,
}

/// Sums over an interval that make up the equations of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<R, const N: usize> {
    /// D₁L_d + f⁻ = Σ b [h(1 − c)F − L_v].
    pub d1_ld: [R; N],
    /// D_mL_d + f_m = Σ b [hβF + γL_v], which must vanish; zero without a bubble.
    pub dm_ld: [R; N],
    /// h Σ b F, the gain of momentum: D₁L_d + D₂L_d with their forces.
    pub impulse: [R; N],
}

impl<R: Real, const N: usize> Balance<R, N> {
    fn zero() -> Self {
        let zero = [R::zero(); N];
        Self { d1_ld: zero, dm_ld: zero, impulse: zero }
    }

    /// p₁ = D₂L_d + f⁺, the momentum at the end of the interval, from the path alone.
    pub fn end_momentum(&self) -> [R; N] {
        core::array::from_fn(|i| self.impulse[i] - self.d1_ld[i])
    }

    /// Adds the share of a Gauss point. h is multiplied last, so no constant such as h(1 − c) repeats the same
    /// rounding error in all steps.
    #[inline(always)]
    fn add(&mut self, point: &GaussPoint<R>, h: R, force: &[R; N], l_v: &[R; N], bubble: bool) {
        let (b, early) = (point.weight, R::one() - point.c);
        let (beta, gamma) = (point.bubble(), point.bubble_rate());
        for i in 0..N {
            self.d1_ld[i] += b * (h * (early * force[i]) - l_v[i]);
            if bubble {
                self.dm_ld[i] += b * (h * (beta * force[i]) + gamma * l_v[i]);
            }
            self.impulse[i] += h * (b * force[i]);
        }
    }
}

/// The balance of an interval, and the derivatives of its equations in w and s.
#[derive(Clone, Copy, Debug)]
pub struct Linearised<R: Real, P: Path, const N: usize> {
    /// The sums of the equations.
    pub balance: Balance<R, N>,
    /// ∂ d1_ld/∂w.
    pub momentum_w: Matrix<R, N>,
    /// Derivatives that a bubble adds, if the path has one.
    pub bubble: P::Bubbles<BubbleDerivatives<R, N>>,
    /// Σ b [Σ_j |M_ij| (|v_j| + √ε |q_j|/h) + Σ_j |∂L_v,i/∂q_j q_j|] + h Σ b (|L_q,i| + |Q_i| + |τ_i| + Σ_j |∂Q_i/∂q_j q_j|): the size of
    /// the terms that rounding acts on, even if they cancel. The term with √ε accepts a residual that would
    /// move the system by no more than the rounding of its position; at rest it is the only term left.
    ///
    /// Every term has the unit of the momentum p_i, whatever the units of the coordinates.
    pub scale: [R; N],
}

/// Derivatives that a bubble adds to those of the equations of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BubbleDerivatives<R, const N: usize> {
    /// ∂ d1_ld/∂s.
    pub momentum_s: Matrix<R, N>,
    /// ∂ dm_ld/∂w.
    pub bubble_w: Matrix<R, N>,
    /// ∂ dm_ld/∂s.
    pub bubble_s: Matrix<R, N>,
}

impl<R: Real, P: Path, const N: usize> Linearised<R, P, N> {
    pub(super) fn zero() -> Self {
        let zero = [[R::zero(); N]; N];
        let bubble = P::bubbles(BubbleDerivatives { momentum_s: zero, bubble_w: zero, bubble_s: zero });
        Self { balance: Balance::zero(), momentum_w: zero, bubble, scale: [R::zero(); N] }
    }
}

/// Σ_j |a_j x_j|.
#[inline(always)]
fn sizes<R: Real, const N: usize>(a: &[R; N], x: &[R; N]) -> R {
    a.iter().zip(x).fold(R::zero(), |sum, (a, x)| sum + (*a * *x).abs())
}

impl<R: Real, P: Path, const N: usize> Interval<R, P, N> {
    /// Creates a straight path from q₀ with increment w.
    pub fn new(q0: [R; N], w: [R; N], h: R, u: Control<R, N>) -> Self {
        Self { q0, w, s: [R::zero(); N], h, u, path: PhantomData }
    }

    /// Increment w.
    pub fn increment(&self) -> [R; N] {
        self.w
    }

    /// Bubble s; zero at order 2.
    pub fn bubble(&self) -> [R; N] {
        self.s
    }

    /// The path with w and s changed by dw and ds.
    #[must_use]
    pub fn moved(&self, dw: &[R; N], ds: &[R; N]) -> Self {
        self.moved_by(R::one(), dw, ds)
    }

    /// The path with w and s changed by `part` times dw and ds.
    #[must_use]
    #[inline(always)]
    pub(super) fn moved_by(&self, part: R, dw: &[R; N], ds: &[R; N]) -> Self {
        Self { w: add_scaled(&self.w, part, dw), s: add_scaled(&self.s, part, ds), ..*self }
    }

    /// The path with these increments, and no bubble, where they are given.
    #[must_use]
    pub(super) fn with_increments(&self, given: &[Option<R>; N]) -> Self {
        let w = core::array::from_fn(|i| given[i].unwrap_or(self.w[i]));
        let s = core::array::from_fn(|i| if given[i].is_some() { R::zero() } else { self.s[i] });
        Self { w, s, ..*self }
    }

    /// Position q₀ at the start.
    pub(super) fn start(&self) -> &[R; N] {
        &self.q0
    }

    /// Position q₁ at the end.
    pub(super) fn end(&self) -> [R; N] {
        add_scaled(&self.q0, self.h, &self.w)
    }

    /// The fraction of a change (dw, ds) that Newton's method takes before it evaluates again. The force laws
    /// limit it by the velocities at the Gauss points that `at` selects.
    #[inline(always)]
    pub(super) fn trusted_part<F: Forces<R, N>>(
        &self,
        forces: &F,
        (dw, ds): (&[R; N], &[R; N]),
        at: impl Fn(&GaussPoint<R>) -> bool,
    ) -> R {
        P::points().as_ref().iter().filter(|point| at(point)).fold(R::one(), |least, point| {
            let dv = if P::BUBBLE { add_scaled(dw, point.bubble_rate(), ds) } else { *dw };
            let part = forces.trusted_part(&self.point(point).1, &dv);
            if part < least { part } else { least }
        })
    }

    /// Part of ∂dm_ld/∂s from the forces' dependence on velocity at the early Gauss points.
    pub(super) fn early_force_s<F: Forces<R, N>>(&self, forces: &F) -> Matrix<R, N> {
        let mut sum = [[R::zero(); N]; N];
        for point in P::points().as_ref().iter().filter(|point| point.is_early()) {
            let (q, v) = self.point(point);
            let (_, force_v) = forces.single_valued_derivatives(&q, &v, &self.u.at(point.c));
            let Variation { force, momentum } = Variation::bubble(point, self.h);
            sum = add_scaled_matrix(&sum, point.weight * force * momentum, &force_v);
        }
        sum
    }

    /// Position and velocity at a Gauss point.
    #[inline]
    pub fn point(&self, point: &GaussPoint<R>) -> ([R; N], [R; N]) {
        if !P::BUBBLE {
            return (add_scaled(&self.q0, self.h * point.c, &self.w), self.w);
        }
        let (beta, gamma) = (point.bubble(), point.bubble_rate());
        let q = core::array::from_fn(|i| self.q0[i] + self.h * (point.c * self.w[i] + beta * self.s[i]));
        (q, add_scaled(&self.w, gamma, &self.s))
    }

    /// (τ, Q) at a Gauss point.
    #[inline(always)]
    fn forces<L, F: Forces<R, N>>(
        &self,
        system: &System<L, F>,
        point: &GaussPoint<R>,
        (q, v): &([R; N], [R; N]),
    ) -> ([R; N], [R; N]) {
        let tau = self.u.at(point.c);
        (tau, system.forces.single_valued(q, v, &tau))
    }

    /// The balance from first derivatives alone.
    pub fn balance<L, F>(&self, system: &System<L, F>) -> Balance<R, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let mut balance = Balance::zero();
        for point in P::points().as_ref() {
            let at = self.point(point);
            let Gradient { l_q, l_v } = system.lagrangian.gradient(&at.0, &at.1);
            let (tau, force) = self.forces(system, point, &at);
            let force = core::array::from_fn(|i| l_q[i] + force[i] + tau[i]);
            balance.add(point, self.h, &force, &l_v, P::BUBBLE);
        }
        balance
    }

    /// The balance and its exact derivatives.
    pub fn linearise<L, F>(&self, system: &System<L, F>) -> Linearised<R, P, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let mut sum = Linearised::zero();
        for point in P::points().as_ref() {
            let at = self.point(point);
            let hessian = system.lagrangian.hessian(&at.0, &at.1);
            self.add_point(&mut sum, system, (point, &at), (&hessian.into(), Some(&hessian.l_qq)));
        }
        sum
    }

    /// The balance, and its derivatives without the terms of L_qq, which have a relative size of (hω)²/4, with ω the fastest rate, rad/s,
    /// at which the system oscillates. Takes one evaluation of [`Lagrangian::linearization`] at each Gauss point.
    pub fn linearise_without_l_qq<L, F>(&self, system: &System<L, F>) -> Linearised<R, P, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let mut sum = Linearised::zero();
        for point in P::points().as_ref() {
            let at = self.point(point);
            let l = system.lagrangian.linearization(&at.0, &at.1);
            self.add_point(&mut sum, system, (point, &at), (&l, None));
        }
        sum
    }

    /// Adds the share of a Gauss point from the derivatives of L there; without L_qq if it is not given.
    #[inline(always)]
    fn add_point<L, F: Forces<R, N>>(
        &self,
        sum: &mut Linearised<R, P, N>,
        system: &System<L, F>,
        (point, at): (&GaussPoint<R>, &([R; N], [R; N])),
        (l, l_qq): (&Linearization<R, N>, Option<&Matrix<R, N>>),
    ) {
        let (tau, force) = self.forces(system, point, at);
        let d =
            PointDerivatives { l, l_qq, forces: system.forces.single_valued_derivatives(&at.0, &at.1, &tau) };
        let total = core::array::from_fn(|i| l.l_q[i] + force[i] + tau[i]);
        sum.balance.add(point, self.h, &total, &l.l_v, P::BUBBLE);
        for (i, scale) in sum.scale.iter_mut().enumerate() {
            let forces = l.l_q[i].abs() + force[i].abs() + tau[i].abs();
            *scale += point.weight * self.scale(&d, i, at, forces);
        }
        let (b, start, end) = (point.weight, Variation::start(point, self.h), Variation::end(point, self.h));
        match sum.bubble.as_mut().first_mut() {
            None => d.add(b, end, [(start, &mut sum.momentum_w)]),
            Some(blocks) => {
                let bubble = Variation::bubble(point, self.h);
                d.add(b, end, [(start, &mut sum.momentum_w), (bubble, &mut blocks.bubble_w)]);
                d.add(b, bubble, [(start, &mut blocks.momentum_s), (bubble, &mut blocks.bubble_s)]);
            }
        }
    }

    /// Terms of [`Linearised::scale`] for coordinate i at a Gauss point; `forces` is the size of the forces there.
    #[inline(always)]
    fn scale(&self, d: &PointDerivatives<R, N>, i: usize, (q, v): &([R; N], [R; N]), forces: R) -> R {
        let rounding = R::EPSILON.sqrt() / self.h.abs();
        let moved = sizes(&d.l.l_vv[i], v) + rounding * sizes(&d.l.l_vv[i], q);
        moved + sizes(&d.l.l_vq[i], q) + self.h.abs() * (forces + sizes(&d.forces.0[i], q))
    }

    /// ∂(D₂L_d + f⁺)/∂s: derivative of the momentum at the end in the bubble.
    pub fn end_momentum_s<L, F>(&self, system: &System<L, F>) -> Matrix<R, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let mut sum = [[R::zero(); N]; N];
        for point in P::points().as_ref() {
            let at = self.point(point);
            let (tau, hessian) = (self.u.at(point.c), system.lagrangian.hessian(&at.0, &at.1));
            let forces = system.forces.derivatives(&at.0, &at.1, &tau);
            let d = PointDerivatives { l: &hessian.into(), l_qq: Some(&hessian.l_qq), forces };
            let end = (Variation::end(point, self.h), &mut sum);
            d.add(point.weight, Variation::bubble(point, self.h), [end]);
        }
        sum
    }
}
