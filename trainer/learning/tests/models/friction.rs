//! Friction with the energies of any family: every loss supports it; it is learned, shipped and read back, and only dissipates.

use leastaction_core::continuous::acceleration;
use leastaction_core::discrete::{Control, Del, Galerkin, State};
use leastaction_core::energy::trigonometric::PENDULUM;
use leastaction_core::forces::{ControlKind, Coulomb, DryFriction, Forces, System, Viscous};
use leastaction_core::model::{Law, Laws};
use leastaction_core::scalar::LANES;
use leastaction_learning::config::Config;
use leastaction_learning::training::{Bounds, Levenberg, LossKind, Objective, Samples, objective};
use leastaction_models::file::{decode, encode};
use leastaction_models::{Architecture, DryNumbers, MOST_LOAD, WIDTHS};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::path::Path;

/// A number between −1 and 1, different for every k.
fn wave(k: usize) -> f64 {
    (1.7 * k as f64 + 0.4).sin()
}

pub fn architecture(model: &str) -> (Architecture, Vec<f64>) {
    let text = format!("[data]\nfile = \"a.npz\"\n[model]\n{model}");
    Config::parse(&text, Path::new("c.toml")).unwrap().beginning().unwrap()
}

const INERTIA_NETWORK: &str = "coordinates = \"ata\"\nhidden = [5, 3]\n";
const TREE: &str = "family = \"modular\"\ntypes = [{ name = \"cart\", transform = \"slide\" }, { name = \"bob\", transform = \"rod\", \
                    inertia = 0.3, potential = [] }]\ntrees = { crane = [\"cart\", \"bob\", \"bob\"] }\n";
const ALL: &str = "[model.friction]\nviscous = \"learned\"\ncoulomb = { learn = 0.3 }\nload = \"learned\"\nwidth = { learn = 0.4 }\n\
                   smoothing = { learn = 0.2 }\n";
const PARTLY: &str = "[model.friction]\ncoulomb = 0.2\nload = \"learned\"\nwidth = 0.3\nsmoothing = 0.4\n";

/// Forced samples of arbitrary states; their number is not a multiple of the block width.
pub fn samples(n: usize) -> Samples {
    let numbers = |k: usize, range: f64| -> Vec<f64> {
        (0..n * (LANES + 3)).map(|i| range * wave(7 * i + k)).collect()
    };
    let q = numbers(1, 2.0);
    let next = |scale: f64, k| q.iter().zip(numbers(k, scale)).map(|(q, dq)| q + dq).collect::<Vec<_>>();
    let (before, after) = (next(0.1, 2), next(0.1, 3));
    Samples {
        n,
        h: 0.1,
        states: [before, q, after],
        next_velocities: numbers(4, 1.0),
        controls: [numbers(5, 3.0), numbers(6, 3.0), numbers(8, 3.0)],
        control: ControlKind::Held,
    }
}

/// The gradient of the loss with respect to the friction numbers equals central differences.
#[test]
fn gradients_of_every_loss_are_its_differences() {
    let kinds = [
        (LossKind::Acceleration, 4),
        (LossKind::DelResidual, 2),
        (LossKind::DelResidual, 4),
        (LossKind::NextPosition, 2),
        (LossKind::NextPosition, 4),
        (LossKind::NextState, 2),
        (LossKind::NextState, 4),
    ];
    for (model, friction) in [(INERTIA_NETWORK, ALL), (INERTIA_NETWORK, PARTLY), (TREE, ALL), (TREE, PARTLY)]
    {
        let (shape, weights) = architecture(&format!("{model}{friction}"));
        let (first, fixed) = (weights.len() - shape.group_laws.count(), shape.fixed_positions());
        for (kind, order) in kinds {
            let own = samples(3);
            let objective = objective(&shape, own.clone(), kind, order).unwrap();
            assert_eq!(objective.solved(&weights).unsolved, 0, "{kind:?} {order}");
            let equations = objective.gradient(&weights, 0..own.len()).unwrap();
            for place in first..weights.len() {
                let loss = |step: f64| {
                    let mut moved = weights.clone();
                    moved[place] += step;
                    objective.loss(&moved)
                };
                let found = 2.0 * equations.gradient[place] / equations.rows as f64;
                let expected = (loss(1e-5) - loss(-1e-5)) / 2e-5;
                let expected = if fixed.contains(&place) { 0.0 } else { expected };
                let error = (found - expected).abs();
                assert!(
                    error < 1e-6 * (1.0 + expected.abs()),
                    "{kind:?} {order} {place}: {found} {expected}"
                );
            }
        }
    }
}

