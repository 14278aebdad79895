//! Runs of a model from a fixed start under a fixed force, whose positions have one fingerprint on every target.
//!
//! A square wave pushes the first coordinate (for particles: the last node along the first axis), 8 steps one way and 8 the other.

pub mod carrying;
mod elementary;
pub mod reference;

use leastaction_core::constraints::{Constrained, ConstraintError, Constraints};
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::discrete::{Control, Del, Path, Report, State, StepError};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::particles::Particles;

/// Amplitude of the square wave, N or N m.
const PUSH: f32 = 0.25;
/// Number of steps that the wave lasts one way.
const HALF_PERIOD: u32 = 8;

fn push(index: u32) -> f32 {
    if (index / HALF_PERIOD).is_multiple_of(2) { PUSH } else { -PUSH }
}

/// A model in motion, step by step.
pub trait Motion {
    /// Reason why a step is refused.
    type Error;

    /// Takes the step with the given index; an error leaves the motion unchanged.
    ///
    /// # Errors
    /// Errors of the model's own step.
    fn step(&mut self, index: u32) -> Result<Report<f32>, Self::Error>;
    /// Calls `visit` with every coordinate of the position, in order.
    fn positions(&self, visit: impl FnMut(f32));
}

/// A system in N generalised coordinates, stepped by the discrete Euler–Lagrange equation.
#[derive(Clone, Debug)]
pub struct SystemMotion<'a, L, F, P, const N: usize> {
    system: &'a System<L, F>,
    del: Del<f32, P>,
    state: State<f32, N>,
}

impl<'a, L: Lagrangian<f32, N>, F: Forces<f32, N>, P: Path, const N: usize> SystemMotion<'a, L, F, P, N> {
    /// Creates a motion from q_i = 0.1 + 0.6 i, v_i = 0.2 − 0.6 i (rad or m, rad/s or m/s).
    ///
    /// # Errors
    /// An error if a momentum is not finite.
    pub fn new(system: &'a System<L, F>, del: Del<f32, P>) -> Result<Self, StepError<f32>> {
        let q = core::array::from_fn(|i| 0.1 + 0.6 * i as f32);
        let v = core::array::from_fn(|i| 0.2 - 0.6 * i as f32);
        Ok(Self { system, del, state: State::new(&system.lagrangian, q, v)? })
    }
}

impl<L: Lagrangian<f32, N>, F: Forces<f32, N>, P: Path, const N: usize> Motion
    for SystemMotion<'_, L, F, P, N>
{
    type Error = StepError<f32>;

    fn step(&mut self, index: u32) -> Result<Report<f32>, StepError<f32>> {
        let mut u = [0.0; N];
        if let Some(first) = u.first_mut() {
            *first = push(index);
        }
        self.del.step(self.system, &mut self.state, &Control::held(u))
    }

    fn positions(&self, visit: impl FnMut(f32)) {
        self.state.q().into_iter().for_each(visit);
    }
}

/// Particles in D dimensions under constraints, stepped by RATTLE in the caller's workspace.
#[derive(Debug)]
pub struct ParticleMotion<'a, S, C: ?Sized, const D: usize> {
    mechanism: &'a Constrained<'a, f32, S, C, D>,
    rattle: Rattle<f32>,
    state: ParticleState<'a, f32, D>,
    force: &'a mut [[f32; D]],
    workspace: &'a mut [f32],
}

impl<'a, S: Particles<f32, D>, C: Constraints<f32, D> + ?Sized, const D: usize> ParticleMotion<'a, S, C, D> {
    /// Creates a motion of particles in a state, with memory for a force on each particle and for [`Rattle::workspace`] numbers.
    pub fn new(
        mechanism: &'a Constrained<'a, f32, S, C, D>,
        rattle: Rattle<f32>,
        state: ParticleState<'a, f32, D>,
        force: &'a mut [[f32; D]],
        workspace: &'a mut [f32],
    ) -> Self {
        Self { mechanism, rattle, state, force, workspace }
    }
}

impl<S, C, const D: usize> Motion for ParticleMotion<'_, S, C, D>
where
    S: Particles<f32, D>,
    C: Constraints<f32, D> + ?Sized,
{
    type Error = ConstraintError<f32>;

    fn step(&mut self, index: u32) -> Result<Report<f32>, ConstraintError<f32>> {
        if let Some(x) = self.force.last_mut().and_then(|force| force.first_mut()) {
            *x = push(index);
        }
        self.rattle.step(self.mechanism, &mut self.state, Some(self.force), self.workspace)
    }

    fn positions(&self, visit: impl FnMut(f32)) {
        self.state.q().iter().flatten().copied().for_each(visit);
    }
}

/// FNV-1a, 64 bits, over the little-endian bits of all positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// Takes in the positions of a motion.
    pub fn update(&mut self, motion: &impl Motion) {
        motion.positions(|x| self.bits(x.to_bits()));
    }

    fn bits(&mut self, bits: u32) {
        for byte in bits.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Fingerprint of all bits taken in.
    pub fn value(&self) -> u64 {
        self.0
    }
}

/// Fingerprint of a number of steps.
///
/// # Errors
/// The first step that is refused.
pub fn fingerprint<M: Motion>(motion: &mut M, steps: u32) -> Result<Fingerprint, M::Error> {
    let mut fingerprint = Fingerprint::default();
    for index in 0..steps {
        motion.step(index)?;
        fingerprint.update(motion);
    }
    Ok(fingerprint)
}
