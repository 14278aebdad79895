//! All derivatives are those of the printed formula, by num-dual over plain loops.

use super::*;
use crate::baselines::oracle::{Dual, assert_close, constant, features, moving, network, random};
use leastaction_programs::{DerivativeOutputs, Program, Row, System, WIDTH};
use num_dual::DualNum;
use std::array::from_fn;

/// Sizes are pairwise distinct: 3 coordinates, 8 inputs, 7 units.
const N: usize = 3;
const COORDINATES: &str = "ata";
const UNITS: usize = 7;
const WEIGHTS: usize = 9 * UNITS + 8 * UNITS + 8;
const EXACT: f64 = 1e-12;

type Vector = [f64; N];
/// Rates of (q, v) along a direction.
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
    network(weights, features(COORDINATES, &state), [UNITS, 1], softplus)[0]
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

fn system() -> System {
    System::new(&Lnn::new(COORDINATES, UNITS))
}

/// The vectors of the program at these inputs, and its gradients with respect to the weights.
fn run(program: &Program, inputs: &[&Vector], vectors: usize) -> [Vec<Vec<f64>>; 2] {
    let rows: Vec<[Row; N]> = inputs.iter().map(|x| x.map(Row::splat)).collect();
    let rows: Vec<&[Row]> = rows.iter().map(|rows| &rows[..]).collect();
    let mut workspace = program.workspace();
    let mut gradients = vec![vec![Row::default(); WEIGHTS]; program.rows()];
    program.run(&weights(), &rows, &mut workspace, &mut gradients);
    let first = |rows: &[Row]| rows.iter().map(|row| row.0[0]).collect::<Vec<_>>();
    let vectors = (0..vectors).map(|k| first(workspace.output(k))).collect();
    [vectors, gradients.iter().map(|row| first(row)).collect()]
}

#[test]
fn first_and_second_derivatives_are_those_of_the_network() {
    let (system, constant) = (system(), constant(&weights()));
    let (derivatives, places) = system.derivatives();
    for [q, v, ..] in states() {
        let at = |a, b| naive(&constant, [&q, &v], [a, b, STILL]);
        let [energies, _] = run(&system.energies(), &[&q, &v], 2);
        assert_close("L", energies[0][0] - energies[1][0], at(STILL, STILL).re, EXACT);
        let [gradient, _] = run(&system.gradient(), &[&q, &v], 2);
        let still = [0.0; N];
        let [motion, _] = run(&system.equation_of_motion().0, &[&q, &v, &still], 1 + N);
        let [found, _] = run(&derivatives, &[&q, &v, &still], 2 + 4 * N);
        for i in 0..N {
            let (l_q, l_v) = (at(in_q(unit(i)), STILL).eps1, at(in_v(unit(i)), STILL).eps1);
            for found in [&gradient, &found] {
                assert_close("L_q", found[DerivativeOutputs::FORCE][i], l_q, EXACT);
                assert_close("L_v", found[DerivativeOutputs::MOMENTUM][i], l_v, EXACT);
            }
            let rate = at(in_v(unit(i)), in_q(v)).eps1eps2;
            assert_close("L_q − L_vq v", motion[0][i], l_q - rate, EXACT);
            for j in 0..N {
                let second = |a: fn(Vector) -> Direction, b: fn(Vector) -> Direction| {
                    at(a(unit(i)), b(unit(j))).eps1eps2
                };
                assert_close("L_qq", found[places.force_q(j)][i], second(in_q, in_q), EXACT);
                assert_close("L_qv", found[places.force_v(j)][i], second(in_q, in_v), EXACT);
                assert_close("L_vq", found[places.momentum_q(j)][i], second(in_v, in_q), EXACT);
                assert_close("L_vv", found[places.mass(j)][i], second(in_v, in_v), EXACT);
                assert_close("M", motion[1 + j][i], second(in_v, in_v), EXACT);
            }
        }
    }
}

/// The derivatives of L along two directions and with respect to every weight in turn.
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

#[test]
fn derivatives_in_the_weights_are_those_of_the_network() {
    let (weights, system) = (weights(), system());
    for [q, v, a, y] in states() {
        let (state, still) = ([&q, &v], [0.0; N]);
        let [_, along] = run(&system.along(1), &[&q, &v, &still, &a, &y], 0);
        let expected = by_weight(&weights, state, [[a, y], STILL], |l| l.eps1eps3);
        let [_, residual] = run(&system.residual(1), &[&q, &v, &still, &a, &y], 0);
        let force = by_weight(&weights, state, [in_q(y), STILL], |l| l.eps1eps3);
        let rate = by_weight(&weights, state, [in_v(y), [v, a]], |l| l.eps1eps2eps3);
        for k in 0..WEIGHTS {
            assert_close("along", along[0][k], expected[k], EXACT);
            assert_close("residual", residual[0][k], force[k] - rate[k], 1e-11);
        }
    }
}

#[test]
fn samples_side_by_side_have_the_bits_of_one() {
    let (program, states) = (system().equation_of_motion().0, states().collect::<Vec<_>>());
    let side_by_side = |part: usize| -> [Row; N] {
        from_fn(|i| Row(from_fn(|sample| states[sample % states.len()][part][i])))
    };
    let mut workspace = program.workspace();
    let (q, v, still) = (side_by_side(0), side_by_side(1), [Row::default(); N]);
    program.run(&weights(), &[&q, &v, &still], &mut workspace, &mut []);
    for (k, [q, v, ..]) in states.iter().enumerate() {
        let [alone, _] = run(&program, &[q, v, &[0.0; N]], 1 + N);
        for (output, alone) in alone.iter().enumerate() {
            for sample in (k..WIDTH).step_by(states.len()) {
                let own: Vec<f64> = workspace.output(output).iter().map(|row| row.0[sample]).collect();
                assert_eq!(&own, alone);
            }
        }
    }
}

#[test]
fn blocks_that_are_too_short_are_refused() {
    let (weights, lnn) = (weights(), Lnn::new(COORDINATES, UNITS));
    let refused = |weights| motion::<2>(&lnn, Vec::new(), weights).is_err();
    assert!(refused(&weights[1..]) && !refused(&weights));
}
