//! `[model.friction]`: valid keys, and messages about invalid ones.

use leastaction_core::model::{Law, Laws};
use leastaction_learning::config::{Config, ConfigError};
use leastaction_models::file::{decode, encode};
use leastaction_models::{Number, Scales};
use leastaction_programs::energies::Energies;
use std::path::Path;

const INERTIA_NETWORK: &str = "coordinates = \"ta\"\n";
const TREE: &str = "family = \"modular\"\ntypes = [{ name = \"cart\", transform = \"slide\" }, { name = \"bob\", transform = \"rod\" }]\n\
                    trees = { crane = [\"cart\", \"bob\", \"bob\"] }\n";

fn parse(model: &str) -> Result<Config, ConfigError> {
    Config::parse(&format!("[data]\nfile = \"a.npz\"\n[model]\n{model}"), Path::new("c.toml"))
}

fn error(model: &str) -> String {
    parse(model).unwrap_err().to_string()
}

/// A number that follows the log's scale.
fn follows(number: Number, part: f64) -> Number {
    Number { part: Some(part), ..number }
}

#[test]
fn one_word_learns_damping_and_dry_friction() {
    let (shape, weights) =
        parse(&format!("{INERTIA_NETWORK}friction = \"learned\"\n")).unwrap().beginning().unwrap();
    assert_eq!((shape.laws(), weights.len()), (Laws::FRICTION, shape.parameters().unwrap()));
    assert_eq!(shape.group_laws.viscous, [follows(Number::learned(0.01), 0.02); 2]);
    let [constant, width] = [0.03, 0.05].map(|part| follows(Number::learned(0.1), part));
    let dry = [constant, Number::known(0.0), follows(Number::known(0.1), 0.02), width];
    assert_eq!(shape.group_laws.coulomb, [dry; 2].as_flattened());
    assert_eq!(weights[weights.len() - 10..], [0.01, 0.01, 0.1, 0.0, 0.1, 0.1, 0.1, 0.0, 0.1, 0.1]);
}

#[test]
fn parts_are_learned_known_or_absent_one_by_one() {
    let text = format!(
        "{TREE}[model.friction]\ncoulomb = [0.5, {{ learn = 0.2 }}]\nload = [0, \"learned\"]\nwidth = 0.3\nsmoothing = 2\n"
    );
    let (shape, _) = parse(&text).unwrap().beginning().unwrap();
    // The types have damping of their own, 0.
    assert_eq!((shape.laws(), shape.group_laws.viscous.len()), (Laws::FRICTION, 0));
    let (known, learned) = (Number::known, Number::learned);
    let cart = [known(0.5), known(0.0), known(2.0), known(0.3)];
    let pole = [learned(0.2), learned(0.1), known(2.0), known(0.3)];
    assert_eq!(shape.group_laws.coulomb, [cart, pole].as_flattened());
    let absent = parse(TREE).unwrap().beginning().unwrap().0;
    assert!(absent.group_laws.is_none() && absent.laws() == Laws::VISCOUS);
    let (viscous, weights) =
        parse(&format!("{TREE}[model.friction]\nviscous = [0.5, 0.25]\n")).unwrap().beginning().unwrap();
    assert_eq!((viscous.laws(), &weights[weights.len() - 2..]), (Laws::VISCOUS, &[0.5, 0.25][..]));
}

