//! Counterpart of `example/follow.c`: writes the plan that it follows, and follows it in Rust.

use super::{Hash, Mechanism, N, Step, Vector, words};
use leastaction_core::discrete::Order;
use leastaction_core::model::stored_fingerprint;
use leastaction_core::plan::{self, Plan, PlanFile, PlanHeader};

const NODES: u32 = 6;
const TICKS_PER_NODE: u32 = 8;
/// Ticks that are followed: the motion, and a while at its end.
const TICKS: u32 = 80;

/// Driven coordinates: the first and the last.
fn driven() -> Vec<u8> {
    let mut driven = vec![0, (N - 1) as u8];
    driven.dedup();
    driven
}

/// Numbers of a state: position, momentum, last increment.
fn three<M: Mechanism>(mechanism: &M, state: &M::State) -> [Vector; 3] {
    let numbers = mechanism.numbers(state);
    std::array::from_fn(|part| std::array::from_fn(|i| numbers[part * N + i]))
}

/// A record of the motion: the state, commands of the driven coordinates, and gains that grow along the plan.
fn record(node: u32, [q, v]: [&Vector; 2], u: [f32; 2]) -> Vec<f32> {
    let growth = 1.0 + node as f32 / 4.0;
    let mut record = [&q[..], v, &u[..driven().len()]].concat();
    for coordinate in driven().into_iter().map(usize::from) {
        let position = |i| if i == coordinate { growth } else { 0.125 };
        record.extend((0..N).map(position));
        record.extend((0..N).map(|i| position(i) / 2.0));
    }
    record
}

/// Writes a plan from rest at q under commands that are held over nodes: a motion of the mechanism itself.
pub fn written(mechanism: &impl Mechanism, model: &[u8], h: f32, q: &Vector) -> Result<Vec<u8>, String> {
    let (driven, mut angles) = (driven(), [0; N]);
    angles[N - 1] = 1;
    let (mut state, mut records) = (mechanism.start(*q, [0.0; N])?, Vec::new());
    let step = Step { h, order: Order::Four, newton: mechanism.default_newton() };
    for node in 0..=NODES {
        let size = if node % 2 == 0 { 0.25 } else { -0.25 };
        let u = if node == NODES { [0.0; 2] } else { [size, -size / 2.0] };
        let [q, _, w] = three(mechanism, &state);
        records.extend(record(node, [&q, &w], u));
        let mut force = [0.0; N];
        driven.iter().zip(u).for_each(|(coordinate, u)| force[usize::from(*coordinate)] = u);
        for _ in 0..if node == NODES { 0 } else { TICKS_PER_NODE } {
            mechanism.step(&mut state, &step, force)?;
        }
    }
    let header = PlanHeader {
        model: stored_fingerprint(model).ok_or("no model file")?,
        driven: &driven,
        angles: &angles,
        h,
        ticks_per_node: TICKS_PER_NODE,
        nodes: NODES,
        limits: &[[-0.375, 0.5], [-0.25, 0.25]][..driven.len()],
    };
    let mut memory = vec![0; 4 * records.len() + 1024];
    Ok(plan::write(&header, &records, &mut memory).map_err(words)?.to_vec())
}

/// Follows the plan from its start with another velocity; the encoder of coordinate 0 is a turn off, that of the last one two turns.
pub fn follow(mechanism: &impl Mechanism, file: &[u8], h: f32, q: &Vector) -> Result<u64, String> {
    let plan = Plan::<N, N>::at_most(PlanFile::parse(file).map_err(words)?).map_err(words)?;
    let mut hash = Hash::new();
    let step = Step { h, order: Order::Four, newton: mechanism.default_newton() };
    let mut state = mechanism.start(*q, core::array::from_fn(|i| (i as f32 - 1.0) / 4.0))?;
    let mut turns = None;
    for tick in 0..TICKS {
        let [q, p, w] = three(mechanism, &state);
        [q, p, w].iter().for_each(|x| hash.add(x));
        let mut measured = q;
        measured[0] -= std::f32::consts::TAU;
        measured[N - 1] += 2.0 * std::f32::consts::TAU;
        let first = || plan.turns(&measured, &core::array::from_fn(|i| i == 0 && N > 1));
        let turns = *turns.get_or_insert_with(first);
        hash.add(&turns);
        for (q, turn) in measured.iter_mut().zip(turns) {
            *q -= turn;
        }
        let (reference, t) = (plan.reference(tick), tick as f32 * h);
        [reference.q, reference.v, plan.planned_force(tick)].iter().for_each(|x| hash.add(x));
        // Half a tick later, as a faster loop would ask.
        let between = plan.reference_at(t + h / 2.0);
        [between.q, between.v, plan.spread(&between.u)].iter().for_each(|x| hash.add(x));
        plan.motion(t).iter().for_each(|x| hash.add(x));
        let u = plan.force(tick, &measured, &w).map_err(words)?;
        hash.add(&u);
        hash.add(&plan.force_at(t + h / 2.0, &measured, &w).map_err(words)?);
        mechanism.step(&mut state, &step, u)?;
    }
    Ok(hash.0)
}
