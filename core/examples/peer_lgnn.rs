//! Our side of `tests/peers/lgnn_jax.py`: rings of springs in f64, by the LGNN authors' network and by ours. Files and output:
//! `tests/peers/README.md`.

use leastaction_core::constraints::{Constrained, ConstraintError, Holonomic};
use leastaction_core::continuous::{Drive, constrained_acceleration, constrained_workspace};
use leastaction_core::discrete::{
    Order,
    rattle::{ParticleState, Rattle},
};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{
    Drag, Edge, EdgeShape, Graph, GraphShape, Kinetic, MessageShape, NodeShape, Potential, Separation, Types,
};
use leastaction_core::network::{Activation, Dense};
use leastaction_core::particles::Particles;
use std::error::Error;
use std::fmt::Write;
use std::process::ExitCode;
use std::time::Instant;

/// The step, s.
const STEP: f64 = 1e-3;
/// Steps whose outcome is compared.
const COMPARED_STEPS: usize = 10;
/// Numbers of springs that the time of a step is measured for.
const SIZES: [usize; 4] = [5, 50, 500, 5_000];
/// A measured stretch lasts so long, s: Linux counts processor time in ticks of some milliseconds.
const STRETCH: f64 = 0.05;
/// The fastest of so many stretches counts.
const STRETCHES: usize = 12;

/// Calls between two looks at the clock.
const CALLS: u32 = 4;

type Outcome<T> = Result<T, Box<dyn Error>>;
/// As much as the trainer compiles in.
type Springs<'a> = Graph<'a, f64, 2, 12, 64, 3>;
/// q and v, node by node.
type State = [Vec<[f64; 2]>; 2];

/// A ring has no rods.
const NO_RODS: &[Holonomic<f64, 2>] = &[];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("peer_lgnn: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let [command, lgnn, springs, states, rest @ ..] = arguments.as_slice() else { return Err(usage()) };
    let (lgnn, springs) = (Model::lgnn(&doubles(lgnn)?)?, Model::springs(&doubles(springs)?)?);
    let states = doubles(states)?;
    match (*command, rest) {
        ("measure", [output]) => measure([&lgnn, &springs], &states, output),
        ("scale", []) => scale([&lgnn, &springs], &states),
        _ => Err(usage()),
    }
}

fn usage() -> Box<dyn Error> {
    "usage: peer_lgnn measure LGNN SPRINGS STATES OUTPUT | scale LGNN SPRINGS STATES".into()
}

/// Writes what is compared, and prints times.
fn measure([lgnn, springs]: [&Model; 2], states: &[f64], output: &str) -> Outcome<()> {
    let [lgnn, springs] = [Ring::new(lgnn, states), Ring::new(springs, states)];
    let (graph, mut workspace) = (lgnn.graph()?, Vec::new());
    let mut l_q = vec![[0.0; 2]; lgnn.q.len()];
    let mut acceleration = l_q.clone();
    workspace.resize(Particles::<f64, 2>::workspace(&graph), 0.0);
    let mut report = String::from("{");
    let mut force = || {
        graph.l_q(&lgnn.q, &mut workspace, &mut l_q);
        Ok(())
    };
    entry(&mut report, "l_q_s", fastest(&mut force)?)?;
    let mechanism = Constrained::new(&graph, NO_RODS).map_err(failed)?;
    workspace.resize(constrained_workspace(&mechanism), 0.0);
    let mut accelerate = || {
        let outputs = (&mut acceleration[..], &mut [][..]);
        constrained_acceleration(&mechanism, (&lgnn.q, &lgnn.v), &Drive::none(), &mut workspace, outputs)
    };
    entry(&mut report, "acceleration_s", fastest(&mut || accelerate().map_err(failed))?)?;
    entry(&mut report, "lgnn_step_s", lgnn.step_time()?)?;
    entry(&mut report, "springs_step_s", springs.step_time()?)?;
    let (_, [q, v]) = springs.stepping(|step| (0..COMPARED_STEPS).try_for_each(|_| step()))?;
    let written = [l_q, acceleration, q, v].concat().into_flattened();
    std::fs::write(output, written.into_iter().flat_map(f64::to_le_bytes).collect::<Vec<u8>>())?;
    println!("{report}\"steps\": {COMPARED_STEPS}}}");
    Ok(())
}

