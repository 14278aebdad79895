//! Reference for the baselines: networks in plain loops with exact derivatives (num-dual), and the normal equations of
//! any residuals by difference quotients.

use super::{AccelerationModel, GraphSizes};
use leastaction_core::network::Dense;
use leastaction_ground_truth::{LgnnSettings, LgnnSystem, lgnn_set};
use leastaction_learning::training::{Adam, AdamSettings, Objective, Samples, Schedule};
use nalgebra::{DMatrix, DVector};
use num_dual::{DualNum, HyperHyperDual64};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::array::from_fn;

/// A number with derivatives along three directions.
pub type Dual = HyperHyperDual64;

pub fn moving(x: f64, [e1, e2, e3]: [f64; 3]) -> Dual {
    Dual::new(x, e1, e2, e3, 0.0, 0.0, 0.0, 0.0)
}

/// Uniform numbers in ±range.
pub fn random(count: usize, range: f64, seed: u64) -> Vec<f64> {
    let mut stream = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| stream.random_range(-range..range)).collect()
}

/// Samples with uniform states in ± these ranges and no controls.
pub fn samples(n: usize, count: usize, [q, v, a]: [f64; 3]) -> Samples {
    let states = [(1, q), (2, v), (3, a)].map(|(seed, range)| random(n * count, range, seed));
    Samples { n, controls: from_fn(|_| vec![0.0; n * count]), states, ..Samples::default() }
}

/// Errors v̇(q, v) − a of all samples.
pub fn errors(samples: &Samples, motion: impl Fn(&[f64], &[f64]) -> Vec<f64>) -> Vec<f64> {
    let [q, v, a] = samples.states.each_ref().map(|x| x.chunks_exact(samples.n));
    let found = q.zip(v).flat_map(|(q, v)| motion(q, v));
    found.zip(a.flatten()).map(|(found, a)| found - a).collect()
}

/// Weights without derivatives.
pub fn constant(weights: &[f64]) -> Vec<Dual> {
    weights.iter().map(|w| moving(*w, [0.0; 3])).collect()
}

/// Gradient of a function.
pub fn gradient(function: impl Fn(Vec<Dual>) -> Dual, x: &[f64]) -> Vec<f64> {
    let unit = |i: usize, k: usize| [f64::from(u8::from(i == k)), 0.0, 0.0];
    let along = |k: usize| x.iter().enumerate().map(|(i, x)| moving(*x, unit(i, k))).collect();
    (0..x.len()).map(|k| function(along(k)).eps1).collect()
}

