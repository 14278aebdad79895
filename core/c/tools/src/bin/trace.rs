//! What `example/trace.c` does, by leastaction-core alone: both must print the same hash.
//!
//! `cargo run --bin trace FILE [NAME]`, with the features and sizes of the library.

#[allow(dead_code, reason = "sizes of the storage")]
#[path = "../../../src/config.rs"]
mod config;

use config::{LEASTACTION_COORDINATES as N, LEASTACTION_HIDDEN as H, LEASTACTION_LAYERS as L};
use leastaction_core::continuous::{acceleration, inverse_dynamics, momentum};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Newton, Path, State};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::TrainedStep;

/// How the model file stores its weights.
#[cfg(not(feature = "half"))]
type Weight = f32;
#[cfg(feature = "half")]
type Weight = leastaction_core::scalar::f16;

const STEPS: usize = 200;

/// FNV-1a over the bits of some numbers.
struct Hash(u64);

impl Hash {
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

fn evaluate<L, F>(system: &System<L, F>, hash: &mut Hash, [q, v, u]: [[f32; N]; 3]) -> Result<(), String>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let a = acceleration(system, &q, &v, &u).map_err(words)?;
    hash.add(&a);
    hash.add(&inverse_dynamics(system, &q, &v, &a).expect("a mass"));
    hash.add(&momentum(&system.lagrangian, &q, &v));
    let energies = system.lagrangian.energies(&q, &v);
    hash.add(&[energies.kinetic, energies.potential]);
    Ok(())
}

fn run<L, F, P: Path>(
    system: &System<L, F>,
    del: &Del<f32, P>,
    mut state: State<f32, N>,
    hash: &mut Hash,
) -> Result<(), String>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    for k in 0..STEPS {
        let mut u = [0.0; N];
        u[0] = if k / 32 % 2 == 0 { 0.25 } else { -0.25 };
        let report = del.step(system, &mut state, &Control::held(u)).map_err(words)?;
        for numbers in [state.q(), state.p(), state.last_increment()] {
            hash.add(&numbers);
        }
        hash.add(&[report.residual, report.iterations.into()]);
    }
    Ok(())
}

fn both_starts<L, F, P: Path>(
    system: &System<L, F>,
    h: f32,
    [q, v, u]: [[f32; N]; 3],
    hash: &mut Hash,
) -> Result<(), String>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let bounded = Newton { max_iterations: 2, stop: 0.0, ..Newton::default() };
    let start = State::new(&system.lagrangian, q, v).map_err(words)?;
    run(system, &Del::<f32, P>::with_newton(h, bounded), start, hash)?;
    let del = Del::<f32, P>::new(h);
    let q1 = core::array::from_fn(|i| q[i] + h * v[i]);
    let start = del.start(system, &q, &q1, &Control::held(u)).map_err(words)?;
    run(system, &del, start, hash)
}

fn trace<L, F>(system: &System<L, F>, trained_step: Option<TrainedStep>) -> Result<u64, String>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    let h = trained_step.ok_or("no step in the file")?.h / 8.0;
    let q = core::array::from_fn(|i| (i as f32 + 1.0) / 8.0);
    let v = core::array::from_fn(|i| (i as f32 - 1.0) / 4.0);
    let at = [q, v, [0.0; N]];
    evaluate(system, &mut hash, at)?;
    both_starts::<L, F, Midpoint>(system, h, at, &mut hash)?;
    both_starts::<L, F, Galerkin>(system, h, at, &mut hash)?;
    Ok(hash.0)
}

#[cfg(not(any(feature = "modular", feature = "graph")))]
fn trace_file(file: &[u8], _: &str) -> Result<u64, String> {
    let model = leastaction_core::model::RigidModel::<N, H, L, Weight>::load(file).map_err(words)?;
    trace(&model.system, model.trained_step)
}

#[cfg(feature = "modular")]
fn trace_file(file: &[u8], name: &str) -> Result<u64, String> {
    use config::LEASTACTION_TYPES as K;
    let model =
        leastaction_core::model::ModularModel::<N, K, H, L, Weight>::load(file, name).map_err(words)?;
    trace(&model.system, model.trained_step)
}

#[cfg(feature = "graph")]
fn trace_file(file: &[u8], name: &str) -> Result<u64, String> {
    use config::{LEASTACTION_DIMENSIONS as D, LEASTACTION_EDGES as EDGES, LEASTACTION_NETWORKS as K};
    use leastaction_core::energy::graph::{Edge, Fixed};
    let mut edges = [Edge::default(); EDGES];
    let model =
        leastaction_core::model::GraphModel::<D, K, H, L, Weight>::load(file, name, &mut edges, &mut [])
            .map_err(words)?;
    let fixed = Fixed::<_, D, K, H, L, N>::new(model.system.graph).map_err(words)?;
    trace(&System { lagrangian: fixed, forces: fixed }, model.trained_step)
}

/// The bytes at a multiple of 4.
fn aligned(bytes: &[u8]) -> Vec<u32> {
    let word = |chunk: &[u8]| {
        let mut word = [0; 4];
        word.iter_mut().zip(chunk).for_each(|(to, from)| *to = *from);
        u32::from_ne_bytes(word)
    };
    bytes.chunks(4).map(word).collect()
}

fn main() -> Result<(), String> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("trace FILE [NAME]")?;
    let bytes = std::fs::read(&path).map_err(|error| format!("{path}: {error}"))?;
    let words = aligned(&bytes);
    // SAFETY: as many bytes as there were, in words that hold at least as many.
    let file = unsafe { core::slice::from_raw_parts(words.as_ptr().cast::<u8>(), bytes.len()) };
    println!("trace {:x}", trace_file(file, &arguments.next().unwrap_or_default())?);
    Ok(())
}
