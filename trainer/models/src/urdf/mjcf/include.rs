//! Files that a file includes.

use super::values::wrong;
use crate::urdf::error::{MOST_BYTES, UrdfError};
use crate::urdf::xacro;
use roxmltree::{Document, Node};
use std::path::Path;

/// Largest number of includes.
const MOST: usize = 256;

/// Text of a file with the elements of included files in their places; `None` if it includes none. Names are relative
/// to the folder of the main file, as MuJoCo has them.
pub(in crate::urdf) fn with_included(text: &str, folder: &Path) -> Result<Option<String>, UrdfError> {
    let mut whole: Option<String> = None;
    for _ in 0..MOST {
        let next = put_first(whole.as_deref().unwrap_or(text), folder)?;
        let Some(next) = next else { return Ok(whole) };
        if next.len() > MOST_BYTES {
            return Err(UrdfError::Bytes(next.len()));
        }
        whole = Some(next);
    }
    let message = format!("more than {MOST} files are included; does a file include itself?");
    Err(UrdfError::Mjcf { line: 1, message })
}

/// The text with the first included file in its place.
fn put_first(text: &str, folder: &Path) -> Result<Option<String>, UrdfError> {
    let document = Document::parse(text).map_err(xacro::not_xml)?;
    let root = document.root_element();
    let include = root.descendants().find(|node| node.has_tag_name("include"));
    let Some(include) = include.filter(|_| root.has_tag_name("mujoco")) else { return Ok(None) };
    let file = include.attribute("file").ok_or_else(|| wrong(include, "needs file"))?;
    let path = folder.join(file);
    let read = std::fs::read_to_string(&path).map_err(|error| UrdfError::Io { path: path.clone(), error })?;
    let inner = inside(&read).map_err(|error| wrong(include, format!("{}: {error}", path.display())))?;
    let range = include.range();
    Ok(Some(format!("{}{inner}{}", &text[..range.start], &text[range.end..])))
}

/// Text between the tags of the root element.
fn inside(text: &str) -> Result<&str, UrdfError> {
    let document = Document::parse(text).map_err(xacro::not_xml)?;
    let root = document.root_element();
    let ends =
        [root.first_child(), root.last_child()].map(|node: Option<Node>| node.map(|node| node.range()));
    Ok(match ends {
        [Some(first), Some(last)] => text.get(first.start..last.end).unwrap_or_default(),
        _ => "",
    })
}
