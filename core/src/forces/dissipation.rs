use super::{Forces, Seen};
use crate::adapt::Number;
use crate::energy::inertia_network::Features;
use crate::energy::{NetworkShape, SizeError};
use crate::expected::{expected, first, first_mut};
use crate::lagrangian::Column;
use crate::linear::Matrix;
use crate::network::{Jet, Mlp};
use crate::scalar::{Scalar, WeightFormat};

/// Dissipation of a few coordinates from a network: Q = −D v with D(q, v) = LLᵀ, so v·Q = −|Lᵀv|² ≤ 0 whatever the network returns. It
/// expresses friction that depends on the position, falls before it rises (Stribeck), or couples coordinates.
///
/// Inputs of the network, for the m coordinates that it sees, are the positions as features (lengths, then the cosines of all angles, then
/// their sines) and then the velocities, each divided by a scale s > 0, m/s or rad/s. The m(m + 1)/2 outputs are L row by row, lower
/// triangular, √(N s/m) or √(N m s/rad). It does not stick: Q = 0 at rest.
///
/// The network has at most `L` hidden layers of at most `H` units.
///
/// The strength of a column l_j of L may change: Q = −Σ_j (1 + δ_j) l_j (l_jᵀv) is linear in δ_j, and takes energy away as long as δ_j ≥ −1.
/// ∂Q/∂δ_j = −l_j (l_jᵀv) is the column of [`Number::Dissipation`].
#[derive(Clone, Copy, Debug)]
pub struct Dissipation<'a, W, const N: usize, const H: usize, const L: usize> {
    of: Option<Acting<'a, W, N, H, L>>,
}

#[derive(Clone, Copy, Debug)]
struct Acting<'a, W, const N: usize, const H: usize, const L: usize> {
    seen: Seen<N>,
    scales: &'a [W],
    network: Mlp<'a, W, H, L>,
}

/// A vector of N jets.
type Jets<S, const T: usize, const N: usize> = [Jet<S, T>; N];

impl<'a, W: WeightFormat, const N: usize, const H: usize, const L: usize> Dissipation<'a, W, N, H, L> {
    /// No dissipation.
    pub const fn none() -> Self {
        Self { of: None }
    }

    /// Takes the scales of the velocities and the network from the front of `block`. `None` if the block is too short, or the network does
    /// not have the required inputs and outputs.
    ///
    /// # Errors
    /// [`SizeError`] if the network has more than `L` hidden layers or `H` units in a layer.
    pub fn take(block: &mut &'a [W], seen: Seen<N>, shape: &NetworkShape) -> Result<Option<Self>, SizeError> {
        shape.check_size::<H, L>()?;
        Ok(Acting::take(block, seen, shape).map(|of| Self { of: Some(of) }))
    }
}

impl<'a, W: WeightFormat, const N: usize, const H: usize, const L: usize> Acting<'a, W, N, H, L> {
    fn take(block: &mut &'a [W], seen: Seen<N>, shape: &NetworkShape) -> Option<Self> {
        let m = seen.count();
        if !shape.serves(seen.features() + m, m * (m + 1) / 2) {
            return None;
        }
        let (scales, rest) = block.split_at_checked(m)?;
        *block = rest;
        Some(Self { seen, scales, network: shape.take(block)? })
    }

    /// Visits the entries of L, each with the coordinate of its row and with its column.
    #[inline(always)]
    fn each_entry<S: Scalar, const T: usize>(
        &self,
        o: &[Jet<S, T>],
        mut visit: impl FnMut(usize, usize, &Jet<S, T>),
    ) {
        let mut o = o.iter();
        for (i, coordinate) in self.seen.iter().enumerate() {
            for (j, l) in o.by_ref().take(i + 1).enumerate() {
                visit(coordinate, j, l);
            }
        }
    }

