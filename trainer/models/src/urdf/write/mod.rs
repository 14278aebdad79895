//! Identified numbers, written back into a description.
//!
//! The text of the description is edited where that is possible, so that meshes, colours and comments stay: a URDF file
//! becomes a URDF file and an MJCF file an MJCF file, unless a setting of its compiler would change the inertias again, or
//! a body has parts on joints that are held still. Otherwise the moving bodies alone are written anew.

mod edits;
mod fresh_mjcf;
mod fresh_urdf;
mod mjcf;
mod note;
mod text;
mod urdf;

pub use note::WriteNote;

use super::bodies::Assembled;
use super::connections::Description;
use super::{Followers, Inertias, Options, UrdfError, description, document, text_of};
use crate::tree::{Body, Inertia, Tree};
use edits::Edits;
use roxmltree::Node;
use std::path::Path;

/// Comment at the end of every file that is written.
pub const MARK: &str = "<!-- Identified by `leastaction export`. -->";

/// Format of a description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// URDF.
    Urdf,
    /// A model of MuJoCo.
    Mjcf,
}

/// Numbers of a joint, as far as the model has them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointNumbers {
    /// Viscous damping b, N m s/rad or N s/m.
    pub damping: Option<f64>,
    /// Coulomb friction c, N m or N.
    pub friction: Option<f64>,
}

/// Numbers of a mechanism with the joints of a description.
#[derive(Clone, Debug)]
pub struct Identified {
    /// Bodies, rotors and gravity.
    pub tree: Tree,
    /// Friction of every coordinate.
    pub joints: Vec<JointNumbers>,
}

/// Text of a description, with notes.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The text.
    pub text: String,
    /// Whether it is the text that was read, with other numbers.
    pub is_edited: bool,
    /// Notes for the user.
    pub notes: Vec<WriteNote>,
}

/// The description that was read, its tree, and the numbers that are written.
struct Job {
    description: Description,
    assembled: Assembled,
    identified: Identified,
}

/// Writes identified numbers into the description in a file, read with this choice of joints.
///
/// # Errors
/// [`UrdfError`]; [`UrdfError::OtherJoints`] if the file no longer has the joints of the numbers.
pub fn write_back(
    path: &Path,
    options: &Options,
    identified: &Identified,
    format: Format,
) -> Result<Written, UrdfError> {
    let text = text_of(path)?;
    let parsed = document(&text)?;
    let root = parsed.root_element();
    let job = Job::new(root, options, identified)?;
    let obstacle = job.obstacle(root, format)?;
    let body = match (&obstacle, format) {
        (None, Format::Urdf) => job.edited_urdf(&parsed),
        (None, Format::Mjcf) => job.edited_mjcf(&parsed)?,
        (Some(_), Format::Urdf) => job.fresh_urdf(root.attribute("name")),
        (Some(_), Format::Mjcf) => job.fresh_mjcf(root.attribute("name").or(root.attribute("model"))),
    };
    let is_edited = obstacle.is_none();
    let mut notes = job.notes(format);
    notes.extend(obstacle.map(|why| WriteNote::Fresh { why }));
    let text = if body.contains(MARK) { body } else { format!("{}\n{MARK}\n", body.trim_end()) };
    Ok(Written { text, is_edited, notes })
}

impl Job {
    fn new(root: Node, options: &Options, identified: &Identified) -> Result<Self, UrdfError> {
        let all = Options { inertias: Inertias::Optional, followers: Followers::Held, ..options.clone() };
        let description = description(root)?;
        let assembled = description.assembled(&all)?;
        let job = Self { description, assembled, identified: identified.clone() };
        job.check()?;
        Ok(job)
    }

    fn described(&self) -> &Tree {
        &self.assembled.described.tree
    }

    /// Bodies of the description, each with its number and the inertia that is written.
    fn bodies(&self) -> impl Iterator<Item = (usize, &Body, Inertia)> {
        let pairs = self.described().bodies().iter().zip(self.identified.tree.bodies());
        pairs.enumerate().map(|(k, (own, identified))| (k, own, identified.inertia))
    }

    /// Numbers of a joint, and the inertia of its rotor.
    fn joint(&self, k: usize) -> (JointNumbers, f64) {
        let rotor = self.identified.tree.rotors.get(k).copied().unwrap_or(0.0);
        (self.identified.joints.get(k).copied().unwrap_or_default(), rotor)
    }

    /// Whether the inertia of a body is another one than in the description.
    fn is_changed(&self, k: usize) -> bool {
        self.described().bodies()[k].inertia != self.identified.tree.bodies()[k].inertia
    }

    fn check(&self) -> Result<(), UrdfError> {
        let [own, others] = [self.described(), &self.identified.tree].map(Tree::bodies);
        let is_same = own.len() == others.len() && own.iter().zip(others).all(|(a, b)| a.has_joint_of(b));
        if is_same { Ok(()) } else { Err(UrdfError::OtherJoints) }
    }

    /// Reason why the text cannot be edited.
    fn obstacle(&self, root: Node, format: Format) -> Result<Option<&'static str>, UrdfError> {
        let is_mjcf = root.has_tag_name("mujoco");
        Ok(match format {
            Format::Urdf if is_mjcf => Some("the description is an MJCF file"),
            Format::Mjcf if !is_mjcf => Some("the description is a URDF file"),
            Format::Urdf => None,
            Format::Mjcf if super::mjcf::changes_inertials(root)? => {
                Some("its <compiler> changes the inertias of bodies")
            }
            Format::Mjcf => self.has_held().then_some("bodies have parts on joints that are held still"),
        })
    }

    /// Whether a moving body has parts on joints that are held still, but could move.
    fn has_held(&self) -> bool {
        !self.held().is_empty()
    }

    /// Names of joints inside moving bodies that are held still, but could move.
    fn held(&self) -> Vec<String> {
        let Assembled { links, joints: moving, .. } = &self.assembled;
        let Description { links: all, joints, .. } = &self.description;
        let inside = |child: &str| links.iter().flatten().any(|link| all[*link].name == child);
        let held =
            joints.iter().enumerate().filter(|(k, joint)| joint.kind != "fixed" && !moving.contains(k));
        held.filter(|(_, joint)| inside(&joint.child)).map(|(_, joint)| joint.name.clone()).collect()
    }

    fn notes(&self, format: Format) -> Vec<WriteNote> {
        let held = self.held();
        let held = (!held.is_empty()).then_some(WriteNote::Held { joints: held });
        let has_rotors = self.identified.tree.rotors.iter().any(|rotor| *rotor != 0.0);
        let rotors = (format == Format::Urdf && has_rotors).then_some(WriteNote::Rotors);
        let usual = self.identified.tree.gravity == nalgebra::Vector3::new(0.0, 0.0, -9.81);
        let gravity = (format == Format::Urdf && !usual)
            .then(|| WriteNote::Gravity { gravity: self.identified.tree.gravity.into() });
        held.into_iter().chain(rotors).chain(gravity).collect()
    }
}
