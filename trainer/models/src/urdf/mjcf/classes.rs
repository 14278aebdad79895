//! Classes of defaults.

use super::values::{self, wrong};
use crate::urdf::error::UrdfError;
use roxmltree::Node;
use std::collections::HashMap;
use std::rc::Rc;

/// Attributes that a class gives to elements, by the name of the element and that of the attribute.
type Given<'a> = HashMap<(&'a str, &'a str), &'a str>;

/// Name of the class that holds for elements without one.
const MAIN: &str = "main";

/// All classes, each with what it inherits.
pub(super) struct Classes<'a>(HashMap<&'a str, Rc<Given<'a>>>);

impl<'a> Classes<'a> {
    pub fn read<'i>(root: Node<'a, 'i>) -> Result<Self, UrdfError> {
        let is_class = |node: &Node| node.has_tag_name("default");
        let mut classes: HashMap<&str, Rc<Given>> = HashMap::new();
        let mut open: Vec<(Node<'a, 'i>, Rc<Given<'a>>)> = Vec::new();
        for top in root.children().filter(is_class) {
            open.push((top, classes.get(MAIN).cloned().unwrap_or_default()));
            while let Some((node, inherited)) = open.pop() {
                let name = match node.attribute("class") {
                    Some(name) => name,
                    None if node == top => MAIN,
                    None => return Err(wrong(node, "inside another one needs a class")),
                };
                let mut given = (*inherited).clone();
                node.children().filter(|node| node.is_element() && !is_class(node)).for_each(|element| {
                    let tag = element.tag_name().name();
                    given.extend(element.attributes().map(|a| ((tag, a.name()), a.value())));
                });
                let given = Rc::new(given);
                open.extend(node.children().filter(is_class).map(|node| (node, given.clone())));
                classes.insert(if node == top { MAIN } else { name }, given.clone());
                classes.insert(name, given);
            }
        }
        Ok(Self(classes))
    }

    /// Attribute of an element, or else that of its class; `around` is the class of the body around it.
    pub fn attribute<'t>(
        &'t self,
        node: Node<'t, '_>,
        around: Option<&str>,
        what: &str,
    ) -> Result<Option<&'t str>, UrdfError> {
        if let Some(value) = node.attribute(what) {
            return Ok(Some(value));
        }
        let class = node.attribute("class").or(around);
        let Some(given) = self.0.get(class.unwrap_or(MAIN)) else {
            return match class {
                Some(class) if class != MAIN => {
                    Err(wrong(node, format!("has the class {class:?}, which no <default> describes")))
                }
                _ => Ok(None),
            };
        };
        Ok(given.get(&(node.tag_name().name(), what)).copied())
    }

    /// N numbers of an attribute, if it is given.
    pub fn numbers<const N: usize>(
        &self,
        node: Node,
        around: Option<&str>,
        what: &str,
    ) -> Result<Option<[f64; N]>, UrdfError> {
        let text = self.attribute(node, around, what)?;
        text.map(|text| values::exactly(node, (what, text))).transpose()
    }

    /// One number of an attribute, if it is given.
    pub fn number(&self, node: Node, around: Option<&str>, what: &str) -> Result<Option<f64>, UrdfError> {
        Ok(self.numbers(node, around, what)?.map(|[x]| x))
    }
}