const TRUE: DryFriction<f64> = DryFriction { constant: 0.3, load: 0.2, smoothing: 0.1, width: 0.2 };
const DAMPING: f64 = 0.05;

fn pendulum() -> System<
    leastaction_core::energy::trigonometric::Trigonometric<'static, 1>,
    (Viscous<f64, 1>, Coulomb<f64, 1>),
> {
    let forces = (Viscous { coefficients: [DAMPING] }, Coulomb { coordinates: [TRUE] });
    System { lagrangian: PENDULUM, forces }
}

/// Arbitrary states of the pendulum, with their accelerations.
fn accelerations() -> Samples {
    const COUNT: usize = 300;
    let mut random = Pcg64::seed_from_u64(1);
    let mut numbers =
        |range: f64| -> Vec<f64> { (0..COUNT).map(|_| random.random_range(-range..range)).collect() };
    let (q, v, u) = (numbers(3.0), numbers(2.0), numbers(4.0));
    let states = q.iter().zip(&v).zip(&u);
    let a = states.map(|((q, v), u)| acceleration(&pendulum(), &[*q], &[*v], &[*u]).unwrap()[0]).collect();
    Samples { n: 1, states: [q, v, a], controls: [u.clone(), u.clone(), u], ..Samples::default() }
}

/// Positions of the pendulum in steps of order 4, through rest and back.
fn positions() -> Samples {
    const H: f64 = 0.05;
    let (mut samples, system) = (Samples { n: 1, h: H, ..Samples::default() }, pendulum());
    let (del, mut random) = (Del::<f64, Galerkin>::new(H), Pcg64::seed_from_u64(2));
    let mut number = |range: f64| random.random_range(-range..range);
    for _ in 0..30 {
        let mut state = State::new(&system.lagrangian, [number(3.0)], [number(1.0)]).unwrap();
        let torques: Vec<f64> = (0..12).map(|_| number(4.0)).collect();
        let mut q = vec![state.q()[0]];
        for torque in &torques {
            del.step(&system, &mut state, &Control::held([*torque])).unwrap();
            q.push(state.q()[0]);
        }
        for k in 0..11 {
            (0..3).for_each(|i| samples.states[i].push(q[k + i]));
            (0..3).for_each(|i| samples.controls[i].push(torques[(k + i).min(11)]));
        }
    }
    samples
}

#[test]
fn friction_is_recovered_from_exact_data() {
    let model = "coordinates = \"a\"\nhidden = [8]\n[model.friction]\nviscous = \"learned\"\ncoulomb = \"learned\"\nload = \"learned\"\n";
    let (shape, start) = architecture(model);
    for (samples, kind) in [(accelerations(), LossKind::Acceleration), (positions(), LossKind::NextPosition)]
    {
        let objective = objective(&shape, samples, kind, 4).unwrap();
        let end = Levenberg::new(&*objective, start.clone()).run(&*objective, 40, |_, _| {});
        let friction = shape.friction_of_coordinates(&end.weights)[0];
        let dry = friction.dry.unwrap();
        assert_eq!(dry.smoothing, TRUE.smoothing, "known");
        for (what, found, expected) in [
            ("b", friction.viscous, DAMPING),
            ("c", dry.constant, TRUE.constant),
            ("c_load", dry.load, TRUE.load),
            ("ε", dry.width, TRUE.width),
        ] {
            assert!(
                (found / expected - 1.0).abs() < 2e-3,
                "{kind:?}, {what}: {found} of {expected}; {:e}",
                end.loss
            );
        }
    }
}

/// For any values of the free numbers, friction is within its range, also in single precision, and its power is never positive.
#[test]
fn learned_friction_only_dissipates() {
    let (shape, weights) = architecture(&format!("{INERTIA_NETWORK}{ALL}"));
    let (bounds, first) = (Bounds::new(shape.ranges()), weights.len() - shape.group_laws.count());
    assert_eq!(shape.ranges().len(), 15);
    for k in 0..2_000 {
        let size = [1.0, 10.0, 1e3, 1e9][k % 4];
        let mut theta = bounds.free(&weights);
        theta[first..].iter_mut().enumerate().for_each(|(i, x)| *x = size * wave(31 * k + i));
        let numbers = bounds.weights(&theta);
        let friction = shape.friction_of_coordinates(&numbers);
        for friction in &friction {
            let DryNumbers { constant, load, smoothing, width, .. } = friction.dry.unwrap();
            assert!(friction.viscous as f32 > 0.0 && constant as f32 > 0.0 && smoothing as f32 > 0.0);
            assert!((0.0..=MOST_LOAD).contains(&load) && (WIDTHS[0]..=WIDTHS[1]).contains(&width));
        }
        encode(&shape, &numbers, None, "").expect("the chip takes it");
        let single = |x: f64| x as f32;
        let viscous = Viscous { coefficients: std::array::from_fn(|i| single(friction[i].viscous)) };
        let dry = |i: usize| friction[i].dry.unwrap();
        let coulomb = Coulomb {
            coordinates: std::array::from_fn(|i| DryFriction {
                constant: single(dry(i).constant),
                load: single(dry(i).load),
                smoothing: single(dry(i).smoothing),
                width: single(dry(i).width),
            }),
        };
        let [v, tau] = [3, 5].map(|i| std::array::from_fn::<f32, 3, _>(|j| single(10.0 * wave(i * k + j))));
        let force = (viscous, coulomb).force(&v, &v, &tau);
        assert!(force.iter().zip(&v).all(|(f, v)| f * v <= 0.0), "{force:?} {v:?}");
    }
}

