use super::Failures;
use super::dense::{dot, times};
use crate::row::{Row, WIDTH};
use leastaction_core::model::Rod;
use leastaction_core::scalar::{product, sum};

/// Massless rods between particles or from the origin, in any number: holonomic constraints φ = (|d|² − ℓ²)/(2ℓ) = 0,
/// m, where d is the vector between their ends ([`leastaction_core::constraints::Holonomic`]). Coordinates are ordered
/// node by node.
///
/// With φ = ½(q·φ_qq q − ℓ) and constant φ_qq, the gradient is φ_qq q, a row of A, and (Ȧv) = v·φ_qq v, m/s².
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rods {
    dimension: usize,
    rods: Vec<Rod>,
}

impl Rods {
    /// Creates rods in 2 or 3 dimensions; evaluating them panics if a node is beyond those of the system.
    pub fn new(dimension: usize, rods: &[Rod]) -> Self {
        Self { dimension, rods: rods.to_vec() }
    }

    /// Number of equations m.
    pub fn count(&self) -> usize {
        self.rods.len()
    }

    /// Nodes that a rod joins, with the sign of their positions in d.
    fn ends(&self, k: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
        let rod = self.rods[k];
        [(Some(rod.to), 1.0), (rod.from, -1.0)]
            .into_iter()
            .filter_map(|(node, sign)| Some((usize::from(node?), sign)))
    }

    /// Values φ of all rods, m; near 0 they have twice the precision of f64.
    pub fn values(&self, q: &[Row]) -> Vec<Row> {
        let value = |k: usize| Row(std::array::from_fn(|sample| self.value(k, q, sample)));
        (0..self.count()).map(value).collect()
    }

    fn value(&self, k: usize, q: &[Row], sample: usize) -> f64 {
        let length = f64::from(self.rods[k].length);
        let (square, error) = product(length, length);
        let (mut high, mut low) = (-square, -error);
        for i in 0..self.dimension {
            let (mut d, mut rest) = (0.0, 0.0);
            for (node, sign) in self.ends(k) {
                (d, rest) = sum(d, sign * q[node * self.dimension + i].0[sample]);
            }
            let (square, error) = product(d, d);
            let (total, lost) = sum(high, square);
            high = total;
            low += lost + error + 2.0 * d * rest;
        }
        0.5 * (high + low) / length
    }

    /// Product φ_qq x of a rod, n rows: it is ∂φ/∂q for x = q, and the rate of change of ∂φ/∂q for x = v.
    pub fn gradient(&self, k: usize, x: &[Row]) -> Vec<Row> {
        let mut gradient = vec![Row::default(); x.len()];
        for i in 0..self.dimension {
            let mut d = Row::default();
            self.ends(k).for_each(|(node, sign)| d.add_scaled(sign, &x[node * self.dimension + i]));
            for (node, sign) in self.ends(k) {
                gradient[node * self.dimension + i].add_scaled(sign / f64::from(self.rods[k].length), &d);
            }
        }
        gradient
    }

    /// Jacobian A, one row per rod: m × n rows.
    pub fn gradients(&self, q: &[Row]) -> Vec<Row> {
        (0..self.count()).flat_map(|k| self.gradient(k, q)).collect()
    }

    /// Matrix ∂(Aᵀλ)/∂q = Σ λ φ_qq, symmetric: n × n rows.
    pub fn turned(&self, lambda: &[Row], n: usize) -> Vec<Row> {
        let mut sum = vec![Row::default(); n * n];
        for (k, lambda) in lambda.iter().enumerate() {
            let length = f64::from(self.rods[k].length);
            for (a, sign) in self.ends(k) {
                for (b, other) in self.ends(k) {
                    let [row, column] = [a, b].map(|node| node * self.dimension);
                    for i in 0..self.dimension {
                        sum[(row + i) * n + column + i].add_scaled(sign * other / length, lambda);
                    }
                }
            }
        }
        sum
    }
}

/// Removes the direction a of a constraint from symmetric matrices, Π − Πa (a·Πa)⁻¹ (Πa)ᵀ, and returns Πa/(a·Πa). A
/// sample fails if a·Πa is 0 or not finite, or if it is negative and `definite` is set.
pub(crate) fn take_out(matrix: &mut [Row], a: &[Row], definite: bool, failures: &mut Failures) -> Vec<Row> {
    let mut lever = times(matrix, a);
    let flexibility = dot(a, &lever);
    for sample in 0..WIDTH {
        let x = flexibility.0[sample];
        failures.0[sample] |= !x.is_finite() || x == 0.0 || (definite && x < 0.0);
    }
    let along = lever.clone();
    lever.iter_mut().for_each(|x| *x = x.zip(&flexibility, |x, f| x / f));
    for (row, lever) in matrix.chunks_exact_mut(a.len()).zip(&lever) {
        let lever = lever.zip(lever, |x, _| -x);
        row.iter_mut().zip(&along).for_each(|(entry, x)| entry.add_product(&lever, x));
    }
    lever
}
