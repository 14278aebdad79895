//! A chosen number of calls and nothing else, to be run under a program that counts instructions.

use crate::cases::{acceleration, del_step, moving};
use crate::chain::{Links, STEP, point};
use leastaction_core::discrete::{Galerkin, Midpoint, Path};
use std::hint::black_box;

/// Runs what `--calls WHAT PENDULUMS TIMES` asks for, if it is among the arguments: WHAT is `acceleration`, `order-2` or `order-4`, all in
/// f32.
pub fn run(arguments: &[String]) -> bool {
    let Some(first) = arguments.iter().position(|argument| argument == "--calls") else { return false };
    let [what, pendulums, times] = &arguments[first + 1..first + 4] else { return false };
    let times = times.parse().expect("a number of calls");
    match pendulums.as_str() {
        "2" => chain::<2>(what, times),
        "3" => chain::<3>(what, times),
        "4" => chain::<4>(what, times),
        "6" => chain::<6>(what, times),
        "8" => chain::<8>(what, times),
        other => panic!("{other} pendulums: choose 2, 3, 4, 6 or 8"),
    }
    true
}

fn chain<const N: usize>(what: &str, times: usize) {
    match what {
        "acceleration" => {
            let links = Links::<f32>::new();
            let system = links.system::<f32, N>();
            for _ in 0..times {
                black_box(acceleration(&system, black_box(&point())));
            }
        }
        "order-2" => steps::<Midpoint, N>(times),
        "order-4" => steps::<Galerkin, N>(times),
        other => panic!("{other}: choose acceleration, order-2 or order-4"),
    }
}

fn steps<P: Path, const N: usize>(times: usize) {
    let links = Links::<f32>::new();
    let system = links.system::<f32, N>();
    let state = moving(&system, &point());
    for _ in 0..times {
        black_box(del_step::<f32, P, _, N>(&system, black_box(state), &point(), STEP));
    }
}
