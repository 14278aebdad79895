//! Descriptions, read back.

mod common;

use common::model;
use leastaction_fmu::{ArchiveError, Description, FmuError, Unit, Version, archive};
use roxmltree::{Document, Node};
use std::collections::HashSet;

/// A cart-pole with an awkward name.
fn cartpole() -> Description {
    Description::new(&model("cartpole"), "a <b> & \"c\"", vec![true, false]).unwrap()
}

fn children<'d>(document: &'d Document, name: &str) -> Vec<Node<'d, 'd>> {
    let of = document.descendants().find(|node| node.has_tag_name(name)).unwrap();
    of.children().filter(Node::is_element).collect()
}

#[test]
fn references_and_names_are_unique_in_both_versions() {
    for version in [Version::Two, Version::Three] {
        let text = cartpole().xml(version);
        let document = Document::parse(&text).unwrap();
        let variables = children(&document, "ModelVariables");
        assert_eq!(variables.len(), 6 * 2 + 5);
        for attribute in ["name", "valueReference"] {
            let all: HashSet<_> = variables.iter().map(|node| node.attribute(attribute).unwrap()).collect();
            assert_eq!(all.len(), variables.len(), "{attribute}");
        }
        assert_eq!(document.root_element().attribute("modelName"), Some("a <b> & \"c\""));
    }
}

#[test]
fn the_structure_names_what_it_should() {
    let text = cartpole().xml(Version::Three);
    let document = Document::parse(&text).unwrap();
    let structure = children(&document, "ModelStructure");
    let count = |name| structure.iter().filter(|node| node.has_tag_name(name)).count();
    let found = ["Output", "ContinuousStateDerivative", "InitialUnknown"].map(count);
    assert_eq!(found, [3 * 2 + 3, 2 * 2, 3 * 2 + 3]);
    let of_name = |name| {
        let all = children(&document, "ModelVariables");
        all.into_iter().find(|node| node.attribute("name") == Some(name)).unwrap()
    };
    let reference = |name| of_name(name).attribute("valueReference").unwrap();
    assert_eq!(of_name("v[2]").attribute("derivative"), Some(reference("q[2]")));
    assert_eq!(of_name("a[1]").attribute("derivative"), Some(reference("v[1]")));
    assert_eq!(["u[1]", "u[2]"].map(|name| of_name(name).attribute("unit").unwrap()), ["N", "N.m"]);
    assert_eq!(of_name("h").attribute("variability"), Some("constant"));
}

#[test]
fn indices_of_version_2_lead_to_their_variables() {
    let text = cartpole().xml(Version::Two);
    let document = Document::parse(&text).unwrap();
    let variables = children(&document, "ModelVariables");
    let named = |list| {
        let of = |node: Node| node.attribute("index").unwrap().parse::<usize>().unwrap() - 1;
        let all = children(&document, list).into_iter();
        all.map(|node| variables[of(node)].attribute("name").unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(named("Derivatives"), ["v[1]", "v[2]", "a[1]", "a[2]"]);
    assert_eq!(named("Outputs").len(), 9);
    assert_eq!(named("Outputs"), named("InitialUnknowns"));
}

#[test]
fn what_is_no_unit_is_refused() {
    let refused = |bytes: &[u8]| Unit::new(bytes).err().unwrap();
    assert!(matches!(refused(&model("pendulums")), FmuError::OfGraph));
    assert!(matches!(refused(&model("cartpole")[..100]), FmuError::Model(_)));
    let wrong = Description::new(&model("cartpole"), "", vec![true]).unwrap_err();
    assert!(matches!(wrong, FmuError::Length { expected: 2, found: 1, .. }));
    let library = archive(&cartpole(), Version::Three, b"fmi3DoStep and nothing else", &[]);
    assert!(matches!(library, Err(ArchiveError::Library { missing: "fmi2DoStep" })));
}
