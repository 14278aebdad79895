//! Networks that correct the energies and friction of any family: every loss supports them; they are learned, shipped and read back.

use crate::friction::{architecture, samples};
use leastaction_core::continuous::acceleration;
use leastaction_core::energy::trigonometric::PENDULUM;
use leastaction_core::forces::{Forces, System};
use leastaction_core::linear::Matrix;
use leastaction_core::model::{Law, LawNetwork};
use leastaction_core::network::Activation;
use leastaction_core::scalar::Scalar;
use leastaction_learning::config::{Config, ConfigError};
use leastaction_learning::training::{Levenberg, LossKind, Samples, objective};
use leastaction_models::file::{decode, encode, rust_source};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::path::Path;

const INERTIA_NETWORK: &str = "coordinates = \"ata\"\nhidden = [5, 3]\n";
const TREE: &str = "family = \"modular\"\ntypes = [{ name = \"cart\", transform = \"slide\" }, { name = \"bob\", transform = \"rod\", \
                    inertia = 0.3, potential = [] }]\ntrees = { crane = [\"cart\", \"bob\", \"bob\"] }\n";
const BODIES: &str = "family = \"bodies\"\nchain = 3\n";
const FRICTION: &str =
    "friction = { viscous = \"learned\", coulomb = { learn = 0.3 }, width = { learn = 0.4 } }\n";
const BOTH: &str = "[model.dissipation]\ncoordinates = [2, 0]\npositions = [2]\nhidden = [4, 3]\nscale = [0.5, 2.0]\n\
                    [model.potential]\ncoordinates = [1, 2]\nhidden = [5]\nactivation = \"softplus\"\n";

fn parse(model: &str) -> Result<Config, ConfigError> {
    Config::parse(&format!("[data]\nfile = \"a.npz\"\n[model]\n{model}"), Path::new("c.toml"))
}

// ---- Configuration ----

#[test]
fn networks_are_what_was_written() {
    let (shape, weights) = architecture(&format!("{INERTIA_NETWORK}{FRICTION}{BOTH}"));
    let laws = shape.laws();
    let dissipation = LawNetwork { coordinates: "c-a", widths: [4, 3, 0, 0], activation: Activation::Tanh };
    let potential = LawNetwork { coordinates: "-ta", widths: [5, 0, 0, 0], activation: Activation::Softplus };
    assert_eq!(laws.network(Law::Dissipation), Some(dissipation));
    assert_eq!(laws.network(Law::Potential), Some(potential));
    assert_eq!(shape.parameters().unwrap(), weights.len());
    let [of_dissipation, of_potential] = shape.corrections.split(&weights);
    // 2 scales, 4 → 4 → 3 → 3; 3 → 5 → 1.
    assert_eq!((of_dissipation.len(), of_potential.len()), (2 + 20 + 15 + 12, 20 + 6));
    assert_eq!(of_dissipation[..2], [0.5, 2.0]);
    // L begins near a small multiple of the unit matrix.
    assert_eq!(of_dissipation[of_dissipation.len() - 3..], [0.1, 0.0, 0.1]);
    let start = weights.len() - 49 - 26;
    let fixed: Vec<usize> = shape.fixed_positions().into_iter().filter(|place| *place >= start).collect();
    assert_eq!(fixed, [start, start + 1, weights.len() - 1]);
    assert_eq!(shape.number_names().len(), weights.len());
    assert!(shape.number_names()[start..].iter().all(Option::is_none));
    assert!(shape.number_names()[start - 1].clone().unwrap().name.contains("width"));
}

/// Keys left out have defaults: all coordinates and their positions, scales of 1, a layer of 8.
#[test]
fn everything_has_a_default() {
    for (model, letters, positions) in [
        (INERTIA_NETWORK, "ata", "ata"),
        (TREE, "taa", "taa"),
        (BODIES, "aaa", "aaa"),
        ("coordinates = \"tca\"\n", "tca", "t-a"),
    ] {
        let (shape, _) = architecture(&format!("{model}[model.dissipation]\n[model.potential]\n"));
        let widths = [8, 0, 0, 0];
        let dissipation = LawNetwork { coordinates: letters, widths, activation: Activation::Tanh };
        assert_eq!(shape.laws().network(Law::Dissipation), Some(dissipation));
        let potential = LawNetwork { coordinates: positions, ..dissipation };
        assert_eq!(shape.laws().network(Law::Potential), Some(potential));
        assert_eq!(shape.corrections.dissipation.unwrap().scales, [1.0; 3]);
    }
    let (without, _) =
        architecture(&format!("{INERTIA_NETWORK}[model.dissipation]\npositions = []\ncoordinates = [1]\n"));
    assert_eq!(without.laws().network(Law::Dissipation).unwrap().coordinates, "-c");
}

