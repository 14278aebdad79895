//! Trees of reusable elements (ModLaNet; Lu et al., ICML 2022).
//!
//! Every element type has a position transform, a mass and a potential, learned once and reused in any tree. With x_e the centre of element
//! e, the sum of its own displacement and those of all elements below it in the tree (ModLaNet eq. 7),
//!
//! L = ½Σ m_e|ẋ_e|² + ½Σ I_e q̇² − c₁Σ m_e U₁(x_e) − c₂Σ_{e<f} m_e m_f U₂(x_e, x_f)   (ModLaNet eqs. 8–10; I_e is ours).
//!
//! # Method
//!
//! A coordinate j adds s_j(q_j) to the position of everything it carries, so x = J s(q) and ẋ = J (g v), g = s′, with J the constant map
//! `Tree::centres` of the tree. With P = Jᵀm J(g v) and F = JᵀV_x, all derivatives are products of a coordinate's own s, s′, s″, s‴ with P
//! and F:
//! p = g·P + Iv, L_q = v g′·P − s′·F, L_vq v = v g′·P + g·JᵀmJ(g′v²). One pass away from the ground and one back give P: no matrix of
//! positions by coordinates is ever formed.

mod curvature;
mod element;
mod potential;
mod shape;
mod tree;

pub use super::NetworkShape;
pub use element::{ELEMENT_PARAMETERS, ElementParameters, ElementType, Input, Transform};
pub use potential::{Pair, PairInput};
pub use shape::{MAX_NETWORKS, MAX_TYPES, ModularShape, PairShape, TransformShape, TypeShape};
pub use tree::{SPACE, Tree, TreeElement, TreeError, Vector};

use crate::energy::List;
use crate::expected::present;
use crate::lagrangian::{Dynamics, Energies, Gradient, Hessian, Lagrangian, Linearization};
use crate::network::Jet;
use crate::scalar::{Scalar, WeightFormat};
use element::Motion;
use potential::Moving;
use tree::scale;

/// A tree of elements in N coordinates over borrowed weights: at most `E` element types, networks of at most `L` hidden
/// layers of at most `H` units.
#[derive(Clone, Copy, Debug)]
pub struct Modular<'a, W, const N: usize, const E: usize, const H: usize, const L: usize> {
    /// The element types.
    pub types: List<ElementType<'a, W, H, L>, E>,
    /// Pair potential, added for every pair of elements.
    pub pair: Option<Pair<'a, W, H, L>>,
    /// Coefficients c₁ and c₂ of the potentials.
    pub coefficients: [W; 2],
    /// The tree of elements.
    pub tree: Tree<N>,
}

/// The motion of every coordinate, and the parameters of every element, at a configuration q.
struct Configuration<S, const N: usize> {
    motion: [Motion<S>; N],
    mass: [S; N],
    centre: [S; N],
    /// The moment of inertia of the element that has the coordinate.
    inertia: [S; N],
}

impl<S: Scalar, const N: usize> Configuration<S, N> {
    #[inline(always)]
    fn of(&self, part: impl Fn(&Motion<S>) -> Vector<S>) -> [Vector<S>; N] {
        self.motion.each_ref().map(part)
    }
}

