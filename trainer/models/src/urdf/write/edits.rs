//! Edits of a text of XML.

use roxmltree::{Document, Node};
use std::collections::HashMap;
use std::ops::Range;

/// Edits of a document, at places that do not overlap.
pub(super) struct Edits<'a, 'i> {
    document: &'a Document<'i>,
    starts: HashMap<usize, Node<'a, 'i>>,
    edits: Vec<(Range<usize>, String)>,
}

impl<'a, 'i> Edits<'a, 'i> {
    pub fn new(document: &'a Document<'i>) -> Self {
        let elements = document.descendants().filter(Node::is_element);
        Self {
            document,
            starts: elements.map(|node| (node.range().start, node)).collect(),
            edits: Vec::new(),
        }
    }

    /// Element at a place; `None` if the place is empty.
    pub fn element(&self, at: &Range<usize>) -> Option<Node<'a, 'i>> {
        self.starts.get(&at.start).copied().filter(|_| !at.is_empty())
    }

    /// Replaces the first child of this name, or adds it.
    pub fn put_child(&mut self, node: Node, name: &str, text: String) {
        match node.children().find(|child| child.has_tag_name(name)) {
            Some(child) => self.edits.push((child.range(), text)),
            None => self.add(node, text),
        }
    }

    /// Removes all children of this name.
    pub fn remove_children(&mut self, node: Node, name: &str) {
        let children = node.children().filter(|child| child.has_tag_name(name));
        self.edits.extend(children.map(|child| (child.range(), String::new())));
    }

    /// Replaces the first comment that begins with these words, or adds it.
    pub fn put_comment(&mut self, node: Node, head: &str, rest: &str) {
        let is_one = |child: &Node| {
            child.is_comment() && child.text().is_some_and(|text| text.trim().starts_with(head))
        };
        let text = format!("<!-- {head}{rest} -->");
        match node.children().find(is_one) {
            Some(comment) => self.edits.push((comment.range(), text)),
            None => self.add(node, text),
        }
    }

    /// Adds text as the first child of an element.
    pub fn add(&mut self, node: Node, text: String) {
        let range = node.range();
        let own = &self.document.input_text()[range.clone()];
        let (at, text) = match (node.first_child(), own.strip_suffix("/>")) {
            (Some(child), _) => (child.range().start..child.range().start, text),
            (None, Some(_)) => (range.end - 2..range.end, format!(">{text}</{}>", node.tag_name().name())),
            (None, None) => {
                let at = range.start + own.rfind("</").unwrap_or(own.len());
                (at..at, text)
            }
        };
        self.edits.push((at, text));
    }

    /// Adds text as the last child of an element that has others.
    pub fn append(&mut self, node: Node, text: String) {
        let own = &self.document.input_text()[node.range()];
        let at = node.range().start + own.rfind("</").unwrap_or(own.len());
        self.edits.push((at..at, text));
    }

    /// Sets attributes of an element.
    pub fn set(&mut self, node: Node, values: &[(&str, f64)]) {
        let after_name = node.range().start + 1 + node.tag_name().name().len();
        for (name, value) in values {
            match node.attribute_node(*name) {
                Some(attribute) => self.edits.push((attribute.range_value(), format!("{value:?}"))),
                None => self.edits.push((after_name..after_name, format!(" {name}=\"{value:?}\""))),
            }
        }
    }

    /// Returns the edited text.
    pub fn text(mut self) -> String {
        let mut text = self.document.input_text().to_owned();
        self.edits.sort_by_key(|(range, _)| (range.start, range.end));
        self.edits.iter().rev().for_each(|(range, new)| text.replace_range(range.clone(), new));
        text
    }
}
