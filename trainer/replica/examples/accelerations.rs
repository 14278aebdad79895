//! Time of 100,000 accelerations on one thread, state by state: `cargo run --release -p leastaction-replica --example accelerations --
//! m.postcard`. Prints the shortest of ten times, in ms.

use leastaction_replica::ModelFile;
use std::time::Instant;

const STATES: usize = 100_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name a model file")?;
    let file = ModelFile::new(&std::fs::read(path)?)?;
    let chip = file.replica(None)?;
    let n = chip.n();
    let numbers: Vec<f32> = (0..3 * n * STATES).map(|k| (k as f32 * 0.37).sin() * 0.5).collect();
    let mut to = vec![0.0; n];
    let mut least = f64::INFINITY;
    for _ in 0..10 {
        let started = Instant::now();
        let mut evaluator = chip.evaluator()?;
        for state in numbers.chunks_exact(3 * n) {
            let (q, rest) = state.split_at(n);
            let (v, tau) = rest.split_at(n);
            evaluator.acceleration(q, v, tau, &mut to)?;
        }
        least = least.min(started.elapsed().as_secs_f64());
    }
    println!("{:.2} ms, {:.0} ns a state; the last is {to:?}", 1e3 * least, 1e9 * least / STATES as f64);
    Ok(())
}
