//! Graphs of any size behind the slice interfaces.

use crate::coordinates::Beginning;
use crate::{Control, Evaluator, LAYERS, Motion, ReplicaError, Step, UNITS};
use leastaction_core::constraints::{Constrained, ConstraintError, Holonomic};
use leastaction_core::continuous::{
    Baumgarte, Drive, constrained_acceleration, constrained_inverse_dynamics, constrained_workspace,
};
use leastaction_core::discrete::Report;
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::energy::graph::{Edge, Graph, MAX_NETWORKS, Types};
use leastaction_core::lagrangian::Energies;
use leastaction_core::model::ModelError;
use leastaction_core::particles::Particles;

/// Rods in D dimensions.
pub(crate) type RodsOf<const D: usize> = Vec<Holonomic<f32, D>>;

/// Types of a file.
type TypesOf<'f, const D: usize> = Types<'f, f32, D, MAX_NETWORKS, UNITS, LAYERS>;

/// Graph of a file.
type GraphOf<'f, const D: usize> = Graph<'f, f32, D, MAX_NETWORKS, UNITS, LAYERS>;

/// A graph with its rods, which are stored in a separate list.
type OnRods<'c, const D: usize> = Constrained<'c, f32, GraphOf<'c, D>, [Holonomic<f32, D>], D>;

/// A graph of any size in D dimensions, with its rods.
pub struct ParticleSystem<'f, const D: usize> {
    /// Energies and drag, over the file's weights.
    pub graph: GraphOf<'f, D>,
    /// Rods of the graph.
    pub rods: &'f [Holonomic<f32, D>],
}

impl<'f, const D: usize> ParticleSystem<'f, D> {
    pub(crate) fn new(
        types: TypesOf<'f, D>,
        (nodes, edges): (&'f [u8], &'f [Edge]),
        rods: &'f [Holonomic<f32, D>],
    ) -> Result<Self, ModelError> {
        Ok(Self { graph: Graph::new(types, nodes, edges).map_err(ModelError::Graph)?, rods })
    }

    /// Number of coordinates.
    pub fn n(&self) -> usize {
        D * self.graph.nodes().len()
    }

    /// Returns the constrained system that the solvers of core step.
    ///
    /// # Errors
    /// See [`ConstraintError`]; none for a file that was read.
    pub fn constrained(&self) -> Result<OnRods<'_, D>, ConstraintError<f32>> {
        Constrained::new(&self.graph, self.rods)
    }

    /// Vectors of all nodes.
    fn vectors<'x>(&self, what: &'static str, x: &'x [f32]) -> Result<&'x [[f32; D]], ReplicaError> {
        ReplicaError::check_length(what, self.n(), x.len())?;
        Ok(x.as_chunks().0)
    }

    fn vectors_mut<'x>(
        &self,
        what: &'static str,
        x: &'x mut [f32],
    ) -> Result<&'x mut [[f32; D]], ReplicaError> {
        ReplicaError::check_length(what, self.n(), x.len())?;
        Ok(x.as_chunks_mut().0)
    }
}

/// A graph and its rods with a workspace.
pub(crate) struct ParticleEvaluator<'c, const D: usize> {
    particles: &'c ParticleSystem<'c, D>,
    on_rods: OnRods<'c, D>,
    workspace: Vec<f32>,
    /// Multiplier λ of each rod.
    lambda: Vec<f32>,
}

impl<'c, const D: usize> ParticleEvaluator<'c, D> {
    pub fn new(particles: &'c ParticleSystem<'c, D>) -> Result<Self, ReplicaError> {
        let on_rods = particles.constrained()?;
        let workspace = vec![0.0; constrained_workspace(&on_rods)];
        Ok(Self { particles, on_rods, workspace, lambda: vec![0.0; particles.rods.len()] })
    }
}

impl<const D: usize> Evaluator for ParticleEvaluator<'_, D> {
    fn energies(&mut self, q: &[f32], v: &[f32]) -> Result<Energies<f32>, ReplicaError> {
        let (q, v) = (self.particles.vectors("q", q)?, self.particles.vectors("v", v)?);
        Ok(self.particles.graph.energies(q, v, &mut self.workspace))
    }

    fn acceleration(
        &mut self,
        q: &[f32],
        v: &[f32],
        tau: &[f32],
        to: &mut [f32],
    ) -> Result<(), ReplicaError> {
        let of = self.particles;
        let (q, v, force) = (of.vectors("q", q)?, of.vectors("v", v)?, Some(of.vectors("tau", tau)?));
        let to = (of.vectors_mut("the acceleration", to)?, self.lambda.as_mut_slice());
        let drive = Drive { force, baumgarte: Baumgarte::none() };
        Ok(constrained_acceleration(&self.on_rods, (q, v), &drive, &mut self.workspace, to)?)
    }

    fn inverse_dynamics(
        &mut self,
        q: &[f32],
        v: &[f32],
        a: &[f32],
        to: &mut [f32],
    ) -> Result<(), ReplicaError> {
        let of = self.particles;
        let state = [of.vectors("q", q)?, of.vectors("v", v)?, of.vectors("a", a)?];
        let to = of.vectors_mut("the force", to)?;
        Ok(constrained_inverse_dynamics(&self.on_rods, state, &mut self.workspace, to)?)
    }

    fn mass_matrix(&mut self, q: &[f32], to: &mut [f32]) -> Result<(), ReplicaError> {
        let (of, n) = (self.particles, self.particles.n());
        let _only_its_length = of.vectors("q", q)?;
        ReplicaError::check_length("the mass matrix", n * n, to.len())?;
        to.fill(0.0);
        for node in 0..n / D {
            let mass = of.graph.mass(node, &[0.0; D]);
            for (i, row) in mass.iter().enumerate() {
                let place = (node * D + i) * n + node * D;
                to[place..place + D].copy_from_slice(row);
            }
        }
        Ok(())
    }
}

