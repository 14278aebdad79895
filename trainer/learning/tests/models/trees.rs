//! Configurations of trees of elements: their meaning, and their errors with file, line and key.

use leastaction_core::energy::modular::{Input, PairInput, TransformShape};
use leastaction_learning::config::{Config, ConfigError};
use leastaction_models::Family as _;
use leastaction_models::config::{FamilyConfig, ModularConfig};
use leastaction_models::{ModularArchitecture, Number};
use std::path::Path;

fn parse(text: &str) -> Result<Config, ConfigError> {
    Config::parse(text, Path::new("c.toml"))
}

/// A configuration whose first four lines are the two of `[data]` and the two of `[model]` that name the family.
fn modular(rest: &str) -> String {
    format!("[data]\nfile = \"data.npz\"\n[model]\nfamily = \"modular\"\n{rest}\n")
}

fn architecture(text: &str) -> ModularArchitecture {
    parse(text).unwrap().beginning().unwrap().0.family.modular().unwrap().clone()
}

fn error(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

const BOB: &str = "[[model.types]]\nname = \"bob\"\ntransform = \"angle\"\n";
const CHAIN: &str = "[model.trees]\ndouble = [\"bob\", \"bob\"]";

fn elements(architecture: &ModularArchitecture) -> Vec<(&str, Vec<u8>)> {
    architecture.trees.iter().map(|tree| (tree.name.as_str(), tree.elements.clone())).collect()
}

#[test]
fn printed_defaults_are_the_defaults() {
    let least = modular(&format!("{BOB}potential = [16]\n{CHAIN}"));
    let (printed, least) = (architecture(ModularConfig::defaults()), architecture(&least));
    assert_eq!((printed.shape, &printed.types), (least.shape, &least.types));
    assert_eq!(elements(&printed), [("double", vec![0, 0, 0, 1]), ("fork", vec![0, 0, 0, 1, 0, 1])]);
}

#[test]
fn printed_keys_that_are_off_can_be_switched_on() {
    let on: Vec<_> = ModularConfig::defaults()
        .lines()
        .map(|line| match line.strip_prefix("# ") {
            Some(key) if key.starts_with("[model.pair]") => key,
            Some(key)
                if ["velocity =", "input =", "hidden =", "activation ="]
                    .iter()
                    .any(|k| key.starts_with(k)) =>
            {
                key
            }
            _ => line,
        })
        .collect();
    let on = architecture(&on.join("\n"));
    assert_eq!(on.shape.networks.len(), 4);
    assert_eq!(on.shape.pair.unwrap().input, PairInput::Distance);
}

#[test]
fn every_key_is_explained() {
    let all = modular(
        "[[model.types]]\nname = \"bob\"\ntransform = \"angle\"\nposition = [3]\nvelocity = [3]\npotential = [3]\n\
         activation = \"isru\"\nmass = 2.0\ninertia = 1\ncentre = 0.5\ndamping = 0.1\n[model.pair]\nhidden = [3]\n\
         activation = \"isru\"\n[model.trees]\none = [\"bob\"]",
    );
    let table: toml::Table = toml::from_str(&parse(&all).unwrap().to_toml()).unwrap();
    let model = table["model"].as_table().unwrap();
    let types = model["types"].as_array().unwrap()[0].as_table().unwrap();
    for key in types.keys().chain(model["pair"].as_table().unwrap().keys()).chain(model.keys()) {
        let known = [format!("{key} = "), format!("[[model.{key}]]"), format!("[model.{key}]")];
        assert!(known.iter().any(|text| ModularConfig::defaults().contains(text)), "{key}");
    }
}

#[test]
fn toml_round_trips() {
    let config = parse(ModularConfig::defaults()).unwrap();
    assert_eq!(parse(&config.to_toml()).unwrap(), config);
    let mixed = modular(&format!(
        "{BOB}mass = {{ learn = 2 }}\n[model.trees]\nmixed = [\"bob\", {{ type = \"bob\" }}, \"bob\", {{ type = \"bob\", on = 0 }}]"
    ));
    let config = parse(&mixed).unwrap();
    assert_eq!(parse(&config.to_toml()).unwrap(), config);
    assert_eq!(elements(&architecture(&mixed)), [("mixed", vec![0, 0, 0, 0, 0, 2, 0, 1])]);
}

#[test]
fn types_have_their_transforms_and_numbers() {
    let text = modular(
        "tree = \"all\"\n\
         [[model.types]]\nname = \"cart\"\ntransform = \"slide\"\nmass = { learn = 2 }\ndamping = { learn = 0.1 }\n\
         [[model.types]]\nname = \"link\"\ntransform = \"rod\"\nlength = 0.5\ncentre = 0.25\ninertia = { learn = 0.02 }\n\
         potential = []\n\
         [[model.types]]\nname = \"body\"\ntransform = \"free\"\n\
         [[model.types]]\nname = \"seam\"\ntransform = \"wrapped-angle\"\nposition = [5, 4]\nvelocity = [3]\n\
         [model.pair]\ninput = \"concat\"\nhidden = [7]\n\
         [model.trees]\nall = [\"cart\", \"link\", \"body\", \"seam\"]\nlone = [\"body\", \"body\"]",
    );
    let model = architecture(&text);
    // The free body hangs from nothing, the seam from the body; the chosen tree is the first.
    assert_eq!(elements(&model), [("all", vec![0, 0, 1, 1, 2, 0, 3, 3]), ("lone", vec![2, 0, 2, 0])]);
    assert_eq!(model.coordinates(), "tatta");
    let [mass, .., damping] = model.types[0].numbers;
    assert_eq!((mass, damping), (Number::learned(2.0), Number::learned(0.1)));
    let known = Number::known;
    let link = [known(1.0), Number::learned(0.02), known(0.25), known(0.5), known(0.0)];
    assert_eq!(model.types[1].numbers, link);
    let sizes: Vec<_> = model.shape.networks.iter().map(|n| (n.inputs, n.widths().0[0], n.outputs)).collect();
    assert_eq!(sizes, [(2, 0, 1), (1, 5, 2), (1, 3, 2), (4, 7, 1)]);
    let seam = model.shape.types.get(3_u8).unwrap().transform;
    assert_eq!(seam, TransformShape::Network { position: 1, velocity: Some(2), input: Input::WrappedAngle });
    assert_eq!(model.fixed_positions().len(), 4 * 5 + 2 - 3);
}

#[test]
fn the_family_decides_which_keys_there_are() {
    let unknown = error("[data]\nfile = \"a\"\n[model]\nfamily = \"modul\"\n");
    assert!(unknown.starts_with("c.toml:4: ") && unknown.contains("did you mean `modular`?"), "{unknown}");
    for family in ["inertia-network", "rigid"] {
        let tree = error(&format!(
            "[data]\nfile = \"a\"\n[model]\nfamily = \"{family}\"\ncoordinates = \"a\"\ntree = \"x\"\n"
        ));
        assert!(tree.starts_with("c.toml:6: ") && tree.contains("unknown field `tree`"), "{tree}");
    }
    let hidden = error(&modular("hidden = [8]"));
    assert!(hidden.starts_with("c.toml:5: ") && hidden.contains("unknown field `hidden`"), "{hidden}");
}

/// Refused text after [`modular`]'s lines, line of the error, and words of its message.
type Refusal<'a> = (String, usize, &'a [&'a str]);

#[track_caller]
fn assert_refused(cases: &[Refusal]) {
    for (text, line, words) in cases {
        let message = error(&modular(text));
        assert!(message.starts_with(&format!("c.toml:{line}: ")), "line {line}: {message}");
        for word in *words {
            assert!(message.contains(word), "{word:?} is not in {message}");
        }
    }
}

#[test]
fn trees_that_cannot_be_are_refused_with_line_and_key() {
    assert_refused(&[
        (CHAIN.to_owned(), 3, &["no element types", "[[model.types]]"]),
        (BOB.to_owned(), 3, &["no tree", "[model.trees]"]),
        (
            format!("{BOB}[model.trees]\na = [\"bob\", \"bo\"]"),
            9,
            &["no element type is called \"bo\"", "bob"],
        ),
        (format!("{BOB}[model.trees]\na = []"), 9, &["at least one element"]),
        (
            format!("{BOB}[model.trees]\na = [{{ type = \"bob\", on = 1 }}, \"bob\"]"),
            9,
            &["element 0", "cycle", "parents first"],
        ),
        (
            format!("{BOB}[model.trees]\na = [{{ type = \"bob\", at = 1 }}]"),
            9,
            &["unknown field `at`", "`on`"],
        ),
        (
            format!("{BOB}[model.trees]\na = [\"bob\",\n {{ type = \"bob\", on = 1 }}]"),
            10,
            &["element 1 hangs from element 1"],
        ),
        (format!("{BOB}[model.trees]\na = [\"bob\"]\nb = [\"bob\"]"), 3, &["which tree", "a, b"]),
        (format!("tree = \"dubble\"\n{BOB}{CHAIN}"), 5, &["no tree is called \"dubble\"", "double"]),
    ]);
}

#[test]
fn types_that_cannot_be_are_refused_with_line_and_key() {
    assert_refused(&[
        (format!("{BOB}mass = 0.0\n{CHAIN}"), 8, &["`mass` is 0", "above 0"]),
        (format!("{BOB}mass = {{ learn = -1.0 }}\n{CHAIN}"), 8, &["`mass` is -1", "above 0"]),
        (
            format!("{BOB}mass = {{ lern = 1.0 }}\n{CHAIN}"),
            8,
            &["unknown field `lern`", "did you mean `learn`?"],
        ),
        (format!("{BOB}mass = \"heavy\"\n{CHAIN}"), 8, &["{ learn = 1.0 }"]),
        (format!("{BOB}damping = -0.1\n{CHAIN}"), 8, &["`damping` is -0.1", "0 or above"]),
        (format!("{BOB}length = 2.0\n{CHAIN}"), 8, &["`length` means nothing", "angle"]),
        (format!("{BOB}masss = 2.0\n{CHAIN}"), 8, &["unknown field `masss`", "did you mean `mass`?"]),
        (
            format!("[[model.types]]\nname = \"r\"\ntransform = \"rod\"\nposition = [8]\n{CHAIN}"),
            8,
            &["`position` means nothing", "rod"],
        ),
        (format!("[[model.types]]\nname = \"r\"\n{CHAIN}"), 6, &["how does \"r\" move", "transform"]),
        (format!("[[model.types]]\nname = \"a,b\"\n{CHAIN}"), 6, &["comma"]),
        (format!("{BOB}{BOB}{CHAIN}"), 9, &["another type \"bob\""]),
    ]);
}

#[test]
fn networks_and_pairs_that_cannot_be_are_refused_with_line_and_key() {
    assert_refused(&[
        (format!("{BOB}position = [65]\n{CHAIN}"), 8, &["1 to 64 units"]),
        (format!("{BOB}potential = [1, 2, 3, 4]\n{CHAIN}"), 8, &["at most 3 layers"]),
        (format!("{BOB}[model.pair]\ninput = \"distence\"\n{CHAIN}"), 9, &["did you mean `distance`?"]),
        (format!("from = \"no/such/run\"\n{CHAIN}"), 5, &["no/such/run"]),
    ]);
}

#[test]
fn more_than_a_model_holds_is_refused() {
    let double = CHAIN.lines().nth(1).unwrap();
    let seven = "[[model.types]]\nname = \"N\"\ntransform = \"rod\"\n";
    let seven: String = (0..7).map(|i| seven.replace('N', &i.to_string())).collect();
    let learned = format!("{BOB}velocity = [1]\npotential = [1]\n");
    let twelve: String = ["bob", "0", "1", "2"].iter().map(|name| learned.replace("bob", name)).collect();
    let nine: String = (0..9).map(|i| format!("t{i} = [\"bob\"]\n")).collect();
    let long = format!("long = [{}]", "\"bob\", ".repeat(65));
    assert_refused(&[
        (
            format!("{seven}[model.trees]\n{}", double.replace("bob", "0")),
            5,
            &["7 element types", "at most 6"],
        ),
        (format!("{twelve}{CHAIN}"), 5, &["12 networks", "at most 8"]),
        (format!("tree = \"t0\"\n{BOB}[model.trees]\n{nine}"), 9, &["9 trees", "at most 8"]),
        (format!("{BOB}[model.trees]\n{long}"), 9, &["65 coordinates", "at most 64"]),
    ]);
}

#[test]
fn positions_of_equal_shape_begin_equal() {
    let text = modular(
        "tree = \"one\"\n[[model.types]]\nname = \"a\"\ntransform = \"angle\"\nposition = [3]\nvelocity = [3]\n\
         [[model.types]]\nname = \"b\"\ntransform = \"angle\"\nposition = [4]\n\
         [[model.types]]\nname = \"c\"\ntransform = \"angle\"\nposition = [3]\n\
         [model.trees]\none = [\"a\", \"b\", \"c\"]",
    );
    let weights = parse(&text).unwrap().beginning().unwrap().1;
    let (small, large) = (2 * 3 + 3 + 3 * 2 + 2, 2 * 4 + 4 + 4 * 2 + 2);
    let [a, velocity, c] = [0, small, 2 * small + large].map(|start| &weights[start..start + small]);
    assert_eq!(a, c);
    assert_ne!(a, velocity);
}