#[test]
fn errors_name_line_and_key() {
    let cases = [
        ("[model.dissipation]\nhiden = [4]", 6, "did you mean `hidden`?"),
        ("[model.dissipation]\nhidden = [4, 0]", 6, "units"),
        ("[model.dissipation]\ncoordinates = [2]", 6, "there is no coordinate 2"),
        ("[model.dissipation]\ncoordinates = [1, 0, 1]", 6, "coordinate 1 stands there twice"),
        ("[model.dissipation]\ncoordinates = []", 6, "must see a coordinate"),
        ("[model.dissipation]\ncoordinates = [1]\npositions = [0]", 7, "coordinate 0 is not among"),
        ("[model.dissipation]\nscale = 0.0", 6, "`scale` is 0; it must be a finite number above 0"),
        ("[model.dissipation]\nscale = [1.0]", 6, "has 1 numbers; it must have 2"),
        ("[model.dissipation]\nscale = \"auto\"", 6, "a number above 0, or a list of them"),
        ("[model.potential]\nscale = 1.0", 6, "unknown field `scale`"),
        ("[model.potential]\ncoordinates = [0, 1]", 6, "coordinate 1 is cyclic"),
    ];
    for (text, line, words) in cases {
        let message = parse(&format!("coordinates = \"tc\"\n{text}\n")).unwrap_err().to_string();
        assert!(
            message.starts_with(&format!("c.toml:{line}: ")) && message.contains(words),
            "{text}: {message}"
        );
    }
    let graph =
        "family = \"graph\"\nnode_types = [{ name = \"bob\" }]\ngraphs = { one = { nodes = [\"bob\"] } }\n";
    for table in ["dissipation", "potential"] {
        let message = parse(&format!("{graph}[model.{table}]\nhidden = [4]\n")).unwrap_err().to_string();
        assert!(message.contains("a graph has no networks of its coordinates"), "{message}");
    }
    let cyclic = parse("coordinates = \"cc\"\n[model.potential]\n").unwrap_err().to_string();
    assert!(cyclic.contains("must see a coordinate"), "{cyclic}");
    let long = parse("family = \"bodies\"\nchain = 17\n[model.dissipation]\n").unwrap_err().to_string();
    assert!(long.contains("17 coordinates of a network, but at most 16"), "{long}");
}

#[test]
fn what_is_written_is_read_again() {
    for model in [INERTIA_NETWORK, TREE, BODIES] {
        let config = parse(&format!("{model}{FRICTION}{BOTH}")).unwrap();
        assert_eq!(
            Config::parse(&config.to_toml(), Path::new("c.toml")).unwrap(),
            config,
            "{}",
            config.to_toml()
        );
    }
}

// ---- Files ----

#[test]
fn files_come_back_bit_for_bit() {
    let one = "[model.dissipation]\ncoordinates = [1]\nscale = 0.25\n";
    for model in [INERTIA_NETWORK, TREE, BODIES] {
        for laws in [format!("{FRICTION}{BOTH}"), BOTH.to_owned(), one.to_owned()] {
            let (shape, weights) = architecture(&format!("{model}{laws}"));
            let bytes = encode(&shape, &weights, None, "here").unwrap();
            let read = decode(&bytes).unwrap();
            assert_eq!(read.architecture.corrections, shape.corrections);
            assert_eq!(
                encode(&read.architecture, &read.weights, None, "here").unwrap(),
                bytes,
                "{model}{laws}"
            );
            let [ours, theirs] = [(&shape, &weights), (&read.architecture, &read.weights)]
                .map(|(shape, weights)| shape.friction_of_coordinates(weights));
            assert_eq!(ours.len(), theirs.len());
            for (ours, theirs) in ours.iter().zip(&theirs) {
                assert_eq!(f64::from(ours.viscous as f32), theirs.viscous);
                assert_eq!(ours.dry.map(|dry| dry.width as f32), theirs.dry.map(|dry| dry.width as f32));
            }
        }
    }
}

/// The trained networks of the model to start from are kept, unless they are given anew.
#[test]
fn a_model_to_go_on_from_keeps_its_networks() {
    let folder = tempfile::tempdir().unwrap();
    let (shape, weights) = architecture(&format!("{TREE}{FRICTION}{BOTH}"));
    let file = folder.path().join("crane.postcard");
    std::fs::write(&file, encode(&shape, &weights, None, "").unwrap()).unwrap();
    let from = |text: &str| parse(&format!("from = {:?}\n{text}", file.display().to_string()));
    let (kept, rounded) = from("").unwrap().beginning().unwrap();
    assert_eq!((&kept.corrections, rounded.len()), (&shape.corrections, weights.len()));
    let single: Vec<f64> = weights.iter().map(|weight| f64::from(*weight as f32)).collect();
    assert_eq!(kept.corrections.split(&rounded), shape.corrections.split(&single));
    assert_eq!(kept.friction_of_coordinates(&rounded), shape.friction_of_coordinates(&single));
    let (anew, weights) = from("[model.dissipation]\ncoordinates = [1]\n").unwrap().beginning().unwrap();
    let [dissipation, potential] = anew.corrections.split(&weights);
    assert_eq!((dissipation.len(), dissipation[0]), (1 + 4 * 8 + 9, 1.0));
    assert_eq!(potential, kept.corrections.split(&rounded)[1]);
    let short = from("trees = { one = [\"cart\"] }\n").unwrap_err().to_string();
    assert!(short.contains("there is no coordinate 2 in every tree"), "{short}");
}

