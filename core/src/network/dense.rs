use super::Jet;
use crate::scalar::{Scalar, WeightFormat};

/// A fully connected layer y = Wx + b over borrowed weights.
///
/// Weights lie in *panels*, so both the product and its transpose read them once, in order. Outputs are taken eight at a time, then four,
/// then one; a panel of P outputs holds, input by input, the P weights of that input. Every output is the sum ((b + w₀x₀) + w₁x₁) + … in
/// this order, on every target and at every vector width.
#[derive(Clone, Copy, Debug)]
pub struct Dense<'a, W> {
    pub(super) weights: &'a [W],
    pub(super) bias: &'a [W],
    pub(super) inputs: usize,
}

impl<'a, W: WeightFormat> Dense<'a, W> {
    /// Length of a layer of this shape in the weight block, in numbers.
    pub const fn parameters(inputs: usize, outputs: usize) -> Option<usize> {
        match inputs.checked_add(1) {
            Some(columns) => columns.checked_mul(outputs),
            None => None,
        }
    }

    /// Takes the layer from the front of `block`, its weights in panels and then its biases, and leaves the rest there. `None` if the block
    /// is too short.
    pub fn take(block: &mut &'a [W], inputs: usize, outputs: usize) -> Option<Self> {
        let (weights, rest) = block.split_at_checked(inputs.checked_mul(outputs)?)?;
        let (bias, rest) = rest.split_at_checked(outputs)?;
        *block = rest;
        Some(Self { weights, bias, inputs })
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.bias.len()
    }

    /// Length of the layer in the weight block, in numbers.
    pub fn len(&self) -> usize {
        self.weights.len() + self.bias.len()
    }

    /// Whether the layer has no outputs.
    pub fn is_empty(&self) -> bool {
        self.bias.is_empty()
    }

    /// Index of the weight from input `j` to output `i` among a layer's weights.
    pub fn position(inputs: usize, outputs: usize, i: usize, j: usize) -> usize {
        let eights = outputs / 8 * 8;
        let fours = outputs / 4 * 4;
        let (start, width) = match i {
            i if i < eights => (i / 8 * 8, 8),
            i if i < fours => (eights, 4),
            i => (i, 1),
        };
        start * inputs + j * width + (i - start)
    }

    /// y = Wx + b and ẏ_k = Wẋ_k.
    #[inline]
    pub fn forward<S: Scalar<Weight = W::Wide>, const T: usize>(&self, x: &[Jet<S, T>], y: &mut [Jet<S, T>]) {
        self.forward_into(x, y);
    }

    /// x̄ = Wᵀȳ, for the value and every tangent of the adjoint; `x_bar` is overwritten.
    #[inline]
    pub fn adjoint<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        y_bar: &[Jet<S, T>],
        x_bar: &mut [Jet<S, T>],
    ) {
        self.adjoint_into(y_bar, x_bar);
    }
}
