//! Model files of random shapes, written by core.

#![allow(dead_code, reason = "every test uses its own part")]

use leastaction_core::discrete::Order;
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::bodies::{BODY_PARAMETERS, GRAVITY_PARAMETERS};
use leastaction_core::energy::graph::{
    Drag, EDGE_NUMBERS, Edge, EdgeShape, GraphShape, Kinetic, NodeShape, Potential, Separation,
};
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::energy::modular::{
    Input, ModularShape, PairInput, PairShape, TransformShape, TypeShape,
};
use leastaction_core::forces::ControlKind;
use leastaction_core::model::{
    BodiesHeader, Family, FrictionNumber, GraphHeader, GraphLayout, Header, InertiaNetworkHeader, Law,
    LawNetwork, Laws, MAX_GRAPHS, MAX_TREES, ModularHeader, NumberRange, Rod, TrainedStep, TreeHeader, write,
};
use leastaction_core::network::Activation;

/// A repeatable stream of numbers.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// Returns a number in ±1.
    pub fn signed(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    pub fn vector(&mut self, n: usize, size: f32) -> Vec<f32> {
        (0..n).map(|_| size * self.signed()).collect()
    }
}

/// Step of all files.
pub fn step(order: Order) -> TrainedStep {
    TrainedStep { order, h: 0.01, control: ControlKind::Held }
}

/// The bytes of a file.
pub fn file(header: &Header, weights: &[f32]) -> Vec<u8> {
    let block: Vec<u8> = weights.iter().flat_map(|w| w.to_le_bytes()).collect();
    bytes(header, &block)
}

/// The bytes of a file with a weight block of any precision.
pub fn bytes(header: &Header, block: &[u8]) -> Vec<u8> {
    let mut memory = vec![0; block.len() + 65_536];
    write(header, block, &mut memory).unwrap().to_vec()
}

/// Number of steps of a motion.
pub const STEPS: usize = 4;

/// The bits of numbers.
pub fn bits(x: &[f32]) -> Vec<u32> {
    x.iter().map(|x| x.to_bits()).collect()
}

/// Bytes with the alignment of flash.
pub fn aligned(bytes: &[u8]) -> Vec<u32> {
    let mut words = vec![0_u32; bytes.len().div_ceil(4)];
    bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
    words
}

/// Bytes in words with the alignment of flash.
pub fn flash<'w>(words: &'w [u32], bytes: &[u8]) -> &'w [u8] {
    &bytemuck::cast_slice(words)[..bytes.len()]
}

/// Numbers of the laws for the given number of groups, in the order of a file.
fn numbers_of_laws(laws: Laws, groups: usize, random: &mut Random) -> Vec<f32> {
    let mut numbers = Vec::new();
    if laws.contains(Law::Viscous) {
        numbers.extend(random.vector(groups, 0.5).into_iter().map(f32::abs));
    }
    if laws.contains(Law::Coulomb) {
        let each = random.vector(4 * groups, 0.5).into_iter().map(|x| x.abs() + 0.0625);
        // Friction cannot grow with a position.
        let is_load = |k: usize| laws.contains(Law::Servo) && k % 4 == FrictionNumber::Load as usize;
        numbers.extend(each.enumerate().map(|(k, x)| if is_load(k) { 0.0 } else { x }));
    }
    for law in [Law::Dissipation, Law::Potential] {
        let Some(network) = laws.network(law) else { continue };
        if law == Law::Dissipation {
            numbers.extend((0..network.count()).map(|k| 0.5 + k as f32));
        }
        let count = network.network(law).unwrap().parameters().unwrap();
        numbers.extend(random.vector(count, 0.5));
    }
    if laws.contains(Law::Servo) {
        numbers.extend(random.vector(groups, 2.0).into_iter().map(f32::abs));
    }
    for law in [Law::Directional, Law::Sticking, Law::Stops].into_iter().filter(|law| laws.contains(*law)) {
        let each =
            random.vector(groups * law.ranges().len(), 0.5).into_iter().zip(law.ranges().iter().cycle());
        numbers.extend(each.map(|(x, range)| match range {
            NumberRange::NotBelowOne => 1.0 + x.abs(),
            NumberRange::Finite => x,
            _ => x.abs() + 0.0625,
        }));
    }
    numbers
}

/// The network of a law of models of one coordinate or more.
pub const NETWORK: LawNetwork<'static> =
    LawNetwork { coordinates: "a", widths: [6, 5, 0, 0], activation: Activation::Tanh };

