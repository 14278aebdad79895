//! Import of networks trained elsewhere: safetensors weights under the tensor names of the authors' programs.

mod lgnn;
mod modlanet;
mod symo;
#[cfg(test)]
mod tests;

pub use lgnn::{EMBEDDINGS as LGNN_EMBEDDINGS, NETWORKS as LGNN_NETWORKS, lgnn};
pub use modlanet::modlanet;
pub use symo::symo;

use leastaction_core::network::Dense;
use leastaction_models::Architecture;
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use thiserror::Error;

/// Largest number of elements in an imported tree or chain: even with two coordinates each, the tree fits a model file.
pub const MAX_ELEMENTS: usize = 32;

/// The reason why weights could not be imported.
#[derive(Debug, Error)]
pub enum ImportError {
    /// Not a safetensors file.
    #[error("not a safetensors file: {0}")]
    Container(#[from] safetensors::SafeTensorError),
    /// No tensor has a name that the program uses.
    #[error("no tensor of {program} in the file; it has {found}")]
    Unknown {
        /// The program, with examples of its tensor names.
        program: &'static str,
        /// Names of the tensors in the file.
        found: String,
    },
    /// A tensor is missing.
    #[error("tensor {0} is missing")]
    Missing(String),
    /// A tensor is not needed: the file holds another network than the one expected.
    #[error("tensor {name} has no place in this network; check {option}")]
    Unexpected {
        /// Name of the tensor.
        name: String,
        /// Command-line option that sets the expectation.
        option: &'static str,
    },
    /// A tensor has another shape than the network needs.
    #[error("tensor {name} has shape {found:?} where {expected} is needed; check {option}")]
    Shape {
        /// Name of the tensor.
        name: String,
        /// Shape in the file.
        found: Vec<usize>,
        /// Expected shape.
        expected: String,
        /// Command-line option that sets the expectation.
        option: &'static str,
    },
    /// The networks do not fit each other.
    #[error("the {part} does not fit the other networks in the file")]
    Misfit {
        /// Name of the part.
        part: &'static str,
    },
    /// A tensor has an element type that is not read.
    #[error("tensor {name} holds {found:?}; F32 and F64 are read")]
    Type {
        /// Name of the tensor.
        name: String,
        /// Element type in the file.
        found: Dtype,
    },
    /// A weight is infinite or NaN.
    #[error("tensor {name} has an infinite or undefined entry at position {index}")]
    NotFinite {
        /// Name of the tensor.
        name: String,
        /// Index of the entry, row by row.
        index: usize,
    },
    /// The number of elements is out of range.
    #[error("{found} elements; 1 to {MAX_ELEMENTS} are possible; check --count")]
    Count {
        /// Requested number.
        found: usize,
    },
    /// The mass is not above 0.
    #[error(
        "tensor {name} is {found}, and a mass must be above 0; it multiplies all of L, so accelerations do not depend on it: \
         set it with --mass 1"
    )]
    Mass {
        /// Name of the tensor.
        name: String,
        /// Mass in the file, kg.
        found: f64,
    },
}

/// An imported network as a model of this program.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// Shape of the model.
    pub architecture: Architecture,
    /// Weight block.
    pub weights: Vec<f64>,
    /// Whether the network was trained through the discrete dynamics (SyMo, E2E-SyMo) rather than through accelerations (L-NODE, ModLaNet,
    /// LGNN).
    pub discrete: bool,
}

/// One layer with row-major weights.
struct Layer {
    rows: Vec<Vec<f64>>,
    bias: Vec<f64>,
}

impl Layer {
    /// Appends the layer in the order of the weight block.
    fn append(&self, weights: &mut Vec<f64>) {
        let (outputs, inputs) = (self.rows.len(), self.rows.first().map_or(0, Vec::len));
        let mut panels = vec![0.0; inputs * outputs];
        for (i, row) in self.rows.iter().enumerate() {
            for (j, w) in row.iter().enumerate() {
                panels[Dense::<f64>::position(inputs, outputs, i, j)] = *w;
            }
        }
        weights.extend(panels);
        weights.extend(&self.bias);
    }
}

