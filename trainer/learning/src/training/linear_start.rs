//! Starting weights for rigid bodies: least squares on the torques of the logged motion.

use super::blocks::Blocks;
use super::{Levenberg, Objective, Samples};
use crate::matrix::cholesky;
use leastaction_core::energy::bodies::{BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS};
use leastaction_core::model::{FrictionNumber, Law, ModelError};
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
/// Lower bound in a linear fit: a number that must be positive keeps at least this fraction of its value. The moment of
/// inertia of a body about its centre of mass is at least this fraction of its moment of inertia about the joint.
const LEAST_PART: f64 = 0.05;

/// Weights of a tree of bodies that balance logged torques: at every state M v̇ + L_vq v − L_q − Q ≈ τ. Any other
/// family keeps its initial weights.
///
/// `states` are q, v, v̇ and τ, \[samples\]\[n\], flat. The balance is linear in m, mc, I + m|c|², J and in the
/// friction numbers b, c and c_load. These are fitted with lengths and the width of friction held fixed, and then
/// modified where necessary so that masses and inertias are positive. Gauss–Newton iterations on the same balance then
/// change all learned numbers. Both steps are repeated. Noise of v̇ makes inertias too small, so the result is a
/// starting point, not an estimate.
///
/// # Errors
/// [`ModelError::Shape`] if a list does not have n numbers per sample; an error also if the shape is inconsistent.
pub fn linear_start(architecture: &Architecture, states: [&[f64]; 4]) -> Result<Vec<f64>, ModelError> {
    let initial = architecture.initial_weights(0);
    let Some(bodies) = architecture.family.bodies() else { return Ok(initial) };
    let objective = balance(architecture, states)?;
    let mut state = Levenberg::new(&objective, initial);
    for _ in 0..ROUNDS {
        let linear = linear_fit(architecture, bodies, &objective, &state.weights);
        let linear = linear.filter(|weights| objective.loss(weights) < state.loss);
        let start = linear.unwrap_or(state.weights);
        state = Levenberg::new(&objective, start).run(&objective, ITERATIONS, |_, _| {});
    }
    Ok(state.weights)
}

/// The mean squared residual of the balance, N or N m.
fn balance(architecture: &Architecture, [q, v, a, tau]: [&[f64]; 4]) -> Result<Blocks, ModelError> {
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
    Ok(blocks.with_bounds(bounds))
}

/// A number in which the balance is linear: the derivatives of the weights with respect to it, and its size.
struct Linear {
    /// Positions of weights, with their derivatives with respect to the number.
    slopes: Vec<(usize, f64)>,
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
            all.push(Linear { slopes, size: numbers.mass });
        }
        for k in (0..2).filter(|k| learned.centre[*k]) {
            let own = (at(PLACES.centre[k]), 1.0 / numbers.mass);
            let slopes = [Some(own), with_inertia(-2.0 * numbers.centre[k])].into_iter().flatten().collect();
            all.push(Linear { slopes, size: (numbers.mass * about_joint).sqrt() });
        }
        if learned.inertia {
            all.push(Linear { slopes: vec![(at(PLACES.inertia), 1.0)], size: about_joint });
        }
        if learned.rotor {
            all.push(Linear { slopes: vec![(at(PLACES.rotor), 1.0)], size: *usual_rotor });
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

/// Positions and initial values of the learned b, c and c_load of friction.
fn of_friction(architecture: &Architecture) -> Vec<(usize, f64)> {
    let (laws, start) = (architecture.laws(), architecture.friction_start());
    let viscous = if laws.contains(Law::Viscous) { architecture.friction.viscous.len() } else { 0 };
    let is_linear = |i: usize| {
        let dry = i.checked_sub(viscous).map(|k| k % FrictionNumber::ALL.len());
        dry.is_none_or(|k| k == FrictionNumber::Constant as usize || k == FrictionNumber::Load as usize)
    };
    let learned = architecture.friction.numbers().enumerate().filter(|(_, number)| number.learned);
    let linear = learned.filter(|(i, _)| is_linear(*i));
    linear.map(|(i, number)| (start + i, number.value)).collect()
}

/// Weights after one Gauss–Newton step in the linear numbers, which solves the linear problem exactly; `None` if the
/// step cannot be taken.
fn linear_fit(
    architecture: &Architecture,
    bodies: &BodiesArchitecture,
    objective: &Blocks,
    weights: &[f64],
) -> Option<Vec<f64>> {
    let (bodies, friction) = (Body::all(bodies, weights), of_friction(architecture));
    let mut linear: Vec<Linear> = bodies.iter().flat_map(Body::linear).collect();
    linear.extend(friction.iter().map(|(at, size)| Linear { slopes: vec![(*at, 1.0)], size: *size }));
    let step = solved(objective, weights, &linear)?;
    let (mut steps, mut weights) = (step.into_iter(), weights.to_vec());
    for body in &bodies {
        let moved = body.moved(&mut steps).into_array();
        weights.get_mut(body.start..)?.first_chunk_mut::<BODY_PARAMETERS>()?.copy_from_slice(&moved);
    }
    for ((at, _), step) in friction.into_iter().zip(steps) {
        let number = weights.get_mut(at)?;
        *number = (*number + step).max(LEAST_PART * *number);
    }
    weights.iter().all(|weight| weight.is_finite()).then(|| objective.bounds().within(weights))
}

/// Least-squares steps of the linear numbers, with a ridge relative to their sizes.
fn solved(objective: &Blocks, weights: &[f64], linear: &[Linear]) -> Option<Vec<f64>> {
    let equations = Objective::normal_equations(objective, weights)?;
    let gram = |i: usize, j: usize| equations.gram[(i.max(j), i.min(j))];
    let product = |a: &Linear, b: &Linear| -> f64 {
        let pairs = a.slopes.iter().flat_map(|(i, x)| b.slopes.iter().map(move |(j, y)| (*i, *j, x * y)));
        a.size * b.size * pairs.map(|(i, j, xy)| xy * gram(i, j)).sum::<f64>()
    };
    let k = linear.len();
    let mut matrix = DMatrix::from_fn(k, k, |i, j| product(&linear[i], &linear[j]));
    let ridge = RIDGE * (0..k).map(|i| matrix[(i, i)]).fold(0.0, f64::max);
    (0..k).for_each(|i| matrix[(i, i)] += ridge);
    let slope = |of: &Linear| of.slopes.iter().map(|(at, x)| x * equations.gradient[*at]).sum::<f64>();
    let mut step = DVector::from_iterator(k, linear.iter().map(|of| -of.size * slope(of)));
    cholesky(matrix)?.solve_mut(&mut step);
    Some(step.iter().zip(linear).map(|(step, of)| step * of.size).collect())
}
