//! Our side of `tests/peers/modlanet_jax.py`: the acceleration loss of a double pendulum with its gradient, and its normal
//! equations, in f64. Files and output: `tests/peers/README.md`.

use leastaction_core::energy::modular::{
    ELEMENT_PARAMETERS, Input, ModularShape, NetworkShape, TransformShape, TypeShape,
};
use leastaction_core::network::{Activation, Dense};
use leastaction_ground_truth::{ManyBody, ModlanetSettings, modlanet_set_of};
use leastaction_learning::data::modlanet;
use leastaction_learning::training::{LossKind, NormalEquations, Samples, objective};
use leastaction_models::{Architecture, ModularArchitecture, NamedTree, NamedType, Number};
use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

/// Layer sizes (inputs, two hidden widths, outputs) of the position network and of the potential network.
const SIZES: [[usize; 4]; 2] = [[2, 16, 16, 2], [2, 16, 16, 1]];
/// Number of repetitions; the fastest counts.
const REPETITIONS: usize = 3;
/// Seed of the generated data.
const SEED: u64 = 0;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("peer_modlanet: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        ["generate", file] => generate(file),
        ["measure", weights, rows, gram] => measure(weights, rows, gram),
        _ => Err("usage: peer_modlanet generate FILE.npz | measure WEIGHTS ROWS GRAM".into()),
    }
}

/// Writes the protocol's double-pendulum data: 9,090 training rows.
fn generate(file: &str) -> Outcome<()> {
    let settings = ModlanetSettings::published(ManyBody::Pendulum(2), SEED);
    Ok(modlanet::write(file, &modlanet_set_of(&settings)?)?)
}

fn measure(weights: &str, rows: &str, gram: &str) -> Outcome<()> {
    let (numbers, rows) = (doubles(weights)?, doubles(rows)?);
    let block = panels(&numbers).ok_or_else(|| format!("{weights}: not 692 numbers"))?;
    let objective = objective(&architecture(), samples(&rows), LossKind::Acceleration, 2)?;
    let count = objective.samples();
    let fails = "a row cannot be evaluated at these weights";
    let (first, gradient_time) = fastest(|| objective.gradient(&block, 0..count)).ok_or(fails)?;
    let (equations, normal_time) = fastest(|| objective.normal_equations(&block)).ok_or(fails)?;
    let places = places();
    std::fs::write(gram, gram_of(&equations, &places))?;
    let factor = 2.0 / first.rows as f64;
    let gradient: Vec<f64> = places.iter().map(|place| factor * first.gradient[*place]).collect();
    let report = serde_json::json!({
        "loss": first.mean_square(),
        "gradient": gradient,
        "gradient_s": gradient_time,
        "normal_s": normal_time,
    });
    println!("{report}");
    Ok(())
}

fn doubles(path: &str) -> Outcome<Vec<f64>> {
    let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
    Ok(bytes.as_chunks().0.iter().map(|word| f64::from_le_bytes(*word)).collect())
}

/// Samples from rows (q, v, a), two numbers each.
fn samples(rows: &[f64]) -> Samples {
    let rows = rows.as_chunks::<6>().0;
    let part = |k: usize| rows.iter().flat_map(|row| [row[2 * k], row[2 * k + 1]]).collect();
    let still = vec![0.0; 2 * rows.len()];
    Samples {
        n: 2,
        h: 0.0,
        states: [part(0), part(1), part(2)],
        controls: [still.clone(), still.clone(), still],
        ..Samples::default()
    }
}

/// Model with learned position and potential, mass 1, learned c₁ and no pair potential.
fn architecture() -> Architecture {
    let network = |[inputs, first, second, outputs]: [usize; 4]| {
        NetworkShape::new(inputs as u8, &[first as u16, second as u16], outputs as u8, Activation::Tanh)
    };
    let networks: Vec<_> = SIZES.into_iter().filter_map(network).collect();
    let transform = TransformShape::Network { position: 0, velocity: None, input: Input::Angle };
    let kind = TypeShape { transform, potential: Some(1) };
    let shape = ModularShape::new(&networks, &[kind], None).expect("two networks and a type fit");
    let numbers = [1.0, 0.0, 1.0, 1.0, 0.0].map(Number::known);
    let bob = NamedType { name: "bob".to_owned(), numbers };
    ModularArchitecture::new(
        shape,
        vec![bob],
        [Number::learned(1.0), Number::known(0.0)],
        vec![NamedTree::chain("double pendulum", &[0, 0])],
    )
    .into()
}

/// Index in our weight block of every number in the file.
fn places() -> Vec<usize> {
    let (mut places, mut start) = (Vec::new(), 0);
    for layer in SIZES.iter().flat_map(|sizes| sizes.windows(2)) {
        let (inputs, outputs) = (layer[0], layer[1]);
        let of = |k: usize| Dense::<f64>::position(inputs, outputs, k / inputs, k % inputs);
        places.extend((0..inputs * outputs).map(|k| start + of(k)));
        start += inputs * outputs;
        places.extend(start..start + outputs);
        start += outputs;
    }
    // c₁ comes after the numbers of the type.
    places.push(start + ELEMENT_PARAMETERS);
    places
}

/// Our weight block from row-major matrices, biases and c₁; `None` if the count is wrong.
fn panels(numbers: &[f64]) -> Option<Vec<f64>> {
    let mut block = architecture().initial_weights(0);
    let places = places();
    (places.len() == numbers.len()).then_some(())?;
    for (place, number) in places.iter().zip(numbers) {
        *block.get_mut(*place)? = *number;
    }
    Some(block)
}

/// JᵀJ in the order of the file, row by row.
fn gram_of(equations: &NormalEquations, places: &[usize]) -> Vec<u8> {
    let entry = |a: usize, b: usize| equations.gram[(a.max(b), a.min(b))];
    places.iter().flat_map(|a| places.iter().flat_map(move |b| entry(*a, *b).to_le_bytes())).collect()
}

/// Calls `call` repeatedly; returns the last result with the least wall-clock and processor seconds.
fn fastest<T>(call: impl Fn() -> Option<T>) -> Option<(T, [f64; 2])> {
    let mut best = [f64::INFINITY; 2];
    let mut result = call()?;
    for _ in 0..REPETITIONS {
        let (start, busy) = (Instant::now(), processor_seconds());
        result = call()?;
        best[0] = best[0].min(start.elapsed().as_secs_f64());
        best[1] = best[1].min(processor_seconds() - busy);
    }
    Some((result, best))
}

/// Processor seconds of all threads of this program so far, as Linux counts them; NaN on other systems.
fn processor_seconds() -> f64 {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return f64::NAN };
    let nanoseconds = tasks.filter_map(|task| {
        let line = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        line.split_whitespace().next()?.parse::<f64>().ok()
    });
    1e-9 * nanoseconds.sum::<f64>()
}
