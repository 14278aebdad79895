//! Models ready for the solvers: a family's system over the weights of a file, with what else the file says.

use super::laws::load_forces;
use super::parse::parse_knowing;
use super::{
    ActuatorBytes, ArmHeader, BodiesHeader, GraphHeader, GraphSystem, InertiaNetworkHeader, Law, LawNumbers,
    Laws, LoadForces, ModelError, ModularHeader, ParsedAs, Sections, ShapeHeader, TrainedStep, TrainingRange,
    TreeHeader,
};
use crate::constraints::Holonomic;
use crate::discrete::rattle::Rattle;
use crate::discrete::{Del, Path};
use crate::energy::arm::ArmBodies;
use crate::energy::bodies::PlanarBodies;
use crate::energy::graph::Edge;
use crate::energy::inertia_network::{InertiaNetwork, InertiaNetworkShape};
use crate::energy::modular::Modular;
use crate::forces::{System, Viscous};
use crate::scalar::{FileWeightFormat, Real, Scalar, WeightFormat};

/// A loaded model: the system, and what the file says of its use.
///
/// Loading validates everything that the program reads, once; evaluation cannot fail afterwards except numerically.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a, M> {
    /// What the solvers step.
    pub system: M,
    /// The step that the model was trained with, where it was.
    pub trained_step: Option<TrainedStep>,
    /// The sections of the file.
    pub sections: Sections<'a>,
    /// Whether the range of the training data is that of this system: of several trees or graphs, of the first.
    covered: bool,
}

/// An inertia network in N coordinates with at most `L` hidden layers of at most `H` units.
///
/// `W` is how the file stores its weights: `f32`, or [`struct@f16`](crate::scalar::f16) in half the flash. `F` are the laws of
/// force that the program is compiled for.
pub type InertiaNetworkModel<
    'a,
    const N: usize,
    const H: usize,
    const L: usize,
    W = f32,
    F = Viscous<f32, N>,
> = Model<'a, System<InertiaNetwork<'a, W, N, H, L>, F>>;

/// A tree of elements in N coordinates: at most `E` element types, networks of at most `L` hidden layers of at most `H` units.
///
/// `W` and `F` as of a [`InertiaNetworkModel`].
pub type ModularModel<
    'a,
    const N: usize,
    const E: usize,
    const H: usize,
    const L: usize,
    W = f32,
    F = Viscous<f32, N>,
> = Model<'a, System<Modular<'a, W, N, E, H, L>, F>>;

/// A graph in `D` dimensions with its rods: at most `K` networks of at most `L` hidden layers of at most `H` units.
///
/// `W` as of a [`InertiaNetworkModel`].
pub type GraphModel<'a, const D: usize, const K: usize, const H: usize, const L: usize, W = f32> =
    Model<'a, GraphSystem<'a, D, K, H, L, W>>;

/// A tree of N rigid bodies on joints in the plane.
///
/// `W` and `F` as of a [`InertiaNetworkModel`].
pub type BodiesModel<'a, const N: usize, W = f32, F = Viscous<f32, N>> =
    Model<'a, System<PlanarBodies<'a, W, N>, F>>;

/// A tree of N rigid bodies on joints in space.
///
/// `W` and `F` as of a [`InertiaNetworkModel`].
pub type ArmModel<'a, const N: usize, W = f32, F = Viscous<f32, N>> =
    Model<'a, System<ArmBodies<'a, W, N>, F>>;

impl<'a, M> Model<'a, M> {
    /// The one way to load: the file, then the system that a family makes of it, and whether that is the first of the file.
    fn read<H: ShapeHeader<'a>, W: FileWeightFormat>(
        bytes: &'a [u8],
        knows: impl Fn(Law) -> bool,
        system: impl FnOnce(&ParsedAs<'a, H, W>) -> Result<(M, bool), ModelError>,
    ) -> Result<Self, ModelError> {
        let parsed = parse_knowing::<H, W>(bytes, knows)?;
        let (system, covered) = system(&parsed)?;
        let ParsedAs { trained_step, sections, .. } = parsed;
        Ok(Self { system, trained_step, sections, covered })
    }

    /// A model that is constants of the program: there is no file that says more of it.
    pub const fn constant(system: M, trained_step: Option<TrainedStep>) -> Self {
        Self { system, trained_step, sections: Sections::NONE, covered: false }
    }

