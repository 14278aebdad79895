//! Derivatives of a motion across the strike of an end stop, in comparison with differences of the exact motion.

use leastaction_programs::dynamics::Order;
use leastaction_programs::energies::{Energies, GroupForce, with_group_laws};
use leastaction_programs::steps::{State, Steps, Tangents, VariationalSteps};
use leastaction_programs::{Builder, Node, Row, System};

/// Two coordinates of inertia \[\[m, c\], \[c, d\]\], the learned numbers.
struct Coupled;

impl Energies for Coupled {
    fn n(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        3
    }

    fn energies(&self, builder: &mut Builder, _: Node, v: Node) -> [Node; 2] {
        let numbers = builder.parameters(0, 3);
        let [first, second] = [&[0, 0, 1], &[0, 1, 1]].map(|index| builder.gather(v, index));
        let products = builder.product(first, second);
        let shares = builder.constant(&[0.5, 1.0, 0.5]);
        let shares = builder.product(shares, numbers);
        let kinetic = builder.dot(products, shares);
        [kinetic, builder.zeros(1)]
    }
}

const INERTIA: [f64; 3] = [0.8, 0.3, 0.5];
const START: [f64; 4] = [0.1, -0.2, 2.0, -0.7];
const FORCE: [f64; 2] = [1.5, -2.0];
const STOP: f64 = 0.3;

/// Solution of \[\[m, c\], \[c, d\]\] x = r.
fn solve([m, c, d]: [f64; 3], r: [f64; 2]) -> [f64; 2] {
    let determinant = m * d - c * c;
    [(d * r[0] - c * r[1]) / determinant, (m * r[1] - c * r[0]) / determinant]
}

/// The exact motion up to a time, (q, v): a parabola, one strike of coordinate 0 on the stop at 0.3, and another parabola, or rest there.
fn exact(numbers: &[f64; 7], restitution: f64, time: f64) -> [f64; 4] {
    let [m, c, d, q0, q1, v0, v1] = *numbers;
    let a = solve([m, c, d], FORCE);
    let at = |[q, p, v, w]: [f64; 4], a: [f64; 2], t: f64| {
        [q + v * t + 0.5 * a[0] * t * t, p + w * t + 0.5 * a[1] * t * t, v + a[0] * t, w + a[1] * t]
    };
    let t = ((v0 * v0 + 2.0 * a[0] * (STOP - q0)).sqrt() - v0) / a[0];
    let [q, p, v, w] = at([q0, q1, v0, v1], a, t);
    let column = solve([m, c, d], [1.0, 0.0]);
    let lost = (1.0 + restitution) * v / column[0];
    let struck = [q, p, v - lost * column[0], w - lost * column[1]];
    // Pressed against the stop, coordinate 1 moves alone.
    let after = if restitution == 0.0 { [0.0, FORCE[1] / d] } else { a };
    at(struck, after, time - t)
}

/// Largest difference between the derivatives that steps carry and those of the exact motion, relative to the largest of these.
fn error(restitution: f64, order: Order, h: f64) -> f64 {
    let steps = (0.2 / h).round() as usize;
    let model = with_group_laws(Box::new(Coupled), &[GroupForce::Stops], (2, &[0, 1])).unwrap();
    let mut weights = INERTIA.to_vec();
    weights.extend([0.0, STOP, restitution, 0.0, f32::MAX.into(), 0.0]);
    let mut variational = VariationalSteps::new(&System::new(&model), h, order).with_learned(vec![0, 1, 2]);
    let mut state: State = START.map(Row::splat).to_vec();
    let mut tangents = Tangents::at_start(2, 3, 0);
    let tau = FORCE.map(Row::splat);
    variational.begin(&weights, &mut state, Some(&mut tangents));
    for _ in 0..steps {
        let failed = variational.step(&weights, &mut state, [&tau, &tau], Some((&mut tangents, &[])));
        assert!(!failed.any(1));
    }
    variational.finish(&weights, &mut state, Some(&mut tangents));
    let mut numbers = [0.0; 7];
    numbers.iter_mut().zip(INERTIA.iter().chain(&START)).for_each(|(number, x)| *number = *x);
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for (number, moved) in tangents.each().enumerate() {
        let [above, below] = [1e-6, -1e-6].map(|step| {
            let mut numbers = numbers;
            numbers[number] += step;
            exact(&numbers, restitution, h * steps as f64)
        });
        for (k, moved) in moved.iter().enumerate() {
            let expected = (above[k] - below[k]) / 2e-6;
            worst = worst.max((moved.0[0] - expected).abs());
            largest = largest.max(expected.abs());
        }
    }
    worst / largest
}

/// The difference vanishes with the step, in which a strike is late by up to h.
#[test]
fn derivatives_cross_strikes_and_rest() {
    for (restitution, order) in [(0.5, Order::Two), (0.9, Order::Two), (0.0, Order::Two), (0.5, Order::Four)]
    {
        let errors = [1e-3, 1e-4].map(|h| error(restitution, order, h));
        assert!(errors[0] < 2e-2 && errors[1] < 2e-3, "{restitution}, {order:?}: {errors:?}");
    }
}
