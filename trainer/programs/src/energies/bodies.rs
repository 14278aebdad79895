//! Trees of rigid bodies on joints of any size ([`leastaction_core::energy::bodies`]).

use super::{Energies, check_tree};
use crate::builder::Builder;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::energy::bodies::{
    BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS, Joint, TreeBody, TreeError,
};

/// A tree of rigid bodies on joints in the plane. With the centre of mass x of a body, its angle φ, and the rotor of
/// its drive, which sits on the parent,
///
/// L = Σ ½m|ẋ|² + ½I φ̇² + ½J(φ̇_parent + g q̇)² + m γ·x.
///
/// The weight block has the numbers of a model file: γ (m/s²), then the
/// [`BodyParameters`] of every body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodiesEnergies {
    bodies: Vec<TreeBody>,
    known: Vec<Option<f64>>,
}

/// The frame of a body at its joint, or the ground.
#[derive(Clone, Copy)]
struct Frame {
    /// φ, rad, and φ̇, rad/s.
    angle: Node,
    spin: Node,
    /// (cos φ, sin φ).
    axis: Node,
    /// Position of the joint, m, and its velocity, m/s.
    origin: Node,
    velocity: Node,
}

impl BodiesEnergies {
    /// Creates the tree of these bodies, parents first.
    ///
    /// # Errors
    /// [`TreeError::Empty`] without bodies, [`TreeError::Parent`] for a body on one that does not precede it.
    pub fn new(bodies: Vec<TreeBody>) -> Result<Self, TreeError> {
        check_tree(bodies.iter())?;
        let known = vec![None; GRAVITY_PARAMETERS + BODY_PARAMETERS * bodies.len()];
        Ok(Self { bodies, known })
    }

    /// Fixes number i of all weight blocks to `known[i]` where that is given, so that programs are shorter and have no
    /// derivatives with respect to these numbers. `None` if the length differs from that of the block.
    #[must_use]
    pub fn with_known(self, known: Vec<Option<f64>>) -> Option<Self> {
        (known.len() == self.known.len()).then_some(Self { known, ..self })
    }

    /// Returns a number of the weight block.
    fn number(&self, builder: &mut Builder, at: usize) -> Node {
        match self.known[at] {
            Some(known) => builder.constant(&[known]),
            None => builder.parameters(at, 1),
        }
    }

    fn numbers(&self, builder: &mut Builder, body: usize) -> BodyParameters<Node> {
        let start = GRAVITY_PARAMETERS + BODY_PARAMETERS * body;
        BodyParameters::from_array(std::array::from_fn(|i| self.number(builder, start + i)))
    }

    fn gravity(&self, builder: &mut Builder) -> Node {
        let components = [0, 1].map(|i| self.number(builder, i));
        builder.joined(&components)
    }
}

impl Frame {
    fn ground(builder: &mut Builder) -> Self {
        let (none, origin) = (builder.zeros(1), builder.zeros(2));
        let axis = builder.constant(&[1.0, 0.0]);
        Self { angle: none, spin: none, axis, origin, velocity: origin }
    }

    /// Frame of a body with these numbers, carried by this one.
    fn carried(
        &self,
        builder: &mut Builder,
        joint: Joint,
        numbers: &BodyParameters<Node>,
        [q, v]: [Node; 2],
    ) -> Self {
        let angle = builder.sum(self.angle, numbers.angle);
        let to_joint = turned(builder, self.axis, numbers.place);
        let [origin, velocity] = self.point(builder, to_joint);
        match joint {
            Joint::Revolute => {
                let (angle, spin) = (builder.sum(angle, q), builder.sum(self.spin, v));
                Self { angle, spin, axis: direction(builder, angle), origin, velocity }
            }
            Joint::Prismatic => {
                let axis = direction(builder, angle);
                let [slide, speed] = [q, v].map(|x| times(builder, x, axis));
                let base = Self { angle, spin: self.spin, axis, origin, velocity };
                let [origin, velocity] = base.point(builder, slide);
                Self { origin, velocity: builder.sum(velocity, speed), ..base }
            }
        }
    }

    /// Position and velocity of a point that is fixed to the body, from its position relative to the origin.
    fn point(&self, builder: &mut Builder, beside: Node) -> [Node; 2] {
        let across = across(builder, beside);
        let turning = times(builder, self.spin, across);
        [builder.sum(self.origin, beside), builder.sum(self.velocity, turning)]
    }
}

/// Returns (cos φ, sin φ).
fn direction(builder: &mut Builder, angle: Node) -> Node {
    if let Some(known) = builder.known(angle) {
        let (sine, cosine) = known[0].sin_cos();
        return builder.constant(&[cosine, sine]);
    }
    let components = [builder.cosine(angle), builder.map(Function::Sine, angle)];
    builder.joined(&components)
}

/// Returns the vector rotated by +90°.
fn across(builder: &mut Builder, x: Node) -> Node {
    let exchanged = builder.gather(x, &[1, 0]);
    let signs = builder.constant(&[-1.0, 1.0]);
    builder.product(signs, exchanged)
}

/// Returns the vector with these components along an axis and perpendicular to it.
fn turned(builder: &mut Builder, axis: Node, [along, aside]: [Node; 2]) -> Node {
    let along = times(builder, along, axis);
    let normal = across(builder, axis);
    let aside = times(builder, aside, normal);
    builder.sum(along, aside)
}

/// Returns cx.
fn times(builder: &mut Builder, c: Node, x: Node) -> Node {
    let c = builder.repeated(c, 2);
    builder.product(c, x)
}

/// Returns cx².
fn square(builder: &mut Builder, c: Node, x: Node) -> Node {
    let square = builder.dot(x, x);
    builder.product(c, square)
}

impl Energies for BodiesEnergies {
    fn n(&self) -> usize {
        self.bodies.len()
    }

    fn parameters(&self) -> usize {
        self.known.len()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        builder.of_short_vectors();
        let ground = Frame::ground(builder);
        let mut frames: Vec<Frame> = Vec::new();
        let (mut twice, mut moment) = (builder.zeros(1), builder.zeros(2));
        for (i, body) in self.bodies.iter().enumerate() {
            let numbers = self.numbers(builder, i);
            let parent = body.parent.map_or(ground, |parent| frames[usize::from(parent)]);
            let [q, v] = [q, v].map(|x| builder.part(x, i..i + 1));
            let frame = parent.carried(builder, body.joint, &numbers, [q, v]);
            let lever = turned(builder, frame.axis, numbers.centre);
            let [centre, velocity] = frame.point(builder, lever);
            let geared = builder.product(numbers.gear, v);
            let geared = builder.sum(parent.spin, geared);
            for (c, x) in [(numbers.mass, velocity), (numbers.inertia, frame.spin), (numbers.rotor, geared)] {
                let term = square(builder, c, x);
                twice = builder.sum(twice, term);
            }
            let own = times(builder, numbers.mass, centre);
            moment = builder.sum(moment, own);
            frames.push(frame);
        }
        let gravity = self.gravity(builder);
        let work = builder.dot(gravity, moment);
        [builder.scaled(0.5, twice), builder.scaled(-1.0, work)]
    }
}
