//! Measurement of decisions over a receding horizon.

use crate::instructions::Counts;
use crate::{print, stack};
use core::hint::black_box;
use leastaction_core::control::{Cost, Horizon, Limits, Node, Penalty, Problem, RecedingHorizon, Stepped};
use leastaction_core::discrete::{Del, Midpoint};
use leastaction_core::forces::{Actuator, Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::diagonal;
use leastaction_firmware_sim::trajectory::reference::{STEP, newton};

const NODES: usize = 25;
const DECISIONS: u32 = 200;

/// Task of two coordinates with one drive.
pub struct Swing {
    /// Coordinate that is driven.
    pub input: usize,
    /// Largest control, N or N m.
    pub most: f32,
    /// Control from which the search begins, N or N m.
    pub first: f32,
    /// Goal (q, v).
    pub goal: [f32; 4],
    /// Which coordinates are angles.
    pub turns: [bool; 4],
}

/// Counts the instructions of decisions over 25 nodes of one step each, with one iteration of one trial at every tick: of the motion that
/// follows the last one, which is a rollout, and of the iteration, which is a backward pass with its linearisations and a rollout.
pub fn measure<L: Lagrangian<f32, 2>, F: Forces<f32, 2>>(
    system: &System<L, F>,
    swing: &Swing,
) -> Result<(), &'static [u8]> {
    let del = Del::<f32, Midpoint>::with_newton(STEP, newton());
    let plant = Stepped { system, del, actuator: Actuator::ideal(), inputs: [swing.input], stride: 1 };
    let cost = Cost {
        goal: swing.goal,
        turns: swing.turns,
        x: [0.01, 0.01, 0.001, 0.001],
        u: [1e-4],
        end: diagonal([1.0, 1.0, 0.1, 0.1]),
    };
    let problem = Problem {
        plant,
        cost,
        controls: Limits { least: [-swing.most], most: [swing.most] },
        hard: Penalty::none(),
        soft: Penalty::none(),
        goal: Penalty::none(),
        energy: Penalty::none(),
    };
    let horizon = Horizon { ticks: 1, iterations: 1, trials: 1, penalty: 1.0, terminal: None };
    let mut nodes = [Node::new(1, [swing.first]); NODES];
    print::number(b"nodes_bytes", size_of_val(&nodes) as u32);
    let start = black_box([0.1, -0.2, 0.3, 0.1]);
    let control = RecedingHorizon::new(problem, horizon, start, &mut nodes);
    let mut control = control.map_err(|_| b"the start is refused".as_slice())?;
    print::number(b"controller_bytes", size_of_val(&control) as u32);
    let (mut follow, mut improve, mut x) = (Counts::default(), Counts::default(), start);
    let mut fallen = 0;
    let (depth, _) = stack::deepest(|| control.decide(0, &start).is_ok());
    for _ in 0..DECISIONS {
        x = control.nodes().get(1).map_or(x, |node| node.x);
        follow.of(|| control.follow(1, &x)).map_err(|_| b"a decision is refused".as_slice())?;
        let action = improve.of(|| control.improve());
        fallen += u32::from(action.fall > 0.0);
    }
    print::number(b"fallen", fallen);
    print::number(b"decision_stack", depth as u32);
    print::number(b"follow_instructions", follow.median());
    print::number(b"follow_instructions_worst", follow.worst);
    print::number(b"iteration_instructions", improve.median());
    print::number(b"iteration_instructions_worst", improve.worst);
    Ok(())
}
