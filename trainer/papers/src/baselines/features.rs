//! Inputs of the baselines' networks, computed from a state.

use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::network::Jet;
use leastaction_core::scalar::Scalar;
use leastaction_programs::{Builder, Function, Node};

/// Inputs for a state x = (q, y), where y are velocities or momenta, and their tangents: coordinate by coordinate,
/// translations unchanged and angles as cosine and sine; then y. `coordinates` has one letter each, `a` for angles.
///
/// ModLaNet's authors use angles wrapped to \[0, 2π). Cosine and sine have no seam, and are also the inputs of the
/// modular family.
pub(super) fn inputs<S: Scalar, const T: usize>(coordinates: &str, state: &[Jet<S, T>]) -> Vec<Jet<S, T>> {
    let mut inputs = Vec::with_capacity(count(coordinates));
    for (kind, q) in coordinates.chars().zip(state) {
        if kind == 'a' {
            let (sin, cos) = q.value.sin_cos();
            inputs.extend([q.chain(cos, -sin), q.chain(sin, cos)]);
        } else {
            inputs.push(*q);
        }
    }
    inputs.extend_from_slice(&state[coordinates.len()..]);
    inputs
}

/// Adjoint of the state and its tangents, from those of its inputs `x`.
pub(super) fn adjoint<S: Scalar, const T: usize>(
    coordinates: &str,
    x: &[Jet<S, T>],
    bar: &[Jet<S, T>],
) -> Vec<Jet<S, T>> {
    let (mut state_bar, mut at) = (Vec::with_capacity(2 * coordinates.len()), 0);
    for kind in coordinates.chars() {
        if kind == 'a' {
            let (cos, sin) = (x[at], x[at + 1]);
            let minus_sin = sin.scaled(-S::one());
            state_bar.push(bar[at].times(&minus_sin).plus(&bar[at + 1].times(&cos)));
            at += 2;
        } else {
            state_bar.push(bar[at]);
            at += 1;
        }
    }
    state_bar.extend_from_slice(&bar[at..]);
    state_bar
}

/// Features s(q) as operations: coordinate by coordinate, translations unchanged and angles as cosine and sine; cyclic
/// coordinates are left out.
pub(super) fn seen(builder: &mut Builder, coordinates: &[Coordinate], q: Node) -> Node {
    let n = coordinates.len();
    let angles: Vec<usize> = (0..n).filter(|i| coordinates[*i] == Coordinate::Angle).collect();
    let own = builder.gather(q, &angles);
    let (cosines, sines) = (builder.cosine(own), builder.map(Function::Sine, own));
    let sources = builder.joined(&[q, cosines, sines]);
    let places = coordinates.iter().enumerate().flat_map(|(i, kind)| {
        let angle = n + angles.partition_point(|angle| *angle < i);
        match kind {
            Coordinate::Translation => vec![i],
            Coordinate::Angle => vec![angle, angle + angles.len()],
            Coordinate::Cyclic => Vec::new(),
        }
    });
    builder.gather(sources, &places.collect::<Vec<_>>())
}

/// Number of inputs.
pub(super) fn count(coordinates: &str) -> usize {
    2 * coordinates.len() + coordinates.matches('a').count()
}

/// Values without a derivative.
pub(super) fn fixed(values: &[f64]) -> Vec<Jet<f64, 0>> {
    values.iter().copied().map(Jet::constant).collect()
}

/// Values with their derivative along a direction.
pub(super) fn moving<S: Scalar>(values: &[S], direction: &[S]) -> Vec<Jet<S, 1>> {
    values.iter().zip(direction).map(|(value, rate)| Jet { value: *value, tangent: [*rate] }).collect()
}