    /// The same file with another system, made of this one.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn try_map<T, E>(self, make: impl FnOnce(M) -> Result<T, E>) -> Result<Model<'a, T>, E> {
        let Self { system, trained_step, sections, covered } = self;
        Ok(Model { system: make(system)?, trained_step, sections, covered })
    }

    /// The step that the model was trained with.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] where it was trained for none.
    pub fn step(&self) -> Result<TrainedStep, ModelError> {
        self.trained_step.ok_or(ModelError::NoStep)
    }

    /// The integrator that the model was trained with, along paths of type `P`.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] where it was trained for none, [`ModelError::Order`] where `P` has another order.
    pub fn del<R: Real, P: Path>(&self) -> Result<Del<R, P>, ModelError> {
        self.step()?.del()
    }

    /// Between command and force; `None`: the command is the force.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] where a number is.
    pub fn actuator(&self) -> Result<Option<ActuatorBytes<'a>>, ModelError> {
        self.sections.actuator()
    }

    /// What the training data of this system covered, where the file says it.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] where a number is.
    pub fn range(&self) -> Result<Option<TrainingRange<'a>>, ModelError> {
        if self.covered { self.sections.range() } else { Ok(None) }
    }
}

impl<'a, const N: usize, const H: usize, const L: usize, W: FileWeightFormat, F: LoadForces<'a, W, f32, N>>
    InertiaNetworkModel<'a, N, H, L, W, F>
{
    /// Reads, validates and borrows a model file; `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn load(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Self::read(bytes, F::knows, |parsed: &ParsedAs<InertiaNetworkHeader, W>| {
            Ok((parsed.shape.system(parsed.laws, parsed.weights)?, true))
        })
    }
}

impl<
    'a,
    const N: usize,
    const E: usize,
    const H: usize,
    const L: usize,
    W: FileWeightFormat,
    F: LoadForces<'a, W, f32, N>,
> ModularModel<'a, N, E, H, L, W, F>
{
    /// Reads, validates and borrows a model file, and takes the tree called `name`; `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn load(bytes: &'a [u8], name: &str) -> Result<Self, ModelError> {
        Self::read(bytes, F::knows, |parsed: &ParsedAs<ModularHeader, W>| {
            let tree = parsed.shape.tree(name)?;
            let first = parsed.shape.trees().next().is_some_and(|first| first.name == name);
            Ok((parsed.shape.system(tree, parsed.laws, parsed.weights)?, first))
        })
    }
}

impl<'a, const N: usize, W: FileWeightFormat, F: LoadForces<'a, W, f32, N>> BodiesModel<'a, N, W, F> {
    /// Reads, validates and borrows a model file; `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn load(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Self::read(bytes, F::knows, |parsed: &ParsedAs<BodiesHeader, W>| {
            Ok((parsed.shape.system(parsed.laws, parsed.weights)?, true))
        })
    }
}

impl<'a, const N: usize, W: FileWeightFormat, F: LoadForces<'a, W, f32, N>> ArmModel<'a, N, W, F> {
    /// Reads, validates and borrows a model file; `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn load(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Self::read(bytes, F::knows, |parsed: &ParsedAs<ArmHeader, W>| {
            Ok((parsed.shape.system(parsed.laws, parsed.weights)?, true))
        })
    }
}

impl<'a, const D: usize, const K: usize, const H: usize, const L: usize, W: FileWeightFormat>
    GraphModel<'a, D, K, H, L, W>
{
    /// Reads, validates and borrows a model file, and takes the graph called `name`, whose edges and rods are read into `edges`
    /// and `rods`; `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`]; [`GraphError::TooManyEdges`](crate::energy::graph::GraphError) and `TooManyRods` where a list is too
    /// short.
    pub fn load(
        bytes: &'a [u8],
        name: &str,
        edges: &'a mut [Edge],
        rods: &'a mut [Holonomic<f32, D>],
    ) -> Result<Self, ModelError> {
        Self::read(
            bytes,
            |_| false,
            |parsed: &ParsedAs<GraphHeader, W>| {
                let header = parsed.shape;
                // Graphs have their drag in their node types, and no other law yet.
                LawNumbers::new(parsed.laws, parsed.weights, 0).finish()?;
                let layout = header.layout(name)?;
                let first = header.graphs().next().is_some_and(|first| first.name == name);
                let graph = header.graph(layout, parsed.weights, edges)?;
                Ok((GraphSystem { graph, rods: layout.constraints(rods)? }, first))
            },
        )
    }

    /// RATTLE with the step and the order that the model was trained with.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] where it was trained for none.
    pub fn rattle<R: Real>(&self) -> Result<Rattle<R>, ModelError> {
        let step = self.step()?;
        Ok(Rattle::new(R::constant(step.h.into()), step.order))
    }
}

