//! Steps with friction that sticks and end stops, samples side by side, in comparison with core in f64.

mod common;

use common::random_weights;
use leastaction_core::discrete::{self, Control, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{Sticking, StickingFriction, Stop, Stops, System as CoreSystem, Viscous};
use leastaction_core::network::Activation;
use leastaction_programs::dynamics::{Del, Newton, Order};
use leastaction_programs::energies::{Energies, GroupForce, InertiaNetworkEnergies, with_group_laws};
use leastaction_programs::{Row, System, WIDTH};

const N: usize = 3;
const KINDS: [Coordinate; N] = [Coordinate::Angle, Coordinate::Translation, Coordinate::Angle];
const INERTIA: Inertia = Inertia::Cholesky { epsilon: 1e-2 };
/// The groups of the coordinates.
const OF: [usize; N] = [1, 0, 1];
const DAMPING: [f64; 2] = [0.3, 0.05];
/// c, δ, c_load, τ_s, s and ε of both groups. With s > 1 a step may have two solutions, which rest and slide.
const FRICTION: [[f64; 6]; 2] = [[0.7, 0.3, 0.25, 0.4, 1.0, 0.01], [0.5, -0.2, 0.1, 0.15, 1.0, 0.02]];
/// Middle, half the distance and restitution of both groups.
const STOPS: [[f64; 3]; 2] = [[0.1, 0.15, 0.5], [-0.05, 0.6, 0.25]];
const STEP: f64 = 0.01;
const NEWTON: Newton = Newton { max_iterations: 50, stop: 1e-13, accept: 1e-9 };

type Core<'w> =
    CoreSystem<InertiaNetwork<'w, f64, N, 8, 2>, (Viscous<f64, N>, (Sticking<f64, N>, Stops<f64, N>))>;

fn weights(stops: bool) -> Vec<f64> {
    let network = InertiaNetworkEnergies::new(KINDS.to_vec(), (&[6, 5], Activation::Tanh), INERTIA, false);
    let mut weights = random_weights(network.parameters(), 9);
    weights.extend(DAMPING);
    weights.extend(FRICTION.as_flattened());
    weights.extend(STOPS.as_flattened().iter().filter(|_| stops));
    weights
}

fn system(stops: bool) -> System {
    let network = InertiaNetworkEnergies::new(KINDS.to_vec(), (&[6, 5], Activation::Tanh), INERTIA, false);
    let laws = [GroupForce::Viscous, GroupForce::Sticking { loaded: true }, GroupForce::Stops];
    let model = with_group_laws(Box::new(network), &laws[..2 + usize::from(stops)], (2, &OF)).unwrap();
    assert_eq!(model.parameters(), weights(stops).len());
    let system = System::new(&model);
    assert!(system.has_contacts());
    system
}

fn core(weights: &[f64], stops: bool) -> Core<'_> {
    let shape = InertiaNetworkShape::new(KINDS, &[6, 5], Activation::Tanh, INERTIA).unwrap();
    let lagrangian = InertiaNetwork::take(&mut &weights[..], &shape).unwrap();
    let coordinates = OF.map(|group| {
        let [constant, asymmetry, load, smoothing, breakaway, width] = FRICTION[group];
        StickingFriction { constant, asymmetry, load, smoothing, breakaway, width }
    });
    let viscous = Viscous { coefficients: OF.map(|group| DAMPING[group]) };
    let stop = |group: usize| {
        let [centre, half, restitution] = STOPS[group];
        if stops { Stop::about(centre, half, restitution) } else { Stop::none() }
    };
    let forces = (viscous, (Sticking { coordinates }, Stops { coordinates: OF.map(stop) }));
    CoreSystem { lagrangian, forces }
}

/// A number of a sample, between −size and size.
fn number(size: f64, k: usize, sample: usize) -> f64 {
    size * (1.7 * k as f64 + 0.9 * sample as f64).sin()
}

fn rows(size: f64, first: usize) -> [Row; N] {
    std::array::from_fn(|i| Row(std::array::from_fn(|sample| number(size, first + i, sample))))
}

fn of(rows: &[Row], sample: usize) -> [f64; N] {
    std::array::from_fn(|i| rows[i].0[sample])
}

/// Pushes that begin motions, let them come to rest, and turn them.
fn push(k: usize) -> [f64; N] {
    let size = [1.0, 0.1, -1.0, 0.2][k / 40 % 4];
    [2.0 * size, -1.5 * size, 1.2 * size]
}

