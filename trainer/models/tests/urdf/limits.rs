//! Limits of 0, which exporters write where nobody gave any.

use super::mjcf::{MASS, world};
use super::{error, joint, link, robot};
use leastaction_models::tree::Limits;
use leastaction_models::urdf::{Described, DescriptionNote, Options, parse_with};

/// Limits of every joint, and the joints that a note on limits of 0 names.
fn limits(text: &str) -> (Vec<Limits>, Vec<String>) {
    let Described { tree, notes } = parse_with(text, &Options::default()).unwrap();
    let noted = notes.into_iter().flat_map(|note| match note {
        DescriptionNote::ZeroLimits { joints } => joints,
        other => panic!("{other}"),
    });
    (tree.bodies().iter().map(|body| body.limits).collect(), noted.collect())
}

#[test]
fn zeros_of_a_urdf_file_are_none() {
    let with = |name: &str, kind: &str, links, limit: &str| {
        joint(name, kind, links, &format!("<axis xyz='0 0 1'/><limit {limit}/>"))
    };
    let text = robot(&[
        ["base", "a", "b", "c", "d"].map(link).concat(),
        with("i", "revolute", ["base", "a"], "lower='0' upper='0.0' velocity='2' effort='3'"),
        with("j", "prismatic", ["a", "b"], "lower='-1' upper='1' velocity='0' effort='0'"),
        with("k", "continuous", ["b", "c"], "lower='0' upper='0' velocity='2' effort='3'"),
        with("l", "revolute", ["c", "d"], "lower='0' upper='1' velocity='2' effort='3'"),
    ]);
    let (found, noted) = limits(&text);
    let (none, own) = (Limits::none(), Limits { velocity: 2.0, effort: 3.0, ..Limits::none() });
    let expected =
        [own, Limits { position: [-1.0, 1.0], ..none }, own, Limits { position: [0.0, 1.0], ..own }];
    assert_eq!((found, noted), (expected.to_vec(), vec!["i".to_owned(), "j".to_owned()]));
    let Described { notes, .. } = parse_with(&text, &Options::default()).unwrap();
    assert!(notes[0].to_string().ends_with("are taken as not given: i, j"), "{}", notes[0]);
}

fn of_mjcf(attributes: &str) -> String {
    world(&format!("<body name='a'>{MASS}<joint name='j' {attributes}/></body>"))
}

#[test]
fn zeros_of_an_mjcf_file_are_none() {
    let none = Limits::none();
    for zeros in [
        "range='0 0'",
        "range='0 0.0' limited='true'",
        "actuatorfrcrange='0 0'",
        "range='0 0' actuatorfrcrange='0 -0' actuatorfrclimited='true'",
    ] {
        assert_eq!(limits(&of_mjcf(zeros)), (vec![none], vec!["j".to_owned()]), "{zeros}");
    }
    // MuJoCo takes these for no limits as well.
    for unlimited in ["", "range='0 0' limited='false'", "range='2 1'", "range='1 1'"] {
        assert_eq!(limits(&of_mjcf(unlimited)), (vec![none], Vec::new()), "{unlimited}");
    }
    let own = Limits { position: [0.0, 1.0], effort: 4.0, ..none };
    assert_eq!(limits(&of_mjcf("range='0 1' actuatorfrcrange='-4 0'")), (vec![own], Vec::new()));
}

#[test]
fn ranges_without_width_are_refused_where_the_file_insists_on_them() {
    let found = error(&of_mjcf("range='2 1' limited='true'"));
    assert!(found.contains("<joint> range = \"2 1\": its first number should be below"), "{found}");
    let found = error(&of_mjcf("actuatorfrcrange='1 1' actuatorfrclimited='true'"));
    assert!(found.contains("actuatorfrcrange = \"1 1\""), "{found}");
}
