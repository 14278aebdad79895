//! Networks that were trained elsewhere: weights in safetensors under the names of the SyMo authors' program.

use crate::architecture::{Architecture, RigidArchitecture};
use leastaction_core::energy::rigid::Coordinate;
use leastaction_core::network::{Activation, Dense};
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use thiserror::Error;

/// Prefixes of the authors' modules: SyMo and E2E-SyMo, then L-NODE.
const PREFIXES: [&str; 2] = ["nn.", "Rigid_Body."];

/// Why weights could not be imported.
#[derive(Debug, Error)]
pub enum ImportError {
    /// Not a safetensors file.
    #[error("not a safetensors file: {0}")]
    Container(#[from] safetensors::SafeTensorError),
    /// No tensor has a known prefix.
    #[error("no tensor of SyMo (nn.…) or L-NODE (Rigid_Body.…) in the file; it has {found}")]
    Unknown {
        /// The names that are there.
        found: String,
    },
    /// A tensor is missing.
    #[error("tensor {0} is missing")]
    Missing(String),
    /// A tensor is not needed: the file holds another network than expected.
    #[error("tensor {0} has no place in this network; check --coordinates")]
    Unexpected(String),
    /// A tensor has another shape than the network needs.
    #[error("tensor {name} has shape {found:?} where {expected} is needed; check --coordinates")]
    Shape {
        /// Which.
        name: String,
        /// In the file.
        found: Vec<usize>,
        /// What fits.
        expected: String,
    },
    /// A tensor has another element type.
    #[error("tensor {name} holds {found:?}; F32 and F64 are read")]
    Type {
        /// Which.
        name: String,
        /// In the file.
        found: Dtype,
    },
    /// A weight is infinite or not a number.
    #[error("tensor {name} has an infinite or undefined entry at position {index}")]
    NotFinite {
        /// Which.
        name: String,
        /// Where, row by row.
        index: usize,
    },
}

/// A network as a model of ours.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// Its shape.
    pub architecture: Architecture,
    /// Its weight block.
    pub weights: Vec<f64>,
    /// Whether it was trained through the discrete dynamics (SyMo, E2E-SyMo), and not through accelerations (L-NODE).
    pub discrete: bool,
}

/// Reads a network of the SyMo authors' program: SyMo, E2E-SyMo or L-NODE.
///
/// Features, layers, heads and inertia are theirs: (translations, cosines, sines) → tanh layers `MLP.MLP.0`, `.2`, … →
/// `fc_ld` (diagonal, softplus), `fc_lo` (below it), `fc_g` (V); H = softplus for one coordinate, LLᵀ + 1e-9 I for more.
///
/// # Errors
/// [`ImportError`] names the tensor.
pub fn symo(bytes: &[u8], coordinates: &[Coordinate]) -> Result<Imported, ImportError> {
    let file = SafeTensors::deserialize(bytes)?;
    let prefix = PREFIXES
        .into_iter()
        .find(|prefix| file.names().iter().any(|name| name.starts_with(prefix)))
        .ok_or_else(|| ImportError::Unknown { found: file.names().join(", ") })?;
    let source = Source { file: &file, prefix };
    let architecture = source.architecture(coordinates)?;
    source.refuse_others(&architecture)?;
    let weights = source.weights(&architecture)?;
    Ok(Imported { architecture: architecture.into(), weights, discrete: prefix == PREFIXES[0] })
}

/// One layer with row-major weights.
struct Layer {
    rows: Vec<Vec<f64>>,
    bias: Vec<f64>,
}

struct Source<'a> {
    file: &'a SafeTensors<'a>,
    prefix: &'static str,
}

