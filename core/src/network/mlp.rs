use super::{Activation, Dense, Jet, sized};
use crate::scalar::{Scalar, WeightFormat};
use heapless::Vec;

/// A multilayer perceptron over borrowed weights: up to `L` hidden layers of up to `H` units, each followed by the activation,
/// and a linear output layer.
#[derive(Clone, Copy, Debug)]
pub struct Mlp<'a, W, const H: usize, const L: usize> {
    hidden: [Option<Dense<'a, W>>; L],
    output: Dense<'a, W>,
    activation: Activation,
}

/// What a forward pass leaves for the adjoint: units a = σ(z) and slopes σ′(z) of every hidden layer with tangents, for widths
/// up to `H`.
#[derive(Clone, Debug)]
pub struct Tape<S, const T: usize, const H: usize, const L: usize> {
    units: [Vec<Jet<S, T>, H>; L],
    slopes: [Vec<Jet<S, T>, H>; L],
}

impl<S: Scalar, const T: usize, const H: usize, const L: usize> Default for Tape<S, T, H, L> {
    fn default() -> Self {
        Self { units: core::array::from_fn(|_| Vec::new()), slopes: core::array::from_fn(|_| Vec::new()) }
    }
}

impl<'a, W: WeightFormat, const H: usize, const L: usize> Mlp<'a, W, H, L> {
    /// Takes a network of `inputs` → `widths` … → `outputs` from the front of `block`, layer by layer. `None` where the
    /// block is too short, there are more than `L` hidden layers, or one has more than `H` units.
    pub fn take(
        block: &mut &'a [W],
        inputs: usize,
        widths: &[usize],
        outputs: usize,
        activation: Activation,
    ) -> Option<Self> {
        let mut hidden = [None; L];
        let mut fan_in = inputs;
        if widths.len() > L || widths.iter().any(|width| *width > H) {
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

    /// Numbers in the weight block.
    pub fn len(&self) -> usize {
        self.layers().map(Dense::len).sum()
    }

    /// Whether the network has no weights.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All layers, first to last.
    pub fn layers(&self) -> impl Iterator<Item = &Dense<'a, W>> {
        self.hidden.iter().flatten().chain([&self.output])
    }

    #[inline(always)]
    pub(super) fn hidden(&self) -> impl DoubleEndedIterator<Item = &Dense<'a, W>> {
        self.hidden.iter().flatten()
    }

    /// Hidden layers.
    #[inline(always)]
    pub(super) fn depth(&self) -> usize {
        self.hidden().count()
    }

    #[inline(always)]
    pub(super) fn output(&self) -> &Dense<'a, W> {
        &self.output
    }

    #[inline(always)]
    pub(super) fn activation(&self) -> Activation {
        self.activation
    }

    /// y(x) and its tangents along those of x; records on `tape` what [`Mlp::adjoint`] needs.
    #[inline]
    pub fn forward<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        tape: &mut Tape<S, T, H, L>,
        y: &mut [Jet<S, T>],
    ) {
        let Tape { units, slopes } = tape;
        let mut input = x;
        for ((layer, units), slopes) in self.hidden.iter().flatten().zip(units).zip(slopes) {
            let width = layer.outputs();
            let units = sized(units, width, Jet::zero());
            layer.forward_of::<S, T, H>(input, units);
            self.activation.apply(units, sized(slopes, width, Jet::zero()));
            input = units;
        }
        self.output.forward_of::<S, T, H>(input, y);
    }

    /// y(x) and its tangents along those of x, as [`Mlp::forward`] gives them, without a tape.
    #[inline]
    pub fn evaluate<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        y: &mut [Jet<S, T>],
    ) {
        let mut units = core::array::from_fn::<_, L, _>(|_| Vec::<_, H>::new());
        let mut input = x;
        for (layer, units) in self.hidden.iter().flatten().zip(&mut units) {
            let units = sized(units, layer.outputs(), Jet::zero());
            layer.forward_of::<S, T, H>(input, units);
            self.activation.apply_forward(units);
            input = units;
        }
        self.output.forward_of::<S, T, H>(input, y);
    }

    /// x̄ = (∂y/∂x)ᵀȳ and its tangents: the tangents of ȳ, together with those on the tape, give the rows of a Hessian.
    ///
    /// `A` ≤ `T` tangents are carried (0: a plain gradient).
    #[inline]
    pub fn adjoint<S: Scalar<Weight = W::Wide>, const T: usize, const A: usize>(
        &self,
        tape: &Tape<S, T, H, L>,
        y_bar: &[Jet<S, A>],
        x_bar: &mut [Jet<S, A>],
    ) {
        self.backward(tape, y_bar, |layer, below, bar| {
            if below.is_none() {
                layer.adjoint_of::<S, A, H>(bar, x_bar);
            }
        });
    }

    /// Calls `visit(layer, inputs, adjoint of its outputs)` for every layer, last to first; `x` is what the forward pass
    /// was given.
    #[inline]
    pub fn layer_adjoints<S: Scalar<Weight = W::Wide>, const T: usize, const A: usize>(
        &self,
        tape: &Tape<S, T, H, L>,
        x: &[Jet<S, T>],
        y_bar: &[Jet<S, A>],
        mut visit: impl FnMut(&Dense<'a, W>, &[Jet<S, T>], &[Jet<S, A>]),
    ) {
        self.backward(tape, y_bar, |layer, below, bar| visit(layer, below.unwrap_or(x), bar));
    }

    /// [`Mlp::adjoint`] and [`Mlp::layer_adjoints`] in one pass.
    #[inline]
    pub fn adjoint_with_layers<S: Scalar<Weight = W::Wide>, const T: usize, const A: usize>(
        &self,
        tape: &Tape<S, T, H, L>,
        (x, x_bar): (&[Jet<S, T>], &mut [Jet<S, A>]),
        y_bar: &[Jet<S, A>],
        mut visit: impl FnMut(&Dense<'a, W>, &[Jet<S, T>], &[Jet<S, A>]),
    ) {
        self.backward(tape, y_bar, |layer, below, bar| {
            visit(layer, below.unwrap_or(x), bar);
            if below.is_none() {
                layer.adjoint_of::<S, A, H>(bar, x_bar);
            }
        });
    }

    /// Carries the adjoint down to the outputs of the first layer. `visit` gets each layer, the units below it on the tape
    /// (none below the first) and the adjoint of its outputs.
    #[inline(always)]
    fn backward<S: Scalar<Weight = W::Wide>, const T: usize, const A: usize>(
        &self,
        tape: &Tape<S, T, H, L>,
        y_bar: &[Jet<S, A>],
        mut visit: impl FnMut(&Dense<'a, W>, Option<&[Jet<S, T>]>, &[Jet<S, A>]),
    ) {
        let (mut unit_bar, mut z_bar) = (Vec::<_, H>::new(), Vec::<_, H>::new());
        let mut layer = &self.output;
        let mut bar = y_bar;
        let Tape { units, slopes } = tape;
        for ((below, units), slopes) in self.hidden.iter().zip(units).zip(slopes).rev() {
            let Some(below) = below else { continue };
            visit(layer, Some(units.as_slice()), bar);
            let unit_bar = sized(&mut unit_bar, layer.inputs(), Jet::zero());
            layer.adjoint_of::<S, A, H>(bar, unit_bar);
            let z_bar = sized(&mut z_bar, layer.inputs(), Jet::zero());
            for ((z, a), slope) in z_bar.iter_mut().zip(unit_bar).zip(slopes) {
                *z = a.times(slope);
            }
            (layer, bar) = (below, z_bar);
        }
        visit(layer, None, bar);
    }
}