/// The tensors of a file.
struct Tensors<'a> {
    file: &'a SafeTensors<'a>,
    /// Command-line option that sets which tensors are expected.
    option: &'static str,
}

impl Tensors<'_> {
    /// The layer `name`: its weight \[outputs, inputs\] and its bias.
    fn layer(&self, name: &str, inputs: usize, outputs: usize) -> Result<Layer, ImportError> {
        let rows = self.rows(name, inputs, outputs)?;
        Ok(Layer { rows, bias: self.read(&format!("{name}.bias"), &[outputs])? })
    }

    /// The layer `name`, which has no bias.
    fn layer_without_bias(&self, name: &str, inputs: usize, outputs: usize) -> Result<Layer, ImportError> {
        Ok(Layer { rows: self.rows(name, inputs, outputs)?, bias: vec![0.0; outputs] })
    }

    fn rows(&self, name: &str, inputs: usize, outputs: usize) -> Result<Vec<Vec<f64>>, ImportError> {
        let weights = self.read(&format!("{name}.weight"), &[outputs, inputs])?;
        Ok(weights.chunks_exact(inputs.max(1)).map(<[f64]>::to_vec).collect())
    }

    /// Number of units in the layer `name`, from its bias; `None` if it has no bias.
    fn width(&self, name: &str) -> Option<u16> {
        let bias = self.file.tensor(&format!("{name}.bias")).ok()?;
        Some(bias.shape().first().map_or(0, |width| u16::try_from(*width).unwrap_or(u16::MAX)))
    }

    /// Number of inputs of the layer `name`, from its weight.
    fn inputs(&self, name: &str) -> Result<usize, ImportError> {
        let name = format!("{name}.weight");
        let weight = self.file.tensor(&name).map_err(|_| ImportError::Missing(name))?;
        Ok(weight.shape().last().copied().unwrap_or(0))
    }

    /// The entries of a tensor in double precision, row by row.
    fn read(&self, name: &str, shape: &[usize]) -> Result<Vec<f64>, ImportError> {
        let view = self.file.tensor(name).map_err(|_| ImportError::Missing(name.to_owned()))?;
        let name = name.to_owned();
        if view.shape() != shape {
            let (found, expected) = (view.shape().to_vec(), format!("{shape:?}"));
            return Err(ImportError::Shape { name, found, expected, option: self.option });
        }
        let values = numbers(&view).ok_or(ImportError::Type { name: name.clone(), found: view.dtype() })?;
        match values.iter().position(|x| !x.is_finite()) {
            Some(index) => Err(ImportError::NotFinite { name, index }),
            None => Ok(values),
        }
    }

    /// Refuses a file if none of its tensor names satisfies `begins`.
    fn require_any(&self, program: &'static str, begins: impl Fn(&str) -> bool) -> Result<(), ImportError> {
        let names = self.file.names();
        if names.iter().any(|name| begins(name)) {
            return Ok(());
        }
        Err(ImportError::Unknown { program, found: names.join(", ") })
    }

    /// Refuses a file with a tensor whose name is not `known`.
    fn refuse_others(&self, known: impl Fn(&str) -> bool) -> Result<(), ImportError> {
        match self.file.names().into_iter().find(|name| !known(name)) {
            Some(name) => Err(ImportError::Unexpected { name: name.to_owned(), option: self.option }),
            None => Ok(()),
        }
    }
}

/// The entries in double precision; `None` if the element type is not read.
fn numbers(view: &TensorView) -> Option<Vec<f64>> {
    match view.dtype() {
        Dtype::F32 => {
            Some(view.data().as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect())
        }
        Dtype::F64 => Some(view.data().as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect()),
        _ => None,
    }
}
