//! First and second derivatives of a network in its inputs, from one forward pass with tangents and one adjoint pass without.

use super::{Jet, Mlp, sized};
use crate::scalar::{Scalar, WeightFormat};
use heapless::Vec;

/// What the forward pass records of every hidden unit for the second derivatives: σ′(z), σ″(z) and the tangents ż, for widths
/// up to `H`. It takes half the memory of a [`Tape`](super::Tape) with tangents.
#[derive(Clone, Debug)]
pub struct SecondOrderTape<S, const T: usize, const H: usize, const L: usize> {
    /// σ′ with ż.
    slopes: [Vec<Jet<S, T>, H>; L],
    /// σ″.
    curvatures: [Vec<S, H>; L],
}

impl<S: Scalar, const T: usize, const H: usize, const L: usize> Default for SecondOrderTape<S, T, H, L> {
    fn default() -> Self {
        Self {
            slopes: core::array::from_fn(|_| Vec::new()),
            curvatures: core::array::from_fn(|_| Vec::new()),
        }
    }
}

impl<'a, W: WeightFormat, const H: usize, const L: usize> Mlp<'a, W, H, L> {
    /// y(x) and its tangents along those of x; records what [`Mlp::second_order`] needs.
    #[inline]
    pub fn forward_second_order<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        tape: &mut SecondOrderTape<S, T, H, L>,
        y: &mut [Jet<S, T>],
    ) {
        let mut workspace = Vec::<_, H>::new();
        let mut input = x;
        let records = tape.slopes.iter_mut().zip(&mut tape.curvatures);
        for (layer, (slopes, curvatures)) in self.hidden().zip(records) {
            let width = layer.outputs();
            let z = sized(slopes, width, Jet::zero());
            layer.forward_of::<S, T, H>(input, z);
            // The layer has read its input, which the workspace held: its output may replace it.
            let units = sized(&mut workspace, width, Jet::zero());
            let mut places = units.iter_mut().zip(sized(curvatures, width, S::zero()));
            self.activation().visit(z, |z, c| {
                if let Some((unit, curvature)) = places.next() {
                    (*unit, *curvature) = (z.chain(c.value, c.slope), c.curvature);
                }
                z.value = c.slope;
            });
            input = units;
        }
        self.output().forward_of::<S, T, H>(input, y);
    }

    /// x̄ = (∂y/∂x)ᵀȳ, and the second derivatives of ȳ·y along every pair of the directions of the forward pass, x moving
    /// along straight lines: Σ āσ″(z)ż_iż_j over all hidden units, ā the adjoint of a unit.
    #[inline]
    pub fn second_order<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        tape: &SecondOrderTape<S, T, H, L>,
        y_bar: &[Jet<S, 0>],
        x_bar: &mut [Jet<S, 0>],
    ) -> [[S; T]; T] {
        let mut sum = [[S::zero(); T]; T];
        let (mut unit_workspace, mut z_workspace) = (Vec::<_, H>::new(), Vec::<_, H>::new());
        let (mut layer, mut bar) = (self.output(), y_bar);
        let records = tape.slopes.iter().zip(&tape.curvatures).take(self.depth());
        for (below, (slopes, curvatures)) in self.hidden().rev().zip(records.rev()) {
            let unit_bar = sized(&mut unit_workspace, layer.inputs(), Jet::zero());
            layer.adjoint_of::<S, 0, H>(bar, unit_bar);
            let z_bar = sized(&mut z_workspace, layer.inputs(), Jet::zero());
            let units = unit_bar.iter().zip(slopes).zip(curvatures);
            for (z, ((a, slope), curvature)) in z_bar.iter_mut().zip(units) {
                for (row, rate) in sum.iter_mut().zip(&slope.tangent) {
                    add_scaled_to(row, a.value * (*curvature * *rate), &slope.tangent);
                }
                z.value = a.value * slope.value;
            }
            (layer, bar) = (below, z_bar);
        }
        layer.adjoint_of::<S, 0, H>(bar, x_bar);
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
