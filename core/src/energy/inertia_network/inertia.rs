//! Energies from the network's outputs o, L = ½vᵀH(o)v − V(o), with derivatives in o and v.

use crate::expected::{expected, first_mut};
use crate::network::{Jet, softplus_jets};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Form of the inertia matrix in the network's outputs o; the last output is V.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Inertia {
    /// H = diag(softplus(o)), o = (diagonal, V): decoupled coordinates, and SyMo's form for one coordinate.
    Diagonal,
    /// H = LLᵀ + εI, L lower triangular with softplus on its diagonal (SyMo, DeLaN); o = (diagonal, strict lower triangle row by
    /// row, V).
    Cholesky {
        /// ε ≥ 0, in the units of H.
        epsilon: f32,
    },
    /// H = BᵀB + εI, o = (B row by row, V): T = ½|B(q)v|² + ½ε|v|², as for a mechanism whose masses m move with velocities J(q)v, B = √m J.
    /// The entries of J are simple functions of q, unlike those of a triangular factor of the same H: with many coordinates, less data
    /// suffices.
    Factor {
        /// Number of rows of B, from n (with fewer, H is singular up to ε) to 2n − 1 (a planar chain of n masses, the first of which moves
        /// on a circle).
        rows: u8,
        /// ε ≥ 0, in the units of H.
        epsilon: f32,
    },
}

impl Inertia {
    /// Number of outputs of the network for `n` coordinates, V included.
    pub const fn outputs(&self, n: usize) -> usize {
        match self {
            Self::Diagonal => n + 1,
            Self::Cholesky { .. } => n * (n + 1) / 2 + 1,
            Self::Factor { rows, .. } => *rows as usize * n + 1,
        }
    }

    /// Replaces ε, if the form has one.
    #[must_use]
    pub const fn with_epsilon(self, epsilon: f32) -> Self {
        match self {
            Self::Diagonal => Self::Diagonal,
            Self::Cholesky { .. } => Self::Cholesky { epsilon },
            Self::Factor { rows, .. } => Self::Factor { rows, epsilon },
        }
    }

    /// ε; 0 for the diagonal form.
    pub(crate) const fn epsilon(&self) -> f32 {
        match *self {
            Self::Diagonal => 0.0,
            Self::Cholesky { epsilon } | Self::Factor { epsilon, .. } => epsilon,
        }
    }

    /// Whether the number of rows is valid for a model of `n` coordinates.
    pub(crate) fn has_valid_rows(&self, n: usize) -> bool {
        match *self {
            Self::Factor { rows, .. } => (n..2 * n).contains(&usize::from(rows)),
            _ => true,
        }
    }
}

/// A vector of N jets.
pub(super) type Jets<S, const T: usize, const N: usize> = [Jet<S, T>; N];

/// Drops the tangents.
#[inline(always)]
pub(super) fn without_tangents<S: Scalar, const T: usize, const N: usize>(
    x: &Jets<S, T, N>,
) -> Jets<S, 0, N> {
    core::array::from_fn(|i| x[i].without_tangents())
}

/// The outputs of the network, with tangents: room for 2N² ≥ (2N − 1)N + 1.
pub(super) type OutputJets<S, const T: usize, const N: usize> = [[Jets<S, T, N>; N]; 2];

/// Bv, with room for 2N rows.
type Speeds<S, const T: usize, const N: usize> = [Jets<S, T, N>; 2];

/// The outputs of the network read as energies, with tangents. H = BᵀB + εI, or diag(d) in the diagonal form; B = Lᵀ in the Cholesky form.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outputs<'o, S, const T: usize, const N: usize> {
    inertia: Inertia,
    /// Outputs of the network, unchanged.
    pub o: &'o [Jet<S, T>],
    /// softplus of the diagonal outputs.
    diagonal: Jets<S, T, N>,
    /// softplus′ of the diagonal outputs.
    slopes: Jets<S, T, N>,
}

impl<'o, S: Scalar, const T: usize, const N: usize> Outputs<'o, S, T, N> {
    #[inline]
    pub fn new(inertia: Inertia, o: &'o [Jet<S, T>]) -> Self {
        let mut diagonal = [Jet::zero(); N];
        diagonal.iter_mut().zip(o).for_each(|(d, o)| *d = *o);
        let [diagonal, slopes] = match inertia {
            Inertia::Factor { .. } => [[Jet::zero(); N]; 2],
            _ => softplus_jets(&diagonal),
        };
        Self { inertia, o, diagonal, slopes }
    }

