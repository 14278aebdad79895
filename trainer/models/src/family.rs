//! What a family has of its own: energies, and the numbers that they are made of.

use crate::bounds::Range;
use crate::names::NumberName;
use crate::source::{ConstantType, LoadedType};
use crate::tree::LogCholesky;
use leastaction_core::model::{Laws, ModelError};
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::Energies;

/// The energies of a model, with the forces that the family has of its own.
///
/// Numbers of the family are the front of a weight block; those of the laws of force beside it follow.
pub trait Family {
    /// Number of coordinates n.
    fn n(&self) -> usize;

    /// One letter a coordinate: `t` translation, `a` angle, `c` cyclic.
    fn coordinates(&self) -> String;

    /// The unit of every coordinate, as a model file has them, separated by commas.
    fn units(&self) -> String {
        let unit = |letter| match letter {
            't' => "m",
            'a' => "rad",
            _ => "",
        };
        self.coordinates().chars().map(unit).collect::<Vec<_>>().join(",")
    }

    /// Says, in the words of a configuration, that data has another number of coordinates.
    fn mismatch(&self, data: usize) -> String;

    /// Energies and forces as a program, for the tree or graph that is meant.
    ///
    /// # Errors
    /// [`ModelError`] where the shape does not fit in itself.
    fn energies(&self) -> Result<Box<dyn Energies>, ModelError>;

    /// Random weights where they are learned, the given numbers elsewhere.
    fn initial_weights(&self, seed: u64) -> Vec<f64>;

    /// The laws of force of its own, whose numbers end its part of the weight block.
    fn laws(&self) -> Laws<'static> {
        Laws::NONE
    }

    /// Groups of coordinates that laws have numbers of their own for, as in a model file; none where there can be no laws.
    fn groups(&self) -> usize {
        self.n()
    }

    /// The group of every coordinate of the tree that is meant; none where there can be no laws.
    fn group_of_coordinates(&self) -> Vec<usize> {
        (0..self.n()).collect()
    }

    /// Name of a group.
    fn group_name(&self, group: usize) -> String {
        format!("coordinate {group}")
    }

    /// Positions of the numbers that training must leave as they are.
    fn fixed_positions(&self) -> Vec<usize> {
        Vec::new()
    }

    /// Ranges of numbers that are learned as free numbers, by their positions.
    fn ranges(&self) -> Vec<(usize, Range)> {
        Vec::new()
    }

    /// Positions of the ten inertial numbers of every learned body in space, with the numbers that keep it a body that can be.
    fn learned_bodies(&self) -> Vec<(usize, LogCholesky)> {
        Vec::new()
    }

    /// Brings numbers that have a range but are learned as they are (masses, damping) back into it.
    fn project(&self, _weights: &mut [f64]) {}

    /// Names of the numbers, from the front, as far as they have names.
    fn number_names(&self) -> Vec<Option<NumberName>> {
        Vec::new()
    }

    /// Units of the hidden layers of every network of the energies.
    fn networks(&self) -> Vec<Vec<usize>> {
        Vec::new()
    }

    /// Parts of a model of several mechanisms: what they are called (tree, graph), their names, and the one that is meant.
    fn parts(&self) -> Option<Parts<'_>> {
        None
    }

    /// Takes the tree or graph of that name for the one that is meant; `false` where there is none, and nothing changes.
    fn mean_part(&mut self, _name: &str) -> bool {
        false
    }

    /// Rods of the graph that is meant.
    ///
    /// # Errors
    /// Where there is no such graph.
    fn rods(&self) -> Result<Rods, ModelError> {
        Ok(Rods::default())
    }

    /// Whether the scale of L is known without a force: some mass or law is known that moves.
    fn shows_scale(&self) -> bool {
        false
    }

    /// How a Rust program names a loaded model.
    fn loaded_type(&self) -> LoadedType;

    /// How a Rust program makes the energies of constants.
    ///
    /// # Errors
    /// In words what can only be read from a file.
    fn constant_type(&self) -> Result<ConstantType, &'static str>;

    /// Why free motion cannot be learned from, where it leaves a common factor of all masses open.
    fn open_gauge(&self) -> Option<OpenGauge> {
        None
    }
}

/// Why free motion does not determine what a model learns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpenGauge {
    /// Every mass is learned.
    Masses {
        /// The key of the types in a configuration.
        types: &'static str,
        /// Mechanism that is made of them: tree or graph.
        of: &'static str,
    },
    /// Only torques show it.
    Torques,
}

/// Trees or graphs of a family.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parts<'a> {
    /// What one is called: tree or graph.
    pub what: &'static str,
    /// Names of all.
    pub names: Vec<&'a str>,
    /// Name of the one that is meant.
    pub meant: &'a str,
}
