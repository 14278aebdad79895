//! A trained model of another shape, at whose energies the training of a new one begins.

use super::place::ShapeError;
use super::problem::Problem;
use crate::architecture::Architecture;
use crate::laws::{CoordinateFriction, GroupLaws, NumberKind};
use crate::model::Model;
use crate::number::Number;
use leastaction_core::model::Law;
use std::path::{Path, PathBuf};

/// Opens a trained model named by a configuration, or says why it cannot be read.
pub type Open<'o> = &'o dyn Fn(&Path) -> Result<Model, String>;

/// A trained model, with its actuator.
pub struct Origin(pub Model);

impl Origin {
    /// Opens a model whose coordinates are of the kinds given by these letters.
    ///
    /// # Errors
    /// [`Problem`] if it cannot be read or has other coordinates.
    pub fn read(path: &Path, coordinates: &str, open: Open) -> Result<Self, Problem> {
        let own = open(path).map_err(|message| Problem::From { message })?;
        let is_angle = |letter: char| letter != 't';
        let found = own.architecture.coordinates();
        if found.chars().map(is_angle).eq(coordinates.chars().map(is_angle)) && own.architecture.has_steps() {
            return Ok(Self(own));
        }
        let needed = coordinates.to_owned();
        Err(Problem::OtherCoordinates { file: path.to_owned(), found, needed })
    }

    /// Opens the model named by the key `start_from`, if there is one; its coordinates must be of the kinds given by these letters.
    ///
    /// # Errors
    /// [`ShapeError`] at that key, see [`Origin::read`].
    pub fn start_from(
        path: Option<&PathBuf>,
        coordinates: &str,
        open: Open,
    ) -> Result<Option<Self>, ShapeError> {
        let read = |path: &PathBuf| Self::read(path, coordinates, open);
        path.map(read).transpose().map_err(|problem| problem.at(["start_from".into()]))
    }

    fn friction(&self) -> Vec<CoordinateFriction> {
        self.0.architecture.friction_of_coordinates(&self.0.weights)
    }

    /// Weights of the correcting networks of a shape: those of this model if its networks are the same, else numbers without an effect.
    pub fn corrections(&self, architecture: &Architecture) -> Vec<f64> {
        let own = &self.0.architecture;
        match self.0.weights.get(own.corrections_place()) {
            Some(weights) if own.corrections == architecture.corrections => weights.to_vec(),
            _ => architecture.corrections.without_effect(),
        }
    }

    /// Viscous damping b of every coordinate.
    pub fn damping(&self) -> Vec<f64> {
        let own = self.friction();
        (0..self.0.n()).map(|i| own.get(i).map_or(0.0, |friction| friction.viscous)).collect()
    }

    /// Laws of friction of the coordinates as a starting point for learning, those without an effect left out. Numbers that are 0, smoothing
    /// loads τ_s and breakaway ratios stay known.
    pub fn friction_to_learn(&self) -> GroupLaws {
        let Model { architecture, weights, .. } = &self.0;
        let (groups, mut laws) = (architecture.family.group_of_coordinates(), GroupLaws::default());
        for law in architecture.laws().iter().filter(|law| NumberKind::are_of_friction(*law)) {
            let numbers: Vec<_> = architecture.law_numbers(law, weights).chunks(law.ranges().len()).collect();
            let own = groups.iter().filter_map(|group| numbers.get(*group)).map(|own| to_learn(law, own));
            laws.set(law, own.collect::<Vec<_>>().concat());
        }
        laws
    }

    /// Lets the learned numbers of friction and servos, of every coordinate, begin at those of this model, as far as it has them.
    pub fn set_laws(&self, laws: &mut GroupLaws) {
        let stiffness = self.0.architecture.stiffness_of_coordinates(&self.0.weights);
        let friction = self.friction();
        laws.change(|group, kind, number| {
            let value = match kind {
                NumberKind::Stiffness => stiffness.get(group).copied(),
                _ => friction.get(group).and_then(|own| own.number(kind)),
            };
            value.into_iter().for_each(|value| begin_at(number, value));
        });
    }
}

/// The numbers of a law for a group, learned as far as they have an effect; none if the whole has none.
fn to_learn(law: Law, numbers: &[f64]) -> Vec<Number> {
    let kinds = NumberKind::of(law);
    let acts = kinds.iter().zip(numbers).any(|(kind, value)| *kind == NumberKind::Friction && *value > 0.0);
    let number = |(kind, value): (&NumberKind, &f64)| {
        let is_learned = match kind {
            NumberKind::Smoothing | NumberKind::Breakaway => false,
            NumberKind::Width => acts,
            _ => *value != 0.0,
        };
        Number::new(*value, is_learned)
    };
    kinds.iter().zip(numbers).map(number).collect()
}

/// Lets a number that is learned, or was not given, begin at that of an earlier model, unless that is 0.
fn begin_at(number: &mut Number, value: f64) {
    if (number.learned || number.part.is_some()) && value != 0.0 {
        number.give(value);
    }
}
