//! A graph of any number of nodes in the plane, two of them joined, and one of two nodes.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_core::constraints::{Constrained, Holonomic};
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::discrete::{Newton, Order};
use leastaction_core::energy::graph::{Edge, Fixed, Graph, Member, Union, cutoff_edges};
use leastaction_core::forces::{Forces, Grip, System};
use leastaction_core::model::GraphModel;
use leastaction_core::particles::{Gripped, Particles};
use leastaction_core::stepper::{
    Actuated, Actuation, Direct, Drive, Held, Kind, Linear, ParticleMemory, ParticleStepper, particle_numbers,
};
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

/// Steps beside rods under dry friction that sticks.
#[inline(never)]
fn gripped(graph: &Graph<f32, 2, 6, 8, 2>, rods: &[Holonomic<f32, 2>]) {
    let (grips, at) = (black_box([[Grip::none(); 2]; NODES]), black_box([[0.1; 2]; NODES]));
    let Ok(system) = Gripped::new(graph, &grips, black_box(0.1)) else { return };
    all(&system);
    let Ok(mechanism) = Constrained::new(&system, rods) else { return };
    let (mut memory, mut more, mut work) = ([0.0; 256], [0.0; 256], [0.0; 512]);
    let rattle = Rattle::new(black_box(0.01), black_box(Order::Two));
    if let Ok(mut state) = ParticleState::new(&mechanism, &at, &at, &mut memory, &mut work) {
        let _ = black_box(rattle.step(&mechanism, &mut state, Some(&at), &mut work));
    }
    let _ = black_box(rattle.start(&mechanism, [&at; 2], None, &mut more, &mut work).is_ok());
}

/// Everything of a stepper of this kind.
#[inline(never)]
fn stepper<K: Kind, A: Actuation<6>, const PAST: usize>() {
    const NUMBERS: usize = particle_numbers::<2>(3, 4, 3, 64);
    let mut memory = ParticleMemory::<2, 8, 4, NUMBERS>::new();
    let (name, at) = (black_box("web"), black_box([0.1; 6]));
    let file = FLASH.bytes();
    let found = if black_box(true) {
        ParticleStepper::<GraphModel<2, 6, 8, 2>, Drive<K, A, 6, PAST>, 2, 6>::new(file, name, &mut memory)
    } else {
        ParticleStepper::with_step(file, name, &mut memory, black_box(0.01))
    };
    let Ok(mut stepper) = found else { return };
    let _ = black_box((stepper.start(at, at), stepper.step(at), stepper.commanded(at)));
    let _ = black_box((stepper.start_from([at, at], at), stepper.step(at)));
    black_box((stepper.q(), stepper.v(), stepper.p(), stepper.h(), stepper.state().lambda()));
    black_box(stepper.with_newton(black_box(Newton::new())).q());
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
        gripped(&graph, model.system.rods);
        fixed(graph);
        let nodes = black_box([0, 1, 2]);
        let members = [Member { graph, nodes: &nodes }; 2];
        if let Ok(union) = Union::new(&members, NODES) {
            all(&union);
        }
    }
    stepper::<Held, Direct, 0>();
    stepper::<Linear, Actuated<6>, 5>();
    let _ = black_box(cutoff_edges(&black_box([[0.1_f32; 2]; NODES]), 1.0, 0, &mut edges));
    halt()
}
