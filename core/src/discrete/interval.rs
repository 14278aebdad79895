use super::{GaussPoint, Path};
use crate::forces::{Control, Forces, System};
use crate::lagrangian::{Gradient, Lagrangian, Linearization};
use crate::linear::{Matrix, add_scaled, add_scaled_matrix, transpose};
use crate::scalar::Real;
use core::marker::PhantomData;

/// One step's path: where it starts, its increment w and bubble s, and the control along it.
#[derive(Clone, Copy, Debug)]
pub struct Interval<R, P, const N: usize> {
    q0: [R; N],
    w: [R; N],
    s: [R; N],
    h: R,
    u: Control<R, N>,
    path: PhantomData<P>,
}

/// The sums over an interval that the step is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<R, const N: usize> {
    /// D₁L_d + f⁻ = Σ b [h(1 − c)F − L_v].
    pub d1_ld: [R; N],
    /// D_mL_d + f_m = Σ b [hβF + γL_v], to vanish; zero without a bubble.
    pub dm_ld: [R; N],
    /// h Σ b F, what the momentum gains: D₁L_d + D₂L_d with their forces.
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

    /// Adds a Gauss point's share. The step multiplies last, so that no constant such as h(1 − c) is rounded once for all steps.
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

/// The balance of an interval with the derivatives of its two equations in w and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearised<R, const N: usize> {
    /// The equations.
    pub balance: Balance<R, N>,
    /// ∂ d1_ld/∂w.
    pub momentum_w: Matrix<R, N>,
    /// ∂ d1_ld/∂s.
    pub momentum_s: Matrix<R, N>,
    /// ∂ dm_ld/∂w.
    pub bubble_w: Matrix<R, N>,
    /// ∂ dm_ld/∂s.
    pub bubble_s: Matrix<R, N>,
    /// Σ b [Σ_j |M_ij| (|v_j| + √ε |q_j|/h) + Σ_j |∂L_v,i/∂q_j q_j|] + h Σ b (|L_q,i| + |Q_i| + |τ_i| + Σ_j |∂Q_i/∂q_j q_j|):
    /// the size of the terms that rounding acts on, also where they cancel. With √ε it takes a residual as solved that would
    /// carry the system by no more than the rounding of its position: at rest nothing else is left of the terms.
    ///
    /// Every term has the unit of the momentum p_i, in whatever units coordinates are measured.
    pub scale: [R; N],
}

impl<R: Real, const N: usize> Linearised<R, N> {
    pub(super) fn zero() -> Self {
        let zero = [[R::zero(); N]; N];
        Self {
            balance: Balance::zero(),
            momentum_w: zero,
            momentum_s: zero,
            bubble_w: zero,
            bubble_s: zero,
            scale: [R::zero(); N],
        }
    }
}

/// How a first variation weighs F and L_v at a Gauss point: Σ b (force · F + momentum · L_v).
#[derive(Clone, Copy, Debug)]
pub struct Variation<R> {
    /// Weight of F = L_q + Q + u.
    pub force: R,
    /// Weight of L_v.
    pub momentum: R,
}

impl<R: Real> Variation<R> {
    /// D₁: of the start position.
    #[inline(always)]
    pub fn start(point: &GaussPoint<R>, h: R) -> Self {
        Self { force: h * (R::one() - point.c), momentum: -R::one() }
    }

    /// D₂: of the end position; also how position and velocity at the point move with hw.
    #[inline(always)]
    pub fn end(point: &GaussPoint<R>, h: R) -> Self {
        Self { force: h * point.c, momentum: R::one() }
    }

    /// D_m: of the bubble; also how position and velocity at the point move with s.
    #[inline(always)]
    pub fn bubble(point: &GaussPoint<R>, h: R) -> Self {
        Self { force: h * point.bubble(), momentum: point.bubble_rate() }
    }
}

/// F and L_v at a Gauss point with their derivatives.
struct PointDerivatives<R, const N: usize> {
    force: [R; N],
    l_v: [R; N],
    force_q: Matrix<R, N>,
    force_v: Matrix<R, N>,
    l_vq: Matrix<R, N>,
    l_vv: Matrix<R, N>,
    /// The terms of [`Linearised::scale`] at this point.
    scale: [R; N],
}

impl<R: Real, const N: usize> PointDerivatives<R, N> {
    /// (∂F, ∂L_v) when the point moves by `column`: position by its `force` part, velocity by its `momentum` part.
    #[inline]
    fn along(&self, column: Variation<R>) -> (Matrix<R, N>, Matrix<R, N>) {
        let mix = |q: &Matrix<R, N>, v: &Matrix<R, N>| -> Matrix<R, N> {
            core::array::from_fn(|i| {
                core::array::from_fn(|j| q[i][j] * column.force + v[i][j] * column.momentum)
            })
        };
        (mix(&self.force_q, &self.force_v), mix(&self.l_vq, &self.l_vv))
    }
}

/// Σ_j |a_j x_j|.
#[inline(always)]
fn sizes<R: Real, const N: usize>(a: &[R; N], x: &[R; N]) -> R {
    a.iter().zip(x).fold(R::zero(), |sum, (a, x)| sum + (*a * *x).abs())
}

/// Adds b(row.force · ∂F + row.momentum · ∂L_v).
#[inline(always)]
fn add_block<R: Real, const N: usize>(
    sum: &mut Matrix<R, N>,
    weight: R,
    row: Variation<R>,
    (force, l_v): &(Matrix<R, N>, Matrix<R, N>),
) {
    *sum = add_scaled_matrix(&add_scaled_matrix(sum, weight * row.force, force), weight * row.momentum, l_v);
}

