//! Element types: how the coordinates of an element move it, its numbers, and its potential.

use super::on_axes;
use crate::builder::{Builder, Node};
use crate::energies::Network;
use crate::function::Function;
use leastaction_core::energy::modular::{Input, SPACE, TransformShape, TypeShape};

/// The map from an element's coordinates to what they add to positions ([`leastaction_core::energy::modular::Transform`]).
#[derive(Clone, Debug, PartialEq)]
enum Transform {
    Network { position: Network, velocity: Option<Network>, input: Input },
    Rod,
    Slide,
    Free,
}

/// An element type over the weight block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ElementType {
    transform: Transform,
    potential: Option<Network>,
    /// The place of mass, moment of inertia, centre and length.
    start: usize,
}

impl ElementType {
    /// The type whose numbers begin at `start`, with its networks among these.
    pub fn new(shape: &TypeShape, networks: &[Network], start: usize) -> Self {
        let network = |i: u8| networks[usize::from(i)].clone();
        let transform = match shape.transform {
            TransformShape::Network { position, velocity, input } => {
                Transform::Network { position: network(position), velocity: velocity.map(network), input }
            }
            TransformShape::Rod => Transform::Rod,
            TransformShape::Slide => Transform::Slide,
            TransformShape::Free => Transform::Free,
        };
        Self { transform, potential: shape.potential.map(network), start }
    }

    /// m, kg.
    pub fn mass(&self, builder: &mut Builder) -> Node {
        builder.parameters(self.start, 1)
    }

    /// I, kg m².
    pub fn inertia(&self, builder: &mut Builder) -> Node {
        builder.parameters(self.start + 1, 1)
    }

    /// Where the centre lies between what the element hangs from (0) and what it carries (1), for every axis.
    pub fn centre(&self, builder: &mut Builder) -> Node {
        let centre = builder.parameters(self.start + 2, 1);
        on_axes(builder, centre)
    }

    /// What an element's coordinates add to the position of everything it carries, s(q), m.
    pub fn displacement(&self, builder: &mut Builder, q: Node) -> Node {
        match &self.transform {
            Transform::Network { position, input, .. } => {
                let features = features(builder, *input, q);
                position.output(builder, features)
            }
            Transform::Rod => {
                let (sine, cosine) = (builder.map(Function::Sine, q), builder.cosine(q));
                let up = builder.scaled(-1.0, cosine);
                let unit = builder.joined(&[sine, up]);
                let length = builder.parameters(self.start + 3, 1);
                let length = on_axes(builder, length);
                builder.product(length, unit)
            }
            Transform::Slide => builder.scatter(q, &[0], SPACE),
            Transform::Free => q,
        }
    }

    /// ModLaNet's separate velocity map T_v(q)v, m/s, where it is a network of its own; without it the velocity is the exact rate of
    /// [`ElementType::displacement`].
    pub fn velocity(&self, builder: &mut Builder, q: Node, v: Node) -> Option<Node> {
        let Transform::Network { velocity: Some(network), input, .. } = &self.transform else { return None };
        let features = features(builder, *input, q);
        let map = network.output(builder, features);
        let v = on_axes(builder, v);
        Some(builder.product(map, v))
    }

    /// U₁(x) per unit of mass, J/kg, where the type has a potential of its own.
    pub fn potential(&self, builder: &mut Builder, x: Node) -> Option<Node> {
        self.potential.as_ref().map(|network| network.output(builder, x))
    }
}

/// What a position network sees of a coordinate.
fn features(builder: &mut Builder, input: Input, q: Node) -> Node {
    match input {
        Input::Translation => q,
        Input::WrappedAngle => builder.map(Function::Wrapped, q),
        Input::Angle => {
            let (cosine, sine) = (builder.cosine(q), builder.map(Function::Sine, q));
            builder.joined(&[cosine, sine])
        }
    }
}
