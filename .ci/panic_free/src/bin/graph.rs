//! A graph of any number of nodes in the plane, two of them joined, and one of two nodes.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_core::constraints::Holonomic;
use leastaction_core::energy::graph::{Edge, Fixed, Graph, Member, Union, cutoff_edges};
use leastaction_core::forces::{Forces, System};
use leastaction_core::model::GraphModel;
use leastaction_core::particles::Particles;
use panic_free::{Flash, everything, halt, said};

static FLASH: Flash = Flash::new();
const NODES: usize = 5;

/// Everything of particles.
#[inline(never)]
fn all(particles: &impl Particles<f32, 2>) {
    let (q, mut workspace, mut l_q) = (black_box([[0.1; 2]; NODES]), [0.0; 256], [[0.0; 2]; NODES]);
    let (node, v) = (black_box(3), &black_box([0.1; 2]));
    black_box((particles.nodes(), particles.workspace(), particles.energies(&q, &q, &mut workspace)));
    particles.l_q(&q, &mut workspace, &mut l_q);
    black_box(l_q);
    black_box((particles.l_v(node, v), particles.mass(node, v)));
    black_box((particles.drag(node, v), particles.drag_slope(node, v)));
    let mut masses = [[[0.0; 2]; 2]; NODES];
    particles.momenta(node, &q, &mut l_q);
    particles.masses(node, &q, &mut masses);
    black_box((l_q, masses));
    particles.drags(node, &q, &mut l_q);
    black_box(l_q);
    particles.drag_slopes(node, &q, &mut l_q);
    black_box(l_q);
}

#[inline(never)]
fn fixed(graph: Graph<f32, 2, 6, 8, 2>) {
    let Ok(lagrangian) = Fixed::<_, 2, 6, 8, 2, 4>::new(graph) else { return };
    let at = &black_box([0.1_f32; 4]);
    black_box((lagrangian.force(at, at, at), lagrangian.derivatives(at, at, at)));
    everything(&System { lagrangian, forces: lagrangian });
}

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    let (mut edges, mut rods) = ([Edge::default(); 8], [Holonomic::Held { node: 0, axis: 0, at: 0.0 }; 4]);
    if let Ok(model) = GraphModel::<2, 6, 8, 2>::load(FLASH.bytes(), black_box("web"), &mut edges, &mut rods)
    {
        let graph = model.system.graph;
        said::<_, 4>(&model);
        let _ = black_box((model.rattle::<f32>(), model.system.constrained().is_ok()));
        all(&graph);
        fixed(graph);
        let nodes = black_box([0, 1, 2]);
        let members = [Member { graph, nodes: &nodes }; 2];
        if let Ok(union) = Union::new(&members, NODES) {
            all(&union);
        }
    }
    let _ = black_box(cutoff_edges(&black_box([[0.1_f32; 2]; NODES]), 1.0, 0, &mut edges));
    halt()
}