impl<'a, W: WeightFormat, const N: usize, const E: usize, const H: usize, const L: usize>
    Modular<'a, W, N, E, H, L>
{
    #[inline(always)]
    fn element_type(&self, kind: usize) -> Option<&ElementType<'a, W, H, L>> {
        present(self.types.get(kind))
    }

    /// c₁ and c₂.
    #[inline(always)]
    fn c<S: Scalar<Weight = W::Wide>>(&self) -> [S; 2] {
        self.coefficients.map(W::scalar)
    }

    /// The motion of every coordinate with the first `O` derivatives of s, and the parameters of every element.
    fn configuration<S: Scalar<Weight = W::Wide>, const O: usize>(&self, q: &[S; N]) -> Configuration<S, N> {
        let zero = [S::zero(); N];
        let mut c = Configuration { motion: [Motion::none(); N], mass: zero, centre: zero, inertia: zero };
        for (e, element) in self.tree.elements() {
            let Some(kind) = self.element_type(element.kind) else { continue };
            if let (Some(mass), Some(centre)) = (c.mass.get_mut(e), c.centre.get_mut(e)) {
                *mass = kind.numbers.mass.scalar();
                *centre = kind.numbers.centre.scalar();
            }
            let own = c.motion.iter_mut().zip(&mut c.inertia).zip(q).skip(element.first).take(element.count);
            for (axis, ((motion, inertia), q)) in own.enumerate() {
                *motion = kind.motion::<S, O>(axis, *q);
                *inertia = kind.numbers.inertia.scalar();
            }
        }
        c
    }

    /// JᵀmJ times the displacements that the coordinates add.
    fn inertial<S: Scalar>(&self, c: &Configuration<S, N>, moved: &[Vector<S>; N]) -> [Vector<S>; N] {
        let centres = self.tree.centres(&c.centre, moved);
        let momenta = core::array::from_fn(|e| scale(c.mass[e], &centres[e]));
        self.tree.joints(&c.centre, &momenta)
    }

    /// JᵀmJ times the displacement that coordinate k adds.
    fn inertial_of<S: Scalar>(&self, c: &Configuration<S, N>, k: usize, moved: Vector<S>) -> [Vector<S>; N] {
        let mut alone = [[S::zero(); SPACE]; N];
        if let Some(slot) = alone.get_mut(k) {
            *slot = moved;
        }
        self.inertial(c, &alone)
    }

    /// M_ik = g_i·(JᵀmJ)_ik g_k + I_i δ_ik.
    fn mass_matrix<S: Scalar>(&self, c: &Configuration<S, N>) -> [[S; N]; N] {
        core::array::from_fn(|k| {
            let row = self.inertial_of(c, k, c.motion[k].g);
            let own = |i: usize| if i == k { c.inertia[k] } else { S::zero() };
            core::array::from_fn(|i| dot(&c.motion[i].g, &row[i]) + own(i))
        })
    }

    /// All derivatives except L_qq, from JᵀmJ(g v) and JᵀV_x; calls `visit` for each k with JᵀmJ times v_k g′_k of that coordinate.
    #[inline(always)]
    fn linearized<S: Scalar>(
        &self,
        c: &Configuration<S, N>,
        v: &[S; N],
        momentum: &[Vector<S>; N],
        force: &[Vector<S>; N],
        mut visit: impl FnMut(usize, &[Vector<S>; N]),
    ) -> Linearization<S, N> {
        let mut l_vq = [[S::zero(); N]; N];
        for k in 0..N {
            let turned = self.inertial_of(c, k, scale(v[k], &c.motion[k].g_q));
            for i in 0..N {
                l_vq[i][k] = dot(&c.motion[i].g, &turned[i]);
            }
            l_vq[k][k] += dot(&c.motion[k].g_q, &momentum[k]);
            visit(k, &turned);
        }
        let l_q = |j: usize| v[j] * dot(&c.motion[j].g_q, &momentum[j]) - dot(&c.motion[j].s_q, &force[j]);
        let l_v = |j: usize| dot(&c.motion[j].g, &momentum[j]) + c.inertia[j] * v[j];
        Linearization {
            l_q: core::array::from_fn(l_q),
            l_v: core::array::from_fn(l_v),
            l_vq,
            l_vv: self.mass_matrix(c),
        }
    }

    /// V_x with its tangents, at moving centres.
    fn pull<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        mass: &[S; N],
        x: &[Moving<S, T>; N],
    ) -> [Moving<S, T>; N] {
        let mut gradient = [[Jet::zero(); SPACE]; N];
        self.for_elements(|e, kind| {
            let (Some(x), Some(sum), Some(m)) = (x.get(e), gradient.get_mut(e), mass.get(e)) else { return };
            let Some(potential) = &kind.potential else { return };
            let [c1, _] = self.c::<S>();
            accumulate(sum, &potential.gradient(x, c1 * *m));
        });
        self.for_pairs(|a, b, pair| {
            let (Some(xa), Some(xb)) = (x.get(a), x.get(b)) else { return };
            let (Some(ma), Some(mb)) = (mass.get(a), mass.get(b)) else { return };
            let [_, c2] = self.c::<S>();
            let [on_a, on_b] = pair.gradients([xa, xb], c2 * *ma * *mb);
            for (e, force) in [(a, &on_a), (b, &on_b)] {
                if let Some(sum) = gradient.get_mut(e) {
                    accumulate(sum, force);
                }
            }
        });
        gradient
    }

    /// V_x.
    fn potential_gradient<S: Scalar<Weight = W::Wide>>(&self, c: &Configuration<S, N>) -> [Vector<S>; N] {
        let x = self.tree.centres(&c.centre, &c.of(|m| m.s)).map(|x| x.map(Jet::constant));
        self.pull::<S, 0>(&c.mass, &x).map(|g| g.map(|g| g.value))
    }

    #[inline(always)]
    fn for_elements(&self, mut visit: impl FnMut(usize, &ElementType<'a, W, H, L>)) {
        for (e, element) in self.tree.elements() {
            if let Some(kind) = self.element_type(element.kind) {
                visit(e, kind);
            }
        }
    }

    #[inline(always)]
    fn for_pairs(&self, mut visit: impl FnMut(usize, usize, &Pair<'a, W, H, L>)) {
        let Some(pair) = &self.pair else { return };
        for (b, _) in self.tree.elements() {
            for a in 0..b {
                visit(a, b, pair);
            }
        }
    }
}

#[inline(always)]
fn accumulate<S: Scalar, const T: usize>(sum: &mut Moving<S, T>, x: &Moving<S, T>) {
    for (sum, x) in sum.iter_mut().zip(x) {
        *sum = sum.plus(x);
    }
}

/// a·b.
#[inline(always)]
fn dot<S: Scalar>(a: &Vector<S>, b: &Vector<S>) -> S {
    a[0] * b[0] + a[1] * b[1]
}

impl<
    W: WeightFormat,
    S: Scalar<Weight = W::Wide>,
    const N: usize,
    const E: usize,
    const H: usize,
    const L: usize,
> Lagrangian<S, N> for Modular<'_, W, N, E, H, L>
{
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let c = self.configuration::<S, 1>(q);
        let velocity = core::array::from_fn(|j| scale(v[j], &c.motion[j].g));
        let momentum = self.inertial(&c, &velocity);
        let (mut twice_kinetic, mut potential) = (S::zero(), S::zero());
        for j in 0..N {
            twice_kinetic += dot(&velocity[j], &momentum[j]) + c.inertia[j] * v[j] * v[j];
        }
        let x = self.tree.centres(&c.centre, &c.of(|m| m.s));
        let [c1, c2] = self.c::<S>();
        self.for_elements(|e, kind| {
            if let (Some(x), Some(m), Some(u)) = (x.get(e), c.mass.get(e), &kind.potential) {
                potential += c1 * *m * u.energy::<S>(&x.map(Jet::constant));
            }
        });
        self.for_pairs(|a, b, pair| {
            if let (Some(xa), Some(xb), Some(ma), Some(mb)) =
                (x.get(a), x.get(b), c.mass.get(a), c.mass.get(b))
            {
                potential += c2 * *ma * *mb * pair.energy::<S>(xa, xb);
            }
        });
        Energies { kinetic: twice_kinetic.half(), potential }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let c = self.configuration::<S, 2>(q);
        let momentum = self.inertial(&c, &core::array::from_fn(|j| scale(v[j], &c.motion[j].g)));
        let force = self.tree.joints(&c.centre, &self.potential_gradient(&c));
        let l_q = |j: usize| v[j] * dot(&c.motion[j].g_q, &momentum[j]) - dot(&c.motion[j].s_q, &force[j]);
        let l_v = |j: usize| dot(&c.motion[j].g, &momentum[j]) + c.inertia[j] * v[j];
        Gradient { l_q: core::array::from_fn(l_q), l_v: core::array::from_fn(l_v) }
    }

    fn dynamics(&self, q: &[S; N], v: &[S; N]) -> Dynamics<S, N> {
        let c = self.configuration::<S, 2>(q);
        let momentum = self.inertial(&c, &core::array::from_fn(|j| scale(v[j], &c.motion[j].g)));
        let turning = self.inertial(&c, &core::array::from_fn(|j| scale(v[j] * v[j], &c.motion[j].g_q)));
        let force = self.tree.joints(&c.centre, &self.potential_gradient(&c));
        let kinetic_q: [S; N] = core::array::from_fn(|j| v[j] * dot(&c.motion[j].g_q, &momentum[j]));
        Dynamics {
            mass: self.mass_matrix(&c),
            l_q: core::array::from_fn(|j| kinetic_q[j] - dot(&c.motion[j].s_q, &force[j])),
            l_v: core::array::from_fn(|j| dot(&c.motion[j].g, &momentum[j]) + c.inertia[j] * v[j]),
            l_vq_v: core::array::from_fn(|j| kinetic_q[j] + dot(&c.motion[j].g, &turning[j])),
        }
    }

    fn linearization(&self, q: &[S; N], v: &[S; N]) -> Linearization<S, N> {
        let c = self.configuration::<S, 2>(q);
        let momentum = self.inertial(&c, &core::array::from_fn(|j| scale(v[j], &c.motion[j].g)));
        let force = self.tree.joints(&c.centre, &self.potential_gradient(&c));
        self.linearized(&c, v, &momentum, &force, |_, _| {})
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let c = self.configuration::<S, 3>(q);
        let momentum = self.inertial(&c, &core::array::from_fn(|j| scale(v[j], &c.motion[j].g)));
        let (gradient, curvature) = self.potential_hessian(&c);
        let force = self.tree.joints(&c.centre, &gradient);
        let mut l_qq = [[S::zero(); N]; N];
        let Linearization { l_q, l_v, l_vq, l_vv } =
            self.linearized(&c, v, &momentum, &force, |k, turned| {
                let (motion, p) = (&c.motion[k], &momentum[k]);
                let pulled = self.pulled(&c, &curvature, k);
                for i in 0..N {
                    l_qq[i][k] = v[i] * dot(&c.motion[i].g_q, &turned[i]) - dot(&c.motion[i].s_q, &pulled[i]);
                }
                l_qq[k][k] += v[k] * dot(&motion.g_qq, p) - dot(&motion.s_qq, &force[k]);
            });
        Hessian { l_q, l_v, l_qq, l_vq, l_vv }
    }
}
