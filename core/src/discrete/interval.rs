use super::{GaussPoint, Path};
use crate::forces::{Control, Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{add_scaled, add_scaled_matrix, transpose};
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
    pub momentum_w: [[R; N]; N],
    /// ∂ d1_ld/∂s.
    pub momentum_s: [[R; N]; N],
    /// ∂ dm_ld/∂w.
    pub bubble_w: [[R; N]; N],
    /// ∂ dm_ld/∂s.
    pub bubble_s: [[R; N]; N],
    /// Σ b Σ_j (|M_ij v_j| + |∂L_v,i/∂q_j| max(1, |q_j|)) + h Σ b (|F_i| + Σ_j |∂F_i/∂q_j| max(1, |q_j|)): the size of the
    /// terms that rounding acts on, also where they cancel (a momentum of zero, a force in equilibrium).
    pub scale: [R; N],
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

/// F and L_v at a Gauss point with their derivatives along a family of paths.
struct PointDerivatives<R, const N: usize> {
    force: [R; N],
    l_v: [R; N],
    force_q: [[R; N]; N],
    force_v: [[R; N]; N],
    l_vq: [[R; N]; N],
    l_vv: [[R; N]; N],
}

impl<R: Real, const N: usize> PointDerivatives<R, N> {
    /// (∂F, ∂L_v) when the point moves by `column`: position by its `force` part, velocity by its `momentum` part.
    #[inline]
    fn along(&self, column: Variation<R>) -> ([[R; N]; N], [[R; N]; N]) {
        let mix = |q: &[[R; N]; N], v: &[[R; N]; N]| -> [[R; N]; N] {
            core::array::from_fn(|i| {
                core::array::from_fn(|j| q[i][j] * column.force + v[i][j] * column.momentum)
            })
        };
        (mix(&self.force_q, &self.force_v), mix(&self.l_vq, &self.l_vv))
    }

    /// The terms of [`Linearised::scale`] at this point.
    #[inline]
    fn size(&self, q: &[R; N], v: &[R; N], h: R) -> [R; N] {
        core::array::from_fn(|i| {
            let in_q = |row: &[R; N]| sum(row, q, |slope, q| slope.abs() * q.abs().max(R::one()));
            let momentum = sum(&self.l_vv[i], v, |m, v| (m * v).abs()) + in_q(&self.l_vq[i]);
            momentum + h * (self.force[i].abs() + in_q(&self.force_q[i]))
        })
    }
}

/// Σ_j f(a_j, b_j).
#[inline(always)]
fn sum<R: Real, const N: usize>(a: &[R; N], b: &[R; N], f: impl Fn(R, R) -> R) -> R {
    a.iter().zip(b).fold(R::zero(), |sum, (a, b)| sum + f(*a, *b))
}

/// Adds b(row.force · ∂F + row.momentum · ∂L_v).
#[inline(always)]
fn add_block<R: Real, const N: usize>(
    sum: &mut [[R; N]; N],
    weight: R,
    row: Variation<R>,
    (force, l_v): &([[R; N]; N], [[R; N]; N]),
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
        let one = R::one();
        Self { w: add_scaled(&self.w, one, dw), s: add_scaled(&self.s, one, ds), ..*self }
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

    #[inline]
    fn total_force<L, F: Forces<R, N>>(
        &self,
        system: &System<L, F>,
        point: &GaussPoint<R>,
        q: &[R; N],
        v: &[R; N],
        l_q: &[R; N],
    ) -> [R; N] {
        let u = self.u.at(point.c);
        let force = system.forces.force(q, v, &u);
        core::array::from_fn(|i| l_q[i] + force[i] + u[i])
    }

    #[inline]
    fn derivatives<L, F>(
        &self,
        system: &System<L, F>,
        point: &GaussPoint<R>,
        q: &[R; N],
        v: &[R; N],
    ) -> PointDerivatives<R, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let d = system.lagrangian.hessian(q, v);
        let (q_q, q_v) = system.forces.derivatives(q, v, &self.u.at(point.c));
        let one = R::one();
        PointDerivatives {
            force: self.total_force(system, point, q, v, &d.l_q),
            l_v: d.l_v,
            force_q: add_scaled_matrix(&d.l_qq, one, &q_q),
            force_v: add_scaled_matrix(&transpose(&d.l_vq), one, &q_v),
            l_vq: d.l_vq,
            l_vv: d.l_vv,
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
            let (q, v) = self.point(point);
            let gradient = system.lagrangian.gradient(&q, &v);
            let force = self.total_force(system, point, &q, &v, &gradient.l_q);
            balance.add(point, self.h, &force, &gradient.l_v, P::BUBBLE);
        }
        balance
    }

    /// The balance and its derivatives.
    pub fn linearise<L, F>(&self, system: &System<L, F>) -> Linearised<R, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let zero = [[R::zero(); N]; N];
        let balance = Balance::zero();
        let mut sum = Linearised {
            balance,
            momentum_w: zero,
            momentum_s: zero,
            bubble_w: zero,
            bubble_s: zero,
            scale: [R::zero(); N],
        };
        for point in P::points().as_ref() {
            let (q, v) = self.point(point);
            let d = self.derivatives(system, point, &q, &v);
            let (start, along_w) = (Variation::start(point, self.h), d.along(Variation::end(point, self.h)));
            sum.balance.add(point, self.h, &d.force, &d.l_v, P::BUBBLE);
            let size = d.size(&q, &v, self.h);
            sum.scale = add_scaled(&sum.scale, point.weight, &size);
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
    pub fn end_momentum_s<L, F>(&self, system: &System<L, F>) -> [[R; N]; N]
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let mut sum = [[R::zero(); N]; N];
        for point in P::points().as_ref() {
            let (q, v) = self.point(point);
            let along_s = self.derivatives(system, point, &q, &v).along(Variation::bubble(point, self.h));
            add_block(&mut sum, point.weight, Variation::end(point, self.h), &along_s);
        }
        sum
    }
}