/// Only numbers that were not given follow the scales of a log; widths are bounded by its speeds, and bounds make way for a given start.
#[test]
fn what_was_not_given_follows_the_log() {
    let text = format!(
        "{INERTIA_NETWORK}[model.friction]\nviscous = [\"learned\", {{ learn = 3.0 }}]\ncoulomb = [0.5, \"learned\"]\nload = \"learned\"\n\
         width = [\"learned\", {{ learn = 9.0 }}]\n"
    );
    let (mut shape, mut weights) = parse(&text).unwrap().beginning().unwrap();
    let before = weights.clone();
    let scales = |speed, force| Scales { speed, force, ..Scales::default() };
    assert!(shape.follows_scales());
    shape.follow(&[scales(0.1, 50.0), scales(4.0, 2.0)], &mut weights);
    let laws = weights.len() - 10;
    assert_eq!(weights[..laws], before[..laws], "energies stay");
    let expected = [0.02 * 500.0, 3.0, 0.5, 0.1, 1.0, 0.005, 0.06, 0.1, 0.04, 9.0];
    for (found, expected) in weights[laws..].iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
    assert_eq!(shape.law_entries().map(|entry| entry.number.value).collect::<Vec<_>>(), weights[laws..]);
    assert_eq!(
        [0, 1].map(|group| shape.group_laws.widths(Law::Coulomb, group)),
        [[0.003 * 0.1, 0.05], [0.012, 18.0]]
    );
    // A log that shows nothing changes nothing, neither does a second one.
    let after = shape.clone();
    shape.follow(&[Scales::default(); 2], &mut weights);
    assert_eq!(shape.group_laws.coulomb, after.group_laws.coulomb);
    assert_eq!(
        shape.group_laws.widths(Law::Coulomb, 0),
        [0.05 * 0.1 / 2.0, 1.0],
        "the usual bounds, which make way for the start"
    );
    let known = parse(&format!("{INERTIA_NETWORK}friction = {{ viscous = 0.1 }}\n")).unwrap();
    assert!(!known.beginning().unwrap().0.follows_scales());
}

/// Coordinates that share their numbers follow the larger scale.
#[test]
fn element_types_follow_the_larger_scale() {
    let text = format!("{TREE}friction = {{ coulomb = \"learned\" }}\n");
    let (mut shape, mut weights) = parse(&text).unwrap().beginning().unwrap();
    let scales = [(1.0, 30.0), (2.0, 5.0), (8.0, 4.0)];
    let scales = scales.map(|(speed, force)| Scales { speed, force, ..Scales::default() });
    shape.follow(&scales, &mut weights);
    let dry: Vec<[f64; 2]> =
        shape.group_laws.coulomb.chunks(4).map(|own| [own[0].value, own[3].value]).collect();
    assert_eq!(dry, [[0.03 * 30.0, 0.05], [0.03 * 5.0, 0.4]]);
}

fn laws_and_numbers(friction: &str) -> (Vec<Law>, Vec<f64>) {
    let (shape, weights) =
        parse(&format!("{INERTIA_NETWORK}[model.friction]\n{friction}")).unwrap().beginning().unwrap();
    assert_eq!(shape.parameters(), Ok(weights.len()));
    shape.energies().unwrap();
    let own = weights[shape.laws_start()..].to_vec();
    (shape.laws().iter().collect(), own)
}

/// Friction that sticks or differs by direction has laws of its own; a part that no law can hold with the others has a second one.
#[test]
fn every_combination_has_its_laws() {
    use Law::{Coulomb, Directional, Sticking, Viscous};
    let (laws, numbers) = laws_and_numbers("viscous = [0.5, 0.25]\ncoulomb = \"sticking\"\nwidth = 0.3\n");
    let stuck = [0.1, 0.0, 0.0, 0.1, 1.0, 0.3];
    assert_eq!(
        (laws, numbers),
        (vec![Viscous, Sticking], [vec![0.5, 0.25], [stuck, stuck].concat()].concat())
    );
    let all = "viscous = 0.5\nviscous_asymmetry = 0.25\ncoulomb = 0.7\nasymmetry = -0.5\nwidth = 0.3\nload = 0.2\nsmoothing = 2\n";
    let (laws, numbers) = laws_and_numbers(all);
    let [grown, turned] = [[0.0, 0.2, 2.0, 0.3].repeat(2), [0.5, 0.25, 0.7, -0.5, 0.3].repeat(2)];
    assert_eq!((laws, numbers), (vec![Coulomb, Directional], [grown, turned].concat()));
    let (laws, numbers) = laws_and_numbers(&format!("{all}sticking = true\nbreakaway = [1.5, 1]\n"));
    let turned = [0.5, 0.25, 0.0, 0.0, 0.3].repeat(2);
    let stuck = [1.5, 1.0].map(|breakaway| [0.7, -0.5, 0.2, 2.0, breakaway, 0.3]);
    assert_eq!((laws, numbers), (vec![Directional, Sticking], [turned, stuck.concat()].concat()));
}

