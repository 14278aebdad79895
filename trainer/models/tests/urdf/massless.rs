//! Moving links without mass that carry links with mass.

use super::{BODY, error, joint, robot};
use leastaction_models::config::{ArmConfig, FamilyConfig, LearnedBodies, Learning};
use leastaction_models::tree::Tree;
use leastaction_models::urdf::{DescriptionNote, Inertias, parse};
use leastaction_models::{ArmArchitecture, Family};
use std::fs;

/// A joint of three axes, of which only the last link has mass; the second axis is `axis`.
fn shoulder(axis: &str) -> String {
    let turn = |name: &str, links, axis: &str| {
        joint(name, "revolute", links, &format!("<origin xyz='0.1 0 0.2'/><axis xyz='{axis}'/>"))
    };
    robot(&[
        "<link name='base'/><link name='a'/><link name='b'/>".to_owned(),
        format!("<link name='c'>{BODY}</link>"),
        turn("i", ["base", "a"], "0 0 1"),
        turn("j", ["a", "b"], axis),
        turn("k", ["b", "c"], "1 0 0"),
    ])
}

/// The arm of a configuration with the description `text`, and its notes.
fn arm(
    name: &str,
    text: &str,
    change: fn(&mut ArmConfig),
) -> Result<(ArmArchitecture, Vec<DescriptionNote>), String> {
    let path = std::env::temp_dir().join(format!("leastaction-{name}-{}.urdf", std::process::id()));
    fs::write(&path, text).unwrap();
    let mut config = ArmConfig::new(&path);
    change(&mut config);
    let none = |_: &std::path::Path| Err("no model".to_owned());
    let architecture = config.architecture(&none).map_err(|error| error.problem.to_string());
    let notes = config.notes(&none);
    fs::remove_file(&path).unwrap();
    Ok((architecture?.family.arm().unwrap().clone(), notes.unwrap()))
}

fn known(config: &mut ArmConfig) {
    (config.bodies, config.rotors) = (LearnedBodies::All(Learning::Known), Learning::Known);
}

fn carried(notes: &[DescriptionNote]) -> Vec<(&str, f64)> {
    let of = |note| match note {
        &DescriptionNote::Massless { ref body, carried } => Some((&*body.link, carried)),
        _ => None,
    };
    notes.iter().filter_map(of).collect()
}

fn forces(tree: &Tree) -> Vec<f64> {
    tree.inverse_dynamics(&[0.3, 0.7, -0.4], &[1.1, -0.6, 0.5], &[0.2, 0.9, -1.3])
}

#[test]
fn known_bodies_may_be_carried_by_links_without_mass() {
    let text = shoulder("0 1 0");
    let (arm, notes) = arm("known", &text, known).unwrap();
    assert_eq!(carried(&notes), [("a", 2.0), ("b", 2.0)]);
    assert!(notes[0].to_string().contains("have 2 kg"), "{}", notes[0]);
    let tree = arm.host_tree(&arm.initial_weights(0)).unwrap();
    assert_eq!(forces(&tree), forces(&parse(&text, Inertias::Required).unwrap()));
}

#[test]
fn a_mass_matrix_that_is_singular_is_refused() {
    // Two axes in line: turning one against the other moves nothing.
    let text = shoulder("0 0 1").replace("xyz='0.1 0 0.2'", "xyz='0 0 0.2'");
    let error = arm("singular", &text, known).unwrap_err();
    assert!(error.contains("link a, moved by joint i") && error.contains("rotors"), "{error}");
    let rotors = |config: &mut ArmConfig| config.bodies = LearnedBodies::All(Learning::Known);
    assert!(arm("rotors", &text, rotors).is_ok());
}

#[test]
fn links_without_mass_are_not_learned() {
    let text = shoulder("0 1 0");
    let (arm, notes) = arm("learned", &text, |_| ()).unwrap();
    let learned: Vec<bool> = arm.bodies.iter().map(|body| body.is_learned).collect();
    assert_eq!(learned, [false, false, true]);
    assert_eq!(carried(&notes), [("a", 2.0), ("b", 2.0)]);
    let tree = arm.host_tree(&arm.initial_weights(0)).unwrap();
    let mut own = parse(&text, Inertias::Required).unwrap();
    own.rotors.clone_from(&tree.rotors);
    assert_eq!(forces(&tree), forces(&own));
}

#[test]
fn the_last_link_needs_mass() {
    let text = shoulder("0 1 0").replace(BODY, "");
    let error = error(&text);
    assert!(["link a", "link b", "link c"].iter().all(|link| error.contains(link)), "{error}");
}
