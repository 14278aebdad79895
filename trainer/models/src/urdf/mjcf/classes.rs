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
    pub fn read(root: Node<'a, '_>) -> Result<Self, UrdfError> {
        let mut classes = Self(HashMap::new());
        root.children().filter(is_class).try_for_each(|top| classes.add(top))?;
        Ok(classes)
    }

    /// Adds a class that is inside no other, and all classes inside it.
    fn add(&mut self, top: Node<'a, '_>) -> Result<(), UrdfError> {
        let mut open = vec![(top, self.0.get(MAIN).cloned().unwrap_or_default())];
        while let Some((node, inherited)) = open.pop() {
            let given = Rc::new(with_own(node, &inherited));
            open.extend(node.children().filter(is_class).map(|node| (node, given.clone())));
            let name = node.attribute("class");
            if name.is_none() && node != top {
                return Err(wrong(node, "inside another one needs a class"));
            }
            let main = (node == top).then_some(MAIN);
            self.0.extend(name.into_iter().chain(main).map(|name| (name, given.clone())));
        }
        Ok(())
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

fn is_class(node: &Node) -> bool {
    node.has_tag_name("default")
}

/// Attributes that a class gives: those that it inherits, and its own in their place.
fn with_own<'a>(class: Node<'a, '_>, inherited: &Given<'a>) -> Given<'a> {
    let mut given = inherited.clone();
    for element in class.children().filter(|node| node.is_element() && !is_class(node)) {
        let tag = element.tag_name().name();
        given.extend(element.attributes().map(|a| ((tag, a.name()), a.value())));
    }
    given
}