impl<R: Real, P: Path, const N: usize> Interval<R, P, N> {
    /// A straight path from q₀ with increment w.
    pub fn new(q0: [R; N], w: [R; N], h: R, u: Control<R, N>) -> Self {
        Self { q0, w, s: [R::zero(); N], h, u, path: PhantomData }
    }

    /// w.
    pub fn increment(&self) -> [R; N] {
        self.w
    }

    /// s; zero at order 2.
    pub fn bubble(&self) -> [R; N] {
        self.s
    }

    /// The path with w and s changed by these amounts.
    #[must_use]
    pub fn moved(&self, dw: &[R; N], ds: &[R; N]) -> Self {
        self.moved_by(R::one(), dw, ds)
    }

    /// The path with w and s changed by a part of these amounts.
    #[must_use]
    #[inline(always)]
    pub(super) fn moved_by(&self, part: R, dw: &[R; N], ds: &[R; N]) -> Self {
        Self { w: add_scaled(&self.w, part, dw), s: add_scaled(&self.s, part, ds), ..*self }
    }

    /// The part of a change (dw, ds) after which Newton's method looks again, by what the laws of force say of the velocities at
    /// some Gauss points.
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

    /// What the forces' change with the velocity at the early Gauss points adds to ∂dm_ld/∂s.
    pub(super) fn early_force_s<F: Forces<R, N>>(&self, forces: &F) -> Matrix<R, N> {
        let mut sum = [[R::zero(); N]; N];
        for point in P::points().as_ref().iter().filter(|point| point.is_early()) {
            let (q, v) = self.point(point);
            let (_, force_v) = forces.derivatives(&q, &v, &self.u.at(point.c));
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
        (tau, system.forces.force(q, v, &tau))
    }

    /// From the derivatives of L at position and velocity `at` of a Gauss point; without L_qq where it is not given.
    #[inline(always)]
    fn derivatives<L, F: Forces<R, N>>(
        &self,
        system: &System<L, F>,
        point: &GaussPoint<R>,
        at: &([R; N], [R; N]),
        l: &Linearization<R, N>,
        l_qq: Option<&Matrix<R, N>>,
    ) -> PointDerivatives<R, N> {
        let (one, (q, v)) = (R::one(), at);
        let (tau, force) = self.forces(system, point, at);
        let (q_q, q_v) = system.forces.derivatives(q, v, &tau);
        let rounding = R::EPSILON.sqrt() / self.h.abs();
        let scale = core::array::from_fn(|i| {
            let forces = l.l_q[i].abs() + force[i].abs() + tau[i].abs() + sizes(&q_q[i], q);
            let moved = sizes(&l.l_vv[i], v) + rounding * sizes(&l.l_vv[i], q);
            moved + sizes(&l.l_vq[i], q) + self.h.abs() * forces
        });
        PointDerivatives {
            force: core::array::from_fn(|i| l.l_q[i] + force[i] + tau[i]),
            l_v: l.l_v,
            force_q: l_qq.map_or(q_q, |l_qq| add_scaled_matrix(l_qq, one, &q_q)),
            force_v: add_scaled_matrix(&transpose(&l.l_vq), one, &q_v),
            l_vq: l.l_vq,
            l_vv: l.l_vv,
            scale,
        }
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
    pub fn linearise<L, F>(&self, system: &System<L, F>) -> Linearised<R, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        self.summed(|point, at| {
            let hessian = system.lagrangian.hessian(&at.0, &at.1);
            self.derivatives(system, point, at, &hessian.into(), Some(&hessian.l_qq))
        })
    }

    /// The balance and its derivatives but for what L_qq adds to them: of a relative size of (hω)²/4 where ω is the fastest
    /// rate, rad/s, at which the system oscillates. One evaluation of [`Lagrangian::linearization`] at each Gauss point.
    pub fn linearise_without_l_qq<L, F>(&self, system: &System<L, F>) -> Linearised<R, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        self.summed(|point, at| {
            let l = system.lagrangian.linearization(&at.0, &at.1);
            self.derivatives(system, point, at, &l, None)
        })
    }

    /// Sums what is at the Gauss points.
    #[inline(always)]
    fn summed(
        &self,
        derivatives: impl Fn(&GaussPoint<R>, &([R; N], [R; N])) -> PointDerivatives<R, N>,
    ) -> Linearised<R, N> {
        let mut sum = Linearised::zero();
        for point in P::points().as_ref() {
            let d = derivatives(point, &self.point(point));
            let (start, along_w) = (Variation::start(point, self.h), d.along(Variation::end(point, self.h)));
            sum.balance.add(point, self.h, &d.force, &d.l_v, P::BUBBLE);
            sum.scale = add_scaled(&sum.scale, point.weight, &d.scale);
            add_block(&mut sum.momentum_w, point.weight, start, &along_w);
            if P::BUBBLE {
                let bubble = Variation::bubble(point, self.h);
                let along_s = d.along(bubble);
                add_block(&mut sum.momentum_s, point.weight, start, &along_s);
                add_block(&mut sum.bubble_w, point.weight, bubble, &along_w);
                add_block(&mut sum.bubble_s, point.weight, bubble, &along_s);
            }
        }
        sum
    }

    /// ∂(D₂L_d + f⁺)/∂s: how the momentum at the end moves with the bubble.
    pub fn end_momentum_s<L, F>(&self, system: &System<L, F>) -> Matrix<R, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let mut sum = [[R::zero(); N]; N];
        for point in P::points().as_ref() {
            let at = self.point(point);
            let hessian = system.lagrangian.hessian(&at.0, &at.1);
            let d = self.derivatives(system, point, &at, &hessian.into(), Some(&hessian.l_qq));
            let along_s = d.along(Variation::bubble(point, self.h));
            add_block(&mut sum, point.weight, Variation::end(point, self.h), &along_s);
        }
        sum
    }
}
