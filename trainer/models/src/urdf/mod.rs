//! Construction of a tree from a robot description: URDF, or a model of MuJoCo (MJCF). The outermost element, `<robot>`
//! or `<mujoco>`, says which; `mjcf` makes links and joints of the latter, and everything else is common to both.
//!
//! The root link is fixed to the base, and its frame is that of the base. Links on joints that are fixed, or held still
//! by a [choice](Options), are merged with the body that carries them; what is fixed to the base vanishes. Joints that
//! follow another one (`<mimic>`) move with the coordinate of that joint, or are held still. Coordinates are in the
//! order in which a breadth-first walk from the base meets their joints, with the children of a link in the order of
//! the file, whichever of them are held still; those of an MJCF file are in the order of a depth-first walk, as in MuJoCo.
//! Meshes, colours, transmissions and everything else are ignored. A
//! document type is refused, which excludes entities that expand; nothing here is recursive, however deep the file is
//! nested.
//!
//! Only moving bodies are judged. A body needs a positive mass, unless one that it carries has mass. If its principal second moments Σ = ½ tr(I) 1 − I about
//! the centre of mass are negative by more than one thousandth of the inertia, no body can have them: Σ becomes the
//! nearest matrix that is positive definite, with a [note](DescriptionNote) that gives numbers, and which is loud beyond
//! a change of [`GROSS`] of the inertia.

mod bodies;
mod connections;
mod error;
mod faults;
mod mjcf;
mod note;
mod parts;
mod roles;
mod write;
mod xacro;
mod zero_limits;

pub(crate) use bodies::{moved, with_extent};
pub use error::{MOST_BYTES, MOST_LINKS, UrdfError};
pub use note::{DescriptionNote, GROSS, Moved};
pub use roles::Followers;
pub use write::{Format, Identified, JointNumbers, MARK, WriteNote, Written, write_back};

use crate::tree::Tree;
use connections::Description;
use faults::Faults;
use parts::{JointElement, Link};
use roles::Roles;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;
use std::path::Path;

/// Whether bodies may have no mass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inertias {
    /// Every moving body has a mass.
    #[default]
    Required,
    /// A body without mass gets zeros, for [`Tree::with_guessed_inertias`].
    Optional,
}

/// Choice among what a description has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Whether bodies may have no mass.
    pub inertias: Inertias,
    /// Joints that are coordinates; all others are held still. `None`: all joints that are not locked.
    pub joints: Option<Vec<String>>,
    /// Joints that are held still, with their positions, rad or m. A joint that is held still for another reason is at
    /// 0, or at the nearest of its limits.
    pub lock: BTreeMap<String, f64>,
    /// Treatment of joints that follow a moving one.
    pub followers: Followers,
}

/// A tree from a description, with notes on what was changed or is not modelled.
#[derive(Clone, Debug, PartialEq)]
pub struct Described {
    /// The tree.
    pub tree: Tree,
    /// Notes for the user.
    pub notes: Vec<DescriptionNote>,
}

/// Reads a robot description from a file.
///
/// # Errors
/// [`UrdfError`].
pub fn read(path: &Path, inertias: Inertias) -> Result<Tree, UrdfError> {
    read_with(path, &Options { inertias, ..Options::default() }).map(|described| described.tree)
}

/// Reads a robot description from a file, with a choice of its joints.
///
/// # Errors
/// [`UrdfError`].
pub fn read_with(path: &Path, options: &Options) -> Result<Described, UrdfError> {
    parse_with(&text_of(path)?, options)
}

/// Text of a description, with the files that it includes.
fn text_of(path: &Path) -> Result<String, UrdfError> {
    let failed = |error| UrdfError::Io { path: path.to_owned(), error };
    let bytes = std::fs::metadata(path).map_err(failed)?.len();
    if bytes > MOST_BYTES as u64 {
        return Err(UrdfError::Bytes(usize::try_from(bytes).unwrap_or(usize::MAX)));
    }
    let text = std::fs::read_to_string(path).map_err(failed)?;
    if !text.contains("<include") {
        return Ok(text);
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    Ok(mjcf::with_included(&text, folder)?.unwrap_or(text))
}

/// Reads a robot description from its text.
///
/// # Errors
/// [`UrdfError`].
pub fn parse(text: &str, inertias: Inertias) -> Result<Tree, UrdfError> {
    parse_with(text, &Options { inertias, ..Options::default() }).map(|described| described.tree)
}

/// Reads a robot description from its text, with a choice of its joints.
///
/// # Errors
/// [`UrdfError`].
pub fn parse_with(text: &str, options: &Options) -> Result<Described, UrdfError> {
    let document = document(text)?;
    let root = document.root_element();
    let mut described = description(root)?.tree(options)?;
    described.notes.extend(zero_limits::note(root));
    Ok(described)
}

/// Parses the text of a description.
fn document(text: &str) -> Result<Document<'_>, UrdfError> {
    if text.len() > MOST_BYTES {
        return Err(UrdfError::Bytes(text.len()));
    }
    Document::parse(text).map_err(xacro::not_xml)
}

/// Reads links and joints, of either kind of file.
fn description(root: Node) -> Result<Description, UrdfError> {
    match root.tag_name().name() {
        "robot" => robot(root),
        "mujoco" => mjcf::description(root),
        other => Err(UrdfError::NotRobot(other.to_owned())),
    }
}

/// Reads the links and joints of a URDF file.
fn robot(robot: Node) -> Result<Description, UrdfError> {
    xacro::refuse(robot.document())?;
    let of = |name: &'static str| robot.children().filter(move |node| node.has_tag_name(name));
    let links = of("link").count();
    if links > MOST_LINKS {
        return Err(UrdfError::Links(links));
    }
    let mut faults = Faults::default();
    let links = of("link").filter_map(|node| faults.take(Link::read(node))).collect();
    let joints = of("joint").filter_map(|node| faults.take(JointElement::read(node))).collect();
    faults.end()?;
    Description::new(links, joints)
}
