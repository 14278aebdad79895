//! Import of networks from the ModLaNet authors' program.

use super::{ImportError, Imported, MAX_ELEMENTS, Tensors};
use leastaction_core::energy::List;
use leastaction_core::energy::modular::{
    Input, MAX_NETWORKS, ModularShape, NetworkShape, PairInput, PairShape, TransformShape, TypeShape,
};
use leastaction_core::network::Activation;
use leastaction_ground_truth::ManyBody;
use leastaction_models::{ModularArchitecture, NamedTree, NamedType, Number};
use safetensors::SafeTensors;

/// Tensor with the mass of every element, \[1, 1\].
const MASS: &str = "mass.weight";
/// Tensors with c₁ and c₂, \[1\] each.
const COEFFICIENTS: [&str; 2] = ["co1", "co2"];

/// A network of the program: two hidden layers, no bias in the output layer.
struct Network {
    name: &'static str,
    inputs: u8,
    outputs: u8,
    activation: Activation,
}

impl Network {
    const fn new(name: &'static str, inputs: u8, outputs: u8, activation: Activation) -> Self {
        Self { name, inputs, outputs, activation }
    }

    const TENSORS: [&str; 5] =
        ["linear1.weight", "linear1.bias", "linear2.weight", "linear2.bias", "linear3.weight"];

    /// Appends the weights and returns the shape; the biases give the widths.
    fn read(&self, tensors: &Tensors, weights: &mut Vec<f64>) -> Result<NetworkShape, ImportError> {
        let layer = |k: usize| format!("{}.mlp.linear{k}", self.name);
        let width = |k| {
            let name = layer(k);
            tensors.width(&name).ok_or_else(|| ImportError::Missing(format!("{name}.bias")))
        };
        let widths = [width(1)?, width(2)?];
        let [first, second] = widths.map(usize::from);
        tensors.layer(&layer(1), self.inputs.into(), first)?.append(weights);
        tensors.layer(&layer(2), first, second)?.append(weights);
        tensors.layer_without_bias(&layer(3), second, self.outputs.into())?.append(weights);
        let (inputs, outputs, activation) = (self.inputs, self.outputs, self.activation);
        Ok(NetworkShape { inputs, widths: [widths[0], widths[1], 0, 0], outputs, activation })
    }
}

/// Networks of pendulums: position, velocity, U₁, U₂. The "hidden" layers of the potentials are linear.
const OF_PENDULUMS: [Network; 4] = [
    Network::new("Global4x", 1, 2, Activation::Tanh),
    Network::new("Global4v", 1, 2, Activation::Tanh),
    Network::new("Potential1", 2, 1, Activation::Identity),
    Network::new("Potential2", 4, 1, Activation::Identity),
];

/// Networks of free bodies: U₁, U₂.
const OF_BODIES: [Network; 2] =
    [Network::new("Potential1", 2, 1, Activation::Tanh), Network::new("Potential2", 4, 1, Activation::Tanh)];

/// Reads a network of the ModLaNet authors' program as a tree of `system`'s size with one element type.
///
/// Their Lagrangian is L = ½m Σ|ẋ|² − m c₁ Σ U₁(x) − m c₂ Σ_{a<b} ½\[U₂(x_a, x_b) + U₂(x_b, x_a)\]. Their pair
/// potential is multiplied by the mass once, ours by m_a m_b; thus our c₂ is their c₂ divided by m. For pendulums, x
/// and ẋ are tanh networks of the angle, wrapped to \[0, 2π), and the potentials have no activation. For bodies, x = q
/// and the potentials are tanh networks (the transforms in the files of bodies are not used).
///
/// `mass` (kg, above 0) replaces the mass in the file. As a factor of all of L it scales energies and leaves accelerations unchanged.
///
/// # Errors
/// [`ImportError`] names the tensor.
pub fn modlanet(bytes: &[u8], system: ManyBody, mass: Option<f64>) -> Result<Imported, ImportError> {
    if !(1..=MAX_ELEMENTS).contains(&system.count()) {
        return Err(ImportError::Count { found: system.count() });
    }
    let file = SafeTensors::deserialize(bytes)?;
    let tensors = Tensors { file: &file, option: "--system" };
    tensors.require_any("ModLaNet (Potential1.mlp.…)", |name| name.starts_with("Potential1."))?;
    tensors.refuse_others(is_known)?;
    let (mut networks, mut weights) = (List::default(), Vec::new());
    for (slot, network) in networks.slots.iter_mut().zip(networks_of(system)) {
        *slot = Some(network.read(&tensors, &mut weights)?);
    }
    let mass = mass.map_or_else(|| mass_of(&tensors), Ok)?;
    let [c1, c2] = COEFFICIENTS.map(|name| one_number(&tensors, name, &[1]));
    let coefficients = [Number::learned(c1?), Number::learned(c2? / mass)];
    let [inertia, centre, length, damping] = [0.0, 1.0, 1.0, 0.0].map(Number::known);
    let numbers = [Number::learned(mass), inertia, centre, length, damping];
    let types = vec![NamedType { name: element_name(system).to_owned(), numbers }];
    let architecture =
        ModularArchitecture::new(shape(system, networks), types, coefficients, vec![tree(system)]);
    weights.extend(architecture.numbers().map(|number| number.value));
    Ok(Imported { architecture: architecture.into(), weights, discrete: false })
}

fn networks_of(system: ManyBody) -> &'static [Network] {
    match system {
        ManyBody::Pendulum(_) => &OF_PENDULUMS,
        ManyBody::Bodies(_) => &OF_BODIES,
    }
}

/// Whether the authors' program has a tensor of this name, for either kind of system.
fn is_known(name: &str) -> bool {
    let of_network = |network: &Network| {
        let part = name.strip_prefix(network.name).and_then(|rest| rest.strip_prefix(".mlp."));
        part.is_some_and(|part| Network::TENSORS.contains(&part))
    };
    name == MASS || COEFFICIENTS.contains(&name) || OF_PENDULUMS.iter().any(of_network)
}

fn one_number(tensors: &Tensors, name: &str, shape: &[usize]) -> Result<f64, ImportError> {
    Ok(tensors.read(name, shape)?.into_iter().sum())
}

fn mass_of(tensors: &Tensors) -> Result<f64, ImportError> {
    let mass = one_number(tensors, MASS, &[1, 1])?;
    if mass > 0.0 { Ok(mass) } else { Err(ImportError::Mass { name: MASS.to_owned(), found: mass }) }
}

fn element_name(system: ManyBody) -> &'static str {
    match system {
        ManyBody::Pendulum(_) => "bob",
        ManyBody::Bodies(_) => "body",
    }
}

fn shape(system: ManyBody, networks: List<NetworkShape, MAX_NETWORKS>) -> ModularShape {
    let (transform, potential, pair) = match system {
        ManyBody::Pendulum(_) => {
            let input = Input::WrappedAngle;
            (TransformShape::Network { position: 0, velocity: Some(1), input }, 2, 3)
        }
        ManyBody::Bodies(_) => (TransformShape::Free, 0, 1),
    };
    let mut types = List::default();
    types.slots[0] = Some(TypeShape { transform, potential: Some(potential) });
    ModularShape { networks, types, pair: Some(PairShape { network: pair, input: PairInput::Concat }) }
}

fn tree(system: ManyBody) -> NamedTree {
    let kinds = vec![0; system.count()];
    let name = format!("{} {}", system.count(), system.name());
    match system {
        ManyBody::Pendulum(_) => NamedTree::chain(&name, &kinds),
        ManyBody::Bodies(_) => NamedTree::apart(&name, &kinds),
    }
}