impl Source<'_> {
    fn hidden_name(k: usize) -> String {
        format!("MLP.MLP.{}", 2 * k)
    }

    fn bias_name(&self, k: usize) -> String {
        format!("{}{}.bias", self.prefix, Self::hidden_name(k))
    }

    fn heads(n: usize) -> &'static [&'static str] {
        if n == 1 { &["fc_ld", "fc_g"] } else { &["fc_ld", "fc_lo", "fc_g"] }
    }

    /// The widths are those of the biases.
    fn architecture(&self, coordinates: &[Coordinate]) -> Result<RigidArchitecture, ImportError> {
        let mut architecture = RigidArchitecture::new(coordinates, 0);
        architecture.activation = Activation::Tanh;
        architecture.widths.clear();
        while let Ok(bias) = self.file.tensor(&self.bias_name(architecture.widths.len())) {
            let width = bias.shape().first().copied().unwrap_or(0);
            architecture.widths.push(u16::try_from(width).unwrap_or(u16::MAX));
        }
        if architecture.widths.is_empty() {
            return Err(ImportError::Missing(self.bias_name(0)));
        }
        Ok(architecture)
    }

    fn refuse_others(&self, architecture: &RigidArchitecture) -> Result<(), ImportError> {
        let hidden = (0..architecture.widths.len()).map(Self::hidden_name);
        let layers = hidden.chain(Self::heads(architecture.n()).iter().map(|head| (*head).to_owned()));
        let known: Vec<String> = layers
            .flat_map(|layer| ["weight", "bias"].map(|part| format!("{}{layer}.{part}", self.prefix)))
            .collect();
        match self.file.names().into_iter().find(|name| !known.iter().any(|k| k == name)) {
            Some(name) => Err(ImportError::Unexpected(name.to_owned())),
            None => Ok(()),
        }
    }

    fn weights(&self, architecture: &RigidArchitecture) -> Result<Vec<f64>, ImportError> {
        let sizes = architecture.layers();
        let mut weights = Vec::new();
        for (k, (inputs, outputs)) in sizes.iter().take(architecture.widths.len()).enumerate() {
            append(&mut weights, &self.layer(&Self::hidden_name(k), *inputs, *outputs)?);
        }
        let inputs = usize::from(architecture.widths.last().copied().unwrap_or(0));
        let n = architecture.n();
        let mut heads = Layer { rows: Vec::new(), bias: Vec::new() };
        for head in Self::heads(n) {
            let outputs = match *head {
                "fc_ld" => n,
                "fc_lo" => n * (n - 1) / 2,
                _ => 1,
            };
            let layer = self.layer(head, inputs, outputs)?;
            heads.rows.extend(layer.rows);
            heads.bias.extend(layer.bias);
        }
        append(&mut weights, &heads);
        Ok(weights)
    }

    fn layer(&self, layer: &str, inputs: usize, outputs: usize) -> Result<Layer, ImportError> {
        let weights = self.tensor(&format!("{layer}.weight"), &[outputs, inputs])?;
        let rows = weights.chunks_exact(inputs).map(<[f64]>::to_vec).collect();
        Ok(Layer { rows, bias: self.tensor(&format!("{layer}.bias"), &[outputs])? })
    }

    fn tensor(&self, name: &str, shape: &[usize]) -> Result<Vec<f64>, ImportError> {
        let name = format!("{}{name}", self.prefix);
        let view = self.file.tensor(&name).map_err(|_| ImportError::Missing(name.clone()))?;
        if view.shape() != shape {
            let (found, expected) = (view.shape().to_vec(), format!("{shape:?}"));
            return Err(ImportError::Shape { name, found, expected });
        }
        let values = numbers(&view).ok_or(ImportError::Type { name: name.clone(), found: view.dtype() })?;
        match values.iter().position(|x| !x.is_finite()) {
            Some(index) => Err(ImportError::NotFinite { name, index }),
            None => Ok(values),
        }
    }
}

/// The entries in double precision.
fn numbers(view: &TensorView) -> Option<Vec<f64>> {
    match view.dtype() {
        Dtype::F32 => {
            Some(view.data().as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect())
        }
        Dtype::F64 => Some(view.data().as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect()),
        _ => None,
    }
}

/// Appends a layer in the order of the weight block.
fn append(weights: &mut Vec<f64>, layer: &Layer) {
    let (outputs, inputs) = (layer.rows.len(), layer.rows.first().map_or(0, Vec::len));
    let mut panels = vec![0.0; inputs * outputs];
    for (i, row) in layer.rows.iter().enumerate() {
        for (j, w) in row.iter().enumerate() {
            panels[Dense::<f64>::position(inputs, outputs, i, j)] = *w;
        }
    }
    weights.extend(panels);
    weights.extend(&layer.bias);
}