/// Prints the times of a step of both models in growing rings.
fn scale(models: [&Model; 2], states: &[f64]) -> Outcome<()> {
    let mut report = String::from("{");
    for (name, model) in ["lgnn_step_s", "springs_step_s"].into_iter().zip(models) {
        let times = SIZES.iter().map(|size| Ring::new(model, &states[..4 * size]).step_time());
        write!(report, "\"{name}\": {:?}, ", times.collect::<Outcome<Vec<_>>>()?)?;
    }
    println!("{report}\"sizes\": {SIZES:?}}}");
    Ok(())
}

fn failed(error: ConstraintError<f64>) -> Box<dyn Error> {
    format!("{error:?}").into()
}

fn entry(report: &mut String, name: &str, [wall, busy]: [f64; 2]) -> Outcome<()> {
    Ok(write!(report, "\"{name}\": [{wall:e}, {busy:e}], ")?)
}

fn doubles(path: &str) -> Outcome<Vec<f64>> {
    let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
    Ok(bytes.as_chunks().0.iter().map(|word| f64::from_le_bytes(*word)).collect())
}

/// A shape and its weight block.
struct Model {
    shape: GraphShape,
    weights: Vec<f64>,
}

impl Model {
    /// The LGNN authors' network: f_b, f_v, f_e, f₁ and T, then the kinetic embedding and the embedding.
    fn lgnn(mut numbers: &[f64]) -> Outcome<Self> {
        const EMBEDDING: u8 = 5;
        let networks = [[1, 5, 5, 5], [10, 5, 5, 5], [5, 5, 5, 5], [5, 5, 5, 1], [6, 10, 10, 1]];
        let node = NodeShape { kinetic: Kinetic::Network(4), potential: Potential::None, drag: Drag::None };
        let edge = EdgeShape { separation: Separation::Distance, potential: None, embedding: Some(0) };
        let messages = MessageShape { message: 1, update: 2, edge_potential: Some(3), node_potential: None };
        let shape = GraphShape {
            kinetic_embedding: EMBEDDING,
            embedding: EMBEDDING,
            messages: Some(messages),
            ..shape(
                &networks.map(|[inputs, a, b, outputs]| network(inputs, &[a.into(), b.into()], outputs)),
                node,
                edge,
            )?
        };
        let mut weights = panels(&shape, &mut numbers)?;
        // Mass, drag and field of the node type before its embeddings, c₁ and c₂ of the edge type behind: none is used.
        weights.extend([1.0, 0.0, 0.0, 0.0]);
        weights.extend(take(&mut numbers, 2 * usize::from(EMBEDDING))?);
        weights.extend([0.0, 0.0]);
        Ok(Self { shape, weights })
    }

    /// What `leastaction-papers lgnn` trains for springs: a network beside c₁ and c₂, mass 1.
    fn springs(mut numbers: &[f64]) -> Outcome<Self> {
        let node = NodeShape { kinetic: Kinetic::Mass, potential: Potential::None, drag: Drag::None };
        let edge = EdgeShape { separation: Separation::Squared, potential: Some(0), embedding: None };
        let shape = shape(&[network(1, &[16], 1)], node, edge)?;
        let mut weights = panels(&shape, &mut numbers)?;
        weights.extend([1.0, 0.0, 0.0, 0.0]);
        weights.extend(take(&mut numbers, 2)?);
        Ok(Self { shape, weights })
    }
}

fn network(inputs: u8, widths: &[u16], outputs: u8) -> NetworkShape {
    NetworkShape::new(inputs, widths, outputs, Activation::Squareplus).expect("few layers")
}

fn shape(networks: &[NetworkShape], node: NodeShape, edge: EdgeShape) -> Outcome<GraphShape> {
    Ok(GraphShape::new(2, networks, &[node], &[edge]).ok_or("too many types")?)
}

