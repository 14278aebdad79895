//! Particles: systems in Cartesian coordinates with any number of nodes, over slices that the caller owns.
//!
//! L(q, v) = Σ T_i(v_i) − V(q). The mass matrix has one block per node, and forces are sums over nodes and edges, so time and memory grow
//! linearly with the system.
//!
//! [`Gripped`] particles have dry friction that sticks.

mod gripped;

pub use gripped::Gripped;

use crate::forces::Grip;
use crate::lagrangian::Energies;
use crate::linear::Matrix;
use crate::scalar::Real;

/// Interface between the solvers and a system of particles in `D` dimensions.
///
/// Slices of nodes have [`Particles::nodes`] items, in the order of the nodes. Evaluation cannot fail: if numbers leave the range of R, the
/// result is not finite, and the solvers return an error.
///
/// The methods on neighbouring nodes exist for systems that evaluate several nodes faster side by side; their results have the same bits as
/// those of one node at a time.
pub trait Particles<R: Real, const D: usize> {
    /// Number of nodes.
    fn nodes(&self) -> usize;
    /// Length of the workspace for [`Particles::energies`] and [`Particles::l_q`]; its contents between calls do not matter.
    fn workspace(&self) -> usize;
    /// T(v) and V(q), J.
    fn energies(&self, q: &[[R; D]], v: &[[R; D]], workspace: &mut [R]) -> Energies<R>;
    /// Writes L_q = −V_q, N.
    fn l_q(&self, q: &[[R; D]], workspace: &mut [R], l_q: &mut [[R; D]]);
    /// p_i = ∂T_i/∂v_i of one node, kg m/s.
    fn l_v(&self, node: usize, v: &[R; D]) -> [R; D];
    /// M_i = ∂²T_i/∂v_i² of one node, kg: symmetric.
    fn mass(&self, node: usize, v: &[R; D]) -> [[R; D]; D];
    /// Q_i(v_i), N, of one node. Each component depends on the same component of v only; drag opposes v.
    fn drag(&self, node: usize, v: &[R; D]) -> [R; D];
    /// ∂Q_i/∂v_i, component by component, N s/m.
    fn drag_slope(&self, node: usize, v: &[R; D]) -> [R; D];

    /// [`Particles::l_v`] of neighbouring nodes, starting at `first`, one per velocity.
    fn momenta(&self, first: usize, v: &[[R; D]], l_v: &mut [[R; D]]) {
        each(first, v, l_v, |node, v| self.l_v(node, v));
    }
    /// [`Particles::mass`] of neighbouring nodes.
    fn masses(&self, first: usize, v: &[[R; D]], masses: &mut [Matrix<R, D>]) {
        each(first, v, masses, |node, v| self.mass(node, v));
    }
    /// [`Particles::drag`] of neighbouring nodes.
    fn drags(&self, first: usize, v: &[[R; D]], drags: &mut [[R; D]]) {
        each(first, v, drags, |node, v| self.drag(node, v));
    }
    /// [`Particles::drag_slope`] of neighbouring nodes.
    fn drag_slopes(&self, first: usize, v: &[[R; D]], slopes: &mut [[R; D]]) {
        each(first, v, slopes, |node, v| self.drag_slope(node, v));
    }

    /// Whether a part of the drag is dry friction that sticks, which is set-valued at rest. A program whose particles say no has no code for it.
    #[inline(always)]
    fn sticks(&self) -> bool {
        false
    }
    /// Levels of the dry friction of one node, N, at least 0. [`Rattle`](crate::discrete::rattle::Rattle) solves this law; in
    /// [`Particles::drag`] a smooth law of the same levels stands in for it.
    #[inline(always)]
    fn grips(&self, _node: usize) -> [Grip<R>; D] {
        [Grip::none(); D]
    }
    /// [`Particles::drags`] without dry friction that sticks, and thus all of it for most particles.
    #[inline(always)]
    fn single_valued_drags(&self, first: usize, v: &[[R; D]], drags: &mut [[R; D]]) {
        self.drags(first, v, drags);
    }
    /// [`Particles::drag_slopes`] of [`Particles::single_valued_drags`].
    #[inline(always)]
    fn single_valued_drag_slopes(&self, first: usize, v: &[[R; D]], slopes: &mut [[R; D]]) {
        self.drag_slopes(first, v, slopes);
    }
}

/// Writes `of(node, v)` for one node after the other.
#[inline(always)]
fn each<V, T>(first: usize, v: &[V], to: &mut [T], of: impl Fn(usize, &V) -> T) {
    for (node, (v, to)) in (first..).zip(v.iter().zip(to)) {
        *to = of(node, v);
    }
}
