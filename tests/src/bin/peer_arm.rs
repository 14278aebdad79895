//! The Rust side of `tests/peers/arm_pinocchio.py`: dynamics of trees of rigid bodies in space, in f64, evaluated and timed with one state
//! per call. Input and output are described in `tests/peers/README.md`.

use leastaction_core::energy::arm::{ARM_PARAMETERS, ArmBodies, BodyTree, Joint, TreeBody};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::scalar::{LANES, Lanes, Scalar};
use std::error::Error;
use std::hint::black_box;
use std::io::Read;
use std::process::ExitCode;
use std::str::{FromStr, SplitAsciiWhitespace};
use std::time::Instant;

/// Number of timed passes over all states; the fastest counts.
const REPETITIONS: usize = 40;

type Failure = Box<dyn Error>;

/// Position q, velocity v, and accelerations or forces.
type State<const N: usize> = [[f64; N]; 3];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("peer_arm: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failure> {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let mut words = text.split_ascii_whitespace();
    match next(&mut words)? {
        6 => measure::<6>(&mut words),
        7 => measure::<7>(&mut words),
        12 => measure::<12>(&mut words),
        other => Err(format!("{other} bodies; 6, 7 and 12 are compiled").into()),
    }
}

fn next<T: FromStr<Err: Error + 'static>>(words: &mut SplitAsciiWhitespace) -> Result<T, Failure> {
    Ok(words.next().ok_or("the input ends too early")?.parse()?)
}

fn numbers(words: &mut SplitAsciiWhitespace, count: usize) -> Result<Vec<f64>, Failure> {
    (0..count).map(|_| next(words)).collect()
}

fn tree<const N: usize>(words: &mut SplitAsciiWhitespace) -> Result<BodyTree<N>, Failure> {
    let mut bodies = Vec::new();
    for _ in 0..N {
        let (parent, slides): (i16, u8) = (next(words)?, next(words)?);
        let joint = if slides == 1 { Joint::Prismatic } else { Joint::Revolute };
        bodies.push(TreeBody { joint, parent: u8::try_from(parent).ok() });
    }
    BodyTree::new(bodies).map_err(|error| format!("{error:?}").into())
}

fn measure<const N: usize>(words: &mut SplitAsciiWhitespace) -> Result<(), Failure> {
    let tree = tree::<N>(words)?;
    let weights = numbers(words, 3 + N * ARM_PARAMETERS)?;
    let arm = ArmBodies::take(&mut &weights[..], tree).ok_or("too few weights")?;
    let count: usize = next(words)?;
    let states: Vec<f64> = numbers(words, 3 * N * count)?;
    let state = |of: &[[f64; N]]| -> State<N> { [of[0], of[1], of[2]] };
    let states: Vec<State<N>> = states.as_chunks().0.chunks_exact(3).map(state).collect();
    for state in &states {
        let all = quantities(&arm, state);
        println!("{}", all.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(" "));
    }
    time_all((&arm, &states), ("", 1));
    let packed = packed(&arm, &states)?;
    time_all((&arm, &packed), ("_lanes", LANES));
    Ok(())
}

/// All quantities of a state, or of states side by side, in the order of the output.
fn quantities<S: Scalar<Weight = f64>, const N: usize>(
    arm: &ArmBodies<f64, N>,
    [q, v, x]: &[[S; N]; 3],
) -> Vec<S> {
    let energies = arm.energies(q, v);
    let mut all = vec![energies.kinetic, energies.potential];
    all.extend(arm.inverse_dynamics(q, v, x).iter().chain(&arm.gravity_torque(q)));
    all.extend(arm.mass_matrix(q).as_flattened().iter().chain(&arm.forward_dynamics(q, v, x)));
    let derivatives = arm.inverse_dynamics_derivatives(q, v, x);
    all.extend([derivatives.force_q, derivatives.force_v].as_flattened().as_flattened());
    all
}

/// Prints the time of every function per state, with `suffix` behind its name; `each` states lie side by side.
fn time_all<S: Scalar<Weight = f64>, const N: usize>(
    (arm, states): (&ArmBodies<f64, N>, &[[[S; N]; 3]]),
    (suffix, each): (&str, usize),
) {
    let time = |name: &str, of: &dyn Fn(&[[S; N]; 3])| {
        println!("{name}{suffix} {}", nanoseconds(states, each, of));
    };
    time("inverse_dynamics", &|[q, v, x]| {
        black_box(arm.inverse_dynamics(q, v, x));
    });
    time("mass_matrix", &|[q, ..]| {
        black_box(arm.mass_matrix(q));
    });
    // Derivatives together with M, which the accelerations contain.
    time("derivatives", &|[q, v, x]| {
        black_box((arm.inverse_dynamics_derivatives(q, v, x), arm.mass_matrix(q)));
    });
    time("acceleration", &|[q, v, x]| {
        black_box(arm.forward_dynamics(q, v, x));
    });
}

/// The states in groups of eight side by side, each of which has the bits that it has alone.
fn packed<const N: usize>(
    arm: &ArmBodies<f64, N>,
    states: &[State<N>],
) -> Result<Vec<LaneState<N>>, Failure> {
    let (groups, rest) = states.as_chunks::<LANES>();
    if !rest.is_empty() {
        return Err(format!("{} states are not a multiple of {LANES}", states.len()).into());
    }
    let packed: Vec<LaneState<N>> = groups.iter().map(side_by_side).collect();
    for (group, together) in groups.iter().zip(&packed) {
        let together = quantities(arm, together);
        for (lane, state) in group.iter().enumerate() {
            let alone = quantities(arm, state);
            if !alone.iter().map(|x| x.to_bits()).eq(together.iter().map(|x| x.0[lane].to_bits())) {
                return Err("a state has other bits side by side with others".into());
            }
        }
    }
    Ok(packed)
}

/// A state in every lane.
type LaneState<const N: usize> = [[Lanes; N]; 3];

fn side_by_side<const N: usize>(states: &[State<N>; LANES]) -> LaneState<N> {
    let one = |of: usize, k: usize| Lanes(std::array::from_fn(|lane| states[lane][of][k]));
    std::array::from_fn(|of| std::array::from_fn(|k| one(of, k)))
}

/// Time of a call in the fastest pass, divided by the number of states in a call.
fn nanoseconds<T>(states: &[T], each: usize, of: &dyn Fn(&T)) -> f64 {
    let pass = || {
        let started = Instant::now();
        states.iter().for_each(|state| of(black_box(state)));
        started.elapsed().as_secs_f64() / (each * states.len()) as f64 * 1e9
    };
    (0..REPETITIONS).map(|_| pass()).fold(f64::INFINITY, f64::min)
}
