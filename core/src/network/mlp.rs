use super::units::{Sink, Units};
use super::{Activation, Dense, Jet};
use crate::scalar::{Scalar, WeightFormat};

/// A multilayer perceptron over borrowed weights: up to `L` hidden layers of up to `H` units, each followed by the activation,
/// and a linear output layer.
#[derive(Clone, Copy, Debug)]
pub struct Mlp<'a, W, const H: usize, const L: usize> {
    hidden: [Option<Dense<'a, W>>; L],
    output: Dense<'a, W>,
    activation: Activation,
}

/// Record of a forward pass for the adjoint: units a = σ(z) and slopes σ′(z) of every hidden layer, with tangents, for widths up to `H`.
#[derive(Clone, Debug)]
pub struct Tape<S, const T: usize, const H: usize, const L: usize> {
    units: [Units<S, T, H>; L],
    slopes: [Units<S, T, H>; L],
}

impl<S: Scalar, const T: usize, const H: usize, const L: usize> Default for Tape<S, T, H, L> {
    fn default() -> Self {
        Self { units: core::array::from_fn(|_| Units::new()), slopes: core::array::from_fn(|_| Units::new()) }
    }
}

/// Vectors with tangents on one side of a layer: a network's inputs or outputs, or the units of a hidden layer.
#[derive(Debug)]
pub(crate) enum Vectors<'v, S, const T: usize, const H: usize> {
    /// Inputs or outputs of the network.
    Jets(&'v [Jet<S, T>]),
    /// Units of a hidden layer.
    Units(&'v Units<S, T, H>),
}

impl<S, const T: usize, const H: usize> Clone for Vectors<'_, S, T, H> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S, const T: usize, const H: usize> Copy for Vectors<'_, S, T, H> {}

impl<S: Scalar, const T: usize, const H: usize> Vectors<'_, S, T, H> {
    /// Number j with its tangents.
    #[inline(always)]
    pub(crate) fn jet(&self, j: usize) -> Option<Jet<S, T>> {
        match self {
            Self::Jets(jets) => jets.get(j).copied(),
            Self::Units(units) => units.jet(j),
        }
    }
}

impl<'a, W: WeightFormat, const H: usize, const L: usize> Mlp<'a, W, H, L> {
    /// Takes a network of `inputs` → `widths` … → `outputs` from the front of `block`, layer by layer. `None` if the block is too short,
    /// there are more than `L` hidden layers, or a layer has more than `H` units.
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

