//! Numbers of laws with networks: columns against differences and formulas, and their places in the weight block of a file.

use crate::common::file::{CARTPOLE, arm};
use crate::common::network_laws::NetworkLaws;
use crate::common::{Random, assert_vectors_close};
use leastaction_core::adapt::{Adapter, Limits, Number, Tuning, Unfit};
use leastaction_core::forces::{Coefficient, Forces, Viscous};
use leastaction_core::lagrangian::Column;
use leastaction_core::linear::{add_scaled, dot};
use leastaction_core::model::{Family, InertiaNetworkHeader, Law, Laws, Layout, ShapeHeader};
use leastaction_core::scalar::{WeightFormat, f16};

/// Units of the last hidden layer.
const UNITS: usize = 4;

/// Numbers of both networks with `m` columns, in no order, and one that is none of theirs.
fn numbers(m: usize) -> Vec<Number> {
    let columns = (0..m).map(|j| Number::Dissipation(j as u8));
    let units = (0..UNITS).rev().map(|j| Number::Potential(j as u8));
    [Number::Rotor(0)].into_iter().chain(columns).chain(units).collect()
}

/// Columns of the numbers; there is no momentum in them.
fn columns<F: Forces<f64, N>, const N: usize>(
    law: &F,
    (q, v): (&[f64; N], &[f64; N]),
    numbers: &[Number],
) -> Vec<[f64; N]> {
    let mut columns = vec![Column::zero(); numbers.len()];
    law.network_columns(q, v, numbers, &mut columns);
    assert!(columns.iter().all(|column| column.momentum == [0.0; N]));
    columns.iter().map(|column| column.force).collect()
}

fn check_columns<const N: usize>(seed: u64) {
    let laws = NetworkLaws::of(N, seed);
    let m = laws.dissipation.count();
    let numbers = numbers(m);
    let forces = (Viscous { coefficients: [0.3; N] }, laws.in_f64::<N>());
    let mut random = Random(seed);
    for _ in 0..20 {
        let [q, v] = [random.array(2.0), random.array(2.0)];
        let columns = columns(&&forces, (&q, &v), &numbers);
        for (number, column) in numbers.iter().zip(&columns) {
            let expected: [f64; N] = match *number {
                Number::Potential(j) => {
                    // The output's weights come last, before its bias.
                    let place = laws.of_potential.len() - 1 - UNITS + usize::from(j);
                    let changed = |step: f64| {
                        let mut changed = laws.of_potential.clone();
                        changed[place] += step;
                        let of = laws.over::<f64, N>([&laws.of_dissipation, &changed]);
                        of.force(&q, &v, &q)
                    };
                    // Exactly linear: large steps are as good as small ones.
                    add_scaled(&changed(0.3), -1.0, &changed(-0.3)).map(|twice| twice / 0.6)
                }
                Number::Dissipation(j) => {
                    let strengths: Vec<f64> =
                        (0..m).map(|k| if k == usize::from(j) { 1.3 } else { 1.0 }).collect();
                    let [after, before] = [strengths, vec![1.0; m]].map(|of| laws.force_of(&q, &v, &of));
                    core::array::from_fn(|i| (after[i] - before[i]) / 0.3)
                }
                _ => [0.0; N],
            };
            assert_vectors_close(&format!("{number:?}"), column, &expected, 1e-11);
        }
    }
}

#[test]
fn columns_are_differences() {
    check_columns::<1>(1);
    check_columns::<2>(2);
    check_columns::<3>(3);
    check_columns::<4>(4);
}

#[test]
fn columns_of_units_at_rest_are_those_in_motion_and_those_of_dissipation_vanish() {
    let laws = NetworkLaws::of(3, 7);
    let numbers = numbers(2);
    let [moving, resting] =
        [[0.4, -0.9, 1.3], [0.0; 3]].map(|v| columns(&laws.in_f64::<3>(), (&[0.3, -0.2, 0.7], &v), &numbers));
    assert_eq!(moving[3..], resting[3..]);
    assert_eq!(resting[1..3], [[0.0; 3]; 2]);
    assert!(moving[1..].iter().all(|column| *column != [0.0; 3]));
}

