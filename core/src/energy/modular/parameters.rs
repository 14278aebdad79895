//! Derivatives in the weights, for training.

use super::element::Motion;
use super::potential::Moving;
use super::tree::{Vector, add, scale};
use super::{Configuration, ElementType, Modular, PotentialTerm, dot};
use crate::energy::Learnable;
use crate::energy::placed_network::WeightTangents;
use crate::expected::expected;
use crate::network::Jet;
use crate::scalar::{Scalar, WeightFormat};

/// Two displacements of the coordinates in Σ α·(JᵀmJ)β, one term of a derivative of the kinetic energy.
struct Bilinear<'m, S, const N: usize> {
    alpha: &'m [Vector<S>; N],
    beta: &'m [Vector<S>; N],
}

impl<S: Scalar, const N: usize, const E: usize, const H: usize, const L: usize> Learnable<S, N>
    for Modular<'_, S::Weight, N, E, H, L>
{
    /// With a = δq v g′ + δv g and b = g v the kinetic part is Σ a·JᵀmJ b + δv I v; the potential part is −V_x·J(s′δq).
    fn directional_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        (dq, dv): (&[S; N], &[S; N]),
        mut row: impl FnMut(usize, S),
    ) {
        let c = self.configuration::<S, 2>(q);
        let a = core::array::from_fn(|j| {
            add(&scale(dq[j] * v[j], &c.motion[j].g_q), &scale(dv[j], &c.motion[j].g))
        });
        let b = core::array::from_fn(|j| scale(v[j], &c.motion[j].g));
        let (of_a, of_b) = (self.inertial(&c, &b), self.inertial(&c, &a));
        let mut bar: [Motion<S>; N] = self.potential_part(&c, dq, &mut row);
        for j in 0..N {
            bar[j].g = add(&scale(dv[j], &of_a[j]), &scale(v[j], &of_b[j]));
            bar[j].g_q = scale(dq[j] * v[j], &of_a[j]);
        }
        self.number_part(
            &c,
            &Bilinear { alpha: &a, beta: &b },
            &core::array::from_fn(|j| dv[j] * v[j]),
            &mut row,
        );
        self.transform_part(q, &bar, &mut row);
    }

    /// With b = y g and w = g′v² + g a, so that ẍ = J w, the kinetic part is −b·JᵀmJ w − y I a (the rates of g that L_q and
    /// d/dt L_v have cancel); the potential part is −V_x·J(s′y).
    fn residual_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        a: &[S; N],
        y: &[S; N],
        mut row: impl FnMut(usize, S),
    ) {
        let c = self.configuration::<S, 2>(q);
        let b = core::array::from_fn(|j| scale(-y[j], &c.motion[j].g));
        let w = core::array::from_fn(|j| {
            add(&scale(v[j] * v[j], &c.motion[j].g_q), &scale(a[j], &c.motion[j].g))
        });
        let (of_b, of_w) = (self.inertial(&c, &w), self.inertial(&c, &b));
        let mut bar: [Motion<S>; N] = self.potential_part(&c, y, &mut row);
        for j in 0..N {
            bar[j].g = add(&scale(-y[j], &of_b[j]), &scale(a[j], &of_w[j]));
            bar[j].g_q = scale(v[j] * v[j], &of_w[j]);
        }
        self.number_part(
            &c,
            &Bilinear { alpha: &b, beta: &w },
            &core::array::from_fn(|j| -(y[j] * a[j])),
            &mut row,
        );
        self.transform_part(q, &bar, &mut row);
    }
}

