//! A model of any shape, from the Rust source that `leastaction export --rust` writes: `shapes.sh`.
#![no_std]
#![no_main]

use leastaction_chip::{image, models};
use leastaction_core::discrete::Newton;
use leastaction_firmware_sim::trajectory::reference;

/// Source that the environment variable LEASTACTION_SHAPE names.
#[allow(dead_code, reason = "an image uses a part of it")]
mod model {
    include!(concat!(env!("OUT_DIR"), "/shape.rs"));
}

/// Newton's method as in the other images, but with any remaining residual accepted, because random weights need not
/// describe a mechanism.
fn newton() -> Newton<f32> {
    Newton { accept: f32::INFINITY, ..reference::newton() }
}

#[cfg(not(graph))]
fn run() -> Result<(), &'static [u8]> {
    #[cfg(order_4)]
    use leastaction_core::discrete::Galerkin as Path;
    #[cfg(order_2)]
    use leastaction_core::discrete::Midpoint as Path;
    let model = models::load(model::load)?;
    models::free::<_, _, Path, { model::N }>(&model.system, newton())
}

/// A graph on a chain of rods, or on none.
#[cfg(graph)]
fn run() -> Result<(), &'static [u8]> {
    use leastaction_core::constraints::Holonomic;
    use leastaction_core::discrete::{
        Order,
        rattle::{ParticleState, Rattle},
    };
    use leastaction_core::energy::graph::Edge;

    const NODES: usize = model::N / model::DIMENSION;
    const ORDER: Order = if cfg!(order_4) { Order::Four } else { Order::Two };
    let mut rods = [Holonomic::Held { node: 0, axis: 0, at: 0.0 }; model::RODS];
    let mut edges = [Edge::default(); model::EDGES];
    let model = models::load(|| model::load(&mut edges, &mut rods))?;
    let mut workspace = [0.0; Rattle::<f32>::workspace_of::<2>(NODES, NODES, 1, 0)];
    let mut numbers = [0.0; ParticleState::<f32, 2>::workspace(NODES, NODES)];
    let q: [[f32; 2]; NODES] = core::array::from_fn(|i| [0.6 * (i + 1) as f32, -0.8 * (i + 1) as f32]);
    models::hanging(
        &model.system.graph,
        (model.system.rods, &q),
        (ORDER, newton()),
        (&mut numbers, &mut workspace),
    )
}

image!(run);