fn check_steps<P: Path>(order: Order, stops: bool) {
    let (weights, mut rests, mut moves, mut strikes) = (weights(stops), 0, 0, 0);
    let (core, mut del) = (core(&weights, stops), Del::new(&system(stops), STEP, order, NEWTON));
    let (q, v) = (rows(if stops { 0.05 } else { 0.5 }, 1), rows(0.8, 5));
    let mut found = del.start_at(&weights, &q, &v);
    let begin = |sample| State::new(&core.lagrangian, of(&q, sample), of(&v, sample)).unwrap();
    let mut expected: [_; WIDTH] = std::array::from_fn(begin);
    for k in 0..400 {
        let tau = push(k);
        let before = found.q.clone();
        let both = tau.map(Row::splat);
        del.step(&weights, &mut found, [&both, &both]);
        for (sample, state) in expected.iter_mut().enumerate() {
            discrete::Del::<f64, P>::new(STEP).step(&core, state, &Control::held(tau)).unwrap();
            assert!(!found.failed.0[sample], "{order:?}: step {k} of sample {sample}");
            for (i, (q, p)) in state.q().iter().zip(state.p()).enumerate() {
                let [own, momentum] = [&found.q, &found.p].map(|rows| rows[i].0[sample]);
                assert!((own - q).abs() < 1e-9, "{order:?}, step {k}, sample {sample}: {own} {q}");
                assert!((momentum - p).abs() < 1e-8, "{order:?}, step {k}, sample {sample}: {momentum} {p}");
                let stays = own == before[i].0[sample];
                assert_eq!(stays, state.last_increment()[i] == 0.0, "{order:?}, step {k}, sample {sample}");
                (rests, moves) = (rests + usize::from(stays), moves + usize::from(!stays));
                let [centre, half, _] = STOPS[OF[i]];
                let is_on_stop = [centre - half, centre + half].contains(&own);
                assert!(!stops || is_on_stop || (own - centre).abs() < half, "step {k}: {own}");
                strikes += usize::from(stops && is_on_stop && !stays);
            }
        }
    }
    assert!(rests > 400 && moves > 400, "{rests} at rest, {moves} not");
    assert!(!stops || strikes > 40, "{strikes} strikes");
}

#[test]
fn steps_are_cores() {
    check_steps::<Midpoint>(Order::Two, false);
    check_steps::<Galerkin>(Order::Four, false);
}

#[test]
fn strikes_are_cores() {
    check_steps::<Midpoint>(Order::Two, true);
    check_steps::<Galerkin>(Order::Four, true);
}

/// Two positions, some of which coincide, give core's momentum.
fn check_starts<P: Path>(order: Order) {
    let weights = weights(false);
    let (core, mut del) = (core(&weights, false), Del::new(&system(false), STEP, order, NEWTON));
    for tau in [[0.0; N], [0.2, -0.3, 0.4], [3.0, -4.0, 5.0]] {
        let q = rows(0.5, 1);
        let mut next = rows(0.5 + 1e-3, 1);
        next[1] = q[1];
        let both = tau.map(Row::splat);
        let found = del.start(&weights, [&q, &next], [&both, &both]);
        for sample in 0..WIDTH {
            let ends = [of(&q, sample), of(&next, sample)];
            let expected = discrete::Del::<f64, P>::new(STEP)
                .start(&core, &ends[0], &ends[1], &Control::held(tau))
                .unwrap();
            assert!(!found.failed.0[sample]);
            for (found, expected) in found.p.iter().zip(&expected.p()) {
                let found = found.0[sample];
                assert!((found - expected).abs() < 1e-8, "{order:?}, sample {sample}: {found} {expected}");
            }
        }
    }
}

/// A coordinate at rest starts only against s times its friction, and then slides against the friction itself.
#[test]
fn rest_is_left_at_the_breakaway_level() {
    let mut weights = weights(false);
    let last = weights.len() - 2;
    weights[last] = 1.3;
    let mut del = Del::new(&system(false), STEP, Order::Two, NEWTON);
    let at = [[0.0; N]; 2].map(|x| x.map(Row::splat));
    let hold = |del: &mut Del, push: f64| {
        let mut state = del.start_at(&weights, &at[0], &at[1]);
        // Against gravity and what the potential of the network pulls, held by the other forces.
        let pulls = pull(&weights);
        let tau: [Row; N] = std::array::from_fn(|i| Row::splat(if i == 2 { push } else { 0.0 } - pulls[i]));
        (0..3).for_each(|_| del.step(&weights, &mut state, [&tau, &tau]));
        assert!(!state.failed.any(WIDTH));
        state.q[2].0[0]
    };
    // Coordinate 2 is of group 1: 0.8 of 0.5 forwards, and a little for the load.
    assert_eq!(hold(&mut del, 0.4 * 1.2), 0.0);
    assert!(hold(&mut del, 0.4 * 1.9) > 1e-5);
}

/// −V_q at rest at 0.
fn pull(weights: &[f64]) -> [f64; N] {
    let core = core(weights, false);
    leastaction_core::lagrangian::Lagrangian::linearization(&core.lagrangian, &[0.0; N], &[0.0; N]).l_q
}

#[test]
fn starts_are_cores() {
    check_starts::<Midpoint>(Order::Two);
    check_starts::<Galerkin>(Order::Four);
}
