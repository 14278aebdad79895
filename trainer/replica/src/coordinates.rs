//! Systems in generalised coordinates behind the slice interfaces.

use crate::control::{array, write};
use crate::{Control, Evaluator, Motion, ReplicaError, Step, SystemOf};
use leastaction_core::continuous::{acceleration, inverse_dynamics};
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Order, Path, Report, SavedState, State};
use leastaction_core::lagrangian::{Energies, Lagrangian};
use leastaction_core::linear;

impl<const N: usize> Evaluator for &SystemOf<'_, N> {
    fn energies(&mut self, q: &[f32], v: &[f32]) -> Result<Energies<f32>, ReplicaError> {
        Ok(SystemOf::energies(*self, &array::<N>("q", q)?, &array("v", v)?))
    }

    fn acceleration(
        &mut self,
        q: &[f32],
        v: &[f32],
        tau: &[f32],
        to: &mut [f32],
    ) -> Result<(), ReplicaError> {
        let a = acceleration(*self, &array("q", q)?, &array("v", v)?, &array::<N>("tau", tau)?)?;
        write("the acceleration", &a, to)
    }

    fn inverse_dynamics(
        &mut self,
        q: &[f32],
        v: &[f32],
        a: &[f32],
        to: &mut [f32],
    ) -> Result<(), ReplicaError> {
        let tau = inverse_dynamics(*self, &array("q", q)?, &array("v", v)?, &array::<N>("a", a)?)?;
        write("the force", &tau, to)
    }

    fn mass_matrix(&mut self, q: &[f32], to: &mut [f32]) -> Result<(), ReplicaError> {
        let mass = self.lagrangian.dynamics(&array::<N>("q", q)?, &[0.0; N]).mass;
        write("the mass matrix", mass.as_flattened(), to)
    }
}

/// Initial condition of a motion.
#[derive(Clone, Copy)]
pub(crate) enum Beginning<'b> {
    /// A position and a velocity.
    At { q: &'b [f32], v: &'b [f32] },
    /// Two positions one step apart, and the control between them; the motion begins at the second position.
    Between { q: [&'b [f32]; 2], control: Control<'b> },
    /// Numbers of an earlier motion.
    Resumed(&'b [f32]),
}

/// Begins the motion of a system.
pub(crate) fn motion<'c, const N: usize>(
    system: &'c SystemOf<'c, N>,
    step: Step,
    beginning: Beginning,
) -> Result<Box<dyn Motion + 'c>, ReplicaError> {
    Ok(match step.order {
        Order::Two => Box::new(DelMotion::<Midpoint, N>::new(system, step.h, beginning)?),
        Order::Four => Box::new(DelMotion::<Galerkin, N>::new(system, step.h, beginning)?),
    })
}

/// The state of an earlier motion: rows of N numbers, and the number of known increments.
fn resumed<const N: usize>(numbers: &[f32]) -> Result<State<f32, N>, ReplicaError> {
    let mut rows: SavedState<f32, N> = [[0.0; N]; _];
    let length = rows.as_flattened().len() + 1;
    let differs = ReplicaError::Saved { expected: length, found: numbers.len() };
    let (known, own) = numbers.split_last().filter(|_| numbers.len() == length).ok_or(differs)?;
    rows.as_flattened_mut().copy_from_slice(own);
    Ok(State::resume(&rows, *known as u8)?)
}

/// A state with its integrator.
struct DelMotion<'c, P, const N: usize> {
    system: &'c SystemOf<'c, N>,
    del: Del<f32, P>,
    state: State<f32, N>,
    q: [f32; N],
    p: [f32; N],
}

impl<'c, P: Path, const N: usize> DelMotion<'c, P, N> {
    fn new(system: &'c SystemOf<'c, N>, h: f32, beginning: Beginning) -> Result<Self, ReplicaError> {
        let del = Del::new(h);
        let state = match beginning {
            Beginning::At { q, v } => State::new(&system.lagrangian, array("q", q)?, array("v", v)?)?,
            Beginning::Between { q: [q0, q1], control } => {
                del.start(system, &array("q", q0)?, &array("q", q1)?, &control.sized()?)?
            }
            Beginning::Resumed(numbers) => resumed(numbers)?,
        };
        Ok(Self { system, del, q: state.q(), p: state.p(), state })
    }
}

impl<P: Path + Send, const N: usize> Motion for DelMotion<'_, P, N> {
    fn q(&self) -> &[f32] {
        &self.q
    }

    fn p(&self) -> &[f32] {
        &self.p
    }

    fn velocity(&self, to: &mut [f32]) -> Result<(), ReplicaError> {
        // The kinetic energies of inertia networks and of trees are quadratic in v.
        let mass = self.system.lagrangian.linearization(&self.q, &[0.0; N]).l_vv;
        write("the velocity", &linear::solve(mass, self.p)?, to)
    }

    fn saved(&self) -> Vec<f32> {
        let (rows, known) = self.state.save();
        rows.as_flattened().iter().copied().chain([f32::from(known)]).collect()
    }

    fn step(&mut self, control: Control) -> Result<Report<f32>, ReplicaError> {
        let report = self.del.step(self.system, &mut self.state, &control.sized()?)?;
        (self.q, self.p) = (self.state.q(), self.state.p());
        Ok(report)
    }
}
