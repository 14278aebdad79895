//! A model in the chip's arithmetic as a plant in double precision.

use leastaction_core::control::{Plant, Stepped, Transition};
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Newton, Order, Path, Report, State, StepError};
use leastaction_core::forces;
use leastaction_core::lagrangian::Linearization;
use leastaction_replica::{AnyLagrangian, ForcesOf, SystemOf};

/// A plant whose steps are the chip's, in single precision, for a search in double precision: Riccati's recursion squares the condition of
/// what it is given.
///
/// The order is a value, so that a search is compiled once per size.
pub enum Widened<'s, const N: usize> {
    /// Steps of order 2.
    Two(SteppedOf<'s, Midpoint, N>),
    /// Steps of order 4.
    Four(SteppedOf<'s, Galerkin, N>),
}

/// A model under its steps; every coordinate has a command.
pub type SteppedOf<'s, P, const N: usize> = Stepped<'s, AnyLagrangian<'s, N>, ForcesOf<'s, N>, f32, P, N, N>;

/// Step of a plant.
pub struct PlantStep<const N: usize> {
    /// Tick, s.
    pub tick: f64,
    /// Order.
    pub order: Order,
    /// Largest number of ticks in a step.
    pub stride: u16,
    /// Bounds of Newton's method.
    pub newton: Newton<f32>,
    /// Gain and offset of the drives.
    pub actuator: forces::Actuator<f32, N>,
}

impl<'s, const N: usize> Widened<'s, N> {
    /// The system under these steps.
    pub fn new(system: &'s SystemOf<'s, N>, step: PlantStep<N>) -> Self {
        match step.order {
            Order::Two => Self::Two(stepped(system, step)),
            Order::Four => Self::Four(stepped(system, step)),
        }
    }
}

fn stepped<'s, P: Path, const N: usize>(
    system: &'s SystemOf<'s, N>,
    PlantStep { tick, stride, newton, actuator, .. }: PlantStep<N>,
) -> SteppedOf<'s, P, N> {
    let del = Del::with_newton(tick as f32, newton);
    Stepped { system, del, actuator, inputs: std::array::from_fn(|i| i), stride }
}

/// Evaluates `$do` with `$plant` bound to the plant of either order.
macro_rules! either {
    ($self:ident, $plant:ident => $do:expr) => {
        match $self {
            Self::Two($plant) => $do,
            Self::Four($plant) => $do,
        }
    };
}

fn narrow<const K: usize>(x: &[f64; K]) -> [f32; K] {
    x.map(|x| x as f32)
}

fn wide<const K: usize>(x: [f32; K]) -> [f64; K] {
    x.map(f64::from)
}

fn widened(error: StepError<f32>) -> StepError<f64> {
    match error {
        StepError::Singular { column } => StepError::Singular { column },
        StepError::NotFinite => StepError::NotFinite,
        StepError::NotConverged(Report { iterations, residual }) => {
            StepError::NotConverged(Report { iterations, residual: residual.into() })
        }
    }
}

impl<const N: usize, const D: usize> Plant<f64, D, N> for Widened<'_, N> {
    type Motion = State<f32, N>;
    type Frame = Linearization<f32, N>;

    fn begin(&self, x: &[f64; D]) -> Result<Self::Motion, StepError<f64>> {
        either!(self, plant => Plant::<f32, D, N>::begin(plant, &narrow(x))).map_err(widened)
    }

    fn advance(
        &self,
        motion: &mut Self::Motion,
        (ticks, u): (u16, &[f64; N]),
        course: &mut [f64; D],
    ) -> Result<[f64; D], StepError<f64>> {
        let mut own = [0.0; D];
        let held = (ticks, &narrow(u));
        let end = either!(self, plant => Plant::<f32, D, N>::advance(plant, motion, held, &mut own));
        *course = wide(own);
        end.map(wide).map_err(widened)
    }

    fn frame(&self, x: &[f64; D]) -> Self::Frame {
        either!(self, plant => plant.frame(&narrow(x)))
    }

    fn linearise(
        &self,
        ends: [(&[f64; D], &Self::Frame); 2],
        (ticks, u): (u16, &[f64; N]),
        course: &[f64; D],
    ) -> Result<Transition<f64, D, N>, StepError<f64>> {
        let [(x, start), (y, end)] = ends;
        let (x, y, u, course) = (narrow(x), narrow(y), narrow(u), narrow(course));
        let found: Result<Transition<f32, D, N>, _> =
            either!(self, plant => plant.linearise([(&x, start), (&y, end)], (ticks, &u), &course));
        let Transition { a, b } = found.map_err(widened)?;
        Ok(Transition { a: a.map(wide), b: b.map(wide) })
    }

    fn energy(&self, x: &[f64; D]) -> Option<(f64, [f64; D])> {
        let x = narrow(x);
        let (energy, slope): (f32, [f32; D]) = either!(self, plant => Plant::<f32, D, N>::energy(plant, &x))?;
        Some((energy.into(), wide(slope)))
    }
}