/// Laws on both sides of the correction networks keep their numbers in a model file, and every coordinate has the friction of all of them.
#[test]
fn laws_stand_before_and_after_the_networks() {
    let text = format!(
        "{INERTIA_NETWORK}servo = {{ stiffness = 7.0 }}\n[model.dissipation]\nhidden = [3]\nscale = 0.4\n[model.friction]\n\
         viscous = [0.5, 0.25]\ncoulomb = \"sticking\"\nasymmetry = [0.125, -0.5]\n"
    );
    let (shape, weights) = parse(&text).unwrap().beginning().unwrap();
    let laws: Vec<Law> = shape.laws().iter().collect();
    assert_eq!(laws, [Law::Viscous, Law::Dissipation, Law::Servo, Law::Sticking]);
    let read = decode(&encode(&shape, &weights, None, "").unwrap()).unwrap();
    let single = |numbers: &[f64]| numbers.iter().map(|x| f64::from(*x as f32)).collect::<Vec<_>>();
    assert_eq!(read.weights, single(&weights));
    assert_eq!(read.architecture.corrections_place(), shape.corrections_place());
    let friction = read.architecture.friction_of_coordinates(&read.weights);
    let of = |i: usize| {
        (friction[i].viscous, friction[i].dry.unwrap().asymmetry, friction[i].dry.unwrap().breakaway)
    };
    assert_eq!([of(0), of(1)], [(0.5, 0.125, Some(1.0)), (0.25, -0.5, Some(1.0))]);
    assert_eq!(read.architecture.stiffness_of_coordinates(&read.weights), [7.0; 2]);
    assert_eq!(read.weights[shape.corrections_place()][0], f64::from(0.4_f32), "the scale of the network");
    let names = shape.number_names();
    let last = names.last().unwrap().as_ref().unwrap();
    assert_eq!(
        (last.name.as_str(), last.unit),
        ("coordinate 1: Coulomb friction, width of the change of sign", "rad/s")
    );
    let model = shape.energies().unwrap();
    assert_eq!(model.parameters(), weights.len());
}

#[test]
fn what_is_written_is_read_again() {
    for friction in [
        "friction = \"learned\"\n",
        "[model.friction]\nviscous = [0.5, \"learned\"]\nload = { learn = 0.2 }\nwidth = 0.3\nsmoothing = 2.0\n",
        "friction = \"sticking\"\n",
        "[model.friction]\nviscous = 0.5\nviscous_asymmetry = \"learned\"\ncoulomb = \"sticking\"\nbreakaway = [1.5, 1]\n",
    ] {
        for model in [INERTIA_NETWORK, TREE] {
            let config = parse(&format!("{model}{friction}")).unwrap();
            assert_eq!(
                Config::parse(&config.to_toml(), Path::new("c.toml")).unwrap(),
                config,
                "{}",
                config.to_toml()
            );
        }
    }
}

