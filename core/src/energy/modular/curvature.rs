//! Second derivatives of the potential.

use super::potential::Moving;
use super::tree::{SPACE, Vector, add};
use super::{Configuration, Modular, dot};
use crate::network::Jet;
use crate::scalar::{Scalar, WeightFormat};

/// V_xx in blocks, by pairs of elements.
pub(super) type Curvature<S, const N: usize> = [[[Vector<S>; SPACE]; N]; N];

impl<'a, W: WeightFormat, const N: usize, const E: usize, const H: usize, const L: usize>
    Modular<'a, W, N, E, H, L>
{
    /// JᵀV_xxJ times the displacement that coordinate k adds.
    pub(super) fn pulled<S: Scalar>(
        &self,
        c: &Configuration<S, N>,
        curvature: &Curvature<S, N>,
        k: usize,
    ) -> [Vector<S>; N] {
        let mut alone = [[S::zero(); SPACE]; N];
        if let (Some(slot), Some(motion)) = (alone.get_mut(k), c.motion.get(k)) {
            *slot = motion.s_q;
        }
        let moved = self.tree.centres(&c.centre, &alone);
        let forces = core::array::from_fn(|a| {
            let mut sum = [S::zero(); SPACE];
            for b in 0..N {
                sum = add(&sum, &curvature[a][b].map(|row| dot(&row, &moved[b])));
            }
            sum
        });
        self.tree.joints(&c.centre, &forces)
    }

    /// V_x and V_xx.
    pub(super) fn potential_hessian<S: Scalar<Weight = W::Wide>>(
        &self,
        c: &Configuration<S, N>,
    ) -> ([Vector<S>; N], Curvature<S, N>) {
        let x = self.tree.centres(&c.centre, &c.of(|m| m.s));
        let mut gradient = [[S::zero(); SPACE]; N];
        let mut curvature = [[[[S::zero(); SPACE]; SPACE]; N]; N];
        let [c1, c2] = self.c::<S>();
        self.for_elements(|e, kind| {
            let (Some(x), Some(m)) = (x.get(e), c.mass.get(e)) else { return };
            let Some(potential) = &kind.potential else { return };
            let x_bar: Moving<S, SPACE> = potential.gradient(&Jet::along_axes(x, 0), c1 * *m);
            scatter(&mut gradient, &mut curvature, e, &[e], &x_bar);
        });
        self.for_pairs(|a, b, pair| {
            let (Some(xa), Some(xb)) = (x.get(a), x.get(b)) else { return };
            let (Some(ma), Some(mb)) = (c.mass.get(a), c.mass.get(b)) else { return };
            let at = [&Jet::<_, 4>::along_axes(xa, 0), &Jet::along_axes(xb, SPACE)];
            let [on_a, on_b] = pair.gradients(at, c2 * *ma * *mb);
            scatter(&mut gradient, &mut curvature, a, &[a, b], &on_a);
            scatter(&mut gradient, &mut curvature, b, &[a, b], &on_b);
        });
        (gradient, curvature)
    }
}

/// Adds a force on element e, and its derivatives along the axes of the elements `along`.
#[inline(always)]
fn scatter<S: Scalar, const T: usize, const N: usize>(
    gradient: &mut [Vector<S>; N],
    curvature: &mut Curvature<S, N>,
    e: usize,
    along: &[usize],
    force: &Moving<S, T>,
) {
    let (Some(gradient), Some(rows)) = (gradient.get_mut(e), curvature.get_mut(e)) else { return };
    for (i, force) in force.iter().enumerate() {
        gradient[i] += force.value;
        for (f, derivatives) in along.iter().zip(force.tangent.as_chunks::<SPACE>().0) {
            if let Some(block) = rows.get_mut(*f) {
                block[i] = add(&block[i], derivatives);
            }
        }
    }
}