/// Mass matrix L_vv and force L_q − L_vq v of a Lagrangian of (q, v).
pub fn equation(lagrangian: impl Fn(&[Dual]) -> Dual, [q, v]: [&[f64]; 2]) -> (DMatrix<f64>, DVector<f64>) {
    let (n, state) = (q.len(), [q, v].concat());
    let at = |one: &[f64], two: &[f64]| {
        let x = state.iter().zip(one).zip(two).map(|((x, one), two)| moving(*x, [*one, *two, 0.0]));
        lagrangian(&x.collect::<Vec<_>>())
    };
    let unit = |i: usize| (0..2 * n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>();
    let (still, motion) = (vec![0.0; 2 * n], [v, &vec![0.0; n]].concat());
    let mass = DMatrix::from_fn(n, n, |i, j| at(&unit(n + i), &unit(n + j)).eps1eps2);
    let force = |i: usize| at(&unit(i), &still).eps1 - at(&unit(n + i), &motion).eps1eps2;
    (mass, DVector::from_fn(n, |i, _| force(i)))
}

/// Acceleration of nodes in the plane, on rods from the origin or a node to another node, solved together with the
/// multipliers.
pub fn on_rods(
    (mass, force): (DMatrix<f64>, DVector<f64>),
    rods: &[(Option<u16>, u16)],
    [q, v]: [&[f64]; 2],
) -> Vec<f64> {
    let (n, all) = (q.len(), q.len() + rods.len());
    let mut matrix = mass.resize(all, all, 0.0);
    let mut right = force.resize_vertically(all, 0.0);
    for (k, (from, to)) in (n..).zip(rods) {
        for c in 0..2 {
            let to = 2 * usize::from(*to) + c;
            let from = from.map(|from| 2 * usize::from(from) + c);
            let between = |x: &[f64]| x[to] - from.map_or(0.0, |from| x[from]);
            for (i, sign) in [(Some(to), 1.0), (from, -1.0)] {
                let Some(i) = i else { continue };
                matrix[(k, i)] = sign * between(q);
                matrix[(i, k)] = -sign * between(q);
            }
            right[k] -= between(v) * between(v);
        }
    }
    matrix.lu().solve(&right).unwrap().as_slice()[..n].to_vec()
}

/// Settings of a short training.
pub const ADAM: AdamSettings =
    AdamSettings { learning_rate: 1e-2, batch: 50, schedule: Schedule::Constant, decay: 0.0, seed: 0 };

/// Loss after some epochs of Adam.
pub fn after_adam(objective: &dyn Objective, start: Vec<f64>, settings: AdamSettings, epochs: usize) -> f64 {
    let mut adam = Adam::new(objective, start, settings);
    (0..epochs).for_each(|_| {
        adam.iterate(objective);
    });
    objective.loss(&adam.weights)
}

/// Cosine and sine of angles (`a`), other coordinates unchanged, then the rest of the state.
pub fn features<D: DualNum + Copy>(coordinates: &str, state: &[D]) -> Vec<D> {
    let mut x = Vec::new();
    for (kind, q) in coordinates.chars().zip(state) {
        match kind {
            'a' => x.extend([q.cos(), q.sin()]),
            _ => x.push(*q),
        }
    }
    x.extend(&state[coordinates.len()..]);
    x
}

/// A network with two hidden layers of equal width and a linear output.
pub fn network<D: DualNum + Copy>(
    mut weights: &[D],
    x: Vec<D>,
    [width, outputs]: [usize; 2],
    activation: fn(D) -> D,
) -> Vec<D> {
    let y = take(&mut weights, x, &[width, width, outputs], activation);
    assert!(weights.is_empty());
    y
}

/// Takes a network with layers of these numbers of outputs from the front of the weights; the last layer is linear.
pub fn take<D: DualNum + Copy>(
    weights: &mut &[D],
    mut x: Vec<D>,
    layers: &[usize],
    activation: fn(D) -> D,
) -> Vec<D> {
    for (k, outputs) in layers.iter().enumerate() {
        let inputs = x.len();
        let (own, rest) = weights.split_at((inputs + 1) * outputs);
        *weights = rest;
        let weight = |i, j| own[Dense::<f64>::position(inputs, *outputs, i, j)];
        let sum = |i: usize| (0..inputs).fold(own[inputs * outputs + i], |sum, j| sum + weight(i, j) * x[j]);
        let y: Vec<D> = (0..*outputs).map(sum).collect();
        x = if k + 1 < layers.len() { y.into_iter().map(activation).collect() } else { y };
    }
    x
}

pub fn squareplus<D: DualNum<Primitive = f64> + Copy>(z: D) -> D {
    (z + (z * z + D::from(4.0)).sqrt()) * D::from(0.5)
}

/// Embeddings of the nodes of a graph network after the messages, by the printed equations; every network is taken from
/// the front of the weights. The remaining weights are those of the read-out.
pub fn messages<D: DualNum<Primitive = f64> + Copy>(
    weights: &mut &[D],
    sizes: GraphSizes,
    (kinds, ends): (&[f64], &[[u16; 2]]),
    [q, v]: [&[D]; 2],
) -> Vec<Vec<D>> {
    let GraphSizes { dimension: d, node, edge, hidden } = sizes;
    let layers = [&[edge][..], &[node], &[hidden, hidden, edge], &[hidden, hidden, node]];
    let inputs = [1, 2 * d + 1, edge + 2 * node, node + 2 * edge];
    let block = *weights;
    let network = |which: usize, x: Vec<D>| {
        let mut rest = block;
        (0..which).for_each(|k| drop(take(&mut rest, vec![D::zero(); inputs[k]], layers[k], squareplus)));
        (take(&mut rest, x, layers[which], squareplus), rest)
    };
    let at = |x: &[D], i: usize| x[d * i..d * (i + 1)].to_vec();
    let embed = |i: usize| network(1, [at(q, i), at(v, i), vec![D::from(kinds[i])]].concat()).0;
    let h: Vec<_> = (0..kinds.len()).map(embed).collect();
    let message = |i: usize, j: usize| {
        let squares = at(q, i).into_iter().zip(at(q, j)).map(|(a, b)| (a - b) * (a - b));
        let distance = squares.fold(D::zero(), |sum, square| sum + square).sqrt();
        network(2, [network(0, vec![distance]).0, h[i].clone(), h[j].clone()].concat()).0
    };
    let joined = |i: usize, j: usize| ends.iter().any(|e| [[i, j], [j, i]].contains(&e.map(usize::from)));
    let total = |messages: Vec<Vec<D>>| -> Vec<D> {
        (0..edge).map(|k| messages.iter().fold(D::zero(), |sum, message| sum + message[k])).collect()
    };
    let one = |i: usize| {
        let partners = || (0..kinds.len()).filter(|j| joined(i, *j));
        let sent = total(partners().map(|j| message(i, j)).collect());
        let received = total(partners().map(|j| message(j, i)).collect());
        network(3, [h[i].clone(), sent, received].concat())
    };
    let nodes: Vec<_> = (0..kinds.len()).map(one).collect();
    *weights = nodes[0].1;
    nodes.into_iter().map(|(node, _)| node).collect()
}

/// Checks the acceleration loss and its normal equations against the equations of motion in plain loops.
pub fn check_accelerations(
    model: &dyn AccelerationModel,
    (weights, samples): (&[f64], &Samples),
    motion: impl Fn(&[f64], &[f64], &[f64]) -> Vec<f64>,
) {
    let objective = model.objective(samples.clone()).unwrap();
    check_normal_equations(&*objective, (weights, 1e-6), |weights| {
        errors(samples, |q, v| motion(weights, q, v))
    });
}

/// Checks that some epochs of Adam on a few trajectories halve the loss.
pub fn check_epochs(
    model: &dyn AccelerationModel,
    (system, trajectories): (LgnnSystem, usize),
    (settings, epochs): (AdamSettings, usize),
) {
    let published = LgnnSettings::published(system, 3);
    let data = lgnn_set(&LgnnSettings { trajectories, ..published }).unwrap();
    let objective = model.objective(Samples::accelerations(&data).unwrap()).unwrap();
    let start = model.initial_weights(2);
    let before = objective.loss(&start);
    let after = after_adam(&*objective, start, settings, epochs);
    assert!(after < 0.5 * before, "{system:?}: {after} {before}");
}

pub fn assert_close(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance * (1.0 + expected.abs()), "{what}: {found} {expected}");
}

