//! Networks on matrices with one row per sample, whose layers are matrix products.

use crate::baselines::layers_of;
use leastaction_core::network::Dense;
use leastaction_core::scalar::{LANES, Lanes, Scalar};
use leastaction_learning::matrix::{column, column_mut};
use leastaction_learning::training::ChunkRows;
use nalgebra::DMatrix;
use std::ops::Range;

/// A network: hidden tanh layers and a linear output.
pub struct Layers(Vec<Layer>);

struct Layer {
    /// Transposed weights Wᵀ: \[inputs\]\[outputs\].
    weights: DMatrix<f64>,
    bias: Vec<f64>,
    /// Position of the first number in the weight block.
    start: usize,
}

/// One matrix per layer, first to last, each with one row per sample.
type Each = Vec<DMatrix<f64>>;

/// Results of a forward pass that the adjoint needs.
pub struct Pass {
    /// Inputs of every layer.
    inputs: Each,
    pub outputs: DMatrix<f64>,
}

/// Adjoints of a pass, for given adjoints of the outputs.
pub struct Adjoint {
    /// Adjoints z̄ of every layer's sums, before tanh.
    sums: Each,
    /// Adjoints ā of every layer's inputs.
    inputs: Each,
}

impl Adjoint {
    /// Adjoint x̄ of the inputs of the network.
    pub fn of_inputs(&self) -> &DMatrix<f64> {
        &self.inputs[0]
    }
}

/// Derivatives with respect to the weights, for every sample: for a layer's weights Σ z̄ᵢ aⱼ over pairs of an adjoint
/// and inputs, for its biases z̄.
pub struct Derivatives<'p> {
    pairs: Vec<[&'p [DMatrix<f64>]; 2]>,
    biases: &'p [DMatrix<f64>],
}

impl Layers {
    /// Takes a network with these numbers of units (inputs and outputs included); `None` if the block is too short.
    pub fn take(block: &[f64], units: &[usize]) -> Option<Self> {
        let (mut layers, mut start) = (Vec::new(), 0);
        for (inputs, outputs) in layers_of(units) {
            layers.push(Layer::take(block, start, [inputs, outputs])?);
            start += (inputs + 1) * outputs;
        }
        Some(Self(layers))
    }

    /// Computes y(x).
    pub fn forward(&self, x: DMatrix<f64>) -> Pass {
        let mut inputs = vec![x];
        for (k, layer) in self.0.iter().enumerate() {
            let mut units = &inputs[k] * &layer.weights;
            each_column(&mut units, |i, z| z.iter_mut().for_each(|z| *z += layer.bias[i]));
            if k + 1 < self.0.len() {
                each_column(&mut units, |_, z| tanh(z));
            }
            inputs.push(units);
        }
        let outputs = inputs.pop().unwrap_or_default();
        Pass { inputs, outputs }
    }

    /// Returns the tangents along ẋ of every layer's inputs.
    pub fn tangent(&self, pass: &Pass, x: DMatrix<f64>) -> Each {
        let mut inputs = vec![x];
        for (k, layer) in self.0.iter().enumerate().take(self.0.len() - 1) {
            let mut rates = &inputs[k] * &layer.weights;
            each_column(&mut rates, |i, z| pass.times_slope(k, i, z));
            inputs.push(rates);
        }
        inputs
    }

    /// Returns z̄ and ā from ȳ.
    pub fn adjoint(&self, pass: &Pass, y_bar: DMatrix<f64>) -> Adjoint {
        self.backward(y_bar, |k, units| each_column(units, |i, a| pass.times_slope(k, i, a)))
    }

    /// Returns the tangents of z̄ and ā along ẋ for constant ȳ; `rates` are the tangents of every layer's inputs.
    pub fn adjoint_tangent(&self, pass: &Pass, rates: &[DMatrix<f64>], adjoint: &Adjoint) -> Adjoint {
        let still = DMatrix::zeros(pass.outputs.nrows(), pass.outputs.ncols());
        self.backward(still, |k, units| {
            each_column(units, |i, a| {
                pass.times_slope(k, i, a);
                let [bar, unit, rate] =
                    [&adjoint.inputs[k + 1], &pass.inputs[k + 1], &rates[k + 1]].map(|x| column(x, i));
                for (((a, bar), unit), rate) in a.iter_mut().zip(bar).zip(unit).zip(rate) {
                    *a -= 2.0 * bar * unit * rate;
                }
            });
        })
    }

