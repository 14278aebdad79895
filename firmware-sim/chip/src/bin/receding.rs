//! Decisions over a receding horizon of 25 nodes of one step each, for two links of which the second joint is driven.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::instructions::Counts;
use leastaction_chip::{Aligned, image, models, print, stack};
use leastaction_core::control::{Cost, Horizon, Limits, Node, Penalty, Problem, RecedingHorizon, Stepped};
use leastaction_core::discrete::{Del, Midpoint};
use leastaction_core::forces::Actuator;
use leastaction_core::linear::diagonal;
use leastaction_firmware_sim::trajectory::reference::{Links, STEP, newton};

static MODEL: &Aligned<{ include_bytes!("../../models/acrobot.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/acrobot.postcard"));

const NODES: usize = 25;
const DECISIONS: u32 = 200;

/// Upright from hanging, with one iteration of one trial at every tick.
fn run() -> Result<(), &'static [u8]> {
    let model = models::load(|| Links::load(black_box(&MODEL.0)))?;
    let del = Del::<f32, Midpoint>::with_newton(STEP, newton());
    let plant = Stepped { system: &model.system, del, actuator: Actuator::ideal(), inputs: [1], stride: 1 };
    let cost = Cost {
        goal: [core::f32::consts::PI, 0.0, 0.0, 0.0],
        turns: [true, true, false, false],
        x: [0.01, 0.01, 0.001, 0.001],
        u: [1e-4],
        end: diagonal([1.0, 1.0, 0.1, 0.1]),
    };
    let problem = Problem {
        plant,
        cost,
        controls: Limits { least: [-6.0], most: [6.0] },
        hard: Penalty::none(),
        soft: Penalty::none(),
        goal: Penalty::none(),
        energy: Penalty::none(),
    };
    let horizon = Horizon { ticks: 1, iterations: 1, trials: 1, penalty: 1.0, terminal: None };
    let mut nodes = [Node::new(1, [0.5]); NODES];
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

image!(run);