#[test]
fn a_rust_source_names_the_types_of_its_laws() {
    let source = |model: &str| {
        let (shape, weights) = architecture(model);
        rust_source(&encode(&shape, &weights, None, "").unwrap()).unwrap()
    };
    let both = source(&format!("{INERTIA_NETWORK}{FRICTION}{BOTH}"));
    for words in [
        "use leastaction_core::forces::{Coulomb, Dissipation, PotentialCorrection, Viscous};",
        "pub const LAW_H: usize = 5;",
        "pub const LAW_L: usize = 2;",
        "(((Viscous<f32, M>, Coulomb<f32, M>), Dissipation<'static, f32, M, LAW_H, LAW_L>), \
         PotentialCorrection<'static, f32, M, LAW_H, LAW_L>)",
        "pub type Model = InertiaNetworkModel<'static, N, H, L, f32, Forces<N>>;",
    ] {
        assert!(both.contains(words), "{words}: {both}");
    }
    let one = source(&format!("{TREE}[model.potential]\nhidden = [3]\n"));
    assert!(one.contains("(Viscous<f32, M>, PotentialCorrection<'static, f32, M, LAW_H, LAW_L>)"), "{one}");
}

// ---- Learning ----

/// The gradient of the loss with respect to the networks' weights equals central differences.
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
    for model in [INERTIA_NETWORK, TREE, BODIES] {
        let (shape, mut weights) = architecture(&format!("{model}{FRICTION}{BOTH}"));
        let first = shape.corrections_start();
        // The weights move away from the start, where outputs are small.
        let mut random = Pcg64::seed_from_u64(3);
        weights[first + 2..].iter_mut().for_each(|weight| *weight += random.random_range(-0.3..0.3));
        let fixed = shape.fixed_positions();
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
                    "{model}{kind:?} {order} {place}: {found} {expected}"
                );
            }
        }
    }
}

/// Friction that falls before it rises (Stribeck) and depends on the position.
#[derive(Clone, Copy)]
struct Stribeck;

impl<S: Scalar> Forces<S, 1> for Stribeck {
    fn force(&self, [q]: &[S; 1], [v]: &[S; 1], _: &[S; 1]) -> [S; 1] {
        let number = S::constant;
        let relative = *v / number(0.4);
        let level = number(0.15) + number(0.25) * (-(relative * relative)).exp();
        let ripple = S::one() + number(0.4) * q.sin_cos().1;
        [-(number(0.03) * *v + level * ripple * (*v / number(0.15)).tanh())]
    }

    fn derivatives(&self, _: &[S; 1], _: &[S; 1], _: &[S; 1]) -> (Matrix<S, 1>, Matrix<S, 1>) {
        unreachable!("accelerations need no derivative")
    }

    fn load_derivative(&self, _: &[S; 1], _: &[S; 1], _: &[S; 1]) -> Matrix<S, 1> {
        unreachable!("accelerations need no derivative")
    }
}

/// States of a pendulum under such friction, with their accelerations.
fn accelerations(count: usize, seed: u64) -> Samples {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut numbers =
        |range: f64| -> Vec<f64> { (0..count).map(|_| random.random_range(-range..range)).collect() };
    let (q, v, u) = (numbers(3.0), numbers(2.0), numbers(4.0));
    let system = System { lagrangian: PENDULUM, forces: Stribeck };
    let states = q.iter().zip(&v).zip(&u);
    let a = states.map(|((q, v), u)| acceleration(&system, &[*q], &[*v], &[*u]).unwrap()[0]).collect();
    Samples { n: 1, states: [q, v, a], controls: [u.clone(), u.clone(), u], ..Samples::default() }
}

/// The held-back error of a model of bodies with these laws, learned from accelerations.
fn held_back(laws: &str) -> f64 {
    // The frame of PENDULUM: 0 is upright.
    let (shape, start) =
        architecture(&format!("family = \"bodies\"\ngravity = [-9.81, 0.0]\nchain = 1\n{laws}"));
    let of = |samples| objective(&shape, samples, LossKind::Acceleration, 4).unwrap();
    let (train, test) = (of(accelerations(600, 1)), of(accelerations(400, 2)));
    let end = Levenberg::new(&*train, start).run(&*train, 200, |_, _| {});
    test.loss(&end.weights)
}

#[test]
fn a_network_learns_friction_that_no_formula_has() {
    let coulomb = "friction = { viscous = \"learned\", coulomb = \"learned\" }\n";
    let without = held_back(coulomb);
    let with = held_back(&format!("{coulomb}[model.dissipation]\nhidden = [8]\nscale = 0.3\n"));
    println!("held back, mean square in (rad/s²)²: without {without:.3e}, with {with:.3e}");
    assert!(with < without / 100.0, "{with:e} of {without:e}");
}
