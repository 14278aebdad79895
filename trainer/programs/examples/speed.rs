//! Compares programs with core's code, whose sizes are types, over lanes of the same samples. It prints nanoseconds per
//! sample for the parts of losses, for an inertia network of two coordinates (core has no derivatives with respect to
//! the weights), and for the acceleration loss of a chain of two equal pendulums with learned networks.
//!
//! `cargo run --release -p leastaction-programs --example speed`

use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::energy::modular::{Input, ModularShape, TransformShape, TreeElement, TypeShape};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::network::Activation;
use leastaction_core::scalar::{LANES, Lanes};
use leastaction_programs::energies::{Energies, InertiaNetworkEnergies, ModularEnergies};
use leastaction_programs::losses::{AccelerationLoss, Block, Derivatives, Loss};
use leastaction_programs::{Row, System, WIDTH};
use std::hint::black_box;
use std::time::Instant;

const KINDS: [Coordinate; 2] = [Coordinate::Translation, Coordinate::Angle];
const INERTIA: Inertia = Inertia::Cholesky { epsilon: 1e-3 };

fn nanoseconds(samples: usize, mut run: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..30 {
        let clock = Instant::now();
        (0..200).for_each(|_| run());
        best = best.min(clock.elapsed().as_nanos() as f64 / (200 * samples) as f64);
    }
    best
}

/// A chain of two equal elements; position and potential are networks.
fn pendulums() -> ModularEnergies {
    let network =
        |inputs, outputs| NetworkShape::new(inputs, &[16, 16], outputs, Activation::Tanh).expect("a network");
    let transform = TransformShape::Network { position: 0, velocity: None, input: Input::Angle };
    let kind = TypeShape { transform, potential: Some(1) };
    let shape = ModularShape::new(&[network(2, 2), network(2, 1)], &[kind], None).expect("a shape");
    let chain = [None, Some(0)].map(|parent| TreeElement { kind: 0, parent });
    ModularEnergies::new(&shape, &chain, false).expect("a tree")
}

/// Times the residual alone, with its gradient, and with its Jacobian.
fn acceleration_loss() {
    let model = pendulums();
    let mut weights: Vec<f64> = (0..model.parameters()).map(|i| (1.7 * i as f64).sin() * 0.3).collect();
    // Mass 1, no moment of inertia, the centre at the end, c₁ = 1.
    let count = weights.len();
    weights[count - 6..].copy_from_slice(&[1.0, 0.0, 1.0, 1.0, 1.0, 0.0]);
    let mut loss = AccelerationLoss::new(&System::new(&model));
    let rows = vec![Row::splat(0.3), Row::splat(0.7)];
    let block = Block {
        states: [(); 3].map(|()| rows.clone()),
        controls: [(); 3].map(|()| vec![Row::default(); 2]),
        ..Block::default()
    };
    let mut residual = rows.clone();
    let mut gradients = vec![vec![Row::default(); count]; 2];
    let mut gradient = gradients[0].clone();
    let times = [
        nanoseconds(WIDTH, || {
            loss.evaluate(&weights, &block, &mut residual, Derivatives::None);
        }),
        nanoseconds(WIDTH, || {
            loss.evaluate(&weights, &block, &mut residual, Derivatives::Gradient(&mut gradient));
        }),
        nanoseconds(WIDTH, || {
            loss.evaluate(&weights, &block, &mut residual, Derivatives::Jacobian(&mut gradients));
        }),
    ];
    for (name, time) in ["residual", "gradient", "Jacobian"].into_iter().zip(times) {
        println!("pendulums {name:<10} {time:>7.1} ns");
    }
}

fn beside(lanes: f64, time: f64) -> String {
    format!(", lanes {lanes:>7.1} ns: {:.2}×", lanes / time)
}

fn main() {
    acceleration_loss();
    for width in [16_u16, 32, 64] {
        let model = InertiaNetworkEnergies::new(
            KINDS.to_vec(),
            (&[width.into(), width.into()], Activation::Tanh),
            INERTIA,
            false,
        );
        let weights: Vec<f64> = (0..model.parameters()).map(|i| (1.7 * i as f64).sin() * 0.3).collect();
        let shape =
            InertiaNetworkShape::new(KINDS, &[width, width], Activation::Tanh, INERTIA).expect("a shape");
        let core = InertiaNetwork::<f64, 2, 64, 3>::take(&mut &weights[..], &shape).expect("a model");
        let x = [Lanes([0.3; LANES]), Lanes([0.7; LANES])];
        let lanes = [
            nanoseconds(LANES, || {
                black_box(Lagrangian::<Lanes, 2>::gradient(&core, black_box(&x), &x));
            }),
            nanoseconds(LANES, || {
                black_box(Lagrangian::<Lanes, 2>::dynamics(&core, black_box(&x), &x));
            }),
            nanoseconds(LANES, || {
                black_box(Lagrangian::<Lanes, 2>::hessian(&core, black_box(&x), &x));
            }),
        ];
        let lanes = lanes.into_iter().map(Some).chain([None; 2]);
        let system = System::new(&model);
        let rows = [Row::splat(0.3), Row::splat(0.7)];
        let programs = [
            system.gradient(),
            system.equation_of_motion().0,
            system.derivatives().0,
            system.along(1),
            system.residual(1),
        ];
        let names = ["gradient", "dynamics", "hessian", "along", "residual"];
        for ((name, program), lanes) in names.into_iter().zip(programs).zip(lanes) {
            let mut workspace = program.workspace();
            let mut gradient = vec![vec![Row::default(); weights.len()]];
            let inputs: [&[Row]; 5] = [&rows; 5];
            let time = nanoseconds(WIDTH, || {
                program.run(&weights, black_box(&inputs), &mut workspace, &mut gradient)
            });
            print!(
                "{width:>3} units {name:<10} programs {time:>7.1} ns, {} numbers",
                program.workspace_len()
            );
            println!("{}", lanes.map_or(String::new(), |lanes| beside(lanes, time)));
        }
    }
}
