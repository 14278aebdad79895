use super::{Activation, Dense, Jet};
use crate::scalar::Scalar;

/// A multilayer perceptron over borrowed weights: up to `D` hidden layers, each followed by the activation, and a linear
/// output layer.
#[derive(Clone, Copy, Debug)]
pub struct Mlp<'a, W, const D: usize> {
    hidden: [Option<Dense<'a, W>>; D],
    output: Dense<'a, W>,
    activation: Activation,
}

/// What a forward pass leaves for the adjoint: units a = σ(z) and slopes σ′(z) of every hidden layer, with tangents,
/// for widths up to `H`.
#[derive(Clone, Debug)]
pub struct Tape<S, const T: usize, const H: usize, const D: usize> {
    units: [[Jet<S, T>; H]; D],
    slopes: [[Jet<S, T>; H]; D],
}

impl<S: Scalar, const T: usize, const H: usize, const D: usize> Default for Tape<S, T, H, D> {
    fn default() -> Self {
        Self { units: [[Jet::zero(); H]; D], slopes: [[Jet::zero(); H]; D] }
    }
}

impl<'a, W: Copy, const D: usize> Mlp<'a, W, D> {
    /// Takes a network of `inputs` → `widths` … → `outputs` from the front of `block`, layer by layer. `None` where the
    /// block is too short or there are more than `D` hidden layers.
    pub fn take(
        block: &mut &'a [W],
        inputs: usize,
        widths: &[usize],
        outputs: usize,
        activation: Activation,
    ) -> Option<Self> {
        let mut hidden = [None; D];
        let mut fan_in = inputs;
        if widths.len() > D {
            return None;
        }
        for (layer, width) in hidden.iter_mut().zip(widths) {
            *layer = Some(Dense::take(block, fan_in, *width)?);
            fan_in = *width;
        }
        let output = Dense::take(block, fan_in, outputs)?;
        Some(Self { hidden, output, activation })
    }

    /// Numbers that such a network takes from the weight block; `None` on overflow.
    pub fn parameters(inputs: usize, widths: &[usize], outputs: usize) -> Option<usize> {
        let (mut fan_in, mut sum) = (inputs, 0usize);
        for width in widths.iter().chain([&outputs]) {
            sum = sum.checked_add(Dense::<W>::parameters(fan_in, *width)?)?;
            fan_in = *width;
        }
        Some(sum)
    }

    /// Outputs.
    pub fn outputs(&self) -> usize {
        self.output.outputs()
    }

    /// All layers, first to last.
    pub fn layers(&self) -> impl Iterator<Item = &Dense<'a, W>> {
        self.hidden.iter().flatten().chain([&self.output])
    }

    /// y(x) and its tangents along those of x; records on `tape` what [`Mlp::adjoint`] needs.
    #[inline]
    pub fn forward<S: Scalar<Weight = W>, const T: usize, const H: usize>(
        &self,
        x: &[Jet<S, T>],
        tape: &mut Tape<S, T, H, D>,
        y: &mut [Jet<S, T>],
    ) {
        let mut input = x;
        for ((layer, units), slopes) in
            self.hidden.iter().flatten().zip(&mut tape.units).zip(&mut tape.slopes)
        {
            let units = first_mut(units, layer.outputs());
            layer.forward(input, units);
            self.activation.apply(units, slopes);
            input = units;
        }
        self.output.forward(input, y);
    }

    /// x̄ = (∂y/∂x)ᵀȳ and its tangents: the tangents of ȳ, together with those on the tape, give the rows of a Hessian.
    ///
    /// `A` ≤ `T` tangents are carried (0: a plain gradient).
    #[inline]
    pub fn adjoint<S: Scalar<Weight = W>, const T: usize, const A: usize, const H: usize>(
        &self,
        tape: &Tape<S, T, H, D>,
        y_bar: &[Jet<S, A>],
        x_bar: &mut [Jet<S, A>],
    ) {
        self.backward(tape, y_bar, |layer, below, bar| {
            if below.is_none() {
                layer.adjoint(bar, x_bar);
            }
        });
    }

    /// Calls `visit(layer, inputs, adjoint of its outputs)` for every layer, last to first; `x` is what the forward pass
    /// was given.
    #[inline]
    pub fn layer_adjoints<S: Scalar<Weight = W>, const T: usize, const A: usize, const H: usize>(
        &self,
        tape: &Tape<S, T, H, D>,
        x: &[Jet<S, T>],
        y_bar: &[Jet<S, A>],
        mut visit: impl FnMut(&Dense<'a, W>, &[Jet<S, T>], &[Jet<S, A>]),
    ) {
        self.backward(tape, y_bar, |layer, below, bar| visit(layer, below.unwrap_or(x), bar));
    }

    /// Carries the adjoint down to the outputs of the first layer. `visit` gets each layer, the units below it on the tape
    /// (none below the first) and the adjoint of its outputs.
    #[inline(always)]
    fn backward<S: Scalar<Weight = W>, const T: usize, const A: usize, const H: usize>(
        &self,
        tape: &Tape<S, T, H, D>,
        y_bar: &[Jet<S, A>],
        mut visit: impl FnMut(&Dense<'a, W>, Option<&[Jet<S, T>]>, &[Jet<S, A>]),
    ) {
        let (mut unit_bar, mut z_bar) = ([Jet::zero(); H], [Jet::zero(); H]);
        let mut layer = &self.output;
        let mut bar = y_bar;
        for ((below, units), slopes) in self.hidden.iter().zip(&tape.units).zip(&tape.slopes).rev() {
            let Some(below) = below else { continue };
            visit(layer, Some(first(units, layer.inputs())), bar);
            let unit_bar = first_mut(&mut unit_bar, layer.inputs());
            layer.adjoint(bar, unit_bar);
            let z_bar = first_mut(&mut z_bar, layer.inputs());
            for ((z, a), slope) in z_bar.iter_mut().zip(unit_bar).zip(slopes) {
                *z = a.times(slope);
            }
            (layer, bar) = (below, z_bar);
        }
        visit(layer, None, bar);
    }
}

/// The first `n` of a slice; all of it where it is shorter.
#[inline(always)]
fn first<T>(slice: &[T], n: usize) -> &[T] {
    slice.get(..n).unwrap_or(slice)
}

/// The first `n` of a slice; nothing where it is shorter.
#[inline(always)]
fn first_mut<T>(slice: &mut [T], n: usize) -> &mut [T] {
    slice.get_mut(..n).unwrap_or_default()
}