impl InertiaNetworkHeader<'_> {
    /// The system of this shape and these laws over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in
    /// training.
    ///
    /// # Errors
    /// [`ModelError`] where the block or the compiled sizes do not fit, or the program has not all laws.
    pub fn system<'w, W, S, F, const N: usize, const H: usize, const L: usize>(
        &self,
        laws: Laws,
        weights: &'w [W],
    ) -> Result<System<InertiaNetwork<'w, W, N, H, L>, F>, ModelError>
    where
        W: WeightFormat,
        S: Scalar<Weight = W::Wide>,
        F: LoadForces<'w, W, S, N>,
    {
        let shape = InertiaNetworkShape {
            coordinates: self.kinds()?,
            network: self.network()?,
            inertia: self.inertia,
        };
        shape.check_size::<H, L>()?;
        let mut block = weights;
        let needed = self.parameters()?;
        let lagrangian = InertiaNetwork::take(&mut block, &shape)
            .ok_or(ModelError::WeightCount { found: weights.len(), needed })?;
        Ok(System { lagrangian, forces: forces_of_coordinates(laws, block)? })
    }
}

impl BodiesHeader<'_> {
    /// The system of this tree and these laws over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in
    /// training.
    ///
    /// # Errors
    /// [`ModelError`] where the block or the compiled number of bodies does not fit, or the program has not all laws.
    pub fn system<'w, W, S, F, const N: usize>(
        &self,
        laws: Laws,
        weights: &'w [W],
    ) -> Result<System<PlanarBodies<'w, W, N>, F>, ModelError>
    where
        W: WeightFormat,
        S: Scalar<Weight = W::Wide>,
        F: LoadForces<'w, W, S, N>,
    {
        let (tree, needed, mut block) = (self.tree()?, self.parameters()?, weights);
        let lagrangian = PlanarBodies::take(&mut block, tree)
            .ok_or(ModelError::WeightCount { found: weights.len(), needed })?;
        Ok(System { lagrangian, forces: forces_of_coordinates(laws, block)? })
    }
}

impl ArmHeader<'_> {
    /// The system of this tree and these laws over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in
    /// training.
    ///
    /// # Errors
    /// [`ModelError`] where the block or the compiled number of bodies does not fit, or the program has not all laws.
    pub fn system<'w, W, S, F, const N: usize>(
        &self,
        laws: Laws,
        weights: &'w [W],
    ) -> Result<System<ArmBodies<'w, W, N>, F>, ModelError>
    where
        W: WeightFormat,
        S: Scalar<Weight = W::Wide>,
        F: LoadForces<'w, W, S, N>,
    {
        let (tree, needed, mut block) = (self.tree()?, self.parameters()?, weights);
        let lagrangian = ArmBodies::take(&mut block, tree)
            .ok_or(ModelError::WeightCount { found: weights.len(), needed })?;
        Ok(System { lagrangian, forces: forces_of_coordinates(laws, block)? })
    }
}

/// The forces of a file's laws where a coordinate is a group of its own.
fn forces_of_coordinates<'w, W, S, F, const N: usize>(laws: Laws, numbers: &'w [W]) -> Result<F, ModelError>
where
    W: WeightFormat<Wide = S::Weight>,
    S: Scalar,
    F: LoadForces<'w, W, S, N>,
{
    load_forces(LawNumbers::new(laws, numbers, N), &core::array::from_fn(|i| i as u8))
}

impl ModularHeader<'_> {
    /// The system of a tree and these laws over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in
    /// training.
    ///
    /// # Errors
    /// [`ModelError`] where the block or the compiled sizes do not fit, or the program has not all laws.
    pub fn system<'w, W, S, F, const N: usize, const E: usize, const H: usize, const L: usize>(
        &self,
        tree: &TreeHeader,
        laws: Laws,
        weights: &'w [W],
    ) -> Result<System<Modular<'w, W, N, E, H, L>, F>, ModelError>
    where
        W: WeightFormat,
        S: Scalar<Weight = W::Wide>,
        F: LoadForces<'w, W, S, N>,
    {
        self.shape.check_size::<E, H, L>()?;
        let tree = self.shape.tree(tree.nodes()).map_err(ModelError::Tree)?;
        let mut block = weights;
        let needed = self.parameters()?;
        let lagrangian = Modular::take(&mut block, &self.shape, tree)
            .ok_or(ModelError::WeightCount { found: weights.len(), needed })?;
        // Coordinates of elements of one type are a group.
        let groups = tree.kinds();
        let forces = load_forces(LawNumbers::new(laws, block, self.groups()), &groups)?;
        Ok(System { lagrangian, forces })
    }
}