    /// Length of a network of these sizes in the weight block, in numbers; `None` on overflow.
    pub fn parameters(inputs: usize, widths: &[usize], outputs: usize) -> Option<usize> {
        let (mut fan_in, mut sum) = (inputs, 0usize);
        for width in widths.iter().chain([&outputs]) {
            sum = sum.checked_add(Dense::<W>::parameters(fan_in, *width)?)?;
            fan_in = *width;
        }
        Some(sum)
    }

    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.output.outputs()
    }

    /// Length in the weight block, in numbers.
    pub fn len(&self) -> usize {
        self.layers().map(Dense::len).sum()
    }

    /// Whether the network has no weights.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All layers, in order.
    pub fn layers(&self) -> impl Iterator<Item = &Dense<'a, W>> {
        self.hidden.iter().flatten().chain([&self.output])
    }

    #[inline(always)]
    pub(super) fn hidden(&self) -> impl DoubleEndedIterator<Item = &Dense<'a, W>> {
        self.hidden.iter().flatten()
    }

    /// Number of hidden layers.
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

    /// y(x) with tangents along those of x; records the data for [`Mlp::adjoint`] on `tape`.
    #[inline]
    pub fn forward<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        tape: &mut Tape<S, T, H, L>,
        y: &mut [Jet<S, T>],
    ) {
        let Tape { units, slopes } = tape;
        let mut below = Vectors::Jets(x);
        for ((layer, units), slopes) in self.hidden().zip(units).zip(slopes) {
            layer.forward_from(below, units);
            self.activation.apply(units, slopes);
            below = Vectors::Units(units);
        }
        self.output.forward_from(below, y);
    }

    /// y(x) with tangents along those of x, like [`Mlp::forward`] but without a tape.
    #[inline]
    pub fn evaluate<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        y: &mut [Jet<S, T>],
    ) {
        self.evaluate_with(x, y, |units| self.activation.apply_forward(units));
    }

    /// [`Mlp::evaluate`] with `apply` as the activation.
    #[inline(always)]
    pub(super) fn evaluate_with<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        y: &mut [Jet<S, T>],
        apply: impl Fn(&mut Units<S, T, H>),
    ) {
        self.below_output(x, apply, |below| self.output.forward_from(below, y));
    }

    /// Calls `with` with the inputs of the output layer, in which the outputs are linear: the units of the last hidden layer with tangents along
    /// those of x, or the inputs of a network without a hidden layer.
    #[inline(always)]
    pub(crate) fn with_units<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        with: impl FnOnce(Vectors<S, T, H>),
    ) {
        self.below_output(x, |units| self.activation.apply_forward(units), with);
    }

    /// [`Mlp::with_units`] with `apply` as the activation.
    #[inline(always)]
    fn below_output<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        apply: impl Fn(&mut Units<S, T, H>),
        with: impl FnOnce(Vectors<S, T, H>),
    ) {
        let (mut units, mut others) = (Units::<S, T, H>::new(), Units::new());
        let (mut units, mut others) = (&mut units, &mut others);
        let mut below = Vectors::Jets(x);
        for layer in self.hidden() {
            layer.forward_from(below, others);
            apply(others);
            core::mem::swap(&mut units, &mut others);
            below = Vectors::Units(units);
        }
        with(below);
    }

    /// x̄ = (∂y/∂x)ᵀȳ with tangents: the tangents of ȳ, together with those on the tape, give the rows of a Hessian.
    ///
    /// `A` ≤ `T` tangents are carried (0: a plain gradient).
    #[inline]
    pub fn adjoint<S: Scalar<Weight = W::Wide>, const T: usize, const A: usize>(
        &self,
        tape: &Tape<S, T, H, L>,
        y_bar: &[Jet<S, A>],
        x_bar: &mut [Jet<S, A>],
    ) {
        let (mut bar, mut other) = (Units::<S, A, H>::new(), Units::new());
        let (mut bar, mut other) = (&mut bar, &mut other);
        let (mut layer, mut above) = (&self.output, Vectors::Jets(y_bar));
        let records = tape.slopes.iter().take(self.depth());
        for (below, slopes) in self.hidden().rev().zip(records.rev()) {
            layer.adjoint_from(above, other);
            other.multiply(slopes);
            core::mem::swap(&mut bar, &mut other);
            (layer, above) = (below, Vectors::Units(bar));
        }
        layer.adjoint_from(above, x_bar);
    }
}

/// Products of layers inside a network.
impl<W: WeightFormat> Dense<'_, W> {
    /// y = Wx + b.
    #[inline(always)]
    pub(super) fn forward_from<S: Scalar<Weight = W::Wide>, const T: usize, const H: usize>(
        &self,
        x: Vectors<S, T, H>,
        y: &mut (impl Sink<S, T> + ?Sized),
    ) {
        match x {
            Vectors::Jets(x) => self.forward_into(x, y),
            Vectors::Units(x) => self.forward_into(x, y),
        }
    }

    /// x̄ = Wᵀȳ.
    #[inline(always)]
    pub(super) fn adjoint_from<S: Scalar<Weight = W::Wide>, const T: usize, const H: usize>(
        &self,
        y_bar: Vectors<S, T, H>,
        x_bar: &mut (impl Sink<S, T> + ?Sized),
    ) {
        match y_bar {
            Vectors::Jets(y_bar) => self.adjoint_into(y_bar, x_bar),
            Vectors::Units(y_bar) => self.adjoint_into(y_bar, x_bar),
        }
    }
}