/// A file written from any laws is read as a shape that writes an identical file.
#[test]
fn files_come_back_bit_for_bit() {
    let damped = "damping = true\n";
    let viscous = "[model.friction]\nviscous = 0.25\n";
    let cases = [
        (INERTIA_NETWORK.to_owned() + ALL, Laws::FRICTION),
        (INERTIA_NETWORK.to_owned() + damped + PARTLY, Laws::FRICTION),
        (INERTIA_NETWORK.to_owned() + PARTLY, Laws::COULOMB),
        (INERTIA_NETWORK.to_owned() + viscous, Laws::VISCOUS),
        (TREE.to_owned() + ALL, Laws::FRICTION),
        (TREE.to_owned() + viscous, Laws::VISCOUS),
        (TREE.to_owned() + PARTLY, Laws::FRICTION),
    ];
    for (text, laws) in cases {
        let (shape, weights) = architecture(&text);
        assert_eq!((shape.laws(), shape.parameters().unwrap()), (laws, weights.len()), "{text}");
        let bytes = encode(&shape, &weights, None, "here").unwrap();
        let read = decode(&bytes).unwrap();
        assert_eq!(encode(&read.architecture, &read.weights, None, "here").unwrap(), bytes, "{text}");
        assert_eq!(read.architecture.laws(), laws);
        let [ours, theirs] = [(&shape, &weights), (&read.architecture, &read.weights)]
            .map(|(shape, weights)| shape.friction_of_coordinates(weights));
        assert_eq!((ours.len(), theirs.len()), (3, 3));
        for (ours, theirs) in ours.iter().zip(&theirs) {
            assert_eq!(f64::from(ours.viscous as f32), theirs.viscous);
            assert_eq!(ours.dry.is_some(), laws.contains(Law::Coulomb));
            assert_eq!(ours.dry.map(|dry| dry.constant as f32), theirs.dry.map(|dry| dry.constant as f32));
        }
        // Numbers read from a file are known.
        assert!(read.architecture.ranges().is_empty());
        assert_eq!(read.architecture.law_entries().filter(|entry| entry.number.learned).count(), 0);
    }
}

/// A tree without any law, which files written elsewhere can contain.
#[test]
fn a_tree_may_have_no_law() {
    let (mut shape, weights) = architecture(TREE);
    let leastaction_models::AnyFamily::Modular(tree) = &mut shape.family else { panic!("a tree") };
    tree.damped = false;
    let weights = &weights[..weights.len() - 2];
    let bytes = encode(&shape, weights, None, "").unwrap();
    let read = decode(&bytes).unwrap();
    assert_eq!(
        (read.architecture.laws(), read.architecture.parameters().unwrap()),
        (Laws::NONE, weights.len())
    );
    assert!(read.architecture.friction_of_coordinates(&read.weights).is_empty());
}

/// Training lowers the loss and changes only learned numbers.
#[test]
fn known_numbers_stay() {
    let (shape, start) = architecture(&format!("{TREE}{PARTLY}"));
    let objective: Box<dyn Objective> = objective(&shape, samples(3), LossKind::NextState, 4).unwrap();
    let before = objective.loss(&start);
    let end = Levenberg::new(&*objective, start.clone()).run(&*objective, 5, |_, _| {});
    assert!(end.loss < before);
    // The numbers are c, c_load, τ_s and ε, for both types.
    let changed: Vec<bool> = end.weights.iter().zip(&start).map(|(a, b)| a != b).collect();
    assert_eq!(changed[start.len() - 8..], [false, true, false, false, false, true, false, false]);
}
