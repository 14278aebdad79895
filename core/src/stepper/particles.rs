//! Stepper of graphs of particles with rods. It has the calls of the stepper for all other models, and works in
//! memory that the caller owns.

use super::{Actuation, Drive, Kind};
use crate::constraints::{Constrained, ConstraintError, Holonomic};
use crate::discrete::rattle::{ParticleState, Rattle};
use crate::discrete::{Control, Newton, Order, Report};
use crate::energy::graph::{Edge, Graph, GraphError};
use crate::model::{GraphModel, GraphSystem, ModelError, TrainedStep};
use crate::particles::Particles;
use crate::scalar::{FileWeightFormat, WeightFormat};

/// Length of a [`ParticleStepper`]'s [`ParticleMemory`] in numbers: its state, and the workspace of [`Rattle::workspace_of`].
pub const fn particle_numbers<const D: usize>(nodes: usize, rods: usize, band: usize, graph: usize) -> usize {
    ParticleState::<f32, D>::workspace(nodes, rods)
        + Rattle::<f32>::workspace_of::<D>(nodes, rods, band, graph)
}

/// Memory for reading and stepping a graph of at most `EDGES` edges and `RODS` rods in `D` dimensions: a static, or a variable of a
/// function that outlives the stepper.
#[derive(Clone, Debug)]
pub struct ParticleMemory<const D: usize, const EDGES: usize, const RODS: usize, const NUMBERS: usize> {
    edges: [Edge; EDGES],
    rods: [Holonomic<f32, D>; RODS],
    numbers: [f32; NUMBERS],
}

impl<const D: usize, const EDGES: usize, const RODS: usize, const NUMBERS: usize>
    ParticleMemory<D, EDGES, RODS, NUMBERS>
{
    /// Creates an empty memory.
    pub const fn new() -> Self {
        Self {
            edges: [Edge { kind: 0, ends: [0; 2] }; EDGES],
            rods: [Holonomic::Held { node: 0, axis: 0, at: 0.0 }; RODS],
            numbers: [0.0; NUMBERS],
        }
    }
}

impl<const D: usize, const EDGES: usize, const RODS: usize, const NUMBERS: usize> Default
    for ParticleMemory<D, EDGES, RODS, NUMBERS>
{
    fn default() -> Self {
        Self::new()
    }
}

/// A graph model `M` of particles in `D` dimensions, stepped by RATTLE under the commands of a drive `C`. The N
/// coordinates are listed node by node.
///
/// The force of a step is the mean of the drive's force over the step. Before the start, the positions are NaN and
/// steps are refused with [`ConstraintError::NotFinite`]; all commands before the first are 0.
#[derive(Debug)]
pub struct ParticleStepper<'a, M, C, const D: usize, const N: usize> {
    model: M,
    /// Band of the matrix A M⁻¹ Aᵀ of the rods.
    band: usize,
    rattle: Rattle<f32>,
    drive: C,
    state: ParticleState<'a, f32, D>,
    workspace: &'a mut [f32],
}

/// Mechanism that RATTLE steps.
type Mechanism<'m, 'a, const D: usize, const K: usize, const H: usize, const L: usize, W> =
    Constrained<'m, f32, Graph<'a, W, D, K, H, L>, [Holonomic<f32, D>], D>;

impl<
    'a,
    C,
    W,
    A,
    const D: usize,
    const N: usize,
    const K: usize,
    const H: usize,
    const L: usize,
    const PAST: usize,