    /// Calls `f` with the same outputs without tangents.
    #[inline]
    pub fn without_tangents<Y>(&self, f: impl FnOnce(&Outputs<S, 0, N>) -> Y) -> Y {
        let mut values: OutputJets<S, 0, N> = [[[Jet::zero(); N]; N]; 2];
        let slots = first_mut(values.as_flattened_mut().as_flattened_mut(), self.o.len());
        for (slot, o) in slots.iter_mut().zip(self.o) {
            *slot = o.without_tangents();
        }
        f(&Outputs {
            inertia: self.inertia,
            o: slots,
            diagonal: without_tangents(&self.diagonal),
            slopes: without_tangents(&self.slopes),
        })
    }

    /// Potential V.
    #[inline]
    pub fn potential(&self) -> Jet<S, T> {
        expected(self.o.last().copied(), Jet::zero())
    }

    /// Visits the entries of B with their row and column.
    #[inline(always)]
    fn each_entry(&self, mut visit: impl FnMut(usize, usize, &Jet<S, T>)) {
        match self.inertia {
            Inertia::Diagonal => {}
            Inertia::Cholesky { .. } => {
                let mut below = self.o.iter().skip(N);
                for (i, d) in self.diagonal.iter().enumerate() {
                    for (j, l) in below.by_ref().take(i).enumerate() {
                        visit(j, i, l);
                    }
                    visit(i, i, d);
                }
            }
            Inertia::Factor { rows, .. } => {
                for (k, row) in self.o.chunks_exact(N).take(usize::from(rows)).enumerate() {
                    for (j, b) in row.iter().enumerate() {
                        visit(k, j, b);
                    }
                }
            }
        }
    }

    /// Bv.
    #[inline]
    fn speeds(&self, v: &Jets<S, T, N>) -> Speeds<S, T, N> {
        let mut y = [[Jet::zero(); N]; 2];
        self.each_entry(|row, column, b| {
            if let (Some(y), Some(v)) = (y.as_flattened_mut().get_mut(row), v.get(column)) {
                *y = y.plus(&b.times(v));
            }
        });
        y
    }

    /// p = Hv, with its tangents.
    #[inline]
    pub fn momentum(&self, v: &Jets<S, T, N>) -> Jets<S, T, N> {
        match self.inertia {
            Inertia::Diagonal => core::array::from_fn(|i| self.diagonal[i].times(&v[i])),
            Inertia::Cholesky { epsilon } | Inertia::Factor { epsilon, .. } => {
                let y = self.speeds(v);
                let epsilon = S::constant(f64::from(epsilon));
                let mut p = v.map(|v| v.scaled(epsilon));
                self.each_entry(|row, column, b| {
                    if let (Some(p), Some(y)) = (p.get_mut(column), y.as_flattened().get(row)) {
                        *p = p.plus(&b.times(y));
                    }
                });
                p
            }
        }
    }

    /// Inertia matrix H.
    #[inline]
    pub fn mass_matrix(&self) -> [[S; N]; N] {
        // H is symmetric: its columns are its rows.
        self.without_tangents(|plain| {
            core::array::from_fn(|j| {
                let unit = core::array::from_fn(|i| Jet::constant(if i == j { S::one() } else { S::zero() }));
                plain.momentum(&unit).map(|p| p.value)
            })
        })
    }

    /// ∂L/∂o at (o, v), with tangents.
    #[inline]
    pub fn lagrangian_bar(&self, v: &Jets<S, T, N>) -> OutputJets<S, T, N> {
        let mut bar = match self.inertia {
            Inertia::Diagonal => self.pack(|_, i| v[i].times(&v[i]).scaled(S::constant(0.5))),
            _ => {
                let y = self.speeds(v);
                self.pack(|row, i| v[i].times(&speed(&y, row)))
            }
        };
        if let Some(potential) =
            bar.as_flattened_mut().as_flattened_mut().get_mut(self.inertia.outputs(N) - 1)
        {
            potential.value = S::constant(-1.0);
        }
        bar
    }

    /// Arranges ∂/∂B, given by row and column, in the order of the outputs, through softplus on the diagonal.
    #[inline]
    fn pack(&self, entry: impl Fn(usize, usize) -> Jet<S, T>) -> OutputJets<S, T, N> {
        let mut bar = [[[Jet::zero(); N]; N]; 2];
        if let Inertia::Factor { rows, .. } = self.inertia {
            for (k, row) in bar.as_flattened_mut().iter_mut().take(usize::from(rows)).enumerate() {
                *row = core::array::from_fn(|j| entry(k, j));
            }
            return bar;
        }
        let mut slots = bar.as_flattened_mut().as_flattened_mut().iter_mut();
        // Plain loops over const bounds leave no panic branch at any optimisation level.
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
                    *slot = entry(j, i);
                }
            }
        }
        bar
    }
}

/// One row of Bv.
#[inline(always)]
fn speed<S: Scalar, const T: usize, const N: usize>(y: &Speeds<S, T, N>, row: usize) -> Jet<S, T> {
    expected(y.as_flattened().get(row).copied(), Jet::zero())
}
