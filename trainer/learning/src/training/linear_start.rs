//! Starting weights for rigid bodies: least squares on the torques of the logged motion.

use super::balance::{Balance, HeldScale};
use super::blocks::Blocks;
use super::{Levenberg, NormalEquations, Objective, Samples};
use crate::matrix::cholesky;
use leastaction_core::energy::bodies::{BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS};
use leastaction_core::model::ModelError;
use leastaction_models::{Architecture, BodiesArchitecture, Number};
use leastaction_programs::System;
use leastaction_programs::losses::TorqueLoss;
use nalgebra::{DMatrix, DVector};

/// Ridge of the linear fit, relative to its largest diagonal entry: it keeps numbers that the log does not determine at
/// their values.
const RIDGE: f64 = 1e-6;
/// Number of linear fits, each at the lengths that the previous round has found.
const ROUNDS: usize = 4;
/// Gauss–Newton iterations on all learned numbers after each linear fit.
const ITERATIONS: usize = 15;
/// Largest part of the balance, relative to the sum of its squared terms, that is not proportional to learned numbers if
/// nothing else acts.
const HOMOGENEOUS: f64 = 1e-9;
/// Lower bound in a linear fit: a number that must be positive keeps at least this fraction of its value. The moment of
/// inertia of a body about its centre of mass is at least this fraction of its moment of inertia about the joint.
const LEAST_PART: f64 = 0.05;

/// Weights that balance logged torques.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearStart {
    /// The weight block.
    pub weights: Vec<f64>,
    /// Whether the torques or a known number show the scale of the learned numbers.
    pub shows_scale: bool,
}

/// Weights of planar bodies or of an arm that balance logged torques: at every state M v̇ + L_vq v − L_q − Q ≈ τ. Any other family keeps
/// its initial weights. For an arm, whose scale must be known, these are Gauss–Newton iterations alone.
///
/// `states` are q, v, v̇ and τ, \[samples\]\[n\], flat. The balance is linear in m, mc, I + m|c|², J and in the
/// friction numbers b, c and c_load. These are fitted with lengths and the width of friction held fixed, and then
/// modified where necessary so that masses and inertias are positive. Gauss–Newton iterations on the same balance then
/// change all learned numbers. Both steps are repeated. Noise of v̇ makes inertias too small, so the result is a
/// starting point, not an estimate. If the torques do not show the scale of the numbers, the ratio of I to m|c|² of a
/// body of known mass or inertia stays.
///
/// # Errors
/// [`ModelError::Shape`] if a list does not have n numbers per sample; an error also if the shape is inconsistent.
pub fn linear_start(architecture: &Architecture, states: [&[f64]; 4]) -> Result<LinearStart, ModelError> {
    let initial = architecture.initial_weights(0);
    let Some(bodies) = architecture.family.bodies() else {
        let weights = match architecture.family.arm() {
            Some(_) => {
                let objective = balance(architecture, states)?;
                Levenberg::new(&objective, initial).run(&objective, ROUNDS * ITERATIONS, |_, _| {}).weights
            }
            None => initial,
        };
        return Ok(LinearStart { weights, shows_scale: true });
    };
    let objective = with_held_scale(balance(architecture, states)?, (architecture, bodies), &initial);
    let mut state = Levenberg::new(&objective, initial);
    for _ in 0..ROUNDS {
        let linear = linear_fit(architecture, bodies, &objective, &state.weights);
        let linear = linear.filter(|weights| objective.loss(weights) < state.loss);
        let start = linear.unwrap_or(state.weights);
        state = Levenberg::new(&objective, start).run(&objective, ITERATIONS, |_, _| {});
    }
    Ok(LinearStart { weights: state.weights, shows_scale: !objective.holds_scale() })
}

/// The mean squared residual of the balance, N or N m.
fn balance(architecture: &Architecture, [q, v, a, tau]: [&[f64]; 4]) -> Result<Balance, ModelError> {
    let n = architecture.n();
    for x in [q, v, a, tau] {
        if x.len() != q.len() || !x.len().is_multiple_of(n) {
            return Err(ModelError::Shape { what: "numbers of states", found: x.len(), compiled: q.len() });
        }
    }
    let system = System::new(&*architecture.energies()?);
    let samples = Samples {
        n,
        states: [q, v, a].map(<[f64]>::to_vec),
        controls: [tau.to_vec(), Vec::new(), Vec::new()],
        ..Samples::default()
    };
    let place = (architecture.parameters()?, architecture.fixed_positions());
    let bounds = architecture.bounds();
    let blocks =
        Blocks::new(move || Box::new(TorqueLoss::new(&system)), place, samples, Box::new(|_: &mut [f64]| ()));
    Ok(Balance::new(blocks.with_bounds(bounds)))
}

/// The balance with its scale held if all its terms are proportional to learned numbers.
fn with_held_scale(
    balance: Balance,
    (architecture, bodies): (&Architecture, &BodiesArchitecture),
    initial: &[f64],
) -> Balance {
    let linear = linear_numbers(architecture, bodies, initial);
    let equations = Objective::normal_equations(&balance, initial);
    let weight = equations.and_then(|equations| homogeneous_size(&equations, &linear));
    let (Some(weight), Some(body)) = (weight, Body::all(bodies, initial).iter().find_map(Body::of_scale))
    else {
        return balance;
    };
    balance.with_scale(HeldScale::new(body, initial, weight))
}

