//! Element types: the motion that an element's coordinates give it, its parameters, and its potential.

use super::on_axes;
use crate::builder::Builder;
use crate::energies::Network;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::energy::modular::{Input, SPACE, TransformShape, TypeShape};

/// Map from an element's coordinates to the displacement they add ([`leastaction_core::energy::modular::Transform`]).
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
    /// Position of mass, moment of inertia, centre and length.
    start: usize,
}

impl ElementType {
    /// Creates the type whose numbers begin at `start`; `networks` are all networks of the model.
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

    /// Mass m, kg.
    pub fn mass(&self, builder: &mut Builder) -> Node {
        builder.parameters(self.start, 1)
    }

    /// Moment of inertia I, kg m².
    pub fn inertia(&self, builder: &mut Builder) -> Node {
        builder.parameters(self.start + 1, 1)
    }

    /// Position of the centre between the element's parent (0) and its children (1), repeated for every axis.
    pub fn centre(&self, builder: &mut Builder) -> Node {
        let centre = builder.parameters(self.start + 2, 1);
        on_axes(builder, centre)
    }

    /// Displacement s(q), m, that an element's coordinates add to the position of everything it carries.
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

    /// ModLaNet's separate velocity map T_v(q)v, m/s, if the type has a network for it; otherwise the velocity is the exact rate of
    /// [`ElementType::displacement`].
    pub fn velocity(&self, builder: &mut Builder, q: Node, v: Node) -> Option<Node> {
        let Transform::Network { velocity: Some(network), input, .. } = &self.transform else { return None };
        let features = features(builder, *input, q);
        let map = network.output(builder, features);
        let v = on_axes(builder, v);
        Some(builder.product(map, v))
    }

    /// Potential U₁(x) per unit of mass, J/kg, if the type has one.
    pub fn potential(&self, builder: &mut Builder, x: Node) -> Option<Node> {
        self.potential.as_ref().map(|network| network.output(builder, x))
    }
}

/// Input of a position network, from a coordinate.
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
