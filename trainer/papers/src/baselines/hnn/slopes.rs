//! Squared errors of quantities linear in the gradient of a learned Hamiltonian: its rates, and its accelerations.

use super::Hnn;
use crate::baselines::batch::{Adjoint, Batched, Derivatives, Layers, Pass, matrix};
use crate::baselines::features::{count, fixed, inputs, moving};
use leastaction_learning::training::Samples;
use nalgebra::{DMatrix, DMatrixView, Dyn, U1};
use std::ops::Range;

/// Residuals r_k = d_k·H_x − t_k at given inputs x of the network, with directions d_k and targets t_k.
pub(super) struct Slopes {
    units: [usize; 4],
    /// Inputs x: \[samples\]\[inputs\].
    inputs: DMatrix<f64>,
    /// Directions d of every residual component: \[samples\]\[inputs\].
    directions: Vec<DMatrix<f64>>,
    /// Targets t: \[samples\]\[components\].
    targets: DMatrix<f64>,
}

/// A sample as (q, v, v̇).
type Row<'s> = [&'s [f64]; 3];

impl Slopes {
    /// Creates the residuals H_p − q̇ and −H_q − ṗ.
    pub fn rates(hnn: &Hnn, samples: &Samples) -> Self {
        let (n, momenta) = (hnn.n(), hnn.momenta);
        let directions: Vec<f64> = (0..2 * n).flat_map(|k| rate_direction(k, n)).collect();
        Self::new(hnn, 2 * n, samples, |[q, v, a]| {
            let rates = momenta.momenta(q, a).into_iter().zip(momenta.convection(q, v)).map(|(a, b)| a + b);
            (directions.clone(), v.iter().copied().chain(rates).collect())
        })
    }

    /// Creates the residuals M⁻¹(−H_q − Ṁv) − v̇; NaN if M is singular.
    pub fn accelerations(hnn: &Hnn, samples: &Samples) -> Self {
        let (n, momenta) = (hnn.n(), hnn.momenta);
        Self::new(hnn, n, samples, |[q, v, a]| {
            let Some(mobility) = momenta.mobility(q) else {
                return (vec![f64::NAN; 2 * n * n], a.to_vec());
            };
            let convection = momenta.convection(q, v);
            let row = |i: usize| (0..2 * n).map(|j| if j < n { -mobility[(i, j)] } else { 0.0 }).collect();
            let directions: Vec<Vec<f64>> = (0..n).map(row).collect();
            let bent = |i: usize| (0..n).map(|j| mobility[(i, j)] * convection[j]).sum::<f64>();
            (directions.concat(), (0..n).map(|i| a[i] + bent(i)).collect())
        })
    }

    /// Creates residuals; `terms` gives the directions of a sample in (q, p), one per component, and its targets.
    fn new(
        hnn: &Hnn,
        components: usize,
        samples: &Samples,
        terms: impl Fn(Row) -> (Vec<f64>, Vec<f64>),
    ) -> Self {
        let (mut x, mut along, mut t) = (Vec::new(), vec![Vec::new(); components], Vec::new());
        let [q, v, a] = samples.states.each_ref().map(|rows| rows.chunks_exact(hnn.n()));
        for ((q, v), a) in q.zip(v).zip(a) {
            let state = [q, &hnn.momenta.momenta(q, v)].concat();
            let (directions, targets) = terms([q, v, a]);
            for (along, direction) in along.iter_mut().zip(directions.chunks_exact(state.len())) {
                let moved = inputs(&hnn.coordinates, &moving(&state, direction));
                along.extend(moved.iter().map(|x| x.tangent[0]));
            }
            x.extend(inputs(&hnn.coordinates, &fixed(&state)).iter().map(|x| x.value));
            t.extend(targets);
        }
        let width = count(&hnn.coordinates);
        Self {
            units: hnn.units(),
            inputs: matrix(&x, width),
            directions: along.iter().map(|along| matrix(along, width)).collect(),
            targets: matrix(&t, components),
        }
    }

    /// Directions d of some samples, component by component.
    fn directions(&self, samples: &Range<usize>) -> impl Iterator<Item = DMatrixView<'_, f64, U1, Dyn>> {
        self.directions.iter().map(|directions| directions.rows_range(samples.clone()))
    }
}

/// Direction of the k-th rate; the rates are (H_p, −H_q).
fn rate_direction(k: usize, n: usize) -> Vec<f64> {
    let mut direction = vec![0.0; 2 * n];
    let (entry, sign) = if k < n { (n + k, 1.0) } else { (k - n, -1.0) };
    direction[entry] = sign;
    direction
}

impl Batched for Slopes {
    /// The trace is that of H itself.
    type Trace = (Pass, Adjoint);

    fn units(&self) -> [usize; 4] {
        self.units
    }

    fn samples(&self) -> usize {
        self.inputs.nrows()
    }

    fn components(&self) -> usize {
        self.targets.ncols()
    }

    fn residuals(&self, layers: &Layers, samples: &Range<usize>) -> (Self::Trace, DMatrix<f64>) {
        let pass = layers.forward(self.inputs.rows_range(samples.clone()).into_owned());
        let adjoint = layers.adjoint(&pass, DMatrix::from_element(samples.len(), 1, 1.0));
        let mut residuals = -self.targets.rows_range(samples.clone());
        let slope = adjoint.of_inputs();
        for (i, directions) in self.directions(samples).enumerate() {
            for (j, k) in (0..slope.ncols()).flat_map(|j| (0..samples.len()).map(move |k| (j, k))) {
                residuals[(k, i)] += directions[(k, j)] * slope[(k, j)];
            }
        }
        ((pass, adjoint), residuals)
    }

    /// Residuals are linear in their directions, so the directions are added first.
    fn derive(
        &self,
        layers: &Layers,
        ((pass, adjoint), samples): (&Self::Trace, &Range<usize>),
        y: &DMatrix<f64>,
        then: impl FnOnce(&Derivatives),
    ) {
        let mut along = DMatrix::zeros(samples.len(), self.units[0]);
        for (i, directions) in self.directions(samples).enumerate() {
            for (j, k) in (0..self.units[0]).flat_map(|j| (0..samples.len()).map(move |k| (j, k))) {
                along[(k, j)] += y[(k, i)] * directions[(k, j)];
            }
        }
        let rates = layers.tangent(pass, along);
        let tangent = layers.adjoint_tangent(pass, &rates, adjoint);
        then(&pass.tangent_derivatives(&rates, [adjoint, &tangent]));
    }
}
