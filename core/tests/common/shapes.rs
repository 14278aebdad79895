//! Inertia networks of every kind, with a naive evaluation of their energies.

use super::Random;
use super::oracle::Learned;
use leastaction_core::energy::inertia_network::{
    Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape, feature_count,
};
use leastaction_core::network::{Activation, Dense};
use leastaction_core::scalar::{Scalar, WeightFormat};

pub use Coordinate::{Angle, Cyclic, Translation};

/// Workspace of the compiled model: more than any shape here needs, so that unused workspace is covered too.
pub const WIDTH: usize = 13;
pub const DEPTH: usize = 3;

/// An inertia network that owns its weights.
#[derive(Clone, Debug)]
pub struct Model<const N: usize> {
    pub coordinates: [Coordinate; N],
    pub widths: Vec<u16>,
    pub activation: Activation,
    pub inertia: Inertia,
    pub weights: Vec<f64>,
}

impl<const N: usize> Model<N> {
    pub fn new(
        coordinates: [Coordinate; N],
        widths: &[u16],
        activation: Activation,
        inertia: Inertia,
        seed: u64,
    ) -> Self {
        let mut model = Self { coordinates, widths: widths.to_vec(), activation, inertia, weights: vec![] };
        model.weights = Random(seed).vector(model.shape().parameters().unwrap(), 0.8);
        model
    }

    pub fn shape(&self) -> InertiaNetworkShape<N> {
        InertiaNetworkShape::new(self.coordinates, &self.widths, self.activation, self.inertia)
            .expect("a small network")
    }

    /// The model over a weight block of any type, of this shape.
    pub fn over<'a, W: WeightFormat>(&self, mut weights: &'a [W]) -> InertiaNetwork<'a, W, N, WIDTH, DEPTH> {
        let inertia_network =
            InertiaNetwork::take(&mut weights, &self.shape()).expect("weights of this shape");
        assert!(weights.is_empty(), "{} weights too many", weights.len());
        inertia_network
    }

    pub fn in_f64(&self) -> InertiaNetwork<'_, f64, N, WIDTH, DEPTH> {
        self.over(&self.weights)
    }
}

impl<const N: usize> Learned<N> for Model<N> {
    type Over<'w, S: Scalar>
        = InertiaNetwork<'w, S::Weight, N, WIDTH, DEPTH>
    where
        S::Weight: 'w,
        Self: 'w;

    fn energies_over<'w, S: Scalar>(&'w self, weights: &'w [S::Weight]) -> Self::Over<'w, S> {
        self.over(weights)
    }

    fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Energies from row-major matrices.
    fn naive_energies(&self, q: &[f64; N], v: &[f64; N]) -> (f64, f64) {
        let of = |kind| (0..N).filter(move |i| self.coordinates[*i] == kind);
        let mut x: Vec<f64> = of(Translation).map(|i| q[i]).collect();
        x.extend(of(Angle).map(|i| q[i].cos()));
        x.extend(of(Angle).map(|i| q[i].sin()));
        let widths = self.widths.iter().copied().map(usize::from);
        let o = naive_network(&self.weights, x, widths, self.activation, self.inertia.outputs(N));
        (self.naive_kinetic(&o, v), *o.last().unwrap())
    }
}

impl<const N: usize> Model<N> {
    /// Kinetic energy from the outputs of the network, by matrices.
    fn naive_kinetic(&self, o: &[f64], v: &[f64; N]) -> f64 {
        let softplus = |z: f64| (1.0 + z.exp()).ln();
        let square = |rows: &[Vec<f64>]| -> f64 {
            rows.iter().map(|row| row.iter().zip(v).map(|(b, v)| b * v).sum::<f64>().powi(2)).sum()
        };
        let speed: f64 = v.iter().map(|v| v * v).sum();
        match self.inertia {
            Inertia::Diagonal => (0..N).map(|i| softplus(o[i]) * v[i] * v[i]).sum::<f64>() / 2.0,
            Inertia::Cholesky { epsilon } => {
                let below = |i: usize, j: usize| o[N + i * (i - 1) / 2 + j];
                let entry = |i: usize, j: usize| if i == j { softplus(o[i]) } else { below(i, j) };
                let column = |j| (0..N).map(|i| if i < j { 0.0 } else { entry(i, j) }).collect();
                let columns: Vec<Vec<f64>> = (0..N).map(column).collect();
                (square(&columns) + f64::from(epsilon) * speed) / 2.0
            }
            Inertia::Factor { rows, epsilon } => {
                let rows: Vec<Vec<f64>> = o.chunks(N).take(rows.into()).map(<[f64]>::to_vec).collect();
                (square(&rows) + f64::from(epsilon) * speed) / 2.0
            }
        }
    }
}