/// A state of particles with RATTLE.
pub(crate) struct ParticleMotion<'c, const D: usize> {
    particles: &'c ParticleSystem<'c, D>,
    on_rods: OnRods<'c, D>,
    rattle: Rattle<f32>,
    /// State as written by [`ParticleState::save`]: q and its carry, p and its carry, v, and further numbers.
    saved: Vec<f32>,
    memory: Vec<f32>,
    workspace: Vec<f32>,
    /// Mean of the control.
    force: Vec<f32>,
}

impl<'c, const D: usize> ParticleMotion<'c, D> {
    pub fn new(
        particles: &'c ParticleSystem<'c, D>,
        step: Step,
        beginning: Beginning,
    ) -> Result<Self, ReplicaError> {
        let on_rods = particles.constrained()?;
        let (nodes, rods) = (particles.graph.nodes().len(), particles.rods.len());
        let mut motion = Self {
            particles,
            rattle: Rattle::new(step.h, step.order),
            saved: vec![0.0; ParticleState::<f32, D>::saved(nodes, rods)],
            memory: vec![0.0; ParticleState::<f32, D>::workspace(nodes, rods)],
            workspace: vec![0.0; Rattle::workspace(&on_rods)],
            force: vec![0.0; particles.n()],
            on_rods,
        };
        motion.begin(beginning)?;
        Ok(motion)
    }

    fn begin(&mut self, beginning: Beginning) -> Result<(), ReplicaError> {
        if let Beginning::Between { control, .. } = beginning {
            self.act(control)?;
        }
        let Self { particles, on_rods, rattle, saved, memory, workspace, force } = self;
        let state = match beginning {
            Beginning::At { q, v } => {
                let (q, v) = (particles.vectors("q", q)?, particles.vectors("v", v)?);
                ParticleState::new(on_rods, q, v, memory, workspace)?
            }
            Beginning::Between { q: [q0, q1], .. } => {
                let q = [particles.vectors("q", q0)?, particles.vectors("q", q1)?];
                rattle.start(on_rods, q, Some(force.as_chunks().0), memory, workspace)?
            }
            Beginning::Resumed(numbers) => ParticleState::resume(on_rods, numbers, memory)?,
        };
        Ok(state.save(saved)?)
    }

    /// Sets the force to the mean of a control.
    fn act(&mut self, Control { start, end }: Control) -> Result<(), ReplicaError> {
        for x in [start, end] {
            ReplicaError::check_length("tau", self.force.len(), x.len())?;
        }
        for ((force, start), end) in self.force.iter_mut().zip(start).zip(end) {
            // For a held control this is exactly its value.
            *force = 0.5 * start + 0.5 * end;
        }
        Ok(())
    }

    /// Vectors at position k of the saved state.
    fn saved(&self, k: usize) -> &[f32] {
        let n = self.particles.n();
        self.saved.get(k * n..(k + 1) * n).unwrap_or_default()
    }
}

impl<const D: usize> Motion for ParticleMotion<'_, D> {
    fn q(&self) -> &[f32] {
        self.saved(0)
    }

    fn p(&self) -> &[f32] {
        self.saved(2)
    }

    fn velocity(&self, to: &mut [f32]) -> Result<(), ReplicaError> {
        crate::control::write("the velocity", self.saved(4), to)
    }

    fn saved(&self) -> Vec<f32> {
        self.saved.clone()
    }

    fn step(&mut self, control: Control) -> Result<Report<f32>, ReplicaError> {
        self.act(control)?;
        let Self { on_rods, rattle, saved, memory, workspace, force, .. } = self;
        let mut state = ParticleState::resume(on_rods, saved, memory)?;
        let report = rattle.step(on_rods, &mut state, Some(force.as_chunks().0), workspace)?;
        state.save(saved)?;
        Ok(report)
    }
}