#[test]
fn dissipation_takes_energy_away_up_to_none() {
    let (laws, mut random) = (NetworkLaws::of(4, 11), Random(5));
    let (dissipation, _) = laws.in_f64::<4>();
    let numbers: [Number; 3] = core::array::from_fn(|j| Number::Dissipation(j as u8));
    for _ in 0..200 {
        let [q, v] = [random.array(2.0), random.array(2.0)];
        let columns = columns(&dissipation, (&q, &v), &numbers);
        let with = |distances: [f64; 3]| {
            let parts = columns.iter().zip(distances);
            let own = dissipation.force(&q, &v, &q);
            parts.fold(own, |sum, (column, distance)| add_scaled(&sum, distance, column))
        };
        assert!(dot(&with(random.array(1.0)), &v) <= 1e-13);
        assert_vectors_close("no dissipation", &with([-1.0; 3]), &[0.0; 4], 1e-12);
    }
}

/// A model of four coordinates with friction and both networks: its header, its laws, and its numbers.
fn model(laws: &NetworkLaws) -> (InertiaNetworkHeader<'static>, Laws<'static>, Vec<f32>) {
    let header = InertiaNetworkHeader { coordinates: "tact", ..CARTPOLE };
    let of = Laws::FRICTION.with_dissipation(laws.dissipation).with_potential(laws.potential);
    let mut numbers = vec![0.25; header.parameters().unwrap() + 4 + 16];
    numbers.extend(laws.numbers(|x| x as f32).concat());
    (header, of, numbers)
}

/// Numbers of the networks, which end a block.
fn of_networks<'w, W>(laws: &NetworkLaws, block: &'w [W]) -> [&'w [W]; 2] {
    let [first, second] = [laws.of_dissipation.len(), laws.of_potential.len()];
    let (first, second) = block[block.len() - first - second..].split_at(first);
    [first, second]
}

/// Writes distances to a block of a file, and compares the force with what the columns say.
fn check_written<W: WeightFormat<Wide = f32>>(laws: &NetworkLaws, file: &[W]) {
    let (header, of, _) = model(laws);
    let layout = Layout::of(&Family::InertiaNetwork(header), of).unwrap();
    let (numbers, distances) = (numbers(3), [9.0, 0.3, -1.0, -0.4, 0.25, -0.5, 0.3, 0.7]);
    let mut block: Vec<f32> = file.iter().map(|weight| weight.wide()).collect();
    let before = block.clone();
    layout.write(file, (&numbers, &distances), &mut block);
    let (q, v): ([f64; 4], [f64; 4]) = ([0.3, -1.2, 0.8, -0.4], [0.7, 2.5, -1.1, 0.9]);
    let [of_dissipation, of_potential] =
        of_networks(laws, &before).map(|part| part.iter().map(|x| f64::from(*x)).collect());
    let widened = NetworkLaws { of_dissipation, of_potential, ..NetworkLaws::of(4, 3) };
    let exact = widened.in_f64::<4>();
    let expected = columns(&exact, (&q, &v), &numbers)
        .iter()
        .zip(distances)
        .fold(exact.force(&q, &v, &q), |sum, (column, distance)| {
            add_scaled(&sum, f64::from(distance), column)
        });
    let found = laws.over::<f32, 4>(of_networks(laws, &block)).force(
        &q.map(|x| x as f32),
        &v.map(|x| x as f32),
        &[0.0; 4],
    );
    let found = found.map(f64::from);
    assert_vectors_close("force of the block", &found, &expected, 2e-5);
    for (number, distance) in numbers.iter().zip(distances) {
        let values = (layout.value(file, *number), layout.value(&block, *number));
        match number {
            Number::Potential(_) => assert_eq!(values.1, values.0.map(|own| own + distance)),
            Number::Dissipation(_) => assert_eq!(values, (Some(1.0), Some(1.0))),
            _ => assert_eq!(values, (None, None)),
        }
    }
    // Columns with three, two and one entries of 4 weights and a bias each, and four weights of the potential.
    let changed = block.iter().zip(&before).filter(|(after, before)| after != before).count();
    assert_eq!(changed, 5 * (3 + 2 + 1) + UNITS);
    layout.write(file, (&numbers, &[0.0; 8]), &mut block);
    assert_eq!(block, before);
}

