//! First and second derivatives of a network in its inputs, from one forward pass with tangents and one adjoint pass without.

use super::units::Units;
use super::{Jet, Mlp, Vectors};
use crate::scalar::{Scalar, WeightFormat};
use heapless::Vec;

/// Record of a forward pass for the second derivatives: σ′(z), σ″(z) and the tangents ż of every hidden unit, for widths up to `H`. It
/// takes half the memory of a [`Tape`](super::Tape) with tangents.
#[derive(Clone, Debug)]
pub struct SecondOrderTape<S, const T: usize, const H: usize, const L: usize> {
    /// σ′ with ż.
    slopes: [Units<S, T, H>; L],
    /// σ″.
    curvatures: [Vec<S, H>; L],
}

impl<S: Scalar, const T: usize, const H: usize, const L: usize> Default for SecondOrderTape<S, T, H, L> {
    fn default() -> Self {
        Self {
            slopes: core::array::from_fn(|_| Units::new()),
            curvatures: core::array::from_fn(|_| Vec::new()),
        }
    }
}

impl<'a, W: WeightFormat, const H: usize, const L: usize> Mlp<'a, W, H, L> {
    /// y(x) with tangents along those of x; records the data for [`Mlp::second_order`].
    #[inline]
    pub fn forward_second_order<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        tape: &mut SecondOrderTape<S, T, H, L>,
        y: &mut [Jet<S, T>],
    ) {
        let mut units = Units::<S, T, H>::new();
        let mut below = Vectors::Jets(x);
        let records = tape.slopes.iter_mut().zip(&mut tape.curvatures);
        for (layer, (slopes, curvatures)) in self.hidden().zip(records) {
            layer.forward_from(below, slopes);
            // The layer has already read the units below, so its own units may replace them.
            self.activation().apply_second_order(slopes, &mut units, curvatures);
            below = Vectors::Units(&units);
        }
        self.output().forward_from(below, y);
    }

    /// x̄ = (∂y/∂x)ᵀȳ, and the second derivatives of ȳ·y along every pair of directions of the forward pass, for x on straight lines: Σ
    /// āσ″(z)ż_iż_j over all hidden units, with ā the adjoint of a unit.
    #[inline]
    pub fn second_order<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        tape: &SecondOrderTape<S, T, H, L>,
        y_bar: &[Jet<S, 0>],
        x_bar: &mut [Jet<S, 0>],
    ) -> [[S; T]; T] {
        let mut sum = [[S::zero(); T]; T];
        let (mut bar, mut other) = (Units::<S, 0, H>::new(), Units::new());
        let (mut bar, mut other) = (&mut bar, &mut other);
        let (mut layer, mut above) = (self.output(), Vectors::Jets(y_bar));
        let records = tape.slopes.iter().zip(&tape.curvatures).take(self.depth());
        for (below, (slopes, curvatures)) in self.hidden().rev().zip(records.rev()) {
            layer.adjoint_from(above, other);
            let (values, _) = other.parts_mut();
            for ((a, slope), curvature) in values.iter_mut().zip(slopes.jets()).zip(curvatures) {
                for (row, rate) in sum.iter_mut().zip(&slope.tangent) {
                    add_scaled_to(row, *a * (*curvature * *rate), &slope.tangent);
                }
                *a = *a * slope.value;
            }
            core::mem::swap(&mut bar, &mut other);
            (layer, above) = (below, Vectors::Units(bar));
        }
        layer.adjoint_from(above, x_bar);
        sum
    }
}

/// x ← x + cy.
#[inline(always)]
fn add_scaled_to<S: Scalar, const T: usize>(x: &mut [S; T], c: S, y: &[S; T]) {
    for (x, y) in x.iter_mut().zip(y) {
        *x += c * *y;
    }
}
