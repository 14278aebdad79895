//! What a model costs on a chip, by its shape: multiply-adds, flash, RAM and stack.

use crate::architecture::{Architecture, Visitor};
use leastaction_core::discrete::{Galerkin, Linearised, Midpoint, Path, Solved, State};
use leastaction_core::forces::Viscous;
use leastaction_core::model::ModelError;
use leastaction_core::network::{Jet, Tape};
use serde::Serialize;

/// Work and memory of one evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Work {
    /// Multiply-adds in the layers of the network; activations, features and small matrices come on top.
    pub multiply_adds: usize,
    /// Bytes of the arrays that are live at once on the stack; call frames and spilled registers come on top.
    pub stack_bytes: usize,
}

/// Work and memory of a model on a 32-bit chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Cost {
    /// Bytes of the state that a program keeps between steps.
    pub state_bytes: usize,
    /// Bytes of the loaded model beside its weights, which stay in flash.
    pub handle_bytes: usize,
    /// One acceleration.
    pub acceleration: Work,
    /// One Newton iteration of a step of order 2.
    pub newton_order_2: Work,
    /// One Newton iteration of a step of order 4.
    pub newton_order_4: Work,
}

/// The cost of models of this shape.
///
/// # Errors
/// Where the shape is beyond what is compiled.
pub fn cost(architecture: &Architecture) -> Result<Cost, ModelError> {
    architecture.dispatch(Count { architecture })
}

struct Count<'a> {
    architecture: &'a Architecture,
}

impl Visitor for Count<'_> {
    type Output = Cost;

    fn visit<const N: usize, const H: usize>(self) -> Cost {
        Cost {
            state_bytes: size_of::<State<f32, N>>(),
            handle_bytes: self.handle_bytes::<N>(),
            acceleration: self.acceleration::<N>(),
            newton_order_2: self.newton::<Midpoint, N>(),
            newton_order_4: self.newton::<Galerkin, N>(),
        }
    }
}

impl Count<'_> {
    /// Weights that are multiplied in one pass: all but the biases.
    fn weights(&self) -> usize {
        self.architecture.layers().iter().map(|(inputs, outputs)| inputs * outputs).sum()
    }

    /// Up to two coordinates a forward pass with N tangents; beyond, one with a single tangent and a plain adjoint.
    fn acceleration<const N: usize>(&self) -> Work {
        if N <= 2 {
            let units = size_of::<Jet<f32, N>>() * self.widest() * self.architecture.widths.len();
            Work { multiply_adds: (1 + N) * self.weights(), stack_bytes: units + ends::<N, N>() }
        } else {
            Work { multiply_adds: 3 * self.weights(), stack_bytes: self.tape::<1>() + ends::<1, N>() }
        }
    }

    /// At every Gauss point the second derivatives (a forward pass with N tangents and a plain adjoint) and, for the
    /// residual after the update, the first derivatives once more (a forward pass and an adjoint).
    fn newton<P: Path, const N: usize>(&self) -> Work {
        let nodes = P::nodes::<f32>().as_ref().len();
        let sums =
            size_of::<Linearised<f32, N>>() + size_of::<Solved<f32, P, N>>() + size_of::<State<f32, N>>();
        Work {
            multiply_adds: nodes * ((1 + N) + 1 + 2) * self.weights(),
            stack_bytes: self.tape::<N>() + ends::<N, N>() + sums,
        }
    }

    fn widest(&self) -> usize {
        self.architecture.widths.iter().copied().max().map_or(0, usize::from)
    }

    /// The tape of a forward pass with T tangents and two layers of a plain adjoint.
    fn tape<const T: usize>(&self) -> usize {
        let tape = size_of::<Tape<f32, T, 1, 1>>() * self.widest() * self.architecture.widths.len();
        tape + 2 * self.widest() * size_of::<Jet<f32, 0>>()
    }

    /// Two slices and a length a layer, the kinds of coordinates, the inertia, the damping and the step.
    fn handle_bytes<const N: usize>(&self) -> usize {
        const WORD: usize = 4;
        let layers = self.architecture.layers().len();
        layers * 5 * WORD + N.next_multiple_of(WORD) + size_of::<Viscous<f32, N>>() + 5 * WORD
    }
}

/// Inputs and outputs of the network.
fn ends<const T: usize, const N: usize>() -> usize {
    2 * size_of::<[[[Jet<f32, T>; N]; N]; 2]>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::energy::rigid::Coordinate;
    use leastaction_core::model::RigidModel;

    fn cartpole(width: u16) -> Architecture {
        Architecture::new(&[Coordinate::Translation, Coordinate::Angle], width)
    }

    #[test]
    fn the_cart_pole_of_the_paper_by_hand() {
        let cost = cost(&cartpole(24)).unwrap();
        let weights = 3 * 24 + 24 * 24 + 24 * 4;
        assert_eq!(cost.acceleration.multiply_adds, 3 * weights);
        assert_eq!(cost.newton_order_2.multiply_adds, 6 * weights);
        assert_eq!(cost.newton_order_4.multiply_adds, 12 * weights);
    }

    #[test]
    fn the_tape_is_that_of_the_compiled_sizes() {
        let tape = size_of::<Tape<f32, 2, 24, 2>>();
        let adjoint = size_of::<[[Jet<f32, 0>; 24]; 2]>();
        let stack = cost(&cartpole(24)).unwrap().newton_order_2.stack_bytes;
        assert!((tape + adjoint..tape + adjoint + 1024).contains(&stack), "{stack}");
    }

    #[test]
    #[cfg(target_pointer_width = "64")]
    fn the_handle_is_about_half_of_that_on_a_64_bit_host() {
        let here = size_of::<RigidModel<2, 24, 2>>() / 2;
        let there = cost(&cartpole(24)).unwrap().handle_bytes;
        assert!(there.abs_diff(here) <= 16, "{there} against {here}");
    }
}
