//! The shape of a model, in words.

use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::arm::ArmParameters;
use leastaction_core::energy::bodies::{BodyParameters, Joint, TreeBody};
use leastaction_core::energy::graph::{Drag, Kinetic, Potential, Separation};
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::energy::modular::{TransformShape, TreeElement, TypeShape};
use leastaction_core::model::TreeHeader;
use leastaction_models::{
    AnyFamily, Architecture, ArmArchitecture, BodiesArchitecture, Family as _, GraphArchitecture,
    InertiaNetworkArchitecture, ModularArchitecture,
};
use serde::Serialize;

/// What differs between the families.
#[derive(Serialize)]
#[serde(untagged)]
pub enum ShapeReport {
    /// One network.
    InertiaNetwork {
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
    /// A graph of particles.
    Graph {
        /// Coordinates of a node.
        dimension: usize,
        /// The node types.
        nodes: Vec<String>,
        /// The edge types.
        edges: Vec<String>,
        /// All graphs.
        graphs: Vec<GraphOf>,
        /// The one that coordinates and cost are of.
        graph: String,
    },
    /// A tree of rigid bodies.
    Bodies {
        /// m/s².
        gravity: [f64; 2],
        /// The bodies, in the order of the coordinates.
        bodies: Vec<Body>,
    },
    /// A tree of rigid bodies in space.
    Arm {
        /// m/s².
        gravity: [f64; 3],
        /// The bodies, in the order of the coordinates.
        bodies: Vec<ArmBody>,
    },
}

/// A rigid body in space on its joint.
#[derive(Serialize)]
pub struct ArmBody {
    joint: &'static str,
    on: Option<u8>,
    at: [f64; 3],
    axis: [f64; 3],
    mass: f64,
    centre: [f64; 3],
    inertia: [f64; 3],
    rotor: f64,
}

/// A rigid body on its joint.
#[derive(Serialize)]
pub struct Body {
    joint: &'static str,
    on: Option<u8>,
    at: [f64; 2],
    angle: f64,
    mass: f64,
    centre: [f64; 2],
    inertia: f64,
    rotor: f64,
    gear: f64,
}

/// A graph by its name and size.
#[derive(Serialize)]
pub struct GraphOf {
    name: String,
    nodes: usize,
    edges: usize,
    rods: usize,
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

impl ShapeReport {
    /// Of a model.
    pub fn of(architecture: &Architecture) -> Self {
        match &architecture.family {
            AnyFamily::InertiaNetwork(inertia_network) => Self::inertia_network(inertia_network),
            AnyFamily::Modular(modular) => Self::modular(modular),
            AnyFamily::Graph(graph) => Self::graph(graph),
            AnyFamily::Bodies(bodies) => Self::bodies(bodies),
            AnyFamily::Arm(arm) => Self::arm(arm),
        }
    }

    fn inertia_network(inertia_network: &InertiaNetworkArchitecture) -> Self {
        Self::InertiaNetwork {
            layers: inertia_network.layers().into_iter().map(|(inputs, outputs)| [inputs, outputs]).collect(),
            activation: format!("{:?}", inertia_network.activation).to_lowercase(),
            inertia: match inertia_network.inertia {
                Inertia::Diagonal => "diagonal".to_owned(),
                Inertia::Cholesky { epsilon } => format!("cholesky, epsilon {epsilon:e}"),
                Inertia::Factor { rows, epsilon } => format!("factor of {rows} rows, epsilon {epsilon:e}"),
            },
        }
    }

    fn modular(modular: &ModularArchitecture) -> Self {
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
        Self::Modular { types: types.collect(), pair, trees, tree: modular.tree_name().to_owned() }
    }

    fn graph(graph: &GraphArchitecture) -> Self {
        let shape = &graph.shape;
        let network = |network: u8| layers(shape.networks.get(network));
        let named = shape.nodes.iter().zip(&graph.node_types).map(|(kind, named)| {
            let number = |k: usize| named.numbers.get(k).map_or(f64::NAN, |number| number.value);
            let kinetic = match kind.kinetic {
                Kinetic::Mass => format!("mass {:.4} kg", number(0)),
                Kinetic::Network(n) => format!("kinetic energy {}", network(n)),
            };
            let field: Vec<_> = (0..graph.dimension()).map(|i| format!("{:.4}", number(2 + i))).collect();
            let field = format!("({}) N", field.join(", "));
            let potential = match kind.potential {
                Potential::None => "no potential".to_owned(),
                Potential::Uniform => format!("field {field}"),
                Potential::Network(n) => format!("field {field}, potential {}", network(n)),
            };
            let drag = match kind.drag {
                Drag::None => String::new(),
                Drag::Viscous => format!(", drag {:.4} N s/m", number(1)),
                Drag::Network(n) => format!(", drag {}", network(n)),
            };
            format!("{}: {kinetic}, {potential}{drag}", named.name)
        });
        let joined = shape.edges.iter().zip(&graph.edge_types).map(|(kind, named)| {
            let name = &named.name;
            let law: Vec<_> = named.numbers.iter().map(|number| format!("{:.4}", number.value)).collect();
            let seen = match kind.separation {
                Separation::Distance => "distance",
                Separation::Squared => "squared distance",
            };
            let potential = kind.potential.map_or("no potential".to_owned(), network);
            let embedding = kind.embedding.map_or(String::new(), |n| format!(", embedded by {}", network(n)));
            format!("{name}: of the {seen}, law ({}), {potential}{embedding}", law.join(", "))
        });
        let graphs = graph.graphs.iter().map(|graph| GraphOf {
            name: graph.name.clone(),
            nodes: graph.nodes.len(),
            edges: graph.edges.len(),
            rods: graph.rods.len(),
        });
        Self::Graph {
            dimension: graph.dimension(),
            nodes: named.collect(),
            edges: joined.collect(),
            graphs: graphs.collect(),
            graph: graph.graph().map_or(String::new(), |graph| graph.name.clone()),
        }
    }

