//! The shape of a model, in words.

use leastaction::architecture::{Architecture, ModularArchitecture, RigidArchitecture};
use leastaction_core::energy::modular::{NetworkShape, Node, TransformShape, TypeShape};
use leastaction_core::energy::rigid::Inertia;
use leastaction_core::model::TreeHeader;
use serde::Serialize;

/// What differs between the families.
#[derive(Serialize)]
#[serde(untagged)]
pub enum Shape {
    /// One network.
    Rigid {
        /// Inputs and outputs of every layer.
        layers: Vec<[usize; 2]>,
        /// Of the hidden layers.
        activation: String,
        /// Of the inertia matrix.
        inertia: String,
    },
    /// A tree of elements.
    Modular {
        /// The element types.
        types: Vec<ElementType>,
        /// The pair potential.
        pair: Option<String>,
        /// All trees.
        trees: Vec<Tree>,
        /// The one that coordinates and cost are of.
        tree: String,
    },
}

/// An element type.
#[derive(Serialize)]
pub struct ElementType {
    name: String,
    transform: String,
    potential: Option<String>,
    mass: f64,
    inertia: f64,
    centre: f64,
    length: f64,
    damping: f64,
}

/// A tree of elements: names of types, and what each hangs from.
#[derive(Serialize)]
pub struct Tree {
    name: String,
    coordinates: usize,
    elements: Vec<String>,
}

impl Shape {
    /// Of a model.
    pub fn of(architecture: &Architecture) -> Self {
        match architecture {
            Architecture::Rigid(rigid) => Self::rigid(rigid),
            Architecture::Modular(modular) => Self::modular(modular),
            Architecture::Graph(_) => unimplemented!(),
        }
    }

    fn rigid(rigid: &RigidArchitecture) -> Self {
        Self::Rigid {
            layers: rigid.layers().into_iter().map(|(inputs, outputs)| [inputs, outputs]).collect(),
            activation: format!("{:?}", rigid.activation).to_lowercase(),
            inertia: match rigid.inertia {
                Inertia::Diagonal => "diagonal".to_owned(),
                Inertia::Cholesky { epsilon } => format!("cholesky, epsilon {epsilon:e}"),
            },
        }
    }

    fn modular(modular: &ModularArchitecture) -> Self {
        let header = modular.header();
        let trees = header.trees().map(|tree| Tree::new(tree, modular)).collect();
        let types = modular.shape.types().zip(&modular.types).map(|(shape, named)| {
            let [mass, inertia, centre, length, damping] = named.numbers.map(|number| number.value);
            let transform = transform(shape, modular);
            let potential = shape.potential.map(|network| layers(modular, network));
            ElementType {
                name: named.name.clone(),
                transform,
                potential,
                mass,
                inertia,
                centre,
                length,
                damping,
            }
        });
        let pair = modular.shape.pair.map(|pair| {
            format!("of the {} {}", format!("{:?}", pair.input).to_lowercase(), layers(modular, pair.network))
        });
        Self::Modular { types: types.collect(), pair, trees, tree: modular.tree_name().to_owned() }
    }

    /// Names and values, line by line.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        match self {
            Self::Rigid { layers, activation, inertia } => {
                let layers: Vec<_> =
                    layers.iter().map(|[inputs, outputs]| format!("{inputs}x{outputs}")).collect();
                vec![
                    ("layers", format!("{} ({activation})", layers.join(", "))),
                    ("inertia matrix", inertia.clone()),
                ]
            }
            Self::Modular { types, pair, trees, .. } => {
                let types = types.iter().map(|kind| ("element type", kind.line()));
                let pair = pair.iter().map(|pair| ("pair potential", pair.clone()));
                let trees = trees.iter().map(|tree| ("tree", tree.line()));
                types.chain(pair).chain(trees).collect()
            }
        }
    }
}

impl ElementType {
    fn line(&self) -> String {
        let Self { name, transform, potential, mass, inertia, centre, length, damping } = self;
        let potential = potential.as_ref().map_or("no potential".to_owned(), |p| format!("potential {p}"));
        let mut line = format!("{name}: {transform}, {potential}, mass {mass:.4} kg");
        let others = [
            (transform == ROD, "length", *length, " m"),
            (*inertia != 0.0, "moment of inertia", *inertia, " kg m²"),
            (*centre != 1.0, "centre", *centre, ""),
            (*damping != 0.0, "damping", *damping, ""),
        ];
        for (_, what, value, unit) in others.into_iter().filter(|(shown, ..)| *shown) {
            line.push_str(&format!(", {what} {value:.4}{unit}"));
        }
        line
    }
}

const ROD: &str = "rod";

impl Tree {
    fn new(tree: &TreeHeader, modular: &ModularArchitecture) -> Self {
        let element = |(i, node): (usize, Node)| {
            let name = modular.types.get(usize::from(node.kind)).map_or("?", |kind| kind.name.as_str());
            match node.parent {
                None => format!("{i} {name}"),
                Some(parent) => format!("{i} {name} on {parent}"),
            }
        };
        Self {
            name: tree.name.to_owned(),
            coordinates: tree.coordinates(&modular.shape).unwrap_or(0),
            elements: tree.nodes().enumerate().map(element).collect(),
        }
    }

    fn line(&self) -> String {
        let Self { name, coordinates, elements } = self;
        let unit = if *coordinates == 1 { "coordinate" } else { "coordinates" };
        format!("{name} ({coordinates} {unit}): {}", elements.join(", "))
    }
}

fn transform(shape: &TypeShape, modular: &ModularArchitecture) -> String {
    match shape.transform {
        TransformShape::Network { position, velocity, .. } => {
            let own = velocity.map_or(String::new(), |v| format!(" with velocity {}", layers(modular, v)));
            format!("position {}{own}", layers(modular, position))
        }
        TransformShape::Rod => ROD.to_owned(),
        TransformShape::Slide => "slide".to_owned(),
        TransformShape::Free => "free point".to_owned(),
    }
}

/// A network as 2-16-1 (tanh).
fn layers(modular: &ModularArchitecture, network: u8) -> String {
    let Some(NetworkShape { inputs, widths, outputs, activation }) =
        modular.shape.networks().nth(network.into())
    else {
        return "?".to_owned();
    };
    let hidden: String = widths.iter().take_while(|w| **w > 0).map(|w| format!("{w}-")).collect();
    let activation =
        if hidden.is_empty() { "linear".to_owned() } else { format!("{activation:?}").to_lowercase() };
    format!("{inputs}-{hidden}{outputs} ({activation})")
}
