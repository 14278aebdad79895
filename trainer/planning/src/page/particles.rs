//! Points of a graph, whose coordinates are the positions of its nodes.

use super::skeleton::Part;
use leastaction_core::constraints::Holonomic;
use leastaction_models::GraphArchitecture;
use nalgebra::Vector3;

/// Nodes of a graph in the plane or in space, with the fixed points of its rods.
pub struct Particles {
    dimension: usize,
    nodes: usize,
    anchors: Vec<Vector3<f64>>,
    /// Parts, from the back to the front.
    pub parts: Vec<Part>,
    /// Numbers of the nodes.
    pub tips: Vec<usize>,
}

impl Particles {
    /// The selected graph of a model; `None` if there is none.
    pub fn new(architecture: &GraphArchitecture) -> Option<Self> {
        let (graph, dimension) = (architecture.graph().ok()?, architecture.dimension());
        let nodes = graph.nodes.len();
        let edges = graph.edges.iter().map(|edge| edge.ends.map(usize::from)).map(|[a, b]| Part::Rail(a, b));
        let mut own = Self {
            dimension,
            nodes,
            anchors: Vec::new(),
            parts: edges.collect(),
            tips: (0..nodes).collect(),
        };
        match dimension {
            2 => own.add_rods(&graph.constraints::<2>()),
            _ => own.add_rods(&graph.constraints::<3>()),
        }
        own.parts.extend((0..nodes + own.anchors.len()).map(Part::Pivot));
        Some(own)
    }

    fn add_rods<const D: usize>(&mut self, rods: &[Holonomic<f64, D>]) {
        for rod in rods {
            let part = match rod {
                Holonomic::Rod { nodes: [a, b], .. } => Part::Link(*a, *b),
                Holonomic::Anchor { node, to, .. } => {
                    self.anchors.push(in_space(to));
                    Part::Link(self.nodes + self.anchors.len() - 1, *node)
                }
                Holonomic::Held { .. } => continue,
            };
            self.parts.push(part);
        }
    }

    /// All nodes, and the fixed points of rods.
    pub fn at(&self, q: &[f64]) -> Vec<Vector3<f64>> {
        q.chunks(self.dimension).map(in_space).chain(self.anchors.iter().copied()).collect()
    }

    /// Direction that is drawn downwards: −y in the plane, −z in space.
    pub fn down(&self) -> Vector3<f64> {
        if self.dimension == 2 { -Vector3::y() } else { -Vector3::z() }
    }
}

fn in_space(of: &[f64]) -> Vector3<f64> {
    let [x, y, z] = [0, 1, 2].map(|c| of.get(c).copied().unwrap_or(0.0));
    Vector3::new(x, y, z)
}
