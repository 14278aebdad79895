use super::Jet;
use crate::expected::expected;
use crate::scalar::{Scalar, WeightFormat};
use leastaction_fpu::portable::dot;

/// A fully connected layer y = Wx + b over borrowed weights.
///
/// Weights lie in *panels*, so that both the product and its transpose read them once, in order: outputs are taken eight
/// at a time, then four, then one; a panel of P outputs holds, input by input, the P weights of that input. Every output
/// is the sum ((b + w₀x₀) + w₁x₁) + … in this order, on every target and at every vector width.
#[derive(Clone, Copy, Debug)]
pub struct Dense<'a, W> {
    pub(super) weights: &'a [W],
    pub(super) bias: &'a [W],
    pub(super) inputs: usize,
}

/// Networks of up to this width take the tangents of a layer side by side on controllers too. Wider networks take them one
/// after the other there: gathering each vector then costs less than it saves.
pub const NARROW: usize = 8;

impl<'a, W: WeightFormat> Dense<'a, W> {
    /// Numbers that a layer of this shape takes from the weight block.
    pub const fn parameters(inputs: usize, outputs: usize) -> Option<usize> {
        match inputs.checked_add(1) {
            Some(columns) => columns.checked_mul(outputs),
            None => None,
        }
    }

    /// Takes the layer from the front of `block`: its weights in panels, then its biases; the rest is left in `block`.
    /// `None` where the block is too short.
    pub fn take(block: &mut &'a [W], inputs: usize, outputs: usize) -> Option<Self> {
        let (weights, rest) = block.split_at_checked(inputs.checked_mul(outputs)?)?;
        let (bias, rest) = rest.split_at_checked(outputs)?;
        *block = rest;
        Some(Self { weights, bias, inputs })
    }

    /// Inputs.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Outputs.
    pub fn outputs(&self) -> usize {
        self.bias.len()
    }

    /// Numbers of the layer in the weight block.
    pub fn len(&self) -> usize {
        self.weights.len() + self.bias.len()
    }

    /// Whether the layer has no outputs.
    pub fn is_empty(&self) -> bool {
        self.bias.is_empty()
    }

