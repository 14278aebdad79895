//! The Lagrangian neural network (Cranmer et al., 2020): one network gives L(q, v), whatever its form.

mod lagrangian;

use super::features::count;
use super::network_lagrangian::NetworkLagrangian;
use super::{AccelerationModel, Follow, coordinates_fit};
use lagrangian::{DEPTH, LnnNetwork};
use leastaction::architecture::{Damping, Family, FamilySystem, HostScalar, Visitor};
use leastaction::evaluate::learned::{Forced, Free};
use leastaction::evaluate::prediction::{Prediction, Truth};
use leastaction::training::{Accelerations, Objective, Samples};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::model::ModelError;
use leastaction_core::network::{Dense, Mlp};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Units of a hidden layer at most.
pub const MAX_WIDTH: usize = 600;

/// v̇ = M⁻¹(L_q − L_vq v) with L(q, v) = N(s(q), v), M = L_vv: two hidden softplus layers of one width.
///
/// Nothing makes M positive definite, or regular: where it has no inverse there is no acceleration. The output's bias, one of
/// the weights, is a constant of L that no motion shows; ModLaNet's authors leave it out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lnn {
    coordinates: String,
    width: usize,
}

impl Lnn {
    /// With so many units in each hidden layer; `coordinates` has a letter each, `a` for angles, any other for translations.
    ///
    /// # Errors
    /// [`ModelError::Shape`] where that is more than [`MAX_WIDTH`], or there are more coordinates than are compiled.
    pub fn new(coordinates: &str, width: usize) -> Result<Self, ModelError> {
        let lnn = Self { coordinates: coordinates.to_owned(), width };
        if width > MAX_WIDTH {
            let what = "units in a hidden layer";
            return Err(ModelError::Shape { what, found: width, compiled: MAX_WIDTH });
        }
        match SIZES.contains(&lnn.coordinates.len()) {
            true => Ok(lnn),
            false => lnn.too_many(),
        }
    }

    fn too_many<T>(&self) -> Result<T, ModelError> {
        let compiled = SIZES.iter().copied().max().unwrap_or(0);
        Err(ModelError::Shape { what: "coordinates", found: self.coordinates.len(), compiled })
    }

    /// Numbers in the weight block.
    pub fn parameters(&self) -> usize {
        Mlp::<f64, 0, 0>::parameters(count(&self.coordinates), &[self.width; DEPTH], 1).unwrap_or(0)
    }
}

/// The shape as a family: in any number of coordinates, for the network is the same.
#[derive(Clone)]
struct Compiled(Lnn);

impl<const N: usize> Family<N> for Compiled {
    type Lagrangian<'w, S: HostScalar> = NetworkLagrangian<LnnNetwork<'w, MAX_WIDTH>>;
    type Forces<'w, S: HostScalar> = Damping<S, N>;

    fn system<'w, S: HostScalar>(
        &'w self,
        weights: &'w [f64],
    ) -> Result<FamilySystem<'w, Self, S, N>, ModelError> {
        let (found, compiled) = (weights.len(), self.0.parameters());
        let network = LnnNetwork::new(&self.0.coordinates, self.0.width, weights);
        let network = network.ok_or(ModelError::Shape { what: "weights", found, compiled })?;
        Ok(System { lagrangian: NetworkLagrangian(network), forces: Damping::new(Viscous::none(), &[]) })
    }
}

macro_rules! compiled {
    ($($n:literal),*) => {
        /// Numbers of coordinates that are compiled: those of ModLaNet's table, and 3.
        const SIZES: &[usize] = &[$($n),*];

        impl Lnn {
            fn dispatch<V: Visitor>(&self, visitor: V) -> Result<V::Output, ModelError> {
                match self.coordinates.len() {
                    $($n => Ok(visitor.visit::<_, $n>(&Compiled(self.clone()))),)*
                    _ => self.too_many(),
                }
            }
        }
    };
}

compiled!(2, 3, 6);

impl AccelerationModel for Lnn {
    /// Normal deviates: 2.2/√n₀ from n₀ inputs, 1.16/√n between layers of n units, 1 to the output; biases 0. These are the
    /// variances of ModLaNet's program after Cranmer et al., appendix C (where the output has √n).
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let (mut weights, mut stream) = (Vec::new(), Pcg64::seed_from_u64(seed));
        let (inputs, width) = (count(&self.coordinates), self.width);
        let root = |n: usize| (n as f64).sqrt();
        for (fan_in, outputs, deviation) in
            [(inputs, width, 2.2 / root(inputs)), (width, width, 1.16 / root(width)), (width, 1, 1.0)]
        {
            let mut draw = || -> f64 { StandardNormal.sample(&mut stream) };
            let mut layer = vec![0.0; Dense::<f64>::parameters(fan_in, outputs).unwrap_or(0)];
            layer[..fan_in * outputs].fill_with(|| deviation * draw());
            weights.extend(layer);
        }
        weights
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.coordinates.len())?;
        self.dispatch(Accelerations { parameters: self.parameters(), samples })
    }

    fn predict(&self, weights: &[f64], truth: &Truth, follow: Follow) -> Result<Prediction, ModelError> {
        let then = |f: &Forced| follow.compare(truth, |q, v, out| f(q, v, &[], out));
        self.dispatch(Free { weights, then })?
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
