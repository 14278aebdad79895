//! Bodies of an arm as its description gives them, and what is changed of them before training.

use super::config::{ArmConfig, Learning};
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::limits::MAX_TREE_COORDINATES;
use crate::tree::Tree;
use crate::urdf::{self, Described, DescriptionNote, Followers, Inertias, Moved, Options, UrdfError};
use crate::urdf::{moved, with_extent};
use nalgebra::DMatrix;

impl ArmConfig {
    /// Returns the tree of the description, with guessed bodies if a mass is given.
    pub(super) fn described(&self) -> Result<Described, ShapeError> {
        self.check_numbers()?;
        let mut described =
            urdf::read_with(&self.urdf, &self.options()).map_err(|error| self.refused(&error))?;
        if let Some(mass) = self.mass {
            described.tree = described.tree.with_guessed_inertias(mass, self.radius);
        }
        described.tree.gravity = self.gravity.map_or(described.tree.gravity, Into::into);
        let found = described.tree.coordinates();
        if found > MAX_TREE_COORDINATES {
            return Err(self.at_urdf(Problem::Size { found, most: MAX_TREE_COORDINATES.to_string() }));
        }
        Ok(described)
    }

    /// Choice that the configuration makes among what the description has.
    pub fn options(&self) -> Options {
        let inertias = if self.mass.is_some() { Inertias::Optional } else { Inertias::Required };
        let (joints, lock) = (self.joints.clone(), self.lock.clone());
        // Each joint of a model has a coordinate of its own.
        Options { inertias, joints, lock, followers: Followers::Held }
    }

    fn refused(&self, error: &UrdfError) -> ShapeError {
        let advice = if error.lacks_mass() {
            "; [model] mass = … guesses bodies for links without mass, lock = { joint = 0 } holds them still"
        } else {
            ""
        };
        let message = format!("{error}{advice}");
        Problem::Description { file: self.urdf.clone(), message }.at([error.key().unwrap_or("urdf").into()])
    }

    /// Returns the tree with an extent for every body that needs one, and notes on these: all that are learned, and
    /// known ones whose joint would otherwise move nothing that resists. Bodies without mass are not learned.
    pub(super) fn with_extents(
        &self,
        tree: &Tree,
        learned: &mut [bool],
    ) -> Result<(Tree, Vec<DescriptionNote>), ShapeError> {
        self.check_massless(tree)?;
        let resistance = self.resistance(tree);
        let (mut parameters, mut notes) = (tree.parameters(), Vec::new());
        let (numbers, _) = parameters.as_chunks_mut();
        for (k, (numbers, body)) in numbers.iter_mut().zip(tree.bodies()).enumerate() {
            let is_massless = body.inertia.mass() == 0.0;
            learned[k] &= !is_massless;
            let least = RESISTS * body.inertia.mass() * self.radius * self.radius;
            if !is_massless && (learned[k] || resistance[k] <= least) {
                let (inertia, note) = with_extent(body, self.radius);
                *numbers = inertia.0;
                notes.extend(note);
            }
        }
        Ok((tree.with_parameters(&parameters), notes))
    }

    /// Refuses bodies without mass that some force would move without bound.
    fn check_massless(&self, tree: &Tree) -> Result<(), ShapeError> {
        let mut massless = tree.bodies().iter().filter(|body| body.inertia.mass() == 0.0);
        let Some(body) = massless.next() else { return Ok(()) };
        if self.rotors == Learning::Learned || resists(&tree.mass_matrix(&turned(tree))) {
            return Ok(());
        }
        let Moved { link, joint } = moved(body);
        let message = format!(
            "link {link}, moved by joint {joint}, has no mass, and what it carries does not make up for it: some \
             acceleration needs no force; give the link an inertia, or set rotors = \"learned\", or mass = …"
        );
        Err(self.at_urdf(Problem::Description { file: self.urdf.clone(), message }))
    }

    /// Inertia that every joint moves at a position without special angles, its rotor included.
    fn resistance(&self, tree: &Tree) -> Vec<f64> {
        if self.rotors == Learning::Learned {
            return vec![f64::INFINITY; tree.coordinates()];
        }
        tree.mass_matrix(&turned(tree)).iter().enumerate().map(|(k, row)| row[k]).collect()
    }
}

/// Least inertia of a joint relative to that of its body's mass at the guessed radius.
const RESISTS: f64 = 1e-9;

/// Least eigenvalue of a mass matrix, scaled to a unit diagonal, that can be relied on.
const REGULAR: f64 = 1e-9;

/// Position without special angles.
fn turned(tree: &Tree) -> Vec<f64> {
    (0..tree.coordinates()).map(|k| 0.3 + 0.7 * k as f64).collect()
}

/// Whether every acceleration needs a force.
fn resists(mass: &[Vec<f64>]) -> bool {
    let n = mass.len();
    let scale: Vec<f64> = (0..n).map(|k| mass[k][k].sqrt()).collect();
    if !scale.iter().all(|x| *x > 0.0) {
        return false;
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| mass[i][j] / (scale[i] * scale[j]));
    scaled.symmetric_eigenvalues().min() > REGULAR
}