    fn bodies(bodies: &BodiesArchitecture) -> Self {
        let each = bodies.bodies().zip(&bodies.numbers);
        Self::Bodies {
            gravity: bodies.gravity.map(|number| number.value),
            bodies: each.map(|(body, numbers)| Body::new(body, numbers.map(|number| number.value))).collect(),
        }
    }

    fn arm(arm: &ArmArchitecture) -> Self {
        let weights = arm.initial_weights(0);
        let numbers = |k: usize| ArmArchitecture::body_of(&weights, k);
        let each = arm.tree_bodies().enumerate().filter_map(|(k, body)| Some((body, numbers(k)?)));
        Self::Arm {
            gravity: arm.gravity,
            bodies: each.map(|(body, numbers)| ArmBody::new(body, numbers)).collect(),
        }
    }

    /// Names and values, line by line.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        match self {
            Self::InertiaNetwork { layers, activation, inertia } => {
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
            Self::Graph { dimension, nodes, edges, graphs, .. } => {
                let lines = [("dimensions", dimension.to_string())].into_iter();
                let nodes = nodes.iter().map(|kind| ("node type", kind.clone()));
                let edges = edges.iter().map(|kind| ("edge type", kind.clone()));
                let graphs = graphs.iter().map(|graph| ("graph", graph.line()));
                lines.chain(nodes).chain(edges).chain(graphs).collect()
            }
            Self::Bodies { gravity: [x, y], bodies } => {
                let gravity = [("gravity", format!("({x:.4}, {y:.4}) m/s²"))].into_iter();
                gravity.chain(bodies.iter().map(|body| ("body", body.line()))).collect()
            }
            Self::Arm { gravity: [x, y, z], bodies } => {
                let gravity = [("gravity", format!("({x:.4}, {y:.4}, {z:.4}) m/s²"))].into_iter();
                gravity.chain(bodies.iter().map(|body| ("body", body.line()))).collect()
            }
        }
    }
}

/// What a joint is called.
fn name(joint: Joint) -> &'static str {
    match joint {
        Joint::Revolute => "revolute",
        Joint::Prismatic => "prismatic",
    }
}

/// Numbers in brackets.
fn vector(x: &[f64; 3]) -> String {
    format!("({:.4}, {:.4}, {:.4})", x[0], x[1], x[2])
}

impl ArmBody {
    fn new(body: TreeBody, numbers: ArmParameters<f64>) -> Self {
        let [m, x, y, z, xx, _, yy, _, _, zz] = numbers.inertia.into_array();
        let centre = if m > 0.0 { [x / m, y / m, z / m] } else { [0.0; 3] };
        Self {
            joint: name(body.joint),
            on: body.parent,
            at: numbers.place,
            axis: numbers.axis,
            mass: m,
            centre,
            inertia: [xx, yy, zz],
            rotor: numbers.rotor,
        }
    }

    fn line(&self) -> String {
        let Self { joint, on, at, axis, mass, centre, inertia, rotor } = self;
        let on = on.map_or_else(|| "the base".to_owned(), |on| format!("body {on}"));
        format!(
            "{joint} on {on} at {} m about {}, {mass:.4} kg, centre {} m, moments of inertia about the joint {} kg m², rotor {rotor:.4} kg m²",
            vector(at),
            vector(axis),
            vector(centre),
            vector(inertia)
        )
    }
}

impl GraphOf {
    fn line(&self) -> String {
        let Self { name, nodes, edges, rods } = self;
        format!("{name}: nodes {nodes}, edges {edges}, rods {rods}")
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

impl Body {
    fn new(TreeBody { joint, parent }: TreeBody, numbers: [f64; 9]) -> Self {
        let BodyParameters { place, angle, mass, centre, inertia, rotor, gear } =
            BodyParameters::from_array(numbers);
        let joint = name(joint);
        Self { joint, on: parent, at: place, angle, mass, centre, inertia, rotor, gear }
    }

    fn line(&self) -> String {
        let Self { joint, on, at: [x, y], angle, mass, centre: [cx, cy], inertia, rotor, gear } = self;
        let on = on.map_or("the ground".to_owned(), |body| format!("body {body}"));
        let drive =
            if *rotor > 0.0 { format!(", rotor {rotor:.3e} kg m² by {gear:.4}") } else { String::new() };
        format!(
            "{joint} on {on} at ({x:.4}, {y:.4}) m, {angle:.4} rad: mass {mass:.4} kg, centre ({cx:.4}, {cy:.4}) m, \
             inertia {inertia:.3e} kg m²{drive}"
        )
    }
}

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

/// A network as 2-16-1 (tanh).
fn layers(network: Option<&NetworkShape>) -> String {
    let Some(NetworkShape { inputs, widths, outputs, activation }) = network else {
        return "?".to_owned();
    };
    let hidden: String = widths.iter().take_while(|w| **w > 0).map(|w| format!("{w}-")).collect();
    let activation =
        if hidden.is_empty() { "linear".to_owned() } else { format!("{activation:?}").to_lowercase() };
    format!("{inputs}-{hidden}{outputs} ({activation})")
}
