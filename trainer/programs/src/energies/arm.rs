//! Trees of rigid bodies on joints in space, of any size ([`leastaction_core::energy::arm`]).

use super::{Energies, check_tree};
use crate::builder::Builder;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::energy::arm::{
    ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, Joint, Rotation, TreeBody, TreeError, Vector,
};

/// Joint of a body, with its known kinematics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmJoint {
    /// Kind of the joint, and the body that carries it.
    pub body: TreeBody,
    /// Rotation R of the joint's frame in the parent's, x_parent = Rx + p.
    pub rotation: Rotation<f64>,
    /// Position p, m.
    pub place: Vector<f64>,
    /// Unit axis in the joint's frame.
    pub axis: Vector<f64>,
}

/// A tree of rigid bodies in space. With the angular velocity ω of a body and the velocity u of its frame's origin,
/// both in its frame,
///
/// L = Σ ½m|u|² + u·(ω × mc) + ½ω·Iω + ½Jq̇² + γ·(mr + mc).
///
/// The weight block has the numbers of a model file: γ (m/s²), then the [`ArmParameters`](leastaction_core::energy::arm::ArmParameters) of
/// every body. The entries for the joint's frame are not read; those of the [`ArmJoint`] are used.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmEnergies {
    joints: Vec<ArmJoint>,
}

/// Position of the first of the ten inertial numbers among a body's numbers.
const INERTIAL: usize = ARM_PARAMETERS - 11;
/// Position of the rotor among a body's numbers.
const ROTOR: usize = ARM_PARAMETERS - 1;

/// Motion of a body, in its own frame.
#[derive(Clone, Copy)]
struct Moving {
    /// (cos q, sin q) of a revolute joint, q of a prismatic one.
    joint: [Node; 2],
    angular: Node,
    linear: Node,
}

impl ArmEnergies {
    /// Creates the tree with these joints, parents first.
    ///
    /// # Errors
    /// [`TreeError::Empty`] without bodies, [`TreeError::Parent`] for a body on one that does not precede it.
    pub fn new(joints: Vec<ArmJoint>) -> Result<Self, TreeError> {
        check_tree(joints.iter().map(|joint| &joint.body))?;
        Ok(Self { joints })
    }

    /// Numbers of a body in the weight block: `count` of them, from its number `first` on.
    fn numbers(builder: &mut Builder, body: usize, first: usize, count: usize) -> Node {
        builder.parameters(ARM_GRAVITY_PARAMETERS + ARM_PARAMETERS * body + first, count)
    }
}

impl ArmJoint {
    /// Returns Rᵀx.
    fn into_joint(self, builder: &mut Builder, x: Node) -> Node {
        let [a, b, c] = self.rotation;
        let transposed = [0, 1, 2].map(|k| [a[k], b[k], c[k]]);
        applied(builder, &transposed, x)
    }

    /// Returns a vector of the joint's frame rotated by the angle ±q: cos q (1 − aaᵀ)x ± sin q a × x + aaᵀx.
    fn turned(self, builder: &mut Builder, [cosine, sine]: [Node; 2], x: Node) -> Node {
        let a = self.axis;
        let along: Rotation<f64> = std::array::from_fn(|i| std::array::from_fn(|j| a[i] * a[j]));
        let across =
            std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)) - along[i][j]));
        let normal = [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]];
        let [across, normal, along] = [across, normal, along].map(|m| applied(builder, &m, x));
        let (across, normal) = (times(builder, cosine, across), times(builder, sine, normal));
        let turned = builder.sum(across, normal);
        builder.sum(turned, along)
    }

    /// Motion of the body on this joint, given that of its parent.
    fn carried(self, builder: &mut Builder, parent: Option<Moving>, [q, v]: [Node; 2]) -> Moving {
        let place = builder.constant(&self.place);
        let [angular, linear] = match parent {
            None => [builder.zeros(3); 2],
            Some(parent) => {
                let lever = cross(builder, parent.angular, place);
                [parent.angular, builder.sum(parent.linear, lever)]
            }
        };
        let [angular, linear] = [angular, linear].map(|x| self.into_joint(builder, x));
        let axis = builder.constant(&self.axis);
        let own = times(builder, v, axis);
        match self.body.joint {
            Joint::Revolute => {
                let (cosine, sine) = (builder.cosine(q), builder.map(Function::Sine, q));
                let back = [cosine, builder.scaled(-1.0, sine)];
                let [angular, linear] = [angular, linear].map(|x| self.turned(builder, back, x));
                Moving { joint: [cosine, sine], angular: builder.sum(angular, own), linear }
            }
            Joint::Prismatic => {
                let slide = times(builder, q, axis);
                let turning = cross(builder, angular, slide);
                let linear = builder.sum(linear, turning);
                Moving { joint: [q, q], angular, linear: builder.sum(linear, own) }
            }
        }
    }

    /// First moment of the carried bodies about the origin of the parent's frame, from their mass and their first
    /// moment about the origin of this body's frame.
    fn moment_below(self, builder: &mut Builder, joint: [Node; 2], [mass, moment]: [Node; 2]) -> Node {
        let moment = match self.body.joint {
            Joint::Revolute => self.turned(builder, joint, moment),
            Joint::Prismatic => {
                let axis = builder.constant(&self.axis);
                let slide = times(builder, joint[0], axis);
                let shifted = times(builder, mass, slide);
                builder.sum(moment, shifted)
            }
        };
        let place = builder.constant(&self.place);
        let (turned, shifted) = (applied(builder, &self.rotation, moment), times(builder, mass, place));
        builder.sum(turned, shifted)
    }
}