/// Row-major matrices and biases, layer by layer, as our weight block has them.
fn panels(shape: &GraphShape, numbers: &mut &[f64]) -> Outcome<Vec<f64>> {
    let mut block = Vec::new();
    for network in shape.networks.iter() {
        let (widths, depth) = network.widths();
        let mut inputs = usize::from(network.inputs);
        for outputs in widths[..depth].iter().copied().chain([network.outputs.into()]) {
            let (matrix, start) = (take(numbers, inputs * outputs)?, block.len());
            block.resize(start + matrix.len(), 0.0);
            for (k, number) in matrix.iter().enumerate() {
                block[start + Dense::<f64>::position(inputs, outputs, k / inputs, k % inputs)] = *number;
            }
            block.extend(take(numbers, outputs)?);
            inputs = outputs;
        }
    }
    Ok(block)
}

fn take<'a>(numbers: &mut &'a [f64], count: usize) -> Outcome<&'a [f64]> {
    let (first, rest) = numbers.split_at_checked(count).ok_or("too few weights")?;
    *numbers = rest;
    Ok(first)
}

/// A model in a ring, and a state of it.
struct Ring<'m> {
    model: &'m Model,
    nodes: Vec<u8>,
    edges: Vec<Edge>,
    q: Vec<[f64; 2]>,
    v: Vec<[f64; 2]>,
}

impl<'m> Ring<'m> {
    /// A node for each q and v among the states.
    fn new(model: &'m Model, states: &[f64]) -> Self {
        let states = states.as_chunks::<4>().0;
        let (n, (q, v)) = (states.len(), states.iter().map(|[x, y, u, w]| ([*x, *y], [*u, *w])).unzip());
        let edges = (0..n).map(|i| Edge { kind: 0, ends: [i as u16, ((i + 1) % n) as u16] }).collect();
        Self { model, nodes: vec![0; n], edges, q, v }
    }

    fn graph(&self) -> Outcome<Springs<'_>> {
        let types = Types::take(&mut &self.model.weights[..], &self.model.shape).ok_or("wrong shape")?;
        Ok(Graph::new(types, &self.nodes, &self.edges)?)
    }

    /// The least wall and processor seconds of a step.
    fn step_time(&self) -> Outcome<[f64; 2]> {
        Ok(self.stepping(fastest)?.0)
    }

    /// What `run` makes of a step that can be repeated, and where it leaves q and v.
    fn stepping<T>(
        &self,
        run: impl FnOnce(&mut dyn FnMut() -> Outcome<()>) -> Outcome<T>,
    ) -> Outcome<(T, State)> {
        let graph = self.graph()?;
        let mechanism = Constrained::new(&graph, NO_RODS).map_err(failed)?;
        let mut workspace = vec![0.0; Rattle::workspace(&mechanism)];
        let mut storage = vec![0.0; ParticleState::<f64, 2>::workspace(self.q.len(), 0)];
        let mut state =
            ParticleState::new(&mechanism, &self.q, &self.v, &mut storage, &mut workspace).map_err(failed)?;
        let integrator = Rattle::new(STEP, Order::Two);
        let result = run(&mut || {
            integrator.step(&mechanism, &mut state, None, &mut workspace).map_err(failed)?;
            Ok(())
        })?;
        Ok((result, [state.q().to_vec(), state.v().to_vec()]))
    }
}

/// The least wall and processor seconds of a call.
fn fastest(call: &mut dyn FnMut() -> Outcome<()>) -> Outcome<[f64; 2]> {
    let mut best = [f64::INFINITY; 2];
    call()?;
    for _ in 0..STRETCHES {
        let (start, busy, mut calls) = (Instant::now(), processor_seconds(), 0.0);
        while start.elapsed().as_secs_f64() < STRETCH {
            for _ in 0..CALLS {
                call()?;
            }
            calls += f64::from(CALLS);
        }
        best[0] = best[0].min(start.elapsed().as_secs_f64() / calls);
        best[1] = best[1].min((processor_seconds() - busy) / calls);
    }
    Ok(best)
}

/// Of this thread so far, as Linux counts it; not a number elsewhere.
fn processor_seconds() -> f64 {
    let Ok(line) = std::fs::read_to_string("/proc/thread-self/schedstat") else { return f64::NAN };
    1e-9 * line.split_whitespace().next().and_then(|number| number.parse().ok()).unwrap_or(f64::NAN)
}
