use super::{Node, Path};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{add_scaled, add_scaled_matrix, transpose};
use crate::scalar::Real;
use core::marker::PhantomData;

/// The control force at both ends of an interval; linear between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control<R, const N: usize> {
    /// u at the start.
    pub start: [R; N],
    /// u at the end.
    pub end: [R; N],
}

impl<R: Real, const N: usize> Control<R, N> {
    /// The same force at both ends (zero-order hold).
    pub fn held(u: [R; N]) -> Self {
        Self { start: u, end: u }
    }

    /// No control.
    pub fn none() -> Self {
        Self::held([R::zero(); N])
    }

    #[inline(always)]
    fn at(&self, tau: R) -> [R; N] {
        core::array::from_fn(|i| self.start[i] * (R::one() - tau) + self.end[i] * tau)
    }
}

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
    /// D₁L_d + f⁻ = Σ b [h(1 − τ)F − L_v].
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

    /// Adds a node's share. The step multiplies last, so that no constant such as h(1 − τ) is rounded once for all steps.
    #[inline(always)]
    fn add(&mut self, node: &Node<R>, h: R, force: &[R; N], l_v: &[R; N], bubble: bool) {
        let (b, early) = (node.weight, R::one() - node.tau);
        let (beta, gamma) = (node.bubble(), node.bubble_rate());
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

/// How a first variation weighs F and L_v at a node: Σ b (force · F + momentum · L_v).
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
    pub fn start(node: &Node<R>, h: R) -> Self {
        Self { force: h * (R::one() - node.tau), momentum: -R::one() }
    }

    /// D₂: of the end position; also how position and velocity at the node move with hw.
    #[inline(always)]
    pub fn end(node: &Node<R>, h: R) -> Self {
        Self { force: h * node.tau, momentum: R::one() }
    }

    /// D_m: of the bubble; also how position and velocity at the node move with s.
    #[inline(always)]
    pub fn bubble(node: &Node<R>, h: R) -> Self {
        Self { force: h * node.bubble(), momentum: node.bubble_rate() }
    }
}

/// F and L_v at a node with their derivatives along a family of paths.
struct NodeDerivatives<R, const N: usize> {
    force: [R; N],
    l_v: [R; N],
    force_q: [[R; N]; N],
    force_v: [[R; N]; N],
    l_vq: [[R; N]; N],
    l_vv: [[R; N]; N],
}

impl<R: Real, const N: usize> NodeDerivatives<R, N> {
    /// (∂F, ∂L_v) when the node moves by `column`: position by its `force` part, velocity by its `momentum` part.
    #[inline]
    fn along(&self, column: Variation<R>) -> ([[R; N]; N], [[R; N]; N]) {
        let mix = |q: &[[R; N]; N], v: &[[R; N]; N]| -> [[R; N]; N] {
            core::array::from_fn(|i| {
                core::array::from_fn(|j| q[i][j] * column.force + v[i][j] * column.momentum)
            })
        };
        (mix(&self.force_q, &self.force_v), mix(&self.l_vq, &self.l_vv))
    }

    /// The terms of [`Linearised::scale`] at this node.
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

    /// Position and velocity at a node.
    #[inline]
    pub fn point(&self, node: &Node<R>) -> ([R; N], [R; N]) {
        if !P::BUBBLE {
            return (add_scaled(&self.q0, self.h * node.tau, &self.w), self.w);
        }
        let (beta, gamma) = (node.bubble(), node.bubble_rate());
        let q = core::array::from_fn(|i| self.q0[i] + self.h * (node.tau * self.w[i] + beta * self.s[i]));
        (q, add_scaled(&self.w, gamma, &self.s))
    }

    #[inline]
    fn total_force<L, F: Forces<R, N>>(
        &self,
        system: &System<L, F>,
        node: &Node<R>,
        q: &[R; N],
        v: &[R; N],
        l_q: &[R; N],
    ) -> [R; N] {
        let (u, force) = (self.u.at(node.tau), system.forces.force(q, v));
        core::array::from_fn(|i| l_q[i] + force[i] + u[i])
    }

    #[inline]
    fn derivatives<L, F>(
        &self,
        system: &System<L, F>,
        node: &Node<R>,
        q: &[R; N],
        v: &[R; N],
    ) -> NodeDerivatives<R, N>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let d = system.lagrangian.hessian(q, v);
        let (q_q, q_v) = system.forces.derivatives(q, v);
        let one = R::one();
        NodeDerivatives {
            force: self.total_force(system, node, q, v, &d.l_q),
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
        for node in P::nodes().as_ref() {
            let (q, v) = self.point(node);
            let gradient = system.lagrangian.gradient(&q, &v);
            let force = self.total_force(system, node, &q, &v, &gradient.l_q);
            balance.add(node, self.h, &force, &gradient.l_v, P::BUBBLE);
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
        for node in P::nodes().as_ref() {
            let (q, v) = self.point(node);
            let d = self.derivatives(system, node, &q, &v);
            let (start, along_w) = (Variation::start(node, self.h), d.along(Variation::end(node, self.h)));
            sum.balance.add(node, self.h, &d.force, &d.l_v, P::BUBBLE);
            let size = d.size(&q, &v, self.h);
            sum.scale = add_scaled(&sum.scale, node.weight, &size);
            add_block(&mut sum.momentum_w, node.weight, start, &along_w);
            if P::BUBBLE {
                let bubble = Variation::bubble(node, self.h);
                let along_s = d.along(bubble);
                add_block(&mut sum.momentum_s, node.weight, start, &along_s);
                add_block(&mut sum.bubble_w, node.weight, bubble, &along_w);
                add_block(&mut sum.bubble_s, node.weight, bubble, &along_s);
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
        for node in P::nodes().as_ref() {
            let (q, v) = self.point(node);
            let along_s = self.derivatives(system, node, &q, &v).along(Variation::bubble(node, self.h));
            add_block(&mut sum, node.weight, Variation::end(node, self.h), &along_s);
        }
        sum
    }
}