    /// Propagates ȳ back to the inputs; `slope` converts ā of hidden layer k to z̄.
    fn backward(&self, y_bar: DMatrix<f64>, slope: impl Fn(usize, &mut DMatrix<f64>)) -> Adjoint {
        let (mut sums, mut inputs) = (vec![y_bar], Vec::new());
        for (k, layer) in self.0.iter().enumerate().rev() {
            let bar = &sums[sums.len() - 1] * layer.weights.transpose();
            if k > 0 {
                let mut sum = bar.clone();
                slope(k - 1, &mut sum);
                sums.push(sum);
            }
            inputs.push(bar);
        }
        sums.reverse();
        inputs.reverse();
        Adjoint { sums, inputs }
    }

    /// Adds the derivatives of all samples.
    pub fn add_gradient(&self, derivatives: &Derivatives, gradient: &mut [f64]) {
        for (k, layer) in self.0.iter().enumerate() {
            let [inputs, outputs] = [layer.weights.nrows(), layer.weights.ncols()];
            let mut sum = DMatrix::zeros(inputs, outputs);
            for [bars, units] in &derivatives.pairs {
                sum.gemm(1.0, &units[k].transpose(), &bars[k], 1.0);
            }
            for i in 0..outputs {
                column(&sum, i).iter().enumerate().for_each(|(j, g)| gradient[layer.position(i, j)] += g);
                gradient[layer.bias_position(i)] += column(&derivatives.biases[k], i).iter().sum::<f64>();
            }
        }
    }

    /// Writes the derivatives of every sample to these rows.
    pub fn fill(&self, derivatives: &Derivatives, rows: &mut ChunkRows, range: Range<usize>) {
        for (k, layer) in self.0.iter().enumerate() {
            for i in 0..layer.weights.ncols() {
                for j in 0..layer.weights.nrows() {
                    derivatives.weight(k, [i, j], rows.column(layer.position(i, j), range.clone()));
                }
                let bias = column(&derivatives.biases[k], i);
                rows.column(layer.bias_position(i), range.clone()).copy_from_slice(bias);
            }
        }
    }
}

impl Pass {
    /// Derivatives ȳ·∂y/∂θ.
    pub fn derivatives<'p>(&'p self, adjoint: &'p Adjoint) -> Derivatives<'p> {
        Derivatives { pairs: vec![[&adjoint.sums, &self.inputs]], biases: &adjoint.sums }
    }

    /// Derivatives ȳ·∂ẏ/∂θ.
    pub fn tangent_derivatives<'p>(
        &'p self,
        rates: &'p [DMatrix<f64>],
        [adjoint, tangent]: [&'p Adjoint; 2],
    ) -> Derivatives<'p> {
        let pairs = vec![[&*adjoint.sums, rates], [&tangent.sums, &self.inputs]];
        Derivatives { pairs, biases: &tangent.sums }
    }

    /// Multiplies by 1 − a², the derivative of the activation at unit i of hidden layer k.
    fn times_slope(&self, k: usize, i: usize, x: &mut [f64]) {
        x.iter_mut().zip(column(&self.inputs[k + 1], i)).for_each(|(x, a)| *x *= 1.0 - a * a);
    }
}

impl Derivatives<'_> {
    /// Writes the derivatives with respect to the weight from input j to output i of layer k.
    fn weight(&self, k: usize, [i, j]: [usize; 2], out: &mut [f64]) {
        out.fill(0.0);
        for [bars, units] in &self.pairs {
            let factors = column(&bars[k], i).iter().zip(column(&units[k], j));
            out.iter_mut().zip(factors).for_each(|(out, (bar, unit))| *out += bar * unit);
        }
    }
}

impl Layer {
    fn take(block: &[f64], start: usize, [inputs, outputs]: [usize; 2]) -> Option<Self> {
        let mut rest = block.get(start..)?;
        Dense::take(&mut rest, inputs, outputs)?;
        let mut layer = Self { weights: DMatrix::zeros(inputs, outputs), bias: Vec::new(), start };
        layer.weights = DMatrix::from_fn(inputs, outputs, |j, i| block[layer.position(i, j)]);
        layer.bias = (0..outputs).map(|i| block[layer.bias_position(i)]).collect();
        Some(layer)
    }

    fn position(&self, i: usize, j: usize) -> usize {
        self.start + Dense::<f64>::position(self.weights.nrows(), self.weights.ncols(), i, j)
    }

    fn bias_position(&self, i: usize) -> usize {
        self.start + self.weights.nrows() * self.weights.ncols() + i
    }
}

fn each_column(matrix: &mut DMatrix<f64>, visit: impl Fn(usize, &mut [f64])) {
    (0..matrix.ncols()).for_each(|i| visit(i, column_mut(matrix, i)));
}

fn tanh(z: &mut [f64]) {
    let (groups, rest) = z.as_chunks_mut::<LANES>();
    groups.iter_mut().for_each(|z| *z = Lanes(*z).tanh().0);
    rest.iter_mut().for_each(|z| *z = Scalar::tanh(*z));
}
