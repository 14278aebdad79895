use std::fmt;

/// An element of XML without text.
pub(crate) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
}

impl Element {
    pub fn new(name: &'static str) -> Self {
        Self { name, attributes: Vec::new(), children: Vec::new() }
    }

    /// The element with another attribute.
    pub fn with(mut self, attribute: &'static str, value: impl fmt::Display) -> Self {
        self.attributes.push((attribute, value.to_string()));
        self
    }

    /// The element with an attribute, if it has a value.
    pub fn with_some(self, attribute: &'static str, value: Option<impl fmt::Display>) -> Self {
        match value {
            Some(value) => self.with(attribute, value),
            None => self,
        }
    }

    /// The element with further children.
    pub fn holding(mut self, children: impl IntoIterator<Item = Self>) -> Self {
        self.children.extend(children);
        self
    }

    /// A document with this element as its root.
    pub fn document(&self) -> String {
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{self}")
    }

    fn write(&self, f: &mut fmt::Formatter, depth: usize) -> fmt::Result {
        let Self { name, attributes, children } = self;
        write!(f, "{:depth$}<{name}", "")?;
        attributes.iter().try_for_each(|(name, value)| write!(f, " {name}=\"{}\"", escaped(value)))?;
        if children.is_empty() {
            return writeln!(f, "/>");
        }
        writeln!(f, ">")?;
        children.iter().try_for_each(|child| child.write(f, depth + 2))?;
        writeln!(f, "{:depth$}</{name}>", "")
    }
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.write(f, 0)
    }
}

/// Text as the value of an attribute, or between tags; characters that XML cannot hold are left out.
pub(crate) fn escaped(text: &str) -> String {
    let allowed = text.chars().filter(|c| !c.is_control() || matches!(c, '\n' | '\t'));
    allowed.fold(String::new(), |mut to, c| {
        match c {
            '&' => to.push_str("&amp;"),
            '<' => to.push_str("&lt;"),
            '>' => to.push_str("&gt;"),
            '"' => to.push_str("&quot;"),
            '\n' => to.push_str("&#10;"),
            other => to.push(other),
        }
        to
    })
}
