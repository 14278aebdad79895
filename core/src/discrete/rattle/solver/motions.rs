//! The search for the motions of a line of a step with friction.

use super::coupled::Coupled;
use super::sticking::{Sticking, has_friction, sign};
use crate::constraints::{Constraints, Positions, at};
use crate::discrete::contact::slack;
use crate::discrete::motion::Motion;
use crate::discrete::rattle::stage::size;
use crate::forces::Grip;
use crate::particles::Particles;
use crate::scalar::Real;

impl<R, S, C, const D: usize> Sticking<'_, '_, '_, '_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    /// Compares the motions with the last evaluation, and replaces those that contradict it. Returns whether any did. Three ways follow each
    /// other, since each may return to a set of motions, in rare steps and on rods almost along an axis: all at once, and two descents from rest.
    pub fn revise(&mut self) -> bool {
        let changed = if self.descends() { self.descend() } else { self.replace() };
        self.revisions += usize::from(changed);
        if changed && self.begins_descent() {
            self.stop();
        }
        changed
    }

    pub fn descends(&self) -> bool {
        self.revisions >= 2 * self.coordinates()
    }

    /// Number of revisions at which the second descent begins.
    fn second(&self) -> usize {
        8 * self.coordinates()
    }

    pub fn most_revisions(&self) -> usize {
        14 * self.coordinates()
    }

    /// Whether the next revision begins one of both descents.
    fn begins_descent(&self) -> bool {
        self.revisions == 2 * self.coordinates() || self.revisions == self.second()
    }

    /// Replaces all motions that contradict the last evaluation.
    fn replace(&mut self) -> bool {
        let mut changed = self.release_from_rods();
        for node in 0..self.begun.v.len() {
            let (agreeing, motions) = (self.agreeing(node), self.motions(node).1);
            for i in (0..D).filter(|i| agreeing[*i] != motions[*i]) {
                self.turn(node, i, revised(at(self.begun.direction, node)[i], agreeing[i]));
                changed = true;
            }
        }
        changed
    }

    /// Lets everything rest, where the descent begins.
    fn stop(&mut self) {
        for node in 0..self.begun.v.len() {
            let (grips, _) = self.motions(node);
            let places = (self.begun.v.get_mut(node), self.begun.direction.get_mut(node));
            let (Some(v), Some(direction)) = places else { return };
            *v = core::array::from_fn(|i| if has_friction(&grips[i]) { R::zero() } else { v[i] });
            *direction = *v;
        }
    }

    /// Goes from the velocities where the line begins towards those of the last evaluation, until the first coordinate that slides comes to rest;
    /// it then sticks. If none does, one that friction cannot hold is released. The sum that rest and motion make least, ½vᵀMv − pᵀv + Σ c|v|,
    /// falls wherever something moves on the way.
    fn descend(&mut self) -> bool {
        let blocking = self.blocking();
        let part = blocking.map_or(R::one(), |(part, ..)| part);
        for (from, to) in self.begun.v.iter_mut().zip(self.coupled.points.v.iter()) {
            *from = core::array::from_fn(|i| from[i] + part * (to[i] - from[i]));
        }
        let Some((_, node, i)) = blocking else { return self.release_from_rods() || self.release() };
        // A coordinate that did not move at all: what friction cannot hold may be the reason, which the second descent takes first, or the other
        // direction may be the right one.
        let second = self.revisions >= self.second();
        if part == R::zero() && second && (self.release_from_rods() || self.release()) {
            return true;
        }
        if let Some(direction) = self.begun.direction.get_mut(node).and_then(|node| node.get_mut(i)) {
            *direction = if part > R::zero() { R::zero() } else { revised(*direction, Motion::Sticks) };
        }
        if let Some(v) = self.begun.v.get_mut(node).and_then(|node| node.get_mut(i)) {
            *v = R::zero();
        }
        true
    }

    /// The coordinate that slides and comes to rest first, after the returned part of the way.
    fn blocking(&self) -> Option<(R, usize, usize)> {
        let mut first: Option<(R, usize, usize)> = None;
        for node in 0..self.begun.v.len() {
            let (agreeing, motions) = (self.agreeing(node), self.motions(node).1);
            let (from, to) = (at(self.begun.v, node), at(self.coupled.points.v, node));
            for i in (0..D).filter(|i| motions[*i] != Motion::Sticks && agreeing[*i] == Motion::Sticks) {
                let moves = Motion::shown(&self.motions(node).0[i], from[i]) == motions[i];
                let part = if moves { from[i] / (from[i] - to[i]) } else { R::zero() };
                if first.is_none_or(|(least, ..)| part <= least) {
                    first = Some((part, node, i));
                }
            }
        }
        first
    }

    /// Releases the last coordinate that friction cannot hold.
    fn release(&mut self) -> bool {
        for node in (0..self.begun.v.len()).rev() {
            let (agreeing, motions) = (self.agreeing(node), self.motions(node).1);
            if let Some(i) = (0..D).find(|i| motions[*i] == Motion::Sticks && agreeing[*i] != Motion::Sticks)
            {
                self.turn(node, i, revised(R::zero(), agreeing[i]));
                return true;
            }
        }
        false
    }

    fn turn(&mut self, node: usize, axis: usize, direction: R) {
        let place = self.begun.direction.get_mut(node).and_then(|node| node.get_mut(axis));
        if let Some(place) = place {
            *place = direction;
        }
    }

    /// The motions of a node that agree with the last evaluation.
    fn agreeing(&self, node: usize) -> [Motion; D] {
        let ((grips, motions), still) = (self.motions(node), self.still());
        let Coupled { solver, points, scale, .. } = &self.coupled;
        let (r, v, p) = (at(solver.update, node), at(points.v, node), at(points.p, node));
        let slack = slack(size(&p) + size(&r) + scale.map_or(R::zero(), |scale| scale.impulse));
        core::array::from_fn(|i| {
            let v = if v[i].abs() <= still { R::zero() } else { v[i] };
            motions[i].agreeing(&grips[i], v, -r[i], slack)
        })
    }

    /// Lets slide what stops a rod from turning that the other coordinates move out of its length: if none of them can keep it, its multiplier
    /// has no bound. Of coordinates that stick the one slides whose friction it exceeds first. Returns whether any does.
    fn release_from_rods(&mut self) -> bool {
        if self.coupled.scale.is_none() {
            return false;
        }
        let mut released = false;
        for k in 0..self.begun.lambda.len() {
            if let Some((node, axis, direction)) = self.release_from(k) {
                self.turn(node, axis, direction);
                released = true;
            }
        }
        released
    }

    /// The coordinate that sticks against equation k, with the direction in which it slides, if the equation is violated and no other
    /// coordinate can solve it. Where all nodes of an equation rest, it is left as it is.
    fn release_from(&self, k: usize) -> Option<(usize, usize, R)> {
        let Coupled { solver, points, .. } = &self.coupled;
        let c = *solver.multipliers.get(k)?;
        let constraints = solver.mechanism.constraints();
        let nodes = constraints.nodes(k);
        let moves = nodes.iter().any(|node| at(points.v, *node) != [R::zero(); D]);
        if !solver.matrix.is_dependent(k) || !moves || c.abs() <= self.still() {
            return None;
        }
        let x = Positions::with_carry(solver.trial, solver.trial_carry);
        let mut first: Option<(R, usize, usize, R)> = None;
        for (slot, node) in nodes.iter().enumerate() {
            let ((grips, motions), r) = (self.motions(*node), at(solver.update, *node));
            let pull = constraints.gradient(k, slot, x).map(|gradient| -c * gradient);
            for i in (0..D).filter(|i| motions[*i] == Motion::Sticks && pull[*i] != R::zero()) {
                let room = room(&grips[i], pull[i], r[i]) / pull[i].abs();
                if first.is_none_or(|(least, ..)| room < least) {
                    first = Some((room, *node, i, sign(pull[i])));
                }
            }
        }
        first.map(|(_, node, axis, direction)| (node, axis, direction))
    }
}

/// The direction that replaces one after which another motion agrees. What slides against its direction is first tried in the other: on a
/// rod that turns, rest may contradict both, since its multiplier acts along the rod at the start and keeps its length at the end.
fn revised<R: Real>(direction: R, agreeing: Motion) -> R {
    match agreeing {
        Motion::Forward => R::one(),
        Motion::Backward => -R::one(),
        _ if direction.abs() > R::one().half() => -sign(direction).half(),
        _ => R::zero(),
    }
}

/// The impulse that friction at rest can still take against a pull beside the impulse r.
fn room<R: Real>(grip: &Grip<R>, pull: R, r: R) -> R {
    if pull > R::zero() { grip.breakaway * grip.forward - r } else { grip.breakaway * grip.backward + r }
}
