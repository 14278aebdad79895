//! Pendulums in a chain, all of one learned type: position 2 → 16 → 16 → 2 with its exact velocity, potential 2 → 16 → 16 → 1.

use crate::cases::{Plain, Point};
use leastaction_core::energy::modular::{
    ELEMENT_PARAMETERS, Input, Modular, ModularShape, NetworkShape, TransformShape, TreeElement, TypeShape,
};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::network::Activation;
use leastaction_core::scalar::{Real, Scalar};

/// The step, s.
pub const STEP: f64 = 0.01;

pub type Pendulums<'a, S, const N: usize> =
    System<Modular<'a, <S as Scalar>::Weight, N, 1, 16, 2>, Viscous<S, N>>;

/// Weights that serve a chain of any length.
pub struct Links<W> {
    block: Vec<W>,
}

impl<W: Plain> Links<W> {
    /// Weights uniform in ±0.5, a link of 1 kg and 0.1 kg m², gravity.
    pub fn new() -> Self {
        let length = shape().parameters().expect("small networks") - ELEMENT_PARAMETERS - 2;
        let mut bits = 1_u32;
        let mut next = || {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(bits) / f64::from(u32::MAX) - 0.5
        };
        let networks: Vec<f64> = (0..length).map(|_| next()).collect();
        let numbers = [1.0, 0.1, 1.0, 1.0, 0.0, 9.81, 0.0];
        Self { block: networks.into_iter().chain(numbers).map(W::constant).collect() }
    }

    /// N links with these weights, in their scalar or another.
    pub fn system<S: Real<Weight = W>, const N: usize>(&self) -> Pendulums<'_, S, N> {
        let nodes = (0..N as u8).map(|e| TreeElement { kind: 0, parent: e.checked_sub(1) });
        let tree = shape().tree(nodes).expect("parents come first");
        let chain = Modular::take(&mut self.block.as_slice(), &shape(), tree);
        System::conservative(chain.expect("a block of this length"))
    }
}

fn shape() -> ModularShape {
    let tanh =
        |outputs| NetworkShape::new(2, &[16, 16], outputs, Activation::Tanh).expect("two hidden layers");
    let transform = TransformShape::Network { position: 0, velocity: None, input: Input::Angle };
    let link = TypeShape { transform, potential: Some(1) };
    ModularShape::new(&[tanh(2), tanh(1)], &[link], None).expect("two networks and one type")
}

/// A point of the links' motion.
pub fn point<S: Scalar, const N: usize>() -> Point<S, N> {
    let angle = |j: usize| 0.7 - 0.2 * j as f64;
    let rate = |j: usize| -0.5 + 0.3 * j as f64;
    [
        core::array::from_fn(|j| S::constant(angle(j))),
        core::array::from_fn(|j| S::constant(rate(j))),
        [S::zero(); N],
    ]
}
