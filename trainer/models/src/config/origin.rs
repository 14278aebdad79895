//! A trained model of another shape, at whose energies the training of a new one begins.

use super::place::ShapeError;
use super::problem::Problem;
use crate::architecture::Architecture;
use crate::laws::friction::{CoordinateFriction, FrictionArchitecture};
use crate::laws::servo::Servo;
use crate::model::Model;
use crate::number::Number;
use leastaction_core::model::FrictionNumber;
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
        let start = own.corrections_start();
        match self.0.weights.get(start..start + own.corrections.count()) {
            Some(weights) if own.corrections == architecture.corrections => weights.to_vec(),
            _ => architecture.corrections.without_effect(),
        }
    }

    /// Viscous damping b of every coordinate.
    pub fn damping(&self) -> Vec<f64> {
        let own = self.friction();
        (0..self.0.n()).map(|i| own.get(i).map_or(0.0, |friction| friction.viscous)).collect()
    }

    /// Friction of the coordinates as a starting point for learning. Numbers that are 0, and the smoothing loads τ_s,
    /// stay known.
    pub fn friction_to_learn(&self) -> FrictionArchitecture {
        let friction = self.friction();
        let number = |value: f64| Number::new(value, value > 0.0);
        let viscous = friction.iter().map(|own| number(own.viscous)).collect::<Vec<_>>();
        let of_dry = |own: &CoordinateFriction| {
            let dry = own.dry?;
            let width = Number::new(dry.width, dry.constant > 0.0);
            Some([number(dry.constant), number(dry.load), Number::known(dry.smoothing), width])
        };
        let is_viscous = viscous.iter().any(|number| number.learned);
        FrictionArchitecture::new(
            if is_viscous { viscous } else { Vec::new() },
            friction.iter().map_while(of_dry).collect(),
        )
    }

    /// Sets the learned numbers of friction and servos to those of this model, if it has any.
    pub fn set_laws(&self, friction: &mut FrictionArchitecture, servo: &mut Servo) {
        self.set_friction(friction);
        let stiffness = self.0.architecture.stiffness_of_coordinates(&self.0.weights);
        servo.stiffness.iter_mut().zip(stiffness).for_each(|(number, own)| begin_at(number, own));
    }

    fn set_friction(&self, friction: &mut FrictionArchitecture) {
        let own = self.friction();
        friction.viscous.iter_mut().zip(&own).for_each(|(number, own)| begin_at(number, own.viscous));
        for (numbers, own) in friction.dry.iter_mut().zip(&own) {
            let Some(dry) = own.dry else { continue };
            for (number, kind) in numbers.iter_mut().zip(FrictionNumber::ALL) {
                let value = match kind {
                    FrictionNumber::Constant => dry.constant,
                    FrictionNumber::Load => dry.load,
                    FrictionNumber::Smoothing => dry.smoothing,
                    FrictionNumber::Width => dry.width,
                };
                begin_at(number, value);
            }
        }
    }
}

/// Lets a number that is learned, or was not given, begin at that of an earlier model, if that is above 0.
fn begin_at(number: &mut Number, value: f64) {
    if (number.learned || number.part.is_some()) && value > 0.0 {
        number.give(value);
    }
}