/// Σ x_i²(JᵀJ)_ii, the sum of the squared terms of the balance, if the residual is the sum of these terms alone: r = J x
/// for the values x of the linear numbers. `None` if something else acts.
fn homogeneous_size(equations: &NormalEquations, linear: &[Linear]) -> Option<f64> {
    let gradient = |of: &Linear| of.slopes.iter().map(|(at, x)| x * equations.gradient[*at]).sum::<f64>();
    let (mut terms, mut own, mut product) = (0.0, 0.0, 0.0);
    for (i, a) in linear.iter().enumerate() {
        terms += a.value * a.value * gram_of(equations, a, a);
        product += a.value * gradient(a);
        own += linear[..i].iter().map(|b| 2.0 * a.value * b.value * gram_of(equations, a, b)).sum::<f64>();
    }
    let rest = equations.squares - 2.0 * product + own + terms;
    (terms > 0.0 && rest.abs() < HOMOGENEOUS * terms).then_some(terms)
}

/// Product of the derivatives of the residuals with respect to two linear numbers.
fn gram_of(equations: &NormalEquations, a: &Linear, b: &Linear) -> f64 {
    let pairs = a.slopes.iter().flat_map(|(i, x)| b.slopes.iter().map(move |(j, y)| (*i, *j, x * y)));
    pairs.map(|(i, j, xy)| xy * equations.entry(i, j)).sum()
}

/// A number in which the balance is linear.
struct Linear {
    /// Positions of weights, with their derivatives with respect to the number.
    slopes: Vec<(usize, f64)>,
    value: f64,
    /// Typical size.
    size: f64,
}

/// A body in the weight block, and which of its numbers are learned.
struct Body {
    start: usize,
    numbers: BodyParameters<f64>,
    learned: BodyParameters<bool>,
    /// Initial J.
    usual_rotor: f64,
}

/// Positions of the numbers of a body.
const PLACES: BodyParameters<usize> =
    BodyParameters { place: [0, 1], angle: 2, mass: 3, centre: [4, 5], inertia: 6, rotor: 7, gear: 8 };

impl Body {
    fn all(bodies: &BodiesArchitecture, weights: &[f64]) -> Vec<Self> {
        let starts = (GRAVITY_PARAMETERS..).step_by(BODY_PARAMETERS);
        let each = starts.zip(&bodies.numbers);
        let of = |(start, numbers): (usize, &[Number; BODY_PARAMETERS])| {
            let own: &[f64; BODY_PARAMETERS] = weights.get(start..)?.first_chunk()?;
            let learned = BodyParameters::from_array(numbers.map(|number| number.learned));
            let usual_rotor = numbers[PLACES.rotor].value;
            Some(Self { start, numbers: BodyParameters::from_array(*own), learned, usual_rotor })
        };
        each.map_while(of).collect()
    }

    /// Positions of m, c and I, if m or I is known and the other numbers are learned.
    fn of_scale(&self) -> Option<[usize; 4]> {
        let BodyParameters { mass, centre, inertia, .. } = self.learned;
        let shows = mass != inertia && (centre[0] || centre[1]);
        let places = [PLACES.mass, PLACES.centre[0], PLACES.centre[1], PLACES.inertia];
        shows.then(|| places.map(|place| self.start + place))
    }

    /// Moment of inertia about the joint, I + m|c|².
    fn about_joint(&self) -> f64 {
        let BodyParameters { mass, centre: [x, y], inertia, .. } = self.numbers;
        inertia + mass * (x * x + y * y)
    }

    /// The numbers in which the balance is linear: m (with mc and I + m|c|² fixed if c and I are learned), mc, I +
    /// m|c|², J.
    fn linear(&self) -> Vec<Linear> {
        let (Self { start, numbers, learned, usual_rotor }, mut all) = (self, Vec::new());
        let (at, about_joint) = (|place: usize| start + place, self.about_joint());
        let with_inertia = |slope: f64| learned.inertia.then_some((at(PLACES.inertia), slope));
        if learned.mass {
            let mut slopes = vec![(at(PLACES.mass), 1.0)];
            let mut inertia = 0.0;
            for k in 0..2 {
                let c = numbers.centre[k];
                if learned.centre[k] {
                    slopes.push((at(PLACES.centre[k]), -c / numbers.mass));
                }
                inertia += if learned.centre[k] { c * c } else { -c * c };
            }
            slopes.extend(with_inertia(inertia));
            all.push(Linear { slopes, value: numbers.mass, size: numbers.mass });
        }
        for k in (0..2).filter(|k| learned.centre[*k]) {
            let own = (at(PLACES.centre[k]), 1.0 / numbers.mass);
            let slopes = [Some(own), with_inertia(-2.0 * numbers.centre[k])].into_iter().flatten().collect();
            let value = numbers.mass * numbers.centre[k];
            all.push(Linear { slopes, value, size: (numbers.mass * about_joint).sqrt() });
        }
        if learned.inertia {
            all.push(Linear {
                slopes: vec![(at(PLACES.inertia), 1.0)],
                value: about_joint,
                size: about_joint,
            });
        }
        if learned.rotor {
            let slopes = vec![(at(PLACES.rotor), 1.0)];
            all.push(Linear { slopes, value: numbers.rotor, size: *usual_rotor });
        }
        all
    }