/// An inertia network.
#[derive(Clone, Debug)]
pub struct InertiaNetworkSample {
    pub coordinates: String,
    pub widths: [u16; 4],
    pub activation: Activation,
    pub inertia: Inertia,
    pub laws: Laws<'static>,
    pub seed: u64,
}

impl InertiaNetworkSample {
    pub fn header(&self, order: Order) -> Header<'_> {
        let Self { coordinates, widths, activation, inertia, laws, .. } = self;
        let inertia_network =
            InertiaNetworkHeader { coordinates, widths: *widths, activation: *activation, inertia: *inertia };
        Header {
            laws: *laws,
            trained_step: Some(step(order)),
            ..Header::new(Family::InertiaNetwork(inertia_network))
        }
    }

    pub fn weights(&self) -> Vec<f32> {
        let Family::InertiaNetwork(inertia_network) = self.header(Order::Two).family else { unreachable!() };
        let mut random = Random(self.seed);
        let mut weights = random.vector(inertia_network.parameters().unwrap(), 0.5);
        weights.extend(numbers_of_laws(self.laws, inertia_network.n(), &mut random));
        weights
    }

    pub fn file(&self, order: Order) -> Vec<u8> {
        file(&self.header(order), &self.weights())
    }
}

/// A chain of learned links, rods and slides, with a pair potential.
#[derive(Clone, Debug)]
pub struct TreeSample {
    pub elements: Vec<u8>,
    pub width: u16,
    pub pair: PairInput,
    pub laws: Laws<'static>,
    pub seed: u64,
}

/// Names of the trees of a sample: the first has one element.
pub const TREES: [&str; 2] = ["link", "chain"];

impl TreeSample {
    /// A chain of n elements of alternating types.
    pub fn chain(n: usize, width: u16, pair: PairInput, laws: Laws<'static>, seed: u64) -> Self {
        let elements = (0..n).flat_map(|i| [((i as u64 + seed) % 3) as u8, i as u8]).collect();
        Self { elements, width, pair, laws, seed }
    }

    fn shape(&self) -> ModularShape {
        let network = |inputs, outputs, activation| {
            NetworkShape::new(inputs, &[self.width, 3], outputs, activation).unwrap()
        };
        let networks = [
            network(2, 2, Activation::Tanh),
            network(2, 1, Activation::Softplus),
            network(self.pair.features() as u8, 1, Activation::Squareplus),
        ];
        let learned = TransformShape::Network { position: 0, velocity: None, input: Input::Angle };
        let types = [
            TypeShape { transform: learned, potential: Some(1) },
            TypeShape { transform: TransformShape::Rod, potential: Some(1) },
            TypeShape { transform: TransformShape::Slide, potential: None },
        ];
        ModularShape::new(&networks, &types, Some(PairShape { network: 2, input: self.pair })).unwrap()
    }

    pub fn header(&self, order: Order) -> Header<'_> {
        let mut trees = [TreeHeader::default(); MAX_TREES];
        trees[0] = TreeHeader { name: TREES[0], elements: &[1, 0] };
        trees[1] = TreeHeader { name: TREES[1], elements: &self.elements };
        let modular = ModularHeader { shape: self.shape(), names: "link,rod,slide", trees };
        Header { laws: self.laws, trained_step: Some(step(order)), ..Header::new(Family::Modular(modular)) }
    }

    pub fn weights(&self) -> Vec<f32> {
        let Family::Modular(modular) = self.header(Order::Two).family else { unreachable!() };
        let kinds = [[1.5, 0.25, 0.5, 0.0], [0.75, 0.5, 1.0, 1.5], [2.0, 0.0, 1.0, 0.0]];
        let numbers = [kinds.concat(), vec![9.5, 0.25]].concat();
        let mut random = Random(self.seed);
        let mut weights = random.vector(modular.parameters().unwrap() - numbers.len(), 0.5);
        weights.extend(numbers);
        weights.extend(numbers_of_laws(self.laws, kinds.len(), &mut random));
        weights
    }

    pub fn file(&self, order: Order) -> Vec<u8> {
        file(&self.header(order), &self.weights())
    }
}

/// A chain of rigid bodies that turn and slide.
#[derive(Clone, Debug)]
pub struct BodiesSample {
    bodies: Vec<u8>,
    pub laws: Laws<'static>,
    pub seed: u64,
}

