//! The interface of a family: its energies, and the numbers that they consist of.

use crate::bounds::Range;
use crate::names::NumberName;
use crate::source::{ConstantType, LoadedType};
use crate::tree::LogCholesky;
use leastaction_core::model::{Laws, ModelError};
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::Energies;

/// Energies of a model, with the forces that belong to the family.
///
/// A weight block begins with the numbers of the family; those of the additional laws of force follow.
pub trait Family {
    /// Number of coordinates n.
    fn n(&self) -> usize;

    /// Kinds of the coordinates, one letter each: `t` translation, `a` angle, `c` cyclic.
    fn coordinates(&self) -> String;

    /// Units of the coordinates, separated by commas, as in a model file.
    fn units(&self) -> String {
        let unit = |letter| match letter {
            't' => "m",
            'a' => "rad",
            _ => "",
        };
        self.coordinates().chars().map(unit).collect::<Vec<_>>().join(",")
    }

    /// Returns a message, in the terms of a configuration, that the data has another number of coordinates.
    fn mismatch(&self, data: usize) -> String;

    /// Energies and forces as a program, for the selected tree or graph.
    ///
    /// # Errors
    /// [`ModelError`] if the shape is inconsistent.
    fn energies(&self) -> Result<Box<dyn Energies>, ModelError>;

    /// Returns random values for the learned network weights and the given values for all other numbers.
    fn initial_weights(&self, seed: u64) -> Vec<f64>;

    /// The family's own laws of force, whose numbers are at the end of its part of the weight block.
    fn laws(&self) -> Laws<'static> {
        Laws::NONE
    }

    /// Number of groups of coordinates, as in a model file; the laws have separate numbers for each group. 0 if no laws
    /// are possible.
    fn groups(&self) -> usize {
        self.n()
    }

    /// Group of every coordinate of the selected tree; empty if no laws are possible.
    fn group_of_coordinates(&self) -> Vec<usize> {
        (0..self.n()).collect()
    }

    /// Name of a group.
    fn group_name(&self, group: usize) -> String {
        format!("coordinate {group}")
    }

    /// Positions of the numbers that training must leave unchanged.
    fn fixed_positions(&self) -> Vec<usize> {
        Vec::new()
    }

    /// Ranges, with positions, of the numbers that are learned through free parameters.
    fn ranges(&self) -> Vec<(usize, Range)> {
        Vec::new()
    }

    /// Positions of the ten inertial numbers of every learned body in space, with the chart that keeps it physically consistent.
    fn learned_bodies(&self) -> Vec<(usize, LogCholesky)> {
        Vec::new()
    }

    /// Positions of the numbers that grow with the mass of each body, a list per body; empty for a family without bodies.
    fn masses(&self) -> Vec<Vec<usize>> {
        Vec::new()
    }

    /// Moves numbers that have a range but are learned directly (masses, damping) back into it.
    fn project(&self, _weights: &mut [f64]) {}

    /// Names of the numbers, in the order of the weight block; `None` for a number without a name.
    fn number_names(&self) -> Vec<Option<NumberName>> {
        Vec::new()
    }

    /// Numbers of units in the hidden layers of every network of the energies.
    fn networks(&self) -> Vec<Vec<usize>> {
        Vec::new()
    }

    /// Trees or graphs of a model that holds several mechanisms; `None` for a family without them.
    fn parts(&self) -> Option<Parts<'_>> {
        None
    }

    /// Selects the tree or graph of that name; returns `false`, and changes nothing, if there is none.
    fn mean_part(&mut self, _name: &str) -> bool {
        false
    }

    /// Rods of the selected graph.
    ///
    /// # Errors
    /// An error if there is no such graph.
    fn rods(&self) -> Result<Rods, ModelError> {
        Ok(Rods::default())
    }

    /// Whether the scale of L is known without a force: some mass or law that affects the motion is known.
    fn shows_scale(&self) -> bool {
        false
    }

    /// Type of a loaded model in a Rust program.
    fn loaded_type(&self) -> LoadedType;

    /// Energies as constants of a Rust program.
    ///
    /// # Errors
    /// Name of the part that can only be read from a file.
    fn constant_type(&self) -> Result<ConstantType, &'static str>;

    /// Reason why the model cannot be learned from free motion; present if free motion leaves a common factor of all
    /// masses undetermined.
    fn open_gauge(&self) -> Option<OpenGauge> {
        None
    }
}

/// Reason why free motion does not determine what a model learns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpenGauge {
    /// All masses are learned.
    Masses {
        /// Key of the types in a configuration.
        types: &'static str,
        /// Mechanism built from them: tree or graph.
        of: &'static str,
    },
    /// The scale is determined only by torques.
    Torques,
}

/// Trees or graphs of a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parts<'a> {
    /// Word for one of them: tree or graph.
    pub what: &'static str,
    /// Names of all of them.
    pub names: Vec<&'a str>,
    /// Name of the selected one.
    pub meant: &'a str,
}
