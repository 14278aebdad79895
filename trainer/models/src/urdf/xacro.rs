//! Recognition of a description that xacro has not expanded yet.

use super::error::UrdfError;
use roxmltree::{Document, Error, Node};

/// Refuses elements of xacro, and its expressions in links and joints; meshes and their materials are not looked at.
pub(super) fn refuse(document: &Document) -> Result<(), UrdfError> {
    let found = document.descendants().filter(Node::is_element).find_map(sign);
    found.map_or(Ok(()), |(node, what)| Err(UrdfError::Xacro { line: line(document, node), what }))
}

/// Returns the error of a text that is not XML; a prefix `xacro` without a declaration is one of xacro.
pub(super) fn not_xml(error: Error) -> UrdfError {
    match &error {
        Error::UnknownNamespace(prefix, at) if prefix == "xacro" => {
            UrdfError::Xacro { line: at.row, what: "<xacro:…>".to_owned() }
        }
        _ => UrdfError::Xml(error),
    }
}

fn line(document: &Document, node: Node) -> u32 {
    document.text_pos_at(node.range().start).row
}

/// Element or expression of xacro at a node.
fn sign<'a, 'i>(node: Node<'a, 'i>) -> Option<(Node<'a, 'i>, String)> {
    let name = node.tag_name();
    if name.namespace().is_some_and(|namespace| namespace.contains("xacro")) {
        return Some((node, format!("<xacro:{}>", name.name())));
    }
    let is_open = |value: &&str| value.contains("${") || value.contains("$(");
    let value = node.attributes().map(|attribute| attribute.value()).find(is_open)?;
    is_read(node).then(|| (node, format!("{:?}", value.chars().take(60).collect::<String>())))
}

/// Largest depth of an element below its link or joint that is read.
const DEPTH: usize = 3;

/// Whether an element belongs to what is read of a link or joint.
fn is_read(node: Node) -> bool {
    let of = |name: &str| node.ancestors().take(DEPTH).any(|node| node.has_tag_name(name));
    (of("link") || of("joint")) && !of("visual") && !of("collision")
}
