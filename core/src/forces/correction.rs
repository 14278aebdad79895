use super::{Forces, Seen};
use crate::adapt::Number;
use crate::energy::inertia_network::Features;
use crate::energy::{NetworkShape, SizeError};
use crate::expected::{first, first_mut};
use crate::lagrangian::Column;
use crate::linear::{Matrix, add_scaled};
use crate::network::{Jet, Mlp, SecondOrderTape, Tape};
use crate::scalar::{Scalar, WeightFormat};

/// A potential V_c(q) of a few coordinates from a network, in addition to the Lagrangian's potential: Q = −∂V_c/∂q,
/// N or N m. It corrects what the energies lack: a cable, a spring, the ripple of a drive.
///
/// It is a force like all other laws, so every family can have it, and models without it pay nothing. A step uses
/// forces wherever it uses L_q, so a step with V_c remains the variational step of L − V_c. [`Forces::potential`]
/// returns V_c, J.
///
/// Inputs of the network are the positions of the seen coordinates: lengths, then the cosines of all angles, then
/// their sines. The network has at most `L` hidden layers of at most `H` units.
///
/// V_c = Σ_j w_j φ_j(q) + b is linear in the weights of the last layer: ∂Q/∂w_j = −∂φ_j/∂q is the column of [`Number::Potential`].
#[derive(Clone, Copy, Debug)]
pub struct PotentialCorrection<'a, W, const N: usize, const H: usize, const L: usize> {
    of: Option<Acting<'a, W, N, H, L>>,
}

#[derive(Clone, Copy, Debug)]
struct Acting<'a, W, const N: usize, const H: usize, const L: usize> {
    seen: Seen<N>,
    network: Mlp<'a, W, H, L>,
}

impl<'a, W: WeightFormat, const N: usize, const H: usize, const L: usize>
    PotentialCorrection<'a, W, N, H, L>
{
    /// No potential.
    pub const fn none() -> Self {
        Self { of: None }
    }

    /// Takes the network from the front of `block`. `None` if the block is too short, or the network does not have the required inputs and
    /// one output.
    ///
    /// # Errors
    /// [`SizeError`] if the network has more than `L` hidden layers or `H` units in a layer.
    pub fn take(block: &mut &'a [W], seen: Seen<N>, shape: &NetworkShape) -> Result<Option<Self>, SizeError> {
        shape.check_size::<H, L>()?;
        let network = if shape.serves(seen.features(), 1) { shape.take(block) } else { None };
        Ok(network.map(|network| Self { of: Some(Acting { seen, network }) }))
    }
}

impl<W: WeightFormat, const N: usize, const H: usize, const L: usize> Acting<'_, W, N, H, L> {
    fn potential<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N]) -> S {
        let (x, count) = Features::new(self.seen.kinds(), q).jets::<0>(&[]);
        let mut y = [Jet::zero()];
        self.network.evaluate::<S, 0>(first(x.as_flattened(), count), &mut y);
        let [potential] = y;
        potential.value
    }

    /// ∂V_c/∂q.
    #[inline(never)]
    fn gradient<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N]) -> [S; N] {
        let features = Features::new(self.seen.kinds(), q);
        let (x, count) = features.jets::<0>(&[]);
        let (mut tape, mut bar) = (Tape::<S, 0, H, L>::default(), [[Jet::zero(); N]; 2]);
        self.network.forward(first(x.as_flattened(), count), &mut tape, &mut [Jet::zero()]);
        let slots = first_mut(bar.as_flattened_mut(), count);
        self.network.adjoint(&tape, &[Jet::<S, 0>::constant(S::one())], slots);
        features.adjoint(slots, &[]).map(|slope| slope.value)
    }

    /// Adds −∂φ_j/∂q to the columns of the weights w_j.
    #[inline(never)]
    fn columns<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        numbers: &[Number],
        columns: &mut [Column<S, N>],
    ) {
        let axes = Jet::along_axes(&[S::zero(); N], 0).map(|axis| axis.tangent);
        let (x, count) = Features::new(self.seen.kinds(), q).jets::<N>(&axes);
        self.network.with_units(first(x.as_flattened(), count), |units| {
            for (number, Column { force, .. }) in numbers.iter().zip(columns) {
                let Number::Potential(j) = *number else { continue };
                let slope = units.jet(j.into()).map_or([S::zero(); N], |unit| unit.tangent);
                *force = add_scaled(force, -S::one(), &slope);
            }
        });
    }

    /// ∂²V_c/∂q²: the part of the network, and the part of the features.
    #[inline(never)]
    fn hessian<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N]) -> Matrix<S, N> {
        let features = Features::new(self.seen.kinds(), q);
        let axes = Jet::along_axes(&[S::zero(); N], 0).map(|axis| axis.tangent);
        let (x, count) = features.jets::<N>(&axes);
        let (mut tape, mut bar) = (SecondOrderTape::<S, N, H, L>::default(), [[Jet::zero(); N]; 2]);
        self.network.forward_second_order(first(x.as_flattened(), count), &mut tape, &mut [Jet::zero()]);
        let slots = first_mut(bar.as_flattened_mut(), count);
        let mut sum = self.network.second_order(&tape, &[Jet::<S, 0>::constant(S::one())], slots);
        let bar = bar.map(|row| row.map(|x| Jet::constant(x.value)));
        let of_features = features.adjoint::<N>(first(bar.as_flattened(), count), &axes);
        for (row, own) in sum.iter_mut().zip(of_features) {
            row.iter_mut().zip(own.tangent).for_each(|(entry, own)| *entry += own);
        }
        sum
    }
}

impl<W: WeightFormat, S: Scalar<Weight = W::Wide>, const N: usize, const H: usize, const L: usize>
    Forces<S, N> for PotentialCorrection<'_, W, N, H, L>
{
    fn force(&self, q: &[S; N], _: &[S; N], _: &[S; N]) -> [S; N] {
        self.of.as_ref().map_or([S::zero(); N], |of| of.gradient(q).map(|slope| -slope))
    }

    fn derivatives(&self, q: &[S; N], _: &[S; N], _: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let zero = [[S::zero(); N]; N];
        let in_q = self.of.as_ref().map_or(zero, |of| of.hessian(q).map(|row| row.map(|entry| -entry)));
        (in_q, zero)
    }

    fn load_derivative(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> Matrix<S, N> {
        [[S::zero(); N]; N]
    }

    fn network_columns(&self, q: &[S; N], _: &[S; N], numbers: &[Number], columns: &mut [Column<S, N>]) {
        if let Some(of) = &self.of
            && numbers.iter().any(|number| matches!(number, Number::Potential(_)))
        {
            of.columns(q, numbers, columns);
        }
    }

    fn potential(&self, q: &[S; N]) -> S {
        self.of.as_ref().map_or(S::zero(), |of| of.potential(q))
    }
}
