//! Check whether steps of the trained size make velocities ring under the learned dry friction.

use super::notice::Notice;
use super::plan::Plan;
use crate::data::Trajectory;
use crate::matrix::cholesky;
use leastaction_core::discrete::Order;
use leastaction_core::model::TrainedStep;
use leastaction_models::{CoordinateFriction, Model};
use nalgebra::DMatrix;

/// Number of positions that are checked.
const POSITIONS: usize = 64;

/// A sample of about `POSITIONS` positions from throughout the logs.
pub(super) fn positions(logs: &[Trajectory]) -> Vec<Vec<f64>> {
    let all: usize = logs.iter().map(|trajectory| trajectory.samples()).sum();
    let positions = logs.iter().flat_map(|trajectory| trajectory.q.iter());
    positions.step_by(all.div_ceil(POSITIONS).max(1)).map(<[f64]>::to_vec).collect()
}

/// Largest stiffness a = h c (M⁻¹)_ii/(2ε) at which a step of this order does not ring
/// ([`leastaction_core::forces::Coulomb`]).
fn limit(order: Order) -> f64 {
    match order {
        Order::Two => 1.0,
        Order::Four => 3.0,
    }
}

/// A notice if the friction of these weights is too stiff for the trained step; `None` otherwise, or if the model was
/// not trained for a step.
pub(super) fn notice(plan: &Plan, weights: &[f64]) -> Option<Notice> {
    let TrainedStep { order, h, .. } = plan.trained_step?;
    let friction = plan.architecture.friction_of_coordinates(weights);
    friction.iter().find(|friction| friction.dry.is_some_and(|dry| dry.breakaway.is_none()))?;
    let positions: Vec<&[f64]> = plan.positions.iter().map(Vec::as_slice).collect();
    let own = weights.get(..plan.architecture.parameters().ok()?)?.to_vec();
    let at_rest = Model::new(plan.architecture.clone(), own).at_rest(&positions).ok()?;
    let all =
        at_rest.iter().flat_map(|at| stiffness(f64::from(h), &at.mass, &friction).into_iter().enumerate());
    let (coordinate, stiffness) = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let most = limit(order);
    (stiffness > most).then_some(Notice::Rings { coordinate, stiffness, most, order: order.number() })
}

/// Stiffness a of every coordinate without load; empty if M is not positive definite.
fn stiffness(h: f64, mass: &[f64], friction: &[CoordinateFriction]) -> Vec<f64> {
    let n = friction.len();
    let Some(factor) = cholesky(DMatrix::from_row_slice(n, n, mass)) else { return Vec::new() };
    let inverse = factor.inverse();
    let of = |(i, friction): (usize, &CoordinateFriction)| {
        let smooth = friction.dry.filter(|dry| dry.breakaway.is_none());
        smooth.map_or(0.0, |dry| 0.5 * h * dry.constant * inverse[(i, i)] / dry.width)
    };
    friction.iter().enumerate().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::forces::{Coulomb, DryFriction};
    use leastaction_models::DryNumbers;

    #[test]
    fn it_is_the_stiffness_of_core() {
        let (h, mass) = (0.01, [[2.0, 0.3], [0.3, 0.1]]);
        let dry = |constant: f64, width| DryFriction { constant, load: 0.2, smoothing: 0.5, width };
        let coordinates = [dry(0.4, 0.05), dry(0.02, 0.3)];
        let expected = Coulomb { coordinates }.stiffness(h, mass, &[0.0; 2]).unwrap();
        let friction = coordinates.map(|DryFriction { constant, width, .. }| {
            let dry = Some(DryNumbers { constant, width, ..DryNumbers::default() });
            CoordinateFriction { viscous: 0.1, dry, ..CoordinateFriction::default() }
        });
        for (found, expected) in stiffness(h, mass.as_flattened(), &friction).iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
        assert!(stiffness(h, &[1.0, 2.0, 2.0, 1.0], &friction).is_empty(), "no positive definite mass");
    }
}