/// A network of these hidden layers from the front of a block in panel order.
pub fn naive_network(
    mut block: &[f64],
    mut x: Vec<f64>,
    widths: impl Iterator<Item = usize>,
    activation: Activation,
    outputs: usize,
) -> Vec<f64> {
    for width in widths {
        let z = naive_layer(&mut block, &x, width);
        x = z.into_iter().map(|z| naive_activation(activation, z)).collect();
    }
    naive_layer(&mut block, &x, outputs)
}

/// Wx + b from the front of a block in panel order.
pub fn naive_layer(block: &mut &[f64], x: &[f64], outputs: usize) -> Vec<f64> {
    let (weights, rest) = block.split_at(x.len() * outputs);
    let (bias, rest) = rest.split_at(outputs);
    *block = rest;
    let weight = |i, j| weights[Dense::<f64>::position(x.len(), outputs, i, j)];
    (0..outputs).map(|i| bias[i] + (0..x.len()).map(|j| weight(i, j) * x[j]).sum::<f64>()).collect()
}

pub fn naive_activation(activation: Activation, z: f64) -> f64 {
    match activation {
        Activation::Tanh => z.tanh(),
        Activation::Softplus => (1.0 + z.exp()).ln(),
        Activation::Squareplus => 0.5 * (z + (z * z + 4.0).sqrt()),
        Activation::Isru => z / (1.0 + z * z).sqrt(),
        Activation::Identity => z,
    }
}

const CHOLESKY: Inertia = Inertia::Cholesky { epsilon: 0.01 };

fn factor(rows: u8) -> Inertia {
    Inertia::Factor { rows, epsilon: 0.3 }
}

pub fn of_one() -> Vec<Model<1>> {
    vec![
        Model::new([Angle], &[5], Activation::Tanh, Inertia::Diagonal, 1),
        Model::new([Translation], &[3, 4], Activation::Softplus, CHOLESKY, 2),
        Model::new([Cyclic], &[6], Activation::Isru, CHOLESKY, 3),
        Model::new([Angle], &[4], Activation::Tanh, factor(1), 14),
    ]
}

pub fn of_two() -> Vec<Model<2>> {
    vec![
        Model::new([Angle, Translation], &[7, 5], Activation::Tanh, CHOLESKY, 4),
        Model::new([Cyclic, Angle], &[9, 4, 6], Activation::Squareplus, CHOLESKY, 5),
        Model::new([Angle, Angle], &[12], Activation::Isru, Inertia::Diagonal, 6),
        Model::new([Translation, Cyclic], &[13, 2], Activation::Identity, CHOLESKY, 7),
        Model::new([Angle, Translation], &[6, 5], Activation::Tanh, factor(3), 11),
    ]
}

pub fn of_three() -> Vec<Model<3>> {
    vec![
        Model::new([Angle, Translation, Angle], &[13, 8, 5], Activation::Tanh, CHOLESKY, 8),
        Model::new([Angle, Cyclic, Translation], &[10], Activation::Softplus, Inertia::Diagonal, 9),
        Model::new([Cyclic, Angle, Translation], &[6, 11], Activation::Squareplus, CHOLESKY, 10),
        Model::new([Angle, Angle, Translation], &[7], Activation::Tanh, factor(5), 12),
        Model::new([Angle, Cyclic, Angle], &[4, 9], Activation::Isru, factor(3), 13),
    ]
}

/// One check of all inertia networks, generic in their number of coordinates.
#[allow(unused_macros, reason = "only some tests use it")]
macro_rules! for_each_shape {
    ($check:expr) => {
        $crate::common::shapes::of_one().iter().for_each($check);
        $crate::common::shapes::of_two().iter().for_each($check);
        $crate::common::shapes::of_three().iter().for_each($check);
    };
}
#[allow(unused_imports, reason = "only some tests use it")]
pub(crate) use for_each_shape;

/// One check of the pendulums and of all inertia networks in f64, generic in their number of coordinates.
#[allow(unused_macros, reason = "only some tests use it")]
macro_rules! for_each_model {
    ($check:path) => {
        $check(leastaction_core::energy::trigonometric::PENDULUM);
        $check(leastaction_core::energy::trigonometric::CARTPOLE);
        $check(leastaction_core::energy::trigonometric::ACROBOT);
        $crate::common::shapes::for_each_shape!(|model| $check(model.in_f64()));
    };
}
#[allow(unused_imports, reason = "only some tests use it")]
pub(crate) use for_each_model;

/// Features of a shape, for tests of sizes.
pub fn features<const N: usize>(coordinates: &[Coordinate; N]) -> usize {
    feature_count(coordinates)
}
