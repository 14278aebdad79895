//! The Rust side of `tests/peers/lgnn_jax.py`: rings of springs in f64, with the LGNN authors' network and with ours. Files and output are
//! described in `tests/peers/README.md`.

use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{
    Drag, Edge, EdgeShape, GraphShape, Kinetic, MessageShape, NodeShape, Potential, Separation,
};
use leastaction_core::network::{Activation, Dense};
use leastaction_programs::dynamics::OneSampleAccelerations;
use leastaction_programs::energies::GraphEnergies;
use leastaction_programs::{Row, System};
use std::error::Error;
use std::fmt::Write;
use std::process::ExitCode;
use std::time::Instant;

/// Step size, s.
const STEP: f64 = 1e-3;
/// Number of steps whose outcome is compared.
const COMPARED_STEPS: usize = 10;
/// Numbers of springs for which the time of a step is measured.
const SIZES: [usize; 4] = [5, 50, 500, 5_000];
/// Duration of a measured stretch, s; it is much longer than the ticks of some milliseconds in which Linux counts
/// processor time.
const STRETCH: f64 = 0.05;
/// Number of stretches; the fastest one counts.
const STRETCHES: usize = 12;

/// Number of calls between two readings of the clock.
const CALLS: u32 = 4;

type Outcome<T> = Result<T, Box<dyn Error>>;

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

/// Writes the numbers to be compared, and prints times.
fn measure([lgnn, springs]: [&Model; 2], states: &[f64], output: &str) -> Outcome<()> {
    let [mut lgnn, mut springs] = [Ring::new(lgnn, states)?, Ring::new(springs, states)?];
    let mut report = String::from("{");
    entry(&mut report, "acceleration_s", fastest(&mut || lgnn.accelerate())?)?;
    let compared = [lgnn.forces(), lgnn.a.clone()];
    entry(&mut report, "lgnn_step_s", lgnn.step_time()?)?;
    (0..COMPARED_STEPS).try_for_each(|_| springs.step())?;
    let written = [compared.concat(), springs.q.clone(), springs.v.clone()].concat();
    entry(&mut report, "springs_step_s", springs.step_time()?)?;
    std::fs::write(output, written.into_iter().flat_map(f64::to_le_bytes).collect::<Vec<u8>>())?;
    println!("{report}\"steps\": {COMPARED_STEPS}}}");
    Ok(())
}

/// Prints the time of a step for both models in growing rings.
fn scale(models: [&Model; 2], states: &[f64]) -> Outcome<()> {
    let mut report = String::from("{");
    for (name, model) in ["lgnn_step_s", "springs_step_s"].into_iter().zip(models) {
        let times = SIZES.iter().map(|size| Ring::new(model, &states[..4 * size])?.step_time());
        write!(report, "\"{name}\": {:?}, ", times.collect::<Outcome<Vec<_>>>()?)?;
    }
    println!("{report}\"sizes\": {SIZES:?}}}");
    Ok(())
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
        // The block also needs mass, drag and field of the node type before its embeddings, and c₁ and c₂ of the edge
        // type after them; none is used.
        weights.extend([1.0, 0.0, 0.0, 0.0]);
        weights.extend(take(&mut numbers, 2 * usize::from(EMBEDDING))?);
        weights.extend([0.0, 0.0]);
        Ok(Self { shape, weights })
    }

    /// The model that `leastaction-papers lgnn` trains for springs: a network beside c₁ and c₂, mass 1.
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

/// Converts row-major matrices and biases, layer by layer, to the order of our weight block.
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

/// A model in a ring, with its state: q, v and v̇, node by node.
struct Ring<'m> {
    weights: &'m [f64],
    system: System,
    accelerations: OneSampleAccelerations,
    control: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// Acceleration v̇ before the last step.
    before: Vec<f64>,
}

impl<'m> Ring<'m> {
    /// Creates a ring with one node for each q and v among the states.
    fn new(model: &'m Model, states: &[f64]) -> Outcome<Self> {
        let states = states.as_chunks::<4>().0;
        let n = states.len();
        let edges: Vec<Edge> =
            (0..n).map(|i| Edge { kind: 0, ends: [i as u16, ((i + 1) % n) as u16] }).collect();
        let energies = GraphEnergies::new(&model.shape, &vec![0; n], &edges, 0)?;
        let system = System::new(&energies);
        let mut ring = Self {
            weights: &model.weights,
            accelerations: OneSampleAccelerations::new(&system),
            system,
            control: vec![0.0; 2 * n],
            q: states.iter().flat_map(|[x, y, ..]| [*x, *y]).collect(),
            v: states.iter().flat_map(|[.., x, y]| [*x, *y]).collect(),
            a: vec![0.0; 2 * n],
            before: vec![0.0; 2 * n],
        };
        ring.accelerate()?;
        Ok(ring)
    }

    /// Forces L_q.
    fn forces(&self) -> Vec<f64> {
        let program = self.system.gradient();
        let mut workspace = program.workspace();
        let rows = [&self.q, &self.v].map(|x| x.iter().map(|x| Row::splat(*x)).collect::<Vec<_>>());
        program.run_outputs(self.weights, &rows.each_ref().map(Vec::as_slice), &mut workspace);
        workspace.output(0).iter().map(|row| row.0[0]).collect()
    }

    fn accelerate(&mut self) -> Outcome<()> {
        let at = [&self.q[..], &self.v, &self.control];
        let solved = self.accelerations.evaluate(self.weights, at, &mut self.a);
        if solved { Ok(()) } else { Err("a singular mass".into()) }
    }

    /// Takes a step of velocity Verlet in the authors' version, which uses one acceleration per step: that at the new
    /// position and the old velocity.
    fn step(&mut self) -> Outcome<()> {
        for ((q, v), a) in self.q.iter_mut().zip(&mut self.v).zip(&self.a) {
            *q += STEP * (*v + 0.5 * STEP * a);
        }
        std::mem::swap(&mut self.a, &mut self.before);
        self.accelerate()?;
        for ((v, a), before) in self.v.iter_mut().zip(&self.a).zip(&self.before) {
            *v += 0.5 * STEP * (before + a);
        }
        Ok(())
    }

    /// Smallest wall and processor time of a step, s.
    fn step_time(&mut self) -> Outcome<[f64; 2]> {
        fastest(&mut || self.step())
    }
}

/// Smallest wall and processor time of a call, s.
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

/// Processor time of this thread so far, as Linux counts it; NaN elsewhere.
fn processor_seconds() -> f64 {
    let Ok(line) = std::fs::read_to_string("/proc/thread-self/schedstat") else { return f64::NAN };
    1e-9 * line.split_whitespace().next().and_then(|number| number.parse().ok()).unwrap_or(f64::NAN)
}
