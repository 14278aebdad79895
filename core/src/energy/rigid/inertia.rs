//! From the network's outputs o to energies, L = ½vᵀH(o)v − V(o), with derivatives in o and v.

use crate::expected::expected;
use crate::network::{Activation, Jet};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// How the outputs o = (diagonal, strict lower triangle row by row, V) give the inertia matrix.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Inertia {
    /// H = diag(softplus(o)): decoupled coordinates, and the form SyMo uses for one coordinate.
    Diagonal,
    /// H = LLᵀ + εI, L lower triangular with softplus on its diagonal (SyMo, DeLaN).
    Cholesky {
        /// ε ≥ 0, in the units of H.
        epsilon: f32,
    },
}

impl Inertia {
    /// Outputs of the network for `n` coordinates, V included.
    pub const fn outputs(&self, n: usize) -> usize {
        match self {
            Self::Diagonal => n + 1,
            Self::Cholesky { .. } => n * (n + 1) / 2 + 1,
        }
    }
}

/// A vector of N jets.
pub(super) type Jets<S, const T: usize, const N: usize> = [Jet<S, T>; N];

/// The values alone.
#[inline(always)]
pub(super) fn without_tangents<S: Scalar, const T: usize, const N: usize>(
    x: &Jets<S, T, N>,
) -> Jets<S, 0, N> {
    core::array::from_fn(|i| x[i].without_tangents())
}

/// The outputs of the network read as energies, with tangents.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outputs<S, const T: usize, const N: usize> {
    inertia: Inertia,
    /// softplus of the diagonal outputs.
    diagonal: Jets<S, T, N>,
    /// softplus′ of the diagonal outputs.
    slopes: Jets<S, T, N>,
    /// L, lower triangular with `diagonal` on its diagonal; of the Cholesky form alone.
    factor: [Jets<S, T, N>; N],
    /// V, J.
    pub potential: Jet<S, T>,
}

/// Workspace for the adjoint of the outputs: 2N² ≥ N(N + 1)/2 + 1.
pub(super) type OutputBar<S, const T: usize, const N: usize> = [[Jets<S, T, N>; N]; 2];

impl<S: Scalar, const T: usize, const N: usize> Outputs<S, T, N> {
    #[inline]
    pub fn new(inertia: Inertia, o: &[Jet<S, T>]) -> Self {
        let mut diagonal = [Jet::zero(); N];
        let mut slopes = [Jet::zero(); N];
        let mut factor = [[Jet::zero(); N]; N];
        let mut o = o.iter().copied();
        for (d, o) in diagonal.iter_mut().zip(&mut o) {
            *d = o;
        }
        Activation::Softplus.apply(&mut diagonal, &mut slopes);
        if inertia != Inertia::Diagonal {
            for (i, (row, d)) in factor.iter_mut().zip(&diagonal).enumerate() {
                // Down to the diagonal: outputs, and then softplus of the first ones.
                for l in row.iter_mut().take(i) {
                    *l = expected(o.next(), Jet::zero());
                }
                if let Some(l) = row.get_mut(i) {
                    *l = *d;
                }
            }
        }
        Self { inertia, diagonal, slopes, factor, potential: expected(o.next(), Jet::zero()) }
    }

    /// The same without tangents.
    #[inline]
    pub fn without_tangents(&self) -> Outputs<S, 0, N> {
        Outputs {
            inertia: self.inertia,
            diagonal: without_tangents(&self.diagonal),
            slopes: without_tangents(&self.slopes),
            factor: self.factor.each_ref().map(without_tangents),
            potential: self.potential.without_tangents(),
        }
    }

    /// Lᵀv.
    #[inline]
    fn transposed(&self, v: &Jets<S, T, N>) -> Jets<S, T, N> {
        let mut y = [Jet::zero(); N];
        for (i, (row, v)) in self.factor.iter().zip(v).enumerate() {
            for (y, l) in y.iter_mut().zip(row).take(i + 1) {
                *y = y.plus(&l.times(v));
            }
        }
        y
    }

    /// p = Hv and its tangents.
    #[inline]
    pub fn momentum(&self, v: &Jets<S, T, N>) -> Jets<S, T, N> {
        match self.inertia {
            Inertia::Diagonal => core::array::from_fn(|i| self.diagonal[i].times(&v[i])),
            Inertia::Cholesky { epsilon } => {
                let y = self.transposed(v);
                let epsilon = S::constant(f64::from(epsilon));
                let mut p = v.map(|v| v.scaled(epsilon));
                for (i, (p, row)) in p.iter_mut().zip(&self.factor).enumerate() {
                    for (l, y) in row.iter().zip(&y).take(i + 1) {
                        *p = p.plus(&l.times(y));
                    }
                }
                p
            }
        }
    }

    /// H.
    #[inline]
    pub fn mass_matrix(&self) -> [[S; N]; N] {
        let plain = self.without_tangents();
        let columns = core::array::from_fn(|j| {
            let unit = core::array::from_fn(|i| Jet::constant(if i == j { S::one() } else { S::zero() }));
            plain.momentum(&unit).map(|p| p.value)
        });
        // H is symmetric: its columns are its rows.
        columns
    }

    /// ∂/∂o of aᵀHb, with tangents; the place of V stays 0.
    #[inline]
    pub fn bilinear_bar(&self, a: &Jets<S, T, N>, b: &Jets<S, T, N>) -> OutputBar<S, T, N> {
        match self.inertia {
            Inertia::Diagonal => self.pack(|i, _| a[i].times(&b[i])),
            Inertia::Cholesky { .. } => {
                let (alpha, beta) = (self.transposed(a), self.transposed(b));
                self.pack(|i, j| a[i].times(&beta[j]).plus(&b[i].times(&alpha[j])))
            }
        }
    }

    /// ∂L/∂o at (o, v), with tangents.
    #[inline]
    pub fn lagrangian_bar(&self, v: &Jets<S, T, N>) -> OutputBar<S, T, N> {
        let mut bar = match self.inertia {
            Inertia::Diagonal => self.pack(|i, _| v[i].times(&v[i]).scaled(S::constant(0.5))),
            Inertia::Cholesky { .. } => {
                let y = self.transposed(v);
                self.pack(|i, j| v[i].times(&y[j]))
            }
        };
        if let Some(potential) =
            bar.as_flattened_mut().as_flattened_mut().get_mut(self.inertia.outputs(N) - 1)
        {
            potential.value = S::constant(-1.0);
        }
        bar
    }

    /// Lays ∂/∂L_ij out in the order of the outputs, through softplus on the diagonal.
    #[inline]
    fn pack(&self, entry: impl Fn(usize, usize) -> Jet<S, T>) -> OutputBar<S, T, N> {
        let mut bar = [[[Jet::zero(); N]; N]; 2];
        let mut slots = bar.as_flattened_mut().as_flattened_mut().iter_mut();
        // Plain loops over const bounds: no panic branch is left at any optimisation level.
        for (i, slope) in self.slopes.iter().enumerate() {
            if let Some(slot) = slots.next() {
                *slot = entry(i, i).times(slope);
            }
        }
        if self.inertia == Inertia::Diagonal {
            return bar;
        }
        for i in 0..N {
            for j in 0..i {
                if let Some(slot) = slots.next() {
                    *slot = entry(i, j);
                }
            }
        }
        bar
    }
}