impl<'a, W: WeightFormat, const N: usize, const E: usize, const H: usize, const L: usize>
    Modular<'a, W, N, E, H, L>
{
    /// −∂/∂θ of V_x·J(s′δq) in potentials, coefficients, masses and centres; returns its adjoints of s and s′.
    fn potential_part<S: Scalar<Weight = W::Wide>>(
        &self,
        c: &Configuration<S, N>,
        dq: &[S; N],
        row: &mut impl FnMut(usize, S),
    ) -> [Motion<S>; N] {
        let moved = core::array::from_fn(|j| scale(dq[j], &c.motion[j].s_q));
        let (s, rate) = (c.of(|m| m.s), self.tree.centres(&c.centre, &moved));
        let centres = self.tree.centres(&c.centre, &s);
        let x: [Moving<S, 1>; N] = core::array::from_fn(|e| Jet::moving(&centres[e], &rate[e]));
        let mut rates = Rates::new();
        let gradient = self.potential(&c.mass, &x, &mut WeightTangents(|i, rate: S| row(i, -rate)), |term| {
            rates.add(&term, &c.mass, self.c::<S>())
        });
        let force = gradient.map(|g| g.map(|g| g.value));
        let force_rate = gradient.map(|g| g.map(|g| g.rate()));
        row(self.start, -rates.elements);
        row(self.start + 1, -rates.pairs);
        self.for_own(|e, element, kind| {
            let (Some(force), Some(force_rate)) = (force.get(e), force_rate.get(e)) else { return };
            row(kind.start, -expected(rates.masses.get(e).copied(), S::zero()));
            row(kind.start + 2, -(dot(force_rate, &element.own(&s)) + dot(force, &element.own(&moved))));
        });
        let (of_s, of_moved) =
            (self.tree.joints(&c.centre, &force_rate), self.tree.joints(&c.centre, &force));
        core::array::from_fn(|j| {
            let mut bar = Motion::none();
            bar.s = scale(-S::one(), &of_s[j]);
            bar.s_q = scale(-dq[j], &of_moved[j]);
            bar
        })
    }

    /// The derivatives in masses, centres and moments of inertia; `turned` is what multiplies the moments of inertia.
    fn number_part<S: Scalar<Weight = W::Wide>>(
        &self,
        c: &Configuration<S, N>,
        Bilinear { alpha, beta }: &Bilinear<S, N>,
        turned: &[S; N],
        row: &mut impl FnMut(usize, S),
    ) {
        let (a, b) = (self.tree.centres(&c.centre, alpha), self.tree.centres(&c.centre, beta));
        self.for_own(|e, element, kind| {
            let (Some(a), Some(b), Some(mass)) = (a.get(e), b.get(e), c.mass.get(e)) else { return };
            let own = turned.iter().skip(element.first).take(element.count);
            row(kind.start, dot(a, b));
            row(kind.start + 1, own.fold(S::zero(), |sum, x| sum + *x));
            row(kind.start + 2, *mass * (dot(&element.own(alpha), b) + dot(a, &element.own(beta))));
        });
    }

    /// The derivatives in the transforms, from the adjoints of s, s′, g and g′.
    fn transform_part<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        bar: &[Motion<S>; N],
        row: &mut impl FnMut(usize, S),
    ) {
        self.for_own(|_, element, kind| {
            for (q, bar) in q.iter().zip(bar).skip(element.first).take(element.count) {
                let mut bar = *bar;
                if !kind.has_velocity() {
                    bar.s_q = add(&bar.s_q, &bar.g);
                    bar.s_qq = bar.g_q;
                }
                kind.transform_gradient::<S>(*q, &bar, row);
            }
        });
    }

    #[inline(always)]
    fn for_own(&self, mut visit: impl FnMut(usize, &super::tree::Element, &ElementType<'a, W, H, L>)) {
        for (e, element) in self.tree.elements() {
            if let Some(kind) = self.element_type(element.kind) {
                visit(e, element, kind);
            }
        }
    }
}

/// Derivatives of the rate of V in the numbers that multiply its terms.
struct Rates<S, const N: usize> {
    /// In c₁.
    elements: S,
    /// In c₂.
    pairs: S,
    /// In each mass.
    masses: [S; N],
}

impl<S: Scalar, const N: usize> Rates<S, N> {
    fn new() -> Self {
        Self { elements: S::zero(), pairs: S::zero(), masses: [S::zero(); N] }
    }

    fn add(&mut self, term: &PotentialTerm<S, 1>, mass: &[S; N], [c1, c2]: [S; 2]) {
        let m = |e: usize| expected(mass.get(e).copied(), S::zero());
        match term {
            PotentialTerm::Element(e, u) => {
                let rate = u.rate();
                self.elements += m(*e) * rate;
                self.of_mass(*e, c1 * rate);
            }
            PotentialTerm::Pair(a, b, u) => {
                let rate = u.rate();
                self.pairs += m(*a) * m(*b) * rate;
                self.of_mass(*a, c2 * m(*b) * rate);
                self.of_mass(*b, c2 * m(*a) * rate);
            }
        }
    }

    fn of_mass(&mut self, e: usize, rate: S) {
        if let Some(sum) = self.masses.get_mut(e) {
            *sum += rate;
        }
    }
}
