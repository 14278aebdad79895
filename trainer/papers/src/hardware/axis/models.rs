//! Models in the table of an axis.

use super::identify::Numbers;
use super::motion::Axis;
use super::ours;
use super::stretch::Stretch;
use crate::task::{TaskError, Tell};

/// A row of the table.
#[derive(Clone, Copy)]
pub struct Model {
    /// Name in the table and, in small letters, in the names of tasks.
    pub name: &'static str,
    /// Whether it is the model that `leastaction train` learns with the configuration that `leastaction look` writes.
    pub is_default: bool,
    /// Way to the numbers.
    pub way: Way,
}

/// Way to learn from stretches.
#[derive(Clone, Copy)]
pub enum Way {
    /// Numbers that others identified from the log.
    Known(Axis),
    /// Least squares on forces.
    Force(Numbers),
    /// Least squares on simulated positions.
    Motion(Numbers),
    /// `leastaction train` with look's configuration, or with this table of friction in it.
    Ours(Option<&'static str>),
}

/// Positions from a stretch's start on, m; a step of a model that steps is divided into this many.
pub type Predict = dyn Fn(&Stretch, usize) -> Result<Vec<f64>, TaskError>;

/// A learned model.
pub struct Learned {
    /// Predictor.
    pub predict: Box<Predict>,
    /// Number of learned parameters.
    pub parameters: usize,
    /// Identified numbers of a model that has no others.
    pub axis: Option<Axis>,
}

/// Numbers of the authors of the log, by least squares on its forces.
///
/// Source: Janot, Gautier and Brunot, "Data set and reference models of EMPS", Workshop on Nonlinear System Identification Benchmarks, 2019.
const PUBLISHED: Axis =
    Axis { mass: 95.11, viscous: [203.5; 2], coulomb: [20.39; 2], offset: 3.165, stiffness: [0.0; 3] };

const FOUR: Numbers = Numbers { by_direction: false, stiffness: false };
const BY_DIRECTION: Numbers = Numbers { by_direction: true, ..FOUR };
const BENT: Numbers = Numbers { stiffness: true, ..BY_DIRECTION };

const fn rival(name: &'static str, way: Way) -> Model {
    Model { name, is_default: false, way }
}

/// Our model with a table of friction.
const fn ours(name: &'static str, friction: &'static str) -> Model {
    rival(name, Way::Ours(Some(friction)))
}

/// Rows of the table, in order.
pub const MODELS: [Model; 10] = [
    rival("published numbers", Way::Known(PUBLISHED)),
    rival("least squares on forces", Way::Force(FOUR)),
    rival("least squares on forces, friction by direction", Way::Force(BY_DIRECTION)),
    rival("least squares on motion", Way::Motion(FOUR)),
    rival("least squares on motion, friction by direction", Way::Motion(BY_DIRECTION)),
    rival("least squares on motion, friction by direction and stiffness", Way::Motion(BENT)),
    Model { name: "leastaction, as look configures it", is_default: true, way: Way::Ours(None) },
    ours("leastaction, viscous + Coulomb", "{ viscous = \"learned\", coulomb = \"learned\" }"),
    ours(
        "leastaction, Coulomb that grows with the load",
        "{ viscous = \"learned\", coulomb = \"learned\", load = \"learned\" }",
    ),
    ours(
        "leastaction, friction by direction that sticks",
        "{ viscous = \"learned\", coulomb = \"sticking\", viscous_asymmetry = \"learned\" }",
    ),
];

impl Model {
    /// Whether it is our model.
    pub fn is_ours(&self) -> bool {
        matches!(self.way, Way::Ours(_))
    }

    /// Learns from stretches.
    pub fn learn(&self, stretches: &[&Stretch], quick: bool, tell: &Tell) -> Result<Learned, TaskError> {
        match self.way {
            Way::Known(axis) => Ok(of_axis(axis, 0)),
            Way::Force(numbers) => Ok(of_axis(numbers.by_force(stretches)?, numbers.count())),
            Way::Motion(numbers) => Ok(of_axis(numbers.by_motion(stretches)?, numbers.count())),
            Way::Ours(friction) => ours::learn(stretches, friction, quick, tell),
        }
    }
}

fn of_axis(axis: Axis, parameters: usize) -> Learned {
    let predict = move |stretch: &Stretch, _| Ok(axis.roll_out(stretch.start, stretch.forces(), stretch.h));
    Learned { predict: Box::new(predict), parameters, axis: Some(axis) }
}
