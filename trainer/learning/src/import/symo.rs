//! Import of networks from the SyMo authors' program.

use super::{ImportError, Imported, Layer, Tensors};
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::network::Activation;
use leastaction_models::{Family, InertiaNetworkArchitecture};
use safetensors::SafeTensors;

/// Tensor-name prefixes of the authors' modules: SyMo and E2E-SyMo, then L-NODE.
const PREFIXES: [&str; 2] = ["nn.", "Rigid_Body."];

/// Reads a network of the SyMo authors' program: SyMo, E2E-SyMo or L-NODE.
///
/// Features, layers, heads and inertia follow the authors: (translations, cosines, sines) → tanh layers `MLP.MLP.0`, `.2`, … → `fc_ld`
/// (diagonal, softplus), `fc_lo` (below the diagonal), `fc_g` (V); H = softplus for one coordinate, LLᵀ + 1e-9 I for more.
///
/// # Errors
/// [`ImportError`] names the tensor.
pub fn symo(bytes: &[u8], coordinates: &[Coordinate]) -> Result<Imported, ImportError> {
    let file = SafeTensors::deserialize(bytes)?;
    let tensors = Tensors { file: &file, option: "--coordinates" };
    let known = |name: &str| PREFIXES.iter().any(|prefix| name.starts_with(prefix));
    tensors.require_any("SyMo (nn.…) or L-NODE (Rigid_Body.…)", known)?;
    let discrete = file.names().iter().any(|name| name.starts_with(PREFIXES[0]));
    let source = Source { tensors, prefix: PREFIXES[usize::from(!discrete)] };
    let architecture = source.architecture(coordinates)?;
    source.refuse_others(&architecture)?;
    let weights = source.weights(&architecture)?;
    Ok(Imported { architecture: architecture.into(), weights, discrete })
}

struct Source<'a> {
    tensors: Tensors<'a>,
    prefix: &'static str,
}

impl Source<'_> {
    fn hidden_name(&self, k: usize) -> String {
        format!("{}MLP.MLP.{}", self.prefix, 2 * k)
    }

    fn head_name(&self, head: &str) -> String {
        format!("{}{head}", self.prefix)
    }

    fn heads(n: usize) -> &'static [&'static str] {
        if n == 1 { &["fc_ld", "fc_g"] } else { &["fc_ld", "fc_lo", "fc_g"] }
    }

    /// The architecture; the biases give its widths.
    fn architecture(&self, coordinates: &[Coordinate]) -> Result<InertiaNetworkArchitecture, ImportError> {
        let mut architecture = InertiaNetworkArchitecture::new(coordinates, 0);
        architecture.activation = Activation::Tanh;
        architecture.widths.clear();
        while let Some(width) = self.tensors.width(&self.hidden_name(architecture.widths.len())) {
            architecture.widths.push(width);
        }
        if architecture.widths.is_empty() {
            return Err(ImportError::Missing(format!("{}.bias", self.hidden_name(0))));
        }
        Ok(architecture)
    }

    fn refuse_others(&self, architecture: &InertiaNetworkArchitecture) -> Result<(), ImportError> {
        let hidden = (0..architecture.widths.len()).map(|k| self.hidden_name(k));
        let layers = hidden.chain(Self::heads(architecture.n()).iter().map(|head| self.head_name(head)));
        let known: Vec<String> =
            layers.flat_map(|layer| ["weight", "bias"].map(|part| format!("{layer}.{part}"))).collect();
        self.tensors.refuse_others(|name| known.iter().any(|k| k == name))
    }

    fn weights(&self, architecture: &InertiaNetworkArchitecture) -> Result<Vec<f64>, ImportError> {
        let sizes = architecture.layers();
        let mut weights = Vec::new();
        for (k, (inputs, outputs)) in sizes.iter().take(architecture.widths.len()).enumerate() {
            self.tensors.layer(&self.hidden_name(k), *inputs, *outputs)?.append(&mut weights);
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
            let layer = self.tensors.layer(&self.head_name(head), inputs, outputs)?;
            heads.rows.extend(layer.rows);
            heads.bias.extend(layer.bias);
        }
        heads.append(&mut weights);
        Ok(weights)
    }
}