    /// Q with tangents, from the features of the positions and from the velocities, both with tangents.
    #[inline]
    fn force<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        features: &[Jet<S, T>],
        v: &Jets<S, T, N>,
    ) -> Jets<S, T, N> {
        let mut force = [Jet::zero(); N];
        self.each_part(features, v, |i, _, part| {
            if let Some(force) = force.get_mut(i) {
                *force = force.plus(&part);
            }
        });
        force
    }

    /// Visits the parts −l_ij (l_jᵀv) of Q, each with its coordinate and with the column j of L.
    #[inline(always)]
    fn each_part<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        features: &[Jet<S, T>],
        v: &Jets<S, T, N>,
        mut visit: impl FnMut(usize, usize, Jet<S, T>),
    ) {
        let (mut x, mut o) = ([[Jet::zero(); N]; 3], [[Jet::zero(); N]; N]);
        let scaled = self
            .seen
            .iter()
            .zip(self.scales)
            .map(|(i, scale)| expected(v.get(i).copied(), Jet::zero()).scaled(S::one() / scale.scalar()));
        let inputs = features.iter().copied().chain(scaled);
        x.as_flattened_mut().iter_mut().zip(inputs).for_each(|(slot, input)| *slot = input);
        let (m, inputs) = (self.seen.count(), features.len() + self.seen.count());
        let o = first_mut(o.as_flattened_mut(), m * (m + 1) / 2);
        self.network.evaluate::<S, T>(first(x.as_flattened(), inputs), o);
        let mut y = [Jet::zero(); N];
        self.each_entry(o, |i, j, l| {
            if let (Some(y), Some(v)) = (y.get_mut(j), v.get(i)) {
                *y = y.plus(&l.times(v));
            }
        });
        self.each_entry(o, |i, j, l| {
            if let Some(y) = y.get(j) {
                visit(i, j, l.times(y).scaled(-S::one()));
            }
        });
    }

    /// Adds −l_j (l_jᵀv) to the columns of the strengths δ_j.
    #[inline(never)]
    fn columns<S: Scalar<Weight = W::Wide>>(
        &self,
        (q, v): (&[S; N], &[S; N]),
        numbers: &[Number],
        columns: &mut [Column<S, N>],
    ) {
        let (features, count) = Features::new(self.seen.kinds(), q).jets::<0>(&[]);
        self.each_part(first(features.as_flattened(), count), &v.map(Jet::constant), |i, j, part| {
            for (number, column) in numbers.iter().zip(columns.iter_mut()) {
                let own = matches!(*number, Number::Dissipation(of) if usize::from(of) == j);
                if let (true, Some(force)) = (own, column.force.get_mut(i)) {
                    *force += part.value;
                }
            }
        });
    }

    /// (∂Q/∂q, ∂Q/∂v): one pass with moving positions and one with moving velocities.
    #[inline(never)]
    fn derivatives<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
    ) -> (Matrix<S, N>, Matrix<S, N>) {
        let features = Features::new(self.seen.kinds(), q);
        let axes = Jet::along_axes(&[S::zero(); N], 0).map(|axis| axis.tangent);
        let (moving, count) = features.jets::<N>(&axes);
        let (still, _) = features.jets::<N>(&[[S::zero(); N]; N]);
        let along = |features: &[[Jet<S, N>; N]; 2], v: &Jets<S, N, N>| {
            self.force(first(features.as_flattened(), count), v).map(|force| force.tangent)
        };
        (along(&moving, &v.map(Jet::constant)), along(&still, &Jet::along_axes(v, 0)))
    }
}

impl<W: WeightFormat, S: Scalar<Weight = W::Wide>, const N: usize, const H: usize, const L: usize>
    Forces<S, N> for Dissipation<'_, W, N, H, L>
{
    fn force(&self, q: &[S; N], v: &[S; N], _: &[S; N]) -> [S; N] {
        let Some(of) = &self.of else { return [S::zero(); N] };
        let (features, count) = Features::new(of.seen.kinds(), q).jets::<0>(&[]);
        of.force(first(features.as_flattened(), count), &v.map(Jet::constant)).map(|force| force.value)
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N], _: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let zero = [[S::zero(); N]; N];
        self.of.as_ref().map_or((zero, zero), |of| of.derivatives(q, v))
    }

    fn network_columns(&self, q: &[S; N], v: &[S; N], numbers: &[Number], columns: &mut [Column<S, N>]) {
        if let Some(of) = &self.of
            && numbers.iter().any(|number| matches!(number, Number::Dissipation(_)))
        {
            of.columns((q, v), numbers, columns);
        }
    }

    fn load_derivative(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> Matrix<S, N> {
        [[S::zero(); N]; N]
    }
}
