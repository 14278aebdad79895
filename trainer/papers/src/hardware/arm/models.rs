//! Models in the table of an arm.

use super::ArmData;
use super::network::{from_bodies, from_nothing};
use super::panda::panda;
use crate::task::TaskError;
use leastaction_learning::torque::Samples;
use leastaction_learning::torque::fit::{
    Bodies, Fitted, Learned as Numbers, SOFTNESS, fit, fit_by_folds, variances,
};
use leastaction_learning::torque::linear::{Design, Terms};
use leastaction_models::tree::Tree;

/// A row of the table.
#[derive(Clone, Copy)]
pub struct Identification {
    /// Name in the table and, in small letters, in the names of tasks.
    pub name: &'static str,
    /// Whether it is the default model of a fit.
    pub is_default: bool,
    /// Whether it is our model.
    pub is_ours: bool,
    /// Rough learning time, s.
    pub expected_seconds: f64,
    /// Learns from the training samples.
    pub learn: fn(&ArmData) -> Result<Learned, TaskError>,
}

/// Torques of all samples, row by row.
pub type Predict = dyn Fn(&Samples) -> Vec<f64>;

/// A learned model.
pub struct Learned {
    /// Torques of all samples, row by row.
    pub predict: Box<Predict>,
    /// Number of learned parameters.
    pub parameters: usize,
    /// Number of these parameters that the samples alone determine; `None` for networks.
    pub rank: Option<usize>,
    /// Consistency of the bodies, if the model identifies bodies.
    pub consistency: Option<f64>,
}

/// Width ε in rows in which it is not learned, rad/s.
const WIDTH: f64 = 0.05;
/// Rigid bodies and nothing else.
const RIGID: Terms = Terms { rotors: false, viscous: false, coulomb: None, offsets: false };
const VISCOUS: Terms = Terms { viscous: true, ..RIGID };
const COULOMB: Terms = Terms { rotors: true, viscous: true, coulomb: Some(WIDTH), offsets: true };
/// Learned numbers for friction of constant size.
pub(super) const WITHOUT_LOAD: Numbers = Numbers {
    bodies: Bodies::Consistent,
    known: Vec::new(),
    rotors: true,
    viscous: true,
    coulomb: true,
    load: false,
    asymmetries: [false; 2],
    offsets: true,
    width: [0.02, 1.0],
    smoothing: [SOFTNESS; 2],
    held: Vec::new(),
};
/// Mass of the whole arm (kg), from its data sheet. The guess made from it is the prior if no inertia is known.
const MASS: f64 = 18.0;
/// Radius of the arm's links about their lines, m.
const RADIUS: f64 = 0.1;
/// Strength λ of a prior that only keeps the equations solvable.
const WEAKEST: f64 = 1e-6;
/// Strengths of the prior to be tried.
const STRENGTHS: [f64; 9] = [1000.0, 300.0, 100.0, 30.0, 10.0, 3.0, 1.0, 0.1, 0.01];

const LINEAR: Identification = Identification {
    name: "least squares, rigid bodies alone",
    is_default: false,
    is_ours: false,
    expected_seconds: 1.0,
    learn: |data| linear(data, RIGID),
};

/// Rows of the table, in order.
pub const MODELS: [Identification; 8] = [
    LINEAR,
    Identification { name: "least squares, viscous", learn: |data| linear(data, VISCOUS), ..LINEAR },
    Identification {
        name: "least squares, viscous + Coulomb",
        learn: |data| linear(data, COULOMB),
        ..LINEAR
    },
    Identification {
        name: "least squares, Coulomb that grows with the load",
        learn: |data| {
            let learned = Numbers { bodies: Bodies::Free, width: [WIDTH; 2], ..Numbers::default() };
            Ok(of_fit(fit(&guess()?, &data.train, &learned, WEAKEST)?))
        },
        ..LINEAR
    },
    Identification {
        name: "consistent bodies, Coulomb of constant size",
        is_ours: true,
        expected_seconds: 12.0,
        learn: |data| Ok(of_fit(consistent(data, &WITHOUT_LOAD)?)),
        ..LINEAR
    },
    Identification {
        name: "leastaction, consistent bodies and friction that grows with the load",
        is_default: true,
        is_ours: true,
        expected_seconds: 12.0,
        learn: |data| Ok(of_fit(consistent(data, &Numbers::default())?)),
    },
    Identification {
        name: "network of energies (DeLaN), from nothing",
        expected_seconds: 300.0,
        learn: from_nothing,
        ..LINEAR
    },
    Identification {
        name: "network of energies, from the consistent bodies",
        is_ours: true,
        expected_seconds: 300.0,
        learn: from_bodies,
        ..LINEAR
    },
];

fn guess() -> Result<Tree, TaskError> {
    Ok(panda()?.with_guessed_inertias(MASS, RADIUS))
}

fn linear(data: &ArmData, terms: Terms) -> Result<Learned, TaskError> {
    least_squares(panda()?, &data.train, terms)
}

/// Least squares with every torque divided by its standard deviation, so that the minimised quantity is the error in
/// the table.
pub fn least_squares(tree: Tree, train: &Samples, terms: Terms) -> Result<Learned, TaskError> {
    let deviations: Vec<f64> = variances(train).iter().map(|variance| variance.sqrt()).collect();
    let solution = Design::new(&tree, train, &terms).over(&deviations).solve();
    let solution = solution.ok_or("the samples have numbers that are not finite")?;
    let (parameters, rank) = (solution.numbers.len(), Some(solution.rank));
    let predict = move |samples: &Samples| Design::new(&tree, samples, &terms).predict(&solution.numbers);
    Ok(Learned { predict: Box::new(predict), parameters, rank, consistency: None })
}

/// Fits physically consistent bodies; cross-validation over parts of the samples chooses the strength of the prior.
pub(super) fn consistent(data: &ArmData, learned: &Numbers) -> Result<Fitted, TaskError> {
    Ok(fit_by_folds(&guess()?, &data.train, learned, (&STRENGTHS, &data.folds()))?.0)
}

fn of_fit(fitted: Fitted) -> Learned {
    let consistency = fitted.arm.tree.bodies().iter().map(|body| body.inertia.consistency());
    // The consistency is NaN if a diagonal entry is not positive.
    let least = consistency.fold(f64::INFINITY, |least, x| if x < least || x.is_nan() { x } else { least });
    let (parameters, rank, arm) = (fitted.parameters, Some(fitted.rank), fitted.arm);
    let predict = move |samples: &Samples| arm.torques(samples);
    Learned { predict: Box::new(predict), parameters, rank, consistency: Some(least) }
}