    /// Where the weight from input `j` to output `i` lies in a layer's weights.
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
        self.forward_of::<S, T, { usize::MAX }>(x, y);
    }

    /// [`Dense::forward`] in a network of at most `H` units a layer.
    #[inline]
    pub(super) fn forward_of<S: Scalar<Weight = W::Wide>, const T: usize, const H: usize>(
        &self,
        x: &[Jet<S, T>],
        y: &mut [Jet<S, T>],
    ) {
        if S::COMPONENTWISE && H > NARROW {
            return self.componentwise::<S, T, false>(x, y);
        }
        let (weights, bias, y) = forward_panels::<W, S, T, 8>(self.weights, self.bias, x, y);
        let (weights, bias, y) = forward_panels::<W, S, T, 4>(weights, bias, x, y);
        forward_panels::<W, S, T, 1>(weights, bias, x, y);
    }

    /// x̄ = Wᵀȳ and the same for every tangent of the adjoint; `x_bar` is overwritten.
    #[inline]
    pub fn adjoint<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        y_bar: &[Jet<S, T>],
        x_bar: &mut [Jet<S, T>],
    ) {
        self.adjoint_of::<S, T, { usize::MAX }>(y_bar, x_bar);
    }

    /// [`Dense::adjoint`] in a network of at most `H` units a layer.
    #[inline]
    pub(super) fn adjoint_of<S: Scalar<Weight = W::Wide>, const T: usize, const H: usize>(
        &self,
        y_bar: &[Jet<S, T>],
        x_bar: &mut [Jet<S, T>],
    ) {
        if S::COMPONENTWISE && H > NARROW {
            return self.componentwise::<S, T, true>(y_bar, x_bar);
        }
        x_bar.fill(Jet::zero());
        let (weights, y_bar) = adjoint_panels::<W, S, T, 8>(self.weights, y_bar, x_bar);
        let (weights, y_bar) = adjoint_panels::<W, S, T, 4>(weights, y_bar, x_bar);
        adjoint_panels::<W, S, T, 1>(weights, y_bar, x_bar);
    }

    /// Visits ∂/∂W of the first tangent of a scalar: for every weight, in storage order, then every bias, calls
    /// `row` with its position in the layer and ȧ_j ȳ_i + a_j ẏ̄_i, where `y_bar` is the adjoint (with one tangent) of the
    /// layer's outputs and `x` its inputs (with one tangent).
    #[inline]
    pub fn tangent_gradient<S: Scalar<Weight = W::Wide>>(
        &self,
        x: &[Jet<S, 1>],
        y_bar: &[Jet<S, 1>],
        row: impl FnMut(usize, S),
    ) {
        outer(x, y_bar, derivative, |y| y.tangent[0], row);
    }

    /// Visits ∂/∂W as [`Dense::tangent_gradient`] does, where `x` and `y_bar` are the inputs and the adjoint of the outputs,
    /// each with as many derivatives along a curve: Σ_k ȳ⁽ᵏ⁾x⁽ᵏ⁾.
    #[inline]
    pub fn series_gradient<S: Scalar<Weight = W::Wide>, const K: usize>(
        &self,
        x: &[Jet<S, K>],
        y_bar: &[Jet<S, K>],
        row: impl FnMut(usize, S),
    ) {
        let product = |y: &Jet<S, K>, x: &Jet<S, K>| {
            y.tangent.iter().zip(&x.tangent).fold(y.value * x.value, |sum, (y, x)| sum + *y * *x)
        };
        outer(x, y_bar, product, |y| y.value, row);
    }
}

/// Calls `row` with the position of every weight and `weight(ȳ_i, x_j)`, in storage order, then of every bias.
#[inline(always)]
fn outer<S, X, Y>(
    x: &[X],
    y_bar: &[Y],
    weight: impl Fn(&Y, &X) -> S,
    bias: impl Fn(&Y) -> S,
    mut row: impl FnMut(usize, S),
) {
    let mut position = 0;
    let mut panels = |y_bar: &[Y]| {
        for x in x {
            for y in y_bar {
                row(position, weight(y, x));
                position += 1;
            }
        }
    };
    let (eights, rest) = y_bar.as_chunks::<8>();
    let (fours, ones) = rest.as_chunks::<4>();
    eights.iter().for_each(|y| panels(y));
    fours.iter().for_each(|y| panels(y));
    ones.iter().for_each(|y| panels(core::slice::from_ref(y)));
    for (y, position) in y_bar.iter().zip(position..) {
        row(position, bias(y));
    }
}

/// The tangent of the product xy.
#[inline(always)]
fn derivative<S: Scalar>(y: &Jet<S, 1>, x: &Jet<S, 1>) -> S {
    let [derivative] = x.times(y).tangent;
    derivative
}