    /// The body after `linear` numbers, in the order of [`Body::linear`], have changed by `steps`, with masses and inertias kept positive.
    fn moved(&self, steps: &mut impl Iterator<Item = f64>) -> BodyParameters<f64> {
        let (numbers, learned) = (&self.numbers, &self.learned);
        let mut step = |is_learned: bool| if is_learned { steps.next().unwrap_or(0.0) } else { 0.0 };
        let mass = numbers.mass + step(learned.mass);
        let moments = [0, 1].map(|k| numbers.mass * numbers.centre[k] + step(learned.centre[k]));
        let about_joint = self.about_joint() + step(learned.inertia);
        let about_joint = about_joint.max(LEAST_PART * self.about_joint());
        let rotor = (numbers.rotor + step(learned.rotor)).max(LEAST_PART * numbers.rotor);
        // For given moments mc, the centre of a heavier body is closer to the joint, and its m|c|² is smaller.
        let square: f64 = (0..2).filter(|k| learned.centre[*k]).map(|k| moments[k] * moments[k]).sum();
        let least = (square / ((1.0 - LEAST_PART) * about_joint)).max(LEAST_PART * numbers.mass);
        let mass = if learned.mass { mass.max(least) } else { mass };
        let centre = [0, 1].map(|k| if learned.centre[k] { moments[k] / mass } else { numbers.centre[k] });
        let own = about_joint - mass * (centre[0] * centre[0] + centre[1] * centre[1]);
        let inertia = if learned.inertia { own.max(LEAST_PART * about_joint) } else { numbers.inertia };
        BodyParameters { mass, centre, inertia, rotor, ..*numbers }
    }
}

/// All numbers in which the balance is linear: those of the bodies, then those of friction and servos.
fn linear_numbers(architecture: &Architecture, bodies: &BodiesArchitecture, weights: &[f64]) -> Vec<Linear> {
    let mut linear: Vec<Linear> = Body::all(bodies, weights).iter().flat_map(Body::linear).collect();
    let of = |(at, size): (usize, f64)| Linear { slopes: vec![(at, 1.0)], value: weights[at], size };
    linear.extend(of_laws(architecture).into_iter().map(of));
    linear
}

/// Positions and initial values of the learned b, c and c_load of friction and k of servos, in which the balance is linear.
fn of_laws(architecture: &Architecture) -> Vec<(usize, f64)> {
    let linear = architecture.law_entries().filter(|entry| entry.number.learned && entry.kind.is_linear());
    linear.map(|entry| (entry.position, entry.number.value)).collect()
}

/// Weights after one Gauss–Newton step in the linear numbers, which solves the linear problem exactly; `None` if the
/// step cannot be taken.
fn linear_fit(
    architecture: &Architecture,
    bodies: &BodiesArchitecture,
    objective: &Balance,
    weights: &[f64],
) -> Option<Vec<f64>> {
    let step = solved(objective, weights, &linear_numbers(architecture, bodies, weights))?;
    let (bodies, laws) = (Body::all(bodies, weights), of_laws(architecture));
    let (mut steps, mut weights) = (step.into_iter(), weights.to_vec());
    for body in &bodies {
        let moved = body.moved(&mut steps).into_array();
        weights.get_mut(body.start..)?.first_chunk_mut::<BODY_PARAMETERS>()?.copy_from_slice(&moved);
    }
    for ((at, _), step) in laws.into_iter().zip(steps) {
        let number = weights.get_mut(at)?;
        *number = (*number + step).max(LEAST_PART * *number);
    }
    weights.iter().all(|weight| weight.is_finite()).then(|| objective.bounds().within(weights))
}

/// Least-squares steps of the linear numbers, with a ridge relative to their sizes.
fn solved(objective: &Balance, weights: &[f64], linear: &[Linear]) -> Option<Vec<f64>> {
    let equations = Objective::normal_equations(objective, weights)?;
    let product = |a: &Linear, b: &Linear| a.size * b.size * gram_of(&equations, a, b);
    let k = linear.len();
    let mut matrix = DMatrix::from_fn(k, k, |i, j| product(&linear[i], &linear[j]));
    let ridge = RIDGE * (0..k).map(|i| matrix[(i, i)]).fold(0.0, f64::max);
    (0..k).for_each(|i| matrix[(i, i)] += ridge);
    let slope = |of: &Linear| of.slopes.iter().map(|(at, x)| x * equations.gradient[*at]).sum::<f64>();
    let mut step = DVector::from_iterator(k, linear.iter().map(|of| -of.size * slope(of)));
    cholesky(matrix)?.solve_mut(&mut step);
    Some(step.iter().zip(linear).map(|(step, of)| step * of.size).collect())
}
