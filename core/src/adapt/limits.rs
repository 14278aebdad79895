use super::filter::Filter;
use super::number::{Number, bodies};
use super::possible::{cut, repair};
use crate::energy::arm::INERTIAL_PARAMETERS;
use crate::scalar::Real;

/// Limits on how far numbers may be from the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<R, const P: usize> {
    /// Numbers of the model itself.
    pub model: [R; P],
    /// Smallest distance δ ≤ 0 of every number from the model.
    pub lower: [R; P],
    /// Largest distance δ ≥ 0.
    pub upper: [R; P],
    /// Share κ of its own inertia that a body keeps, above 0 and at most 1: its pseudo-inertia is at least κ times that of the model, so the
    /// mass matrix stays positive definite.
    pub kept: R,
}

/// Maximum number of moves towards the limits: most estimates need none, and an impossible body five.
pub(super) const MOVES: u8 = 16;
/// Maximum number of times that a body's distances are taken a quarter back, if it is still impossible after all moves.
const RETREATS: u8 = 8;
/// Moves of bodies go further than to the edge, by half of the way, so that few of them are enough.
const FURTHER: f64 = 1.5;

impl<R: Real, const P: usize> Limits<R, P> {
    /// The numbers within the limits that are near the estimate: near in the metric of its covariance, so that it is the unknown numbers that
    /// give way. Takes a bounded time. A number that is not finite becomes 0, the model's own.
    pub fn within<const T: usize>(&self, numbers: &[Number; P], filter: &Filter<R, P, T>) -> [R; P] {
        let mut x = *filter.estimate();
        for _ in 0..MOVES {
            if !self.approach(numbers, filter, &mut x) {
                break;
            }
        }
        self.forced(numbers, x)
    }

    /// Makes one move towards the limits; returns whether one was needed.
    pub(super) fn approach<const T: usize>(
        &self,
        numbers: &[Number; P],
        filter: &Filter<R, P, T>,
        x: &mut [R; P],
    ) -> bool {
        let Some((row, by)) = self.outside(x).or_else(|| self.impossible(numbers, x)) else { return false };
        *x = filter.moved(x, &row, by);
        true
    }

    /// A number beyond its limits, as a row a and the change of a·x that it asks for.
    fn outside(&self, x: &[R; P]) -> Option<([R; P], R)> {
        let all = x.iter().zip(&self.lower).zip(&self.upper).enumerate();
        let violated = |(j, ((x, lower), upper)): (usize, ((&R, &R), &R))| {
            let by = if x < lower { *lower - *x } else { *upper - *x };
            (x < lower || x > upper).then_some((j, by))
        };
        let (own, by) = all.filter_map(violated).next()?;
        let mut row = [R::zero(); P];
        *row.get_mut(own)? = R::one();
        Some((row, by))
    }

    /// A body that keeps too little, likewise.
    fn impossible(&self, numbers: &[Number; P], x: &[R; P]) -> Option<([R; P], R)> {
        bodies(numbers).find_map(|(first, count)| {
            let (body, mut row) = (self.body(x, (first, count)), [R::zero(); P]);
            let slopes = cut(body.get(..count)?)?.slopes;
            let short =
                slopes.iter().zip(&body).fold(R::zero(), |sum, (slope, number)| sum - *slope * *number);
            row.iter_mut().skip(first).zip(slopes).take(count).for_each(|(row, slope)| *row = slope);
            Some((row, R::constant(FURTHER) * short))
        })
    }

    /// (1 − κ) of the model's body plus its distance: possible if and only if the body keeps the share κ of its inertia.
    fn body(&self, x: &[R; P], (first, count): (usize, usize)) -> [R; INERTIAL_PARAMETERS] {
        let (mut body, rest) = ([R::zero(); INERTIAL_PARAMETERS], R::one() - self.kept);
        let own = x.iter().zip(&self.model).skip(first).take(count);
        body.iter_mut().zip(own).for_each(|(body, (x, model))| *body = rest * *model + *x);
        body
    }

    /// Repairs bodies, clamps every number, and takes bodies that are then impossible back towards the model, without regard to what is known.
    pub(super) fn forced(&self, numbers: &[Number; P], mut x: [R; P]) -> [R; P] {
        for (first, count) in bodies(numbers) {
            let mut body = self.body(&x, (first, count));
            let Some(own) = body.get_mut(..count) else { continue };
            if cut(own).is_some() {
                repair(own);
                let rest = R::one() - self.kept;
                let distances =
                    self.model.iter().skip(first).zip(own).map(|(model, body)| *body - rest * *model);
                x.iter_mut().skip(first).zip(distances).for_each(|(x, distance)| *x = distance);
            }
        }
        for ((x, lower), upper) in x.iter_mut().zip(&self.lower).zip(&self.upper) {
            let inside = if *x < *lower { *lower } else { *x };
            let inside = if inside > *upper { *upper } else { inside };
            *x = if inside.is_finite() { inside } else { R::zero() };
        }
        bodies(numbers).for_each(|body| self.back(body, &mut x));
        x
    }

    /// Takes the distances of a body a quarter back until it is possible; in the end they are 0.
    fn back(&self, (first, count): (usize, usize), x: &mut [R; P]) {
        for retreat in 0..=RETREATS {
            if cut(self.body(x, (first, count)).get(..count).unwrap_or_default()).is_none() {
                return;
            }
            let share = if retreat == RETREATS { R::zero() } else { R::one() - R::one().half().half() };
            x.iter_mut().skip(first).take(count).for_each(|x| *x = *x * share);
        }
    }
}
