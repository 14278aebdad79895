//! All derivatives are those of the printed formula, by num-dual over plain loops.

use super::*;
use crate::baselines::network_lagrangian::NetworkLagrangian;
use crate::baselines::oracle::{Dual, assert_close, features, moving, network, random};
use leastaction_core::energy::Learnable;
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::dot;
use leastaction_core::scalar::{LANES, Lanes};
use num_dual::DualNum;
use std::array::from_fn;

/// 3 coordinates, 8 inputs, 7 units: no two sizes are alike.
const N: usize = 3;
const COORDINATES: &str = "ata";
const WIDTH: usize = 7;
const WEIGHTS: usize = 9 * WIDTH + 8 * WIDTH + 8;
const EXACT: f64 = 1e-12;

type Vector = [f64; N];
/// Which of (q, v) moves along a direction, and how fast.
type Direction = [Vector; 2];
const STILL: Direction = [[0.0; N]; 2];

fn weights() -> Vec<f64> {
    random(WEIGHTS, 0.8, 4)
}

fn states() -> impl Iterator<Item = [Vector; 4]> {
    (0..4).map(|seed| from_fn(|k| from_fn(|i| random(4 * N, 2.0, seed)[N * k + i])))
}

fn naive(weights: &[Dual], [q, v]: [&Vector; 2], along: [Direction; 3]) -> Dual {
    let state: Vec<Dual> = (0..2)
        .flat_map(|part| (0..N).map(move |i| (part, i)))
        .map(|(part, i)| moving([q, v][part][i], along.map(|d| d[part][i])))
        .collect();
    let softplus = |z: Dual| z.exp().ln_1p();
    network(weights, features(COORDINATES, &state), [WIDTH, 1], softplus)[0]
}

fn constant(weights: &[f64]) -> Vec<Dual> {
    weights.iter().map(|w| moving(*w, [0.0; 3])).collect()
}

fn unit(i: usize) -> Vector {
    from_fn(|j| f64::from(u8::from(i == j)))
}

fn in_q(x: Vector) -> Direction {
    [x, [0.0; N]]
}

fn in_v(x: Vector) -> Direction {
    [[0.0; N], x]
}

fn lnn(weights: &[f64]) -> NetworkLagrangian<LnnNetwork<'_, 16>> {
    NetworkLagrangian(LnnNetwork::new(COORDINATES, WIDTH, weights).unwrap())
}

#[test]
fn first_and_second_derivatives_are_those_of_the_network() {
    let weights = weights();
    let (lnn, constant) = (lnn(&weights), constant(&weights));
    for [q, v, ..] in states() {
        let at = |a, b| naive(&constant, [&q, &v], [a, b, STILL]);
        let (g, d, h) = (lnn.gradient(&q, &v), lnn.dynamics(&q, &v), lnn.hessian(&q, &v));
        let energies = lnn.energies(&q, &v);
        assert_close("L", energies.kinetic - energies.potential, at(STILL, STILL).re, EXACT);
        let energy = dot(&v, &g.l_v) - at(STILL, STILL).re;
        assert_close("E", energies.kinetic + energies.potential, energy, EXACT);
        for i in 0..N {
            let (l_q, l_v) = (at(in_q(unit(i)), STILL).eps1, at(in_v(unit(i)), STILL).eps1);
            for (found_q, found_v) in [(g.l_q, g.l_v), (d.l_q, d.l_v), (h.l_q, h.l_v)] {
                assert_close("L_q", found_q[i], l_q, EXACT);
                assert_close("L_v", found_v[i], l_v, EXACT);
            }
            assert_close("L_vq v", d.l_vq_v[i], at(in_v(unit(i)), in_q(v)).eps1eps2, EXACT);
            for j in 0..N {
                let second = |a: fn(Vector) -> Direction, b: fn(Vector) -> Direction| {
                    at(a(unit(i)), b(unit(j))).eps1eps2
                };
                assert_close("L_qq", h.l_qq[i][j], second(in_q, in_q), EXACT);
                assert_close("L_vq", h.l_vq[i][j], second(in_v, in_q), EXACT);
                assert_close("L_vv", h.l_vv[i][j], second(in_v, in_v), EXACT);
                assert_close("M", d.mass[i][j], second(in_v, in_v), EXACT);
            }
        }
    }
}

/// The part of L that moves with two directions and every weight in turn.
fn by_weight(
    weights: &[f64],
    state: [&Vector; 2],
    [a, b]: [Direction; 2],
    part: fn(Dual) -> f64,
) -> Vec<f64> {
    (0..WEIGHTS)
        .map(|k| {
            let mut moved = constant(weights);
            moved[k] = moving(weights[k], [0.0, 0.0, 1.0]);
            part(naive(&moved, state, [a, b, STILL]))
        })
        .collect()
}

fn summed(visit: impl FnOnce(&mut dyn FnMut(usize, f64))) -> Vec<f64> {
    let mut sums = vec![0.0; WEIGHTS];
    visit(&mut |position, value| sums[position] += value);
    sums
}

#[test]
fn derivatives_in_the_weights_are_those_of_the_network() {
    let weights = weights();
    let lnn = lnn(&weights);
    for [q, v, a, y] in states() {
        let state = [&q, &v];
        let along = summed(|row| lnn.directional_gradient((&q, &v), (&a, &y), row));
        let expected = by_weight(&weights, state, [[a, y], STILL], |l| l.eps1eps3);
        let residual = summed(|row| lnn.residual_gradient((&q, &v), &a, &y, row));
        let force = by_weight(&weights, state, [in_q(y), STILL], |l| l.eps1eps3);
        let rate = by_weight(&weights, state, [in_v(y), [v, a]], |l| l.eps1eps2eps3);
        for k in 0..WEIGHTS {
            assert_close("along", along[k], expected[k], EXACT);
            assert_close("residual", residual[k], force[k] - rate[k], 1e-11);
        }
    }
}

#[test]
fn lanes_have_the_bits_of_one_sample() {
    let weights = weights();
    let lnn = lnn(&weights);
    let [q, v, a, y] = states().next().unwrap();
    let lanes = |x: &Vector| x.map(|x| Lanes([x; LANES]));
    let (one, eight) = (lnn.dynamics(&q, &v), lnn.dynamics(&lanes(&q), &lanes(&v)));
    for i in 0..N {
        assert_eq!((one.l_q[i], one.l_vq_v[i]), (eight.l_q[i].0[5], eight.l_vq_v[i].0[5]));
        assert_eq!(one.mass[i], eight.mass[i].map(|x| x.0[2]));
    }
    let mut sums = vec![0.0; WEIGHTS];
    let at = (&lanes(&q), &lanes(&v));
    lnn.residual_gradient(at, &lanes(&a), &lanes(&y), |k, value: Lanes| sums[k] += value.0[7]);
    assert_eq!(sums, summed(|row| lnn.residual_gradient((&q, &v), &a, &y, row)));
}

#[test]
fn shapes_that_do_not_fit_are_refused() {
    let weights = weights();
    let refused = |width, weights| LnnNetwork::<16>::new(COORDINATES, width, weights).is_none();
    assert!(refused(17, &[0.0; 1_000]) && refused(WIDTH, &weights[1..]) && !refused(WIDTH, &weights));
}