/// Returns Mx for a known matrix.
fn applied(builder: &mut Builder, matrix: &Rotation<f64>, x: Node) -> Node {
    let mut sum = builder.zeros(3);
    for j in 0..3 {
        let column = builder.constant(&matrix.map(|row| row[j]));
        let component = builder.part(x, j..j + 1);
        let term = times(builder, component, column);
        sum = builder.sum(sum, term);
    }
    sum
}

/// Returns a × b.
fn cross(builder: &mut Builder, a: Node, b: Node) -> Node {
    let [ahead, behind] = [[1, 2, 0], [2, 0, 1]];
    let [first, second] = [(ahead, behind), (behind, ahead)].map(|(of_a, of_b)| {
        let (a, b) = (builder.gather(a, &of_a), builder.gather(b, &of_b));
        builder.product(a, b)
    });
    builder.difference(first, second)
}

/// Returns cx for a vector in space.
fn times(builder: &mut Builder, c: Node, x: Node) -> Node {
    let c = builder.repeated(c, 3);
    builder.product(c, x)
}

/// Returns Ix, with I given as I_xx, I_xy, I_yy, I_xz, I_yz, I_zz.
fn symmetric(builder: &mut Builder, inertia: Node, x: Node) -> Node {
    const COLUMNS: [[usize; 3]; 3] = [[0, 1, 3], [1, 2, 4], [3, 4, 5]];
    let mut sum = builder.zeros(3);
    for (j, column) in COLUMNS.iter().enumerate() {
        let (column, component) = (builder.gather(inertia, column), builder.part(x, j..j + 1));
        let term = times(builder, component, column);
        sum = builder.sum(sum, term);
    }
    sum
}

/// Twice the kinetic energy of a body: m|u|² + 2u·(ω × mc) + ω·Iω.
fn twice_kinetic(
    builder: &mut Builder,
    [mass, moment, inertia]: [Node; 3],
    Moving { angular, linear, .. }: Moving,
) -> Node {
    let lever = cross(builder, angular, moment);
    let (square, mixed) = (builder.dot(linear, linear), builder.dot(linear, lever));
    let (square, mixed) = (builder.product(mass, square), builder.scaled(2.0, mixed));
    let spin = symmetric(builder, inertia, angular);
    let spin = builder.dot(angular, spin);
    let sum = builder.sum(square, mixed);
    builder.sum(sum, spin)
}

impl Energies for ArmEnergies {
    fn n(&self) -> usize {
        self.joints.len()
    }

    fn parameters(&self) -> usize {
        ARM_GRAVITY_PARAMETERS + ARM_PARAMETERS * self.joints.len()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        builder.of_short_vectors();
        let mut moving: Vec<Moving> = Vec::new();
        let mut carried: Vec<[Node; 2]> = Vec::new();
        let mut twice = builder.zeros(1);
        for (i, joint) in self.joints.iter().enumerate() {
            let [q, v] = [q, v].map(|x| builder.part(x, i..i + 1));
            let parent = joint.body.parent.map(|parent| moving[usize::from(parent)]);
            let own = joint.carried(builder, parent, [q, v]);
            let [mass, moment, inertia, rotor] =
                [(INERTIAL, 1), (INERTIAL + 1, 3), (INERTIAL + 4, 6), (ROTOR, 1)]
                    .map(|(first, count)| Self::numbers(builder, i, first, count));
            let square = builder.product(v, v);
            for term in [twice_kinetic(builder, [mass, moment, inertia], own), builder.product(rotor, square)]
            {
                twice = builder.sum(twice, term);
            }
            moving.push(own);
            carried.push([mass, moment]);
        }
        let mut of_base = builder.zeros(3);
        for (i, joint) in self.joints.iter().enumerate().rev() {
            let below = joint.moment_below(builder, moving[i].joint, carried[i]);
            match joint.body.parent.map(usize::from) {
                None => of_base = builder.sum(of_base, below),
                Some(parent) => {
                    let [mass, moment] = carried[parent];
                    let mass = builder.sum(mass, carried[i][0]);
                    carried[parent] = [mass, builder.sum(moment, below)];
                }
            }
        }
        let gravity = builder.parameters(0, ARM_GRAVITY_PARAMETERS);
        let work = builder.dot(gravity, of_base);
        [builder.scaled(0.5, twice), builder.scaled(-1.0, work)]
    }
}