> ParticleStepper<'a, GraphModel<'a, D, K, H, L, W>, Drive<C, A, N, PAST>, D, N>
where
    C: Kind,
    W: FileWeightFormat + WeightFormat<Wide = f32>,
    A: Actuation<N>,
{
    /// Creates a stepper of the graph called `name`, with the step, the order, the kind of control and the actuator of the file.
    ///
    /// # Errors
    /// The errors of [`GraphModel::load`]; [`ModelError::NoStep`] if the model was trained without steps;
    /// [`GraphError::Coordinates`],
    /// [`ModelError::Control`], [`ModelError::Actuator`] and [`ModelError::Shape`] if the file does not match types and memory.
    pub fn new<const EDGES: usize, const RODS: usize, const NUMBERS: usize>(
        bytes: &'a [u8],
        name: &str,
        memory: &'a mut ParticleMemory<D, EDGES, RODS, NUMBERS>,
    ) -> Result<Self, ModelError> {
        let model = GraphModel::load(bytes, name, &mut memory.edges, &mut memory.rods)?;
        Self::over(model, model.step()?, &mut memory.numbers)
    }

    /// Creates a stepper of order 4 with steps of h seconds, whatever the model was trained with.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] unless h is positive and finite; else the errors of [`ParticleStepper::new`] except `NoStep`.
    pub fn with_step<const EDGES: usize, const RODS: usize, const NUMBERS: usize>(
        bytes: &'a [u8],
        name: &str,
        memory: &'a mut ParticleMemory<D, EDGES, RODS, NUMBERS>,
        h: f32,
    ) -> Result<Self, ModelError> {
        let step = TrainedStep { order: Order::Four, h, control: C::KIND }.checked()?;
        let model = GraphModel::load(bytes, name, &mut memory.edges, &mut memory.rods)?;
        Self::over(model, step, &mut memory.numbers)
    }

    fn over(
        model: GraphModel<'a, D, K, H, L, W>,
        step: TrainedStep,
        numbers: &'a mut [f32],
    ) -> Result<Self, ModelError> {
        step.check_control(C::KIND)?;
        let drive = Drive::new(A::load(&model.sections, step.h)?)?;
        let mechanism = model.system.constrained().map_err(refused)?;
        let nodes = Particles::<f32, D>::nodes(mechanism.system());
        let (rods, band) = (mechanism.equations(), mechanism.band());
        if nodes * D != N {
            return Err(ModelError::Graph(GraphError::Coordinates { found: nodes * D, compiled: N }));
        }
        let of_state = ParticleState::<f32, D>::workspace(nodes, rods);
        let (found, compiled) = (of_state + Rattle::workspace(&mechanism), numbers.len());
        let short = ModelError::Shape { what: "numbers of memory", found, compiled };
        let (state, workspace) = numbers.split_at_mut_checked(of_state).ok_or(short)?;
        if workspace.len() + of_state < found {
            return Err(short);
        }
        let state = ParticleState::unknown(&mechanism, state).map_err(refused)?;
        Ok(Self { model, band, rattle: Rattle::new(step.h, step.order), drive, state, workspace })
    }

    /// Starts at positions q (m), which satisfy the rods, with velocities v (m/s). Delayed and lagging commands stay in
    /// memory.
    ///
    /// # Errors
    /// See [`ParticleState::new`]; the stepper is then unchanged.
    pub fn start(&mut self, q: [f32; N], v: [f32; N]) -> Result<(), ConstraintError<f32>> {
        let mechanism = mechanism(&self.model.system, self.band);
        self.state.restart(&mechanism, [&q, &v].map(|x| x.as_chunks().0), self.workspace)
    }

    /// Starts at the second of two positions one step apart (m); `u` is the command of that step, as in [`ParticleStepper::step`]. No
    /// velocity is needed.
    ///
    /// # Errors
    /// See [`Rattle::start`]; the stepper is then no longer started, and keeps its commands.
    pub fn start_from(&mut self, positions: [[f32; N]; 2], u: [f32; N]) -> Result<(), ConstraintError<f32>> {
        let (force, after) = self.drive.advanced(&u)?;
        let mechanism = mechanism(&self.model.system, self.band);
        let (force, [q0, q1]) = (mean(&force), &positions);
        let between = [q0, q1].map(|q| q.as_chunks().0);
        let found = self.rattle.restart(
            &mechanism,
            between,
            Some(force.as_chunks().0),
            &mut self.state,
            self.workspace,
        );
        found.inspect_err(|_| self.state.forget())?;
        self.drive.advance(u, after);
        Ok(())
    }

    /// Takes a command without a step, like [`Stepper::commanded`](super::Stepper::commanded).
    ///
    /// # Errors
    /// [`ConstraintError::NotFinite`] if the force of the command is not finite.
    pub fn commanded(&mut self, u: [f32; N]) -> Result<(), ConstraintError<f32>> {
        let (_, after) = self.drive.advanced(&u)?;
        self.drive.advance(u, after);
        Ok(())
    }

    /// Takes one step under the command `u`, N, of every coordinate.
    ///
    /// # Errors
    /// See [`Rattle::step`]; the stepper is then unchanged.
    pub fn step(&mut self, u: [f32; N]) -> Result<Report<f32>, ConstraintError<f32>> {
        let (force, after) = self.drive.advanced(&u)?;
        let mechanism = mechanism(&self.model.system, self.band);
        let force = mean(&force);
        let report =
            self.rattle.step(&mechanism, &mut self.state, Some(force.as_chunks().0), self.workspace)?;
        self.drive.advance(u, after);
        Ok(report)
    }
}

impl<M, C, const D: usize, const N: usize> ParticleStepper<'_, M, C, D, N> {
    /// Replaces the bounds of Newton's method.
    #[must_use]
    pub fn with_newton(self, newton: Newton<f32>) -> Self {
        Self { rattle: self.rattle.newton(newton), ..self }
    }

    /// Positions q, m.
    pub fn q(&self) -> [f32; N] {
        copied(self.state.q())
    }

    /// Velocities v, m/s.
    pub fn v(&self) -> [f32; N] {
        copied(self.state.v())
    }

    /// Momenta p, kg m/s.
    pub fn p(&self) -> [f32; N] {
        copied(self.state.p())
    }

    /// Step size h, s.
    pub const fn h(&self) -> f32 {
        self.rattle.h()
    }

    /// The model: energies, the range of its training data.
    pub const fn model(&self) -> &M {
        &self.model
    }

    /// The state, with the forces of the rods.
    pub const fn state(&self) -> &ParticleState<'_, f32, D> {
        &self.state
    }
}

fn mechanism<
    'm,
    'a,
    W: WeightFormat<Wide = f32>,
    const D: usize,
    const K: usize,
    const H: usize,
    const L: usize,
>(
    system: &'m GraphSystem<'a, D, K, H, L, W>,
    band: usize,
) -> Mechanism<'m, 'a, D, K, H, L, W> {
    Constrained::known(&system.graph, system.rods, band)
}

/// The constant force with the impulse of the control.
#[inline(always)]
fn mean<const N: usize>(control: &Control<f32, N>) -> [f32; N] {
    control.at(0.5)
}

/// Copies vectors to one array, node after node.
fn copied<const D: usize, const N: usize>(vectors: &[[f32; D]]) -> [f32; N] {
    let mut all = [0.0; N];
    all.iter_mut().zip(vectors.as_flattened()).for_each(|(to, from)| *to = *from);
    all
}

/// The error for rods that loading should have refused.
fn refused(_: ConstraintError<f32>) -> ModelError {
    ModelError::OutOfRange { what: "rod" }
}