#[test]
fn blocks_hold_what_is_written() {
    let laws = NetworkLaws::of(4, 3);
    let (_, _, file) = model(&laws);
    check_written(&laws, &file);
    let halves: Vec<f16> = file.iter().map(|x| f16::from_f32(*x)).collect();
    check_written(&laws, &halves);
}

#[test]
fn numbers_beyond_the_networks_are_left_out() {
    let laws = NetworkLaws::of(4, 3);
    let (header, of, file) = model(&laws);
    let beyond = [Number::Potential(4), Number::Potential(255), Number::Dissipation(3)];
    let unchanged = |of: Laws<'_>, numbers: &[Number]| {
        let layout = Layout::of(&Family::InertiaNetwork(header), of).unwrap();
        let mut block = file.clone();
        layout.write(&file, (numbers, &[0.5; 8]), &mut block);
        assert_eq!(block, file);
        assert!(numbers.iter().all(|number| layout.value(&file, *number).is_none()));
    };
    unchanged(of, &beyond);
    unchanged(Laws::FRICTION, &numbers(3));
    let at = ([0.3, -1.2, 0.8, -0.4], [0.7, 2.5, -1.1, 0.9]);
    assert_eq!(columns(&laws.in_f64::<4>(), (&at.0, &at.1), &beyond), [[0.0; 4]; 3]);
    let friction = Viscous { coefficients: [0.5; 4] };
    assert!(columns(&friction, (&at.0, &at.1), &numbers(3)).iter().all(|column| *column == [0.0; 4]));
}

/// Networks come after friction, whose numbers are those of groups in a model of element types.
#[test]
fn places_follow_the_friction_of_groups() {
    let (header, network) = (arm(), NetworkLaws::of(3, 3));
    let laws = Laws::FRICTION.with_potential(network.potential);
    let layout = Layout::new(&header, laws).unwrap();
    let friction = Laws::FRICTION.parameters(header.groups()).unwrap();
    let of_network = network.potential.network(Law::Potential).unwrap().parameters().unwrap();
    let count = ShapeHeader::parameters(&header).unwrap() + friction + of_network;
    let file: Vec<f32> = (0..count).map(|k| k as f32).collect();
    let expected = (count - 1 - UNITS + 2) as f32;
    assert_eq!(layout.value(&file, Number::Potential(2)), Some(expected));
    assert_eq!(layout.value(&file, Number::Friction(Coefficient::Viscous, 0)), None);
}

#[test]
fn columns_of_dissipation_beyond_the_coordinates_are_refused() {
    let new = |number| {
        let limits = Limits { model: [1.0], lower: [-1.0], upper: [3.0], kept: 0.1 };
        let tuning = Tuning {
            numbers: [number],
            half: 10,
            h: 1e-2,
            deviation: [1.0; 3],
            prior: [0.3],
            forgotten: 0.0,
            walk: [0.0],
            change: 50.0,
            limits,
            dry: None,
        };
        Adapter::<f64, 3, 1, 0>::new(&tuning).map(|_| ())
    };
    assert_eq!(new(Number::Dissipation(2)), Ok(()));
    assert_eq!(new(Number::Dissipation(3)), Err(Unfit::NoSuch { found: 3, count: 3 }));
    // How many units there are is known of the model alone.
    assert_eq!(new(Number::Potential(255)), Ok(()));
}