/// Checks that loss, gradient and normal equations agree with these residuals and their central differences.
pub fn check_normal_equations(
    objective: &dyn Objective,
    (weights, tolerance): (&[f64], f64),
    residuals: impl Fn(&[f64]) -> Vec<f64>,
) {
    let r = residuals(weights);
    let column = |j: usize| -> Vec<f64> {
        let moved = |h: f64| {
            let mut moved = weights.to_vec();
            moved[j] += h;
            residuals(&moved)
        };
        moved(1e-5).iter().zip(moved(-1e-5)).map(|(a, b)| (a - b) / 2e-5).collect()
    };
    let columns: Vec<_> = (0..weights.len()).map(column).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Entries are sums of terms that cancel, so an error is measured relative to the size of the terms.
    let size = |a: &[f64], b: &[f64]| (dot(a, a) * dot(b, b)).sqrt();
    let close = |what: String, found: f64, [a, b]: [&[f64]; 2]| {
        let expected = dot(a, b);
        assert!((found - expected).abs() < tolerance * (1.0 + size(a, b)), "{what}: {found} {expected}");
    };
    assert_close("loss", objective.loss(weights), dot(&r, &r) / r.len() as f64, 1e-9);
    let equations = objective.normal_equations(weights).unwrap();
    assert_eq!(equations.rows, r.len());
    assert_close("mean square", equations.mean_square(), objective.loss(weights), 1e-9);
    let gradient = objective.gradient(weights, 0..objective.samples()).unwrap();
    assert_close("squares", gradient.squares, equations.squares, 1e-9);
    for (i, column) in columns.iter().enumerate() {
        close(format!("gradient {i}"), equations.gradient[i], [column, &r]);
        close(format!("gradient alone {i}"), gradient.gradient[i], [column, &r]);
        for (j, other) in columns.iter().enumerate().take(i + 1) {
            close(format!("gram {i} {j}"), equations.gram[(i, j)], [column, other]);
        }
    }
}
