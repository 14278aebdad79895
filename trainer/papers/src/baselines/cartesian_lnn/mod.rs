//! The Lagrangian network in Cartesian coordinates with explicit constraints (Finzi et al., 2020), as LGNN's authors compare
//! with it.

mod lagrangian;

use super::{AccelerationModel, Follow, coordinates_fit};
use lagrangian::{Cartesian, DEPTH, MAX_WIDTH};
use leastaction::architecture::{
    Constraint, Damping, Family, FamilySystem, HostScalar, NamedGraph, Visitor, random_layers,
};
use leastaction::evaluate::particles::Driven;
use leastaction::evaluate::prediction::{Prediction, Truth};
use leastaction::training::{Accelerations, Objective, Samples};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::model::ModelError;

/// k at the start, kg: that of 1 kg.
const HALF: f64 = 0.5;

/// M v̇ = −V_q + Aᵀλ, A v̇ = −Ȧv: L = Σ k_i |v_i|² − V(q) of nodes in the plane, with two hidden squareplus layers between all
/// positions and V, and known rods.
///
/// LGNN's program has 256 units a layer. Every k_i is learned, from ½ kg on, so that L is known but for its scale; other weights
/// start uniform with Glorot's variance. V is of one number of nodes: nothing carries over to another.
#[derive(Clone, Debug, PartialEq)]
pub struct CartesianLnn {
    graph: NamedGraph,
    width: usize,
}

impl CartesianLnn {
    /// On the nodes and rods of a graph, with so many units in each hidden layer; its edges are not seen.
    ///
    /// # Errors
    /// [`ModelError::Shape`] where that is more than 256, or another number of nodes than is compiled.
    pub fn new(graph: NamedGraph, width: usize) -> Result<Self, ModelError> {
        let lnn = Self { graph, width };
        if width > MAX_WIDTH {
            let what = "units in a hidden layer";
            return Err(ModelError::Shape { what, found: width, compiled: MAX_WIDTH });
        }
        if SIZES.contains(&lnn.n()) { Ok(lnn) } else { lnn.not_compiled() }
    }

    fn not_compiled<T>(&self) -> Result<T, ModelError> {
        let compiled = SIZES.iter().copied().max().unwrap_or(0);
        Err(ModelError::Shape { what: "coordinates", found: self.n(), compiled })
    }

    /// Coordinates.
    fn n(&self) -> usize {
        2 * self.graph.nodes.len()
    }

    /// Numbers in the weight block: every k, then V.
    pub fn parameters(&self) -> usize {
        let layers = self.layers().map(|(inputs, outputs)| (inputs + 1) * outputs);
        self.graph.nodes.len() + layers.iter().sum::<usize>()
    }

    /// Inputs and outputs of every layer of V, first to last.
    fn layers(&self) -> [(usize, usize); DEPTH + 1] {
        [(self.n(), self.width), (self.width, self.width), (self.width, 1)]
    }

    /// Writes v̇(q, v), m/s²; `None` where the weights or a slice are too short, or there is none.
    pub fn acceleration(&self, weights: &[f64], q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()> {
        let cartesian = self.cartesian(weights).ok()?;
        let rods = self.graph.constraints();
        Driven::new(&cartesian, &rods).ok()?.acceleration(q, v, &[], out)
    }

    fn cartesian<'w>(&self, weights: &'w [f64]) -> Result<Cartesian<'w>, ModelError> {
        let short = ModelError::Shape { what: "weights", found: weights.len(), compiled: self.parameters() };
        Cartesian::take(self.graph.nodes.len(), self.width, weights).ok_or(short)
    }
}

/// The shape as a family.
#[derive(Clone)]
struct Compiled(CartesianLnn);

impl<const N: usize> Family<N> for Compiled {
    type Lagrangian<'w, S: HostScalar> = Cartesian<'w>;
    type Forces<'w, S: HostScalar> = Damping<S, N>;

    fn system<'w, S: HostScalar>(
        &'w self,
        weights: &'w [f64],
    ) -> Result<FamilySystem<'w, Self, S, N>, ModelError> {
        let lagrangian = self.0.cartesian(weights)?;
        Ok(System { lagrangian, forces: Damping::new(Viscous::none(), &[]) })
    }

    fn constraints(&self, q: &[f64; N]) -> Vec<Constraint<N>> {
        self.0.graph.rods.iter().map(|rod| Constraint::of_rod(rod, q.as_chunks::<2>().0)).collect()
    }
}

macro_rules! compiled {
    ($($n:literal),*) => {
        /// Numbers of coordinates that are compiled: that of LGNN's three pendulums, and 4.
        const SIZES: &[usize] = &[$($n),*];

        impl CartesianLnn {
            fn dispatch<V: Visitor>(&self, visitor: V) -> Result<V::Output, ModelError> {
                match self.n() {
                    $($n => Ok(visitor.visit::<_, $n>(&Compiled(self.clone()))),)*
                    _ => self.not_compiled(),
                }
            }
        }
    };
}

compiled!(4, 6);

impl AccelerationModel for CartesianLnn {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut weights = vec![HALF; self.graph.nodes.len()];
        weights.extend(random_layers(self.layers(), seed));
        weights
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.n())?;
        self.dispatch(Accelerations { parameters: self.parameters(), samples })
    }

    fn predict(&self, weights: &[f64], truth: &Truth, follow: Follow) -> Result<Prediction, ModelError> {
        self.cartesian(weights)?;
        Ok(follow.compare(truth, |q, v, out| self.acceleration(weights, q, v, out)))
    }
}

#[cfg(test)]
mod tests;
