//! Description of trees of elements in words.

use crate::modular::ModularArchitecture;
use crate::words::{Describe, layers};
use leastaction_core::energy::modular::{TransformShape, TreeElement, TypeShape};
use leastaction_core::model::TreeHeader;
use serde::Serialize;

/// Element types, and trees of them.
#[derive(Serialize)]
pub struct ModularDescription {
    /// Element types.
    types: Vec<ElementType>,
    /// Pair potential.
    pair: Option<String>,
    /// All trees.
    trees: Vec<Tree>,
    /// Name of the tree to which coordinates and cost refer.
    tree: String,
}

/// An element type.
#[derive(Serialize)]
struct ElementType {
    name: String,
    transform: String,
    potential: Option<String>,
    mass: f64,
    inertia: f64,
    centre: f64,
    length: f64,
    damping: f64,
}

/// A tree of elements: names of their types, and the parent of each.
#[derive(Serialize)]
struct Tree {
    name: String,
    coordinates: usize,
    elements: Vec<String>,
}

impl From<&ModularArchitecture> for ModularDescription {
    fn from(modular: &ModularArchitecture) -> Self {
        let header = modular.header();
        let trees = header.trees().map(|tree| Tree::new(tree, modular)).collect();
        let types = modular.shape.types.iter().zip(&modular.types).map(|(shape, named)| {
            let [mass, inertia, centre, length, damping] = named.numbers.map(|number| number.value);
            let transform = transform(shape, modular);
            let potential = shape.potential.map(|network| layers(modular.shape.networks.get(network)));
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
            format!(
                "of the {} {}",
                format!("{:?}", pair.input).to_lowercase(),
                layers(modular.shape.networks.get(pair.network))
            )
        });
        Self { types: types.collect(), pair, trees, tree: modular.tree_name().to_owned() }
    }
}

impl Describe for ModularDescription {
    fn lines(&self) -> Vec<(&'static str, String)> {
        let types = self.types.iter().map(|kind| ("element type", kind.line()));
        let pair = self.pair.iter().map(|pair| ("pair potential", pair.clone()));
        let trees = self.trees.iter().map(|tree| ("tree", tree.line()));
        types.chain(pair).chain(trees).collect()
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
        let element = |(i, node): (usize, TreeElement)| {
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
            let network = |network: u8| layers(modular.shape.networks.get(network));
            let own = velocity.map_or(String::new(), |v| format!(" with velocity {}", network(v)));
            format!("position {}{own}", network(position))
        }
        TransformShape::Rod => ROD.to_owned(),
        TransformShape::Slide => "slide".to_owned(),
        TransformShape::Free => "free point".to_owned(),
    }
}