impl BodiesSample {
    /// A chain of n bodies of alternating joints.
    pub fn chain(n: usize, laws: Laws<'static>, seed: u64) -> Self {
        let bodies = (0..n).flat_map(|i| [((i as u64 + seed) % 2) as u8, i as u8]).collect();
        Self { bodies, laws, seed }
    }

    pub fn header(&self, order: Order) -> Header<'_> {
        let family = Family::Bodies(BodiesHeader::planar(&self.bodies));
        Header { laws: self.laws, trained_step: Some(step(order)), ..Header::new(family) }
    }

    pub fn weights(&self) -> Vec<f32> {
        let (mut random, n) = (Random(self.seed), self.bodies.len() / 2);
        let mut weights = random.vector(GRAVITY_PARAMETERS + BODY_PARAMETERS * n, 0.5);
        for body in weights[GRAVITY_PARAMETERS..].chunks_exact_mut(BODY_PARAMETERS) {
            [3, 6, 7].into_iter().for_each(|positive| body[positive] += 1.0);
        }
        weights.extend(numbers_of_laws(self.laws, n, &mut random));
        weights
    }

    pub fn file(&self, order: Order) -> Vec<u8> {
        file(&self.header(order), &self.weights())
    }
}

/// Particles in a row, springs between neighbours; the second graph of the file hangs from the origin by rods instead of half
/// of them.
#[derive(Clone, Debug)]
pub struct GraphSample {
    pub dimension: u8,
    nodes: Vec<u8>,
    edges: Vec<u8>,
    rods: Vec<u8>,
    pub width: u16,
    pub seed: u64,
}

/// Names of the graphs of a sample.
pub const GRAPHS: [&str; 2] = ["free", "hanging"];

impl GraphSample {
    pub fn row(dimension: u8, nodes: u16, width: u16, seed: u64) -> Self {
        let edge = |i: u16| Edge { kind: 0, ends: [i, i + 1] }.to_bytes();
        let rod = |i: u16| Rod { from: i.checked_sub(1), to: i, length: 1.0 }.to_bytes().unwrap();
        Self {
            dimension,
            nodes: vec![0; nodes.into()],
            edges: (0..nodes - 1).flat_map(edge).collect(),
            rods: (0..nodes.div_ceil(2)).flat_map(rod).collect(),
            width,
            seed,
        }
    }

    /// Positions with each node 1 m from the one before it, along a slope.
    pub fn positions(&self) -> Vec<f32> {
        let slope = [0.6, -0.8, 0.0];
        let dimension = usize::from(self.dimension);
        let place = |i: usize| (0..dimension).map(move |k| slope[k] * (i + 1) as f32);
        (0..self.nodes.len()).flat_map(place).collect()
    }

    fn shape(&self) -> GraphShape {
        let networks = [
            NetworkShape::new(1, &[self.width], 1, Activation::Squareplus).unwrap(),
            NetworkShape::new(self.dimension, &[self.width, 3], 1, Activation::Tanh).unwrap(),
        ];
        let node =
            NodeShape { kinetic: Kinetic::Mass, potential: Potential::Network(1), drag: Drag::Viscous };
        let edge = EdgeShape { separation: Separation::Distance, potential: Some(0), embedding: None };
        GraphShape::new(self.dimension, &networks, &[node], &[edge]).unwrap()
    }

    pub fn header(&self, order: Order) -> Header<'_> {
        let mut graphs = [GraphLayout::default(); MAX_GRAPHS];
        let Self { nodes, edges, rods, .. } = self;
        graphs[0] = GraphLayout { name: GRAPHS[0], nodes, edges, rods: &[] };
        graphs[1] = GraphLayout { name: GRAPHS[1], nodes, edges, rods };
        let graph = GraphHeader { shape: self.shape(), node_names: "bob", edge_names: "spring", graphs };
        Header { trained_step: Some(step(order)), ..Header::new(Family::Graph(graph)) }
    }

    pub fn weights(&self) -> Vec<f32> {
        let shape = self.shape();
        let mut random = Random(self.seed);
        let field = [0.0, 9.5, 0.25];
        let numbers = [vec![1.5, 0.25], field[..self.dimension.into()].to_vec()].concat();
        let mut weights = random.vector(shape.parameters().unwrap() - numbers.len() - EDGE_NUMBERS, 0.5);
        weights.extend(numbers);
        weights.extend([-0.75, 0.125]);
        weights
    }

    pub fn file(&self, order: Order) -> Vec<u8> {
        file(&self.header(order), &self.weights())
    }
}
