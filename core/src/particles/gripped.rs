use super::Particles;
use crate::constraints::{ConstraintError, check_length};
use crate::forces::Grip;
use crate::lagrangian::Energies;
use crate::linear::Matrix;
use crate::scalar::Real;

/// Particles with dry friction that sticks, on every coordinate of every node: a set-valued law.
///
/// Q = −c⁺ if v > 0, Q = c⁻ if v < 0, and at rest whatever keeps v = 0, as long as it lies between −s c⁺ and s c⁻; c⁺, c⁻ and s are the levels
/// and the breakaway ratio of a [`Grip`]. It acts along each axis by itself, and beside the drag of the particles. Steps of
/// [`Rattle`](crate::discrete::rattle::Rattle) solve this law, at order 2; accelerations and inverse dynamics use the smooth law
/// −(c + δt) t with c = ½(c⁺ + c⁻), δ = ½(c⁺ − c⁻) and t = tanh(v/ε).
#[derive(Clone, Copy, Debug)]
pub struct Gripped<'a, R, S, const D: usize> {
    particles: &'a S,
    grips: &'a [[Grip<R>; D]],
    width: R,
}

impl<'a, R: Real, S: Particles<R, D>, const D: usize> Gripped<'a, R, S, D> {
    /// Adds dry friction to particles: one grip for every coordinate of every node, and the width ε > 0, m/s, of the smooth law.
    ///
    /// # Errors
    /// [`ConstraintError::Shape`] unless there is a row of grips for every node, [`ConstraintError::Grip`] for a level that is not finite or
    /// below 0, or a breakaway ratio below 1, and [`ConstraintError::Width`] for a width that is not positive and finite.
    pub fn new(particles: &'a S, grips: &'a [[Grip<R>; D]], width: R) -> Result<Self, ConstraintError<R>> {
        check_length(grips, particles.nodes())?;
        for (node, grips) in grips.iter().enumerate() {
            if let Some(axis) = grips.iter().position(|grip| !is_in_range(grip)) {
                return Err(ConstraintError::Grip { node, axis });
            }
        }
        let positive = width > R::zero() && width.is_finite();
        if positive { Ok(Self { particles, grips, width }) } else { Err(ConstraintError::Width { width }) }
    }

    /// The friction added to a node; none for a node that the particles do not have.
    #[inline(always)]
    fn own(&self, node: usize) -> [Grip<R>; D] {
        self.grips.get(node).copied().unwrap_or([Grip::none(); D])
    }

    /// (t, c, δ) of the smooth law for every coordinate of a node.
    #[inline(always)]
    fn smooth(&self, node: usize, v: &[R; D]) -> [[R; 3]; D] {
        let grips = self.own(node);
        core::array::from_fn(|i| {
            let Grip { forward, backward, .. } = grips[i];
            [(v[i] / self.width).tanh(), (forward + backward).half(), (forward - backward).half()]
        })
    }
}

fn is_in_range<R: Real>(grip: &Grip<R>) -> bool {
    let level = |level: R| level >= R::zero() && level.is_finite();
    level(grip.forward) && level(grip.backward) && grip.breakaway >= R::one() && grip.breakaway.is_finite()
}

impl<R: Real, S: Particles<R, D>, const D: usize> Particles<R, D> for Gripped<'_, R, S, D> {
    fn nodes(&self) -> usize {
        self.particles.nodes()
    }

    fn workspace(&self) -> usize {
        self.particles.workspace()
    }

    fn energies(&self, q: &[[R; D]], v: &[[R; D]], workspace: &mut [R]) -> Energies<R> {
        self.particles.energies(q, v, workspace)
    }

    fn l_q(&self, q: &[[R; D]], workspace: &mut [R], l_q: &mut [[R; D]]) {
        self.particles.l_q(q, workspace, l_q);
    }

    fn l_v(&self, node: usize, v: &[R; D]) -> [R; D] {
        self.particles.l_v(node, v)
    }

    fn mass(&self, node: usize, v: &[R; D]) -> [[R; D]; D] {
        self.particles.mass(node, v)
    }

    fn drag(&self, node: usize, v: &[R; D]) -> [R; D] {
        let (drag, smooth) = (self.particles.drag(node, v), self.smooth(node, v));
        core::array::from_fn(|i| {
            let [t, c, delta] = smooth[i];
            drag[i] - (c + delta * t) * t
        })
    }

    fn drag_slope(&self, node: usize, v: &[R; D]) -> [R; D] {
        let (slope, smooth) = (self.particles.drag_slope(node, v), self.smooth(node, v));
        core::array::from_fn(|i| {
            let [t, c, delta] = smooth[i];
            slope[i] - (c + (delta + delta) * t) * ((R::one() - t) * (R::one() + t) / self.width)
        })
    }

    fn momenta(&self, first: usize, v: &[[R; D]], l_v: &mut [[R; D]]) {
        self.particles.momenta(first, v, l_v);
    }

    fn masses(&self, first: usize, v: &[[R; D]], masses: &mut [Matrix<R, D>]) {
        self.particles.masses(first, v, masses);
    }

    #[inline(always)]
    fn sticks(&self) -> bool {
        true
    }

    #[inline(always)]
    fn grips(&self, node: usize) -> [Grip<R>; D] {
        let (theirs, own) = (self.particles.grips(node), self.own(node));
        core::array::from_fn(|i| theirs[i].plus(own[i]))
    }

    #[inline(always)]
    fn single_valued_drags(&self, first: usize, v: &[[R; D]], drags: &mut [[R; D]]) {
        self.particles.single_valued_drags(first, v, drags);
    }

    #[inline(always)]
    fn single_valued_drag_slopes(&self, first: usize, v: &[[R; D]], slopes: &mut [[R; D]]) {
        self.particles.single_valued_drag_slopes(first, v, slopes);
    }
}
