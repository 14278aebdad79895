//! Graphs on rods, and their motion as core steps it.

use leastaction_core::constraints::{Constrained, Holonomic};
use leastaction_core::discrete::{
    self,
    rattle::{ParticleState, Rattle},
};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{
    Drag, Edge, EdgeShape, Graph, GraphShape, Kinetic, MAX_NETWORKS, NodeShape, Potential, Separation, Types,
};
use leastaction_core::forces::ControlKind;
use leastaction_core::model::Rod;
use leastaction_core::network::Activation;
use leastaction_programs::dynamics::{Order, Rods};
use leastaction_programs::energies::{Energies, GraphEnergies};
use leastaction_programs::losses::{Block, RodsLoss};
use leastaction_programs::{Row, System, WIDTH};

/// Step size, s.
pub const H: f64 = 0.06;

/// A kinetic energy that is not quadratic, and a drag that is not linear.
pub const ODD: NodeShape =
    NodeShape { kinetic: Kinetic::Network(0), potential: Potential::Network(1), drag: Drag::Network(2) };
pub const PLAIN: NodeShape =
    NodeShape { kinetic: Kinetic::Mass, potential: Potential::Uniform, drag: Drag::Viscous };
pub const SMOOTH: NodeShape = NodeShape { drag: Drag::None, ..PLAIN };

/// A graph on rods, with its weights.
pub struct Case<const D: usize> {
    pub shape: GraphShape,
    pub nodes: Vec<u8>,
    pub edges: Vec<Edge>,
    pub rods: Vec<Rod>,
    pub weights: Vec<f64>,
}

impl<const D: usize> Case<D> {
    pub fn new(kinds: &[NodeShape], nodes: &[u8], edges: &[[u16; 2]], rods: &[Rod]) -> Self {
        let network = |inputs, units| {
            NetworkShape::new(inputs, &[units], 1, Activation::Squareplus).expect("a network")
        };
        let networks = [network(1, 2), network(D as u8, 3), network(1, 2), network(1, 3)];
        let spring = EdgeShape { separation: Separation::Squared, potential: Some(3), embedding: None };
        let shape = GraphShape::new(D as u8, &networks, kinds, &[spring]).expect("a shape");
        let edges: Vec<Edge> = edges.iter().map(|ends| Edge { kind: 0, ends: *ends }).collect();
        let parameters = GraphEnergies::new(&shape, nodes, &edges, 0).expect("a graph").parameters();
        // Positive weights make kinetic energies convex, and the drag has no kink.
        let weights = (0..parameters).map(|k| 0.3 + 0.6 * wave(k).abs()).collect();
        Self { shape, nodes: nodes.to_vec(), edges, rods: rods.to_vec(), weights }
    }

    pub fn system(&self) -> System {
        System::new(&GraphEnergies::new(&self.shape, &self.nodes, &self.edges, 0).expect("a graph"))
    }

    pub fn rods(&self) -> Rods {
        Rods::new(D, &self.rods)
    }

    pub fn n(&self) -> usize {
        D * self.nodes.len()
    }

    pub fn graph<'a>(&'a self, weights: &'a [f64]) -> Graph<'a, f64, D, MAX_NETWORKS, 64, 4> {
        let mut block = weights;
        let types = Types::take(&mut block, &self.shape).expect("types");
        Graph::new(types, &self.nodes, &self.edges).expect("a graph")
    }

    pub fn constraints(&self) -> Vec<Holonomic<f64, D>> {
        self.rods.iter().map(Rod::constraint).collect()
    }

    /// Positions on the rods, and velocities, different for every seed.
    pub fn start(&self, seed: usize) -> [Vec<[f64; D]>; 2] {
        let vector = |k: usize| -> [f64; D] { std::array::from_fn(|i| 1.3 * wave(5 * k + i + 17 * seed)) };
        let mut q: Vec<[f64; D]> = (0..self.nodes.len()).map(vector).collect();
        for rod in &self.rods {
            let from = rod.from.map_or([0.0; D], |from| q[usize::from(from)]);
            let d = vector(usize::from(rod.to) + 3);
            let size = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            let share = f64::from(rod.length) / size;
            q[usize::from(rod.to)] = std::array::from_fn(|i| from[i] + share * d[i]);
        }
        [q, (0..self.nodes.len()).map(|k| vector(k + 7)).collect()]
    }

    /// Triples of positions of the motion that RATTLE computes under a control that differs at every step.
    pub fn stepped(&self, order: discrete::Order, kind: ControlKind) -> Block {
        let (graph, rods) = (self.graph(&self.weights), self.constraints());
        let mechanism = Constrained::new(&graph, &rods[..]).expect("rods");
        let mut workspace = vec![0.0; ParticleState::<f64, D>::workspace(self.nodes.len(), rods.len())];
        let mut work = vec![0.0; Rattle::workspace(&mechanism)];
        let [q, v] = self.start(0);
        let mut state =
            ParticleState::new(&mechanism, &q, &v, &mut workspace, &mut work).expect("on its rods");
        let control = |k: usize| (0..self.n()).map(|i| 3.0 * wave(11 * k + i)).collect::<Vec<f64>>();
        let mut positions = vec![state.q().as_flattened().to_vec()];
        for k in 0..=WIDTH {
            let end = match kind {
                ControlKind::Held => k,
                ControlKind::Linear => k + 1,
            };
            let force: Vec<f64> = control(k).iter().zip(control(end)).map(|(a, b)| 0.5 * (a + b)).collect();
            let rattle = Rattle::new(H, order);
            rattle.step(&mechanism, &mut state, Some(force.as_chunks().0), &mut work).expect("steps");
            positions.push(state.q().as_flattened().to_vec());
        }
        let controls: Vec<Vec<f64>> = (0..WIDTH + 2).map(control).collect();
        Block {
            states: [0, 1, 2].map(|k| rows(&positions[k..])),
            controls: [0, 1, 2].map(|k| rows(&controls[k..])),
            control: kind,
            ..Block::default()
        }
    }

    pub fn loss(&self, order: Order, next_position: bool) -> RodsLoss {
        RodsLoss::new(&self.system(), self.rods(), H, order, next_position).expect("of particles")
    }

    /// Positions near the rods, with velocities and accelerations that belong to no motion.
    pub fn disturbed(&self) -> Block {
        let starts: Vec<[Vec<[f64; D]>; 2]> = (0..WIDTH).map(|seed| self.start(seed)).collect();
        let of = |part: usize| -> Vec<Vec<f64>> {
            starts.iter().map(|start| start[part].as_flattened().to_vec()).collect()
        };
        let random = |seed: usize| -> Vec<Vec<f64>> {
            (0..WIDTH).map(|k| (0..self.n()).map(|i| wave(seed + 13 * k + i)).collect()).collect()
        };
        let tau = rows(&random(5));
        Block {
            states: [rows(&of(0)), rows(&of(1)), rows(&random(3))],
            controls: [tau.clone(), tau.clone(), tau],
            ..Block::default()
        }
    }
}

/// A number between −1 and 1 that is different for every k.
pub fn wave(k: usize) -> f64 {
    (1.7 * k as f64 + 0.4).sin()
}

/// Rows of vectors: one row per component, one vector per sample.
pub fn rows(vectors: &[Vec<f64>]) -> Vec<Row> {
    (0..vectors[0].len()).map(|i| Row(std::array::from_fn(|sample| vectors[sample][i]))).collect()
}