#[test]
fn errors_name_line_and_key() {
    let cases = [
        ("friction = \"learnt\"", 5, "expected \"learned\""),
        ("friction = 0.1", 5, "\"learned\", \"sticking\", or a table"),
        ("friction = { coulomb = \"stiking\" }", 5, "expected \"sticking\", \"learned\", a number"),
        ("friction = { load = \"sticking\" }", 5, "expected \"learned\", a number"),
        ("[model.friction]\nviscous = 0.1\nsticking = true", 7, "means nothing without dry friction"),
        ("[model.friction]\nviscous = 0.1\nasymmetry = 0.5", 7, "means nothing without dry friction"),
        ("[model.friction]\ncoulomb = 0.1\nviscous_asymmetry = 0.5", 7, "means nothing without damping"),
        (
            "[model.friction]\ncoulomb = 0.1\nasymmetry = 1.5",
            7,
            "`asymmetry` is 1.5; it must be between -1 and 1",
        ),
        (
            "[model.friction]\ncoulomb = 0.1\nasymmetry = { learn = -1.0 }",
            7,
            "without them, where it is learned",
        ),
        ("[model.friction]\ncoulomb = 0.1\nbreakaway = 1.5", 7, "add sticking = true"),
        ("[model.friction]\ncoulomb = \"sticking\"\nbreakaway = \"learned\"", 7, "cannot be learned"),
        ("[model.friction]\ncoulomb = \"sticking\"\nbreakaway = 0.5", 7, "1 or above"),
        ("[model.friction]\ncolomb = 1.0", 6, "did you mean `coulomb`?"),
        ("[model.friction]\ncoulomb = -1.0", 6, "`coulomb` is -1; it must be a finite number, 0 or above"),
        ("[model.friction]\ncoulomb = { learn = 0.0 }", 6, "above 0 where it is learned"),
        ("[model.friction]\nload = 1.0", 6, "below 1"),
        ("[model.friction]\ncoulomb = 1.0\nwidth = { learn = 0.0 }", 7, "above 0 where it is learned"),
        ("[model.friction]\nwidth = 0.1", 6, "means nothing without dry friction"),
        ("[model.friction]\nviscous = [0.1]", 6, "has 1 numbers; it must have 2, one for each coordinate"),
        ("[model.friction]\nviscous = [0.1, \"known\"]", 6, "expected \"learned\""),
        ("damping = true\n[model.friction]\nviscous = 0.1", 7, "`damping` too"),
    ];
    for (text, line, words) in cases {
        let message = error(&format!("{INERTIA_NETWORK}{text}\n"));
        assert!(
            message.starts_with(&format!("c.toml:{line}: ")) && message.contains(words),
            "{text}: {message}"
        );
    }
    let of_types = error(&format!("{TREE}[model.friction]\ncoulomb = [0.1, 0.2, 0.3]\n"));
    assert!(of_types.contains("it must have 2, one for each element type"), "{of_types}");
    let twice = error(&format!(
        "{}[model.friction]\nviscous = 0.1\n",
        TREE.replace("\"slide\"", "\"slide\", damping = 0.1")
    ));
    assert!(twice.contains("`damping` too"), "{twice}");
    let graph =
        "family = \"graph\"\nnode_types = [{ name = \"bob\" }]\ngraphs = { one = { nodes = [\"bob\"] } }\n";
    parse(graph).unwrap();
    let graph = error(&format!("{graph}friction = \"learned\"\n"));
    assert!(graph.starts_with("c.toml:7: ") && graph.contains("give its node types `drag`"), "{graph}");
}

/// Friction of a model file is kept, a new type has none, and friction that is given anew replaces it.
#[test]
fn a_model_to_go_on_from_keeps_its_friction() {
    let folder = tempfile::tempdir().unwrap();
    let friction = "[model.friction]\nviscous = [0.5, 0.25]\ncoulomb = 0.125\nwidth = 0.5\n";
    let (shape, weights) = parse(&format!("{TREE}{friction}")).unwrap().beginning().unwrap();
    let file = folder.path().join("crane.postcard");
    std::fs::write(&file, encode(&shape, &weights, None, "").unwrap()).unwrap();
    let from = format!("from = {:?}\n", file.display().to_string());
    let more =
        "types = [{ name = \"slider\", transform = \"slide\" }]\ntrees = { two = [\"cart\", \"slider\"] }\n";
    let ends = |text: &str, count: usize| {
        let (shape, weights) = parse(&format!("{from}{text}")).unwrap().beginning().unwrap();
        assert_eq!((shape.laws(), shape.parameters().unwrap()), (Laws::FRICTION, weights.len()), "{text}");
        weights[weights.len() - count..].to_vec()
    };
    let dry = [0.125, 0.0, f64::from(0.1_f32), 0.5];
    assert_eq!(ends("", 10), [vec![0.5, 0.25], dry.to_vec(), dry.to_vec()].concat());
    let none = vec![0.0, 0.0, 1.0, 1.0];
    let grown = [vec![0.5, 0.25, 0.0], dry.to_vec(), dry.to_vec(), none].concat();
    assert_eq!(ends(more, 15), grown);
    let changed = [vec![0.75, 0.75], dry.to_vec(), dry.to_vec()].concat();
    assert_eq!(ends("[model.friction]\nviscous = 0.75\n", 10), changed);
}
