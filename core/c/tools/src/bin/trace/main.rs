//! Counterpart of `example/trace.c`, `example/follow.c` and `example/adapt.c` on leastaction-core alone: both must print the same hashes.
//!
//! `cargo run --bin trace FILE NAME PLAN POSITION …`, with the features and sizes of the library; NAME may be empty. A plan for the model is
//! written to PLAN and followed, unless that is empty, too. With the feature `adapt` the settings of an adapter are written to PLAN with the
//! ending `.settings`, a machine that carries a load to `.machine`.

#[cfg(feature = "adapt")]
mod adapt;
#[allow(dead_code, reason = "sizes of the storage")]
#[path = "../../../../src/config.rs"]
mod config;
#[cfg(not(feature = "rods"))]
mod del;
mod follow;
#[cfg(feature = "rods")]
mod rattle;

use config::LEASTACTION_COORDINATES as N;
#[cfg(not(any(feature = "bodies", feature = "arm")))]
use config::{LEASTACTION_HIDDEN as H, LEASTACTION_LAYERS as L};
#[cfg(feature = "networks")]
use config::{LEASTACTION_LAW_HIDDEN as LH, LEASTACTION_LAW_LAYERS as LL};
use leastaction_core::discrete::{Newton, Order, Report};
use leastaction_core::lagrangian::Energies;
use leastaction_core::model::TrainedStep;

/// Storage format of the model file's weights.
#[cfg(not(feature = "half"))]
type Weight = f32;
#[cfg(feature = "half")]
type Weight = leastaction_core::scalar::f16;

/// Laws of friction that the program is built for.
#[cfg(not(any(feature = "friction", feature = "graph")))]
type Friction = leastaction_core::forces::Viscous<f32, N>;
#[cfg(feature = "friction")]
type Friction = (leastaction_core::forces::Viscous<f32, N>, leastaction_core::forces::Coulomb<f32, N>);

/// Laws with networks.
#[cfg(feature = "networks")]
type Networks<'w> = (
    leastaction_core::forces::Dissipation<'w, Weight, N, LH, LL>,
    leastaction_core::forces::PotentialCorrection<'w, Weight, N, LH, LL>,
);

/// Laws beside those of axes.
#[cfg(not(any(feature = "networks", feature = "servo", feature = "graph")))]
type Driven = Friction;
#[cfg(all(feature = "servo", not(feature = "networks")))]
type Driven = (Friction, leastaction_core::forces::Servo<f32, N>);
#[cfg(all(feature = "networks", not(feature = "servo")))]
type Driven<'w> = (Friction, Networks<'w>);
#[cfg(all(feature = "networks", feature = "servo"))]
type Driven<'w> = ((Friction, Networks<'w>), leastaction_core::forces::Servo<f32, N>);

/// Friction by direction, friction that sticks, and end stops.
#[cfg(feature = "axes")]
type Axes = (
    leastaction_core::forces::Directional<f32, N>,
    (leastaction_core::forces::Sticking<f32, N>, leastaction_core::forces::Stops<f32, N>),
);

/// Laws of force that the program is built for.
#[cfg(not(any(feature = "networks", feature = "axes", feature = "graph")))]
type Laws = Driven;
#[cfg(all(feature = "axes", not(feature = "networks")))]
type Laws = (Driven, Axes);
#[cfg(all(feature = "networks", not(feature = "axes")))]
type Laws<'w> = Driven<'w>;
#[cfg(all(feature = "networks", feature = "axes"))]
type Laws<'w> = (Driven<'w>, Axes);

type Vector = [f32; N];

const STEPS: usize = 200;

/// A mechanism whose motion is traced.
trait Mechanism {
    type State;

    fn default_newton(&self) -> Newton<f32>;
    fn acceleration(&self, at: [&Vector; 3]) -> Result<Vector, String>;
    fn inverse_dynamics(&self, at: [&Vector; 3]) -> Result<Vector, String>;
    fn momentum(&self, at: [&Vector; 2]) -> Vector;
    fn energies(&self, at: [&Vector; 2]) -> Energies<f32>;
    /// M, row by row, and the force against gravity; nothing for a mechanism on rods.
    fn terms(&self, q: &Vector) -> Vec<f32>;
    fn start(&self, q: Vector, v: Vector) -> Result<Self::State, String>;
    /// Starts a state from two positions, without control.
    fn between(&self, h: f32, order: Order, q: [&Vector; 2]) -> Result<Self::State, String>;
    /// Takes a step under a held force.
    fn step(&self, state: &mut Self::State, step: &Step, u: Vector) -> Result<Report<f32>, String>;
    /// q, p, the last increment, and everything else that a state reports.
    fn numbers(&self, state: &Self::State) -> Vec<f32>;
}