/// The weights, biases and outputs that follow the full panels.
type Rest<'w, 'y, W, S, const T: usize> = (&'w [W], &'w [W], &'y mut [Jet<S, T>]);

/// P jets as vector registers hold them: their values side by side, and each of their tangents side by side.
struct Panel<S, const T: usize, const P: usize> {
    value: [S; P],
    tangent: [[S; P]; T],
}

impl<S: Scalar, const T: usize, const P: usize> Panel<S, T, P> {
    #[inline(always)]
    fn jet(&self, l: usize) -> Jet<S, T> {
        let mut jet = Jet { value: self.value[l], tangent: [S::zero(); T] };
        for (x, lanes) in jet.tangent.iter_mut().zip(&self.tangent) {
            *x = lanes[l];
        }
        jet
    }
}

/// Evaluates all full panels of P outputs.
#[inline(always)]
fn forward_panels<'w, 'y, W: WeightFormat, S: Scalar<Weight = W::Wide>, const T: usize, const P: usize>(
    weights: &'w [W],
    bias: &'w [W],
    x: &[Jet<S, T>],
    y: &'y mut [Jet<S, T>],
) -> Rest<'w, 'y, W, S, T> {
    let (panels, y) = y.as_chunks_mut::<P>();
    let (bias, bias_rest) = expected(bias.split_at_checked(panels.len() * P), (bias, &[]));
    let (rows, rest) = expected(weights.split_at_checked(panels.len() * P * x.len()), (weights, &[]));
    let mut rows = rows.as_chunks::<P>().0;
    for (y, bias) in panels.iter_mut().zip(bias.as_chunks::<P>().0) {
        let panel = forward_panel(split_off(&mut rows, x.len()), bias, x);
        for (l, y) in y.iter_mut().enumerate() {
            *y = panel.jet(l);
        }
    }
    (rest, bias_rest, y)
}

/// Takes the first `n` from the front of `rows`, which has at least as many.
#[inline(always)]
fn split_off<'w, X>(rows: &mut &'w [X], n: usize) -> &'w [X] {
    let (first, rest) = expected(rows.split_at_checked(n), (rows, &[]));
    *rows = rest;
    first
}

/// A function of its own, so that the sums stay in vectors and are not interleaved before the last is added.
#[inline(never)]
fn forward_panel<W: WeightFormat, S: Scalar<Weight = W::Wide>, const T: usize, const P: usize>(
    rows: &[[W; P]],
    bias: &[W; P],
    x: &[Jet<S, T>],
) -> Panel<S, T, P> {
    let mut value = bias.map(W::scalar);
    let mut tangent = [[S::zero(); P]; T];
    for (x, row) in x.iter().zip(rows) {
        let row = row.map(W::scalar);
        accumulate(&mut value, &row, x.value);
        for (sum, x) in tangent.iter_mut().zip(&x.tangent) {
            accumulate(sum, &row, *x);
        }
    }
    Panel { value, tangent }
}

#[inline(always)]
fn accumulate<S: Scalar, const P: usize>(sum: &mut [S; P], row: &[S; P], x: S) {
    for (sum, w) in sum.iter_mut().zip(row) {
        *sum += *w * x;
    }
}

#[inline(always)]
fn adjoint_panels<'w, 'y, W: WeightFormat, S: Scalar<Weight = W::Wide>, const T: usize, const P: usize>(
    weights: &'w [W],
    y_bar: &'y [Jet<S, T>],
    x_bar: &mut [Jet<S, T>],
) -> (&'w [W], &'y [Jet<S, T>]) {
    let (panels, y_rest) = y_bar.as_chunks::<P>();
    let (rows, rest) = expected(weights.split_at_checked(panels.len() * P * x_bar.len()), (weights, &[]));
    let mut rows = rows.as_chunks::<P>().0;
    for y_bar in panels {
        adjoint_panel(split_off(&mut rows, x_bar.len()), y_bar, x_bar);
    }
    (rest, y_rest)
}

#[inline(always)]
fn adjoint_panel<W: WeightFormat, S: Scalar<Weight = W::Wide>, const T: usize, const P: usize>(
    rows: &[[W; P]],
    y_bar: &[Jet<S, T>; P],
    x_bar: &mut [Jet<S, T>],
) {
    let value: [S; P] = core::array::from_fn(|l| y_bar[l].value);
    let tangent: [[S; P]; T] = core::array::from_fn(|k| core::array::from_fn(|l| y_bar[l].tangent[k]));
    for (x, row) in x_bar.iter_mut().zip(rows) {
        let row = row.map(W::scalar);
        x.value += dot(&row, &value);
        for (x, y) in x.tangent.iter_mut().zip(&tangent) {
            *x += dot(&row, y);
        }
    }
}