/// A step h, s, its order, and the bounds of Newton's method in it.
struct Step {
    h: f32,
    order: Order,
    newton: Newton<f32>,
}

/// FNV-1a over the bits of some numbers.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, x: &[f32]) {
        for byte in x.iter().flat_map(|x| x.to_le_bytes()) {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// An error of core, in its own words.
fn words(error: impl std::fmt::Debug) -> String {
    format!("{error:?}")
}

fn evaluate(mechanism: &impl Mechanism, hash: &mut Hash, [q, v, u]: [&Vector; 3]) -> Result<(), String> {
    let a = mechanism.acceleration([q, v, u])?;
    hash.add(&a);
    hash.add(&mechanism.inverse_dynamics([q, v, &a])?);
    hash.add(&mechanism.momentum([q, v]));
    let energies = mechanism.energies([q, v]);
    hash.add(&[energies.kinetic, energies.potential]);
    hash.add(&mechanism.terms(q));
    Ok(())
}

fn run<M: Mechanism>(mechanism: &M, step: &Step, mut state: M::State, hash: &mut Hash) -> Result<(), String> {
    for k in 0..STEPS {
        let mut u = [0.0; N];
        u[0] = if k / 32 % 2 == 0 { 0.25 } else { -0.25 };
        let report = mechanism.step(&mut state, step, u)?;
        hash.add(&mechanism.numbers(&state));
        hash.add(&[report.residual, report.iterations.into()]);
    }
    Ok(())
}

/// Runs from a velocity with a bounded number of updates per step, and from the end of a step without bounds.
fn both_starts(
    mechanism: &impl Mechanism,
    (h, order): (f32, Order),
    [q, v, u]: [&Vector; 3],
    hash: &mut Hash,
) -> Result<(), String> {
    let newton = mechanism.default_newton();
    let bounded = Step { h, order, newton: Newton { max_iterations: 2, stop: 0.0, ..newton } };
    run(mechanism, &bounded, mechanism.start(*q, *v)?, hash)?;
    let (step, mut state) = (Step { h, order, newton }, mechanism.start(*q, *v)?);
    mechanism.step(&mut state, &step, *u)?;
    let numbers = mechanism.numbers(&state);
    let q1 = numbers.first_chunk().ok_or("no position")?;
    run(mechanism, &step, mechanism.between(h, order, [q, q1])?, hash)
}

/// Arguments of the program beside the model's file.
struct Given {
    plan: String,
    q: Vector,
}

/// Prints the hashes of a mechanism.
fn trace(
    mechanism: &impl Mechanism,
    trained_step: Option<TrainedStep>,
    file: &[u8],
    Given { plan, q, .. }: &Given,
) -> Result<(), String> {
    let h = trained_step.ok_or("no step in the file")?.h / 8.0;
    println!("trace {:x}", motion(mechanism, h, q)?);
    if plan.is_empty() {
        return Ok(());
    }
    let bytes = follow::written(mechanism, file, h, q)?;
    std::fs::write(plan, &bytes).map_err(|error| format!("{plan}: {error}"))?;
    println!("follow {:x}", follow::follow(mechanism, in_place(&aligned(&bytes), bytes.len()), h, q)?);
    #[cfg(feature = "adapt")]
    println!("adapt {:x}", adapted(file, h, plan, q)?);
    Ok(())
}

/// Writes the settings and the machine beside the plan, and lets the model follow the machine.
#[cfg(feature = "adapt")]
fn adapted(file: &[u8], h: f32, plan: &str, q: &Vector) -> Result<u64, String> {
    let (settings, machine) = (adapt::settings(file, h)?, adapt::machine(file)?);
    for (bytes, ending) in [(&settings, "settings"), (&machine, "machine")] {
        let path = std::path::Path::new(plan).with_extension(ending);
        std::fs::write(&path, bytes).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    adapt::adapt(file, &machine, &settings, h, q)
}

fn motion(mechanism: &impl Mechanism, h: f32, q: &Vector) -> Result<u64, String> {
    let mut hash = Hash::new();
    let v = core::array::from_fn(|i| (i as f32 - 1.0) / 4.0);
    let at = [q, &v, &[0.0; N]];
    evaluate(mechanism, &mut hash, at)?;
    both_starts(mechanism, (h, Order::Two), at, &mut hash)?;
    both_starts(mechanism, (h, Order::Four), at, &mut hash)?;
    Ok(hash.0)
}

#[cfg(not(any(feature = "modular", feature = "graph", feature = "bodies", feature = "arm")))]
fn trace_file(file: &[u8], _: &str, given: &Given) -> Result<(), String> {
    let model =
        leastaction_core::model::InertiaNetworkModel::<N, H, L, Weight, Laws>::load(file).map_err(words)?;
    trace(&model.system, model.trained_step, file, given)
}

#[cfg(feature = "bodies")]
fn trace_file(file: &[u8], _: &str, given: &Given) -> Result<(), String> {
    let model = leastaction_core::model::BodiesModel::<N, Weight, Laws>::load(file).map_err(words)?;
    trace(&model.system, model.trained_step, file, given)
}

#[cfg(feature = "arm")]
fn trace_file(file: &[u8], _: &str, given: &Given) -> Result<(), String> {
    let model = leastaction_core::model::ArmModel::<N, Weight, Laws>::load(file).map_err(words)?;
    trace(&model.system, model.trained_step, file, given)
}

#[cfg(feature = "modular")]
fn trace_file(file: &[u8], name: &str, given: &Given) -> Result<(), String> {
    use config::LEASTACTION_TYPES as K;
    let model =
        leastaction_core::model::ModularModel::<N, K, H, L, Weight, Laws>::load(file, name).map_err(words)?;
    trace(&model.system, model.trained_step, file, given)
}

#[cfg(feature = "graph")]
fn trace_file(file: &[u8], name: &str, given: &Given) -> Result<(), String> {
    use config::{LEASTACTION_DIMENSIONS as D, LEASTACTION_EDGES as EDGES};
    use config::{LEASTACTION_NETWORKS as K, LEASTACTION_RODS as RODS};
    use leastaction_core::constraints::Holonomic;
    use leastaction_core::energy::graph::Edge;
    let (mut edges, mut rods) = ([Edge::default(); EDGES], [Holonomic::default(); RODS]);
    let model =
        leastaction_core::model::GraphModel::<D, K, H, L, Weight>::load(file, name, &mut edges, &mut rods)
            .map_err(words)?;
    #[cfg(feature = "rods")]
    let system = rattle::OnRods { mechanism: model.system.constrained().map_err(words)? };
    #[cfg(not(feature = "rods"))]
    let system = del::graph::<D, K>(model.system.graph)?;
    trace(&system, model.trained_step, file, given)
}

/// Copies the bytes to a multiple of 4.
fn aligned(bytes: &[u8]) -> Vec<u32> {
    let word = |chunk: &[u8]| {
        let mut word = [0; 4];
        word.iter_mut().zip(chunk).for_each(|(to, from)| *to = *from);
        u32::from_ne_bytes(word)
    };
    bytes.chunks(4).map(word).collect()
}

/// The first bytes of some words.
fn in_place(words: &[u32], bytes: usize) -> &[u8] {
    assert!(bytes <= size_of_val(words), "{bytes} bytes in {} words", words.len());
    // SAFETY: the words hold at least as many bytes.
    unsafe { core::slice::from_raw_parts(words.as_ptr().cast::<u8>(), bytes) }
}

fn main() -> Result<(), String> {
    let mut arguments = std::env::args().skip(1);
    let mut next = || arguments.next().ok_or("trace FILE NAME PLAN POSITION …");
    let (path, name, plan) = (next()?, next()?, next()?);
    let position: Result<Vec<f32>, _> = arguments.map(|number| number.parse()).collect();
    let q = Vector::try_from(position.map_err(words)?).map_err(|_| format!("not {N} coordinates"))?;
    let bytes = std::fs::read(&path).map_err(|error| format!("{path}: {error}"))?;
    trace_file(in_place(&aligned(&bytes), bytes.len()), &name, &Given { plan, q })
}
