//! Friction beside the forces that a family has: damping, and dry friction that grows with the load.

use super::Energies;
use crate::builder::{Builder, Node};
use crate::function::Function;
use leastaction_core::forces::DryFriction;
use leastaction_core::network::Activation;

/// ε of a learned width, least and most, m/s or rad/s.
pub const WIDTHS: [f64; 2] = [0.02, 1.0];
/// A learned c_load stays below.
pub const MOST_LOAD: f64 = 0.95;

/// A number of a law of friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrictionNumber {
    /// It is this; 0 where the part is absent.
    Known(f64),
    /// From a number θ of the weight block, which may be any: b and c are ln(1 + e^θ); c_load is [`MOST_LOAD`] · ½(1 + tanh θ);
    /// ε is ½(1 + tanh θ) of the way between [`WIDTHS`].
    Learned,
}

/// The friction of a group of coordinates, Q = −(b v + (c + c_load (√(τ² + τ_s²) − τ_s)) tanh(v/ε)), as
/// [`leastaction_core::forces::Coulomb`] beside viscous damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// b ≥ 0, N s/m or N m s/rad.
    pub viscous: FrictionNumber,
    /// c ≥ 0, N or N m.
    pub constant: FrictionNumber,
    /// 0 ≤ c_load < 1.
    pub load: FrictionNumber,
    /// τ_s > 0, N or N m.
    pub smoothing: f64,
    /// ε > 0, m/s or rad/s.
    pub width: FrictionNumber,
}

/// How a number follows from θ: s f(θ) + o.
struct Transformation {
    function: Activation,
    scale: f64,
    offset: f64,
}

/// Of b, c, c_load and ε.
const TRANSFORMATIONS: [Transformation; 4] = {
    const fn half_tanh(least: f64, most: f64) -> Transformation {
        let half = 0.5 * (most - least);
        Transformation { function: Activation::Tanh, scale: half, offset: least + half }
    }
    const POSITIVE: Transformation =
        Transformation { function: Activation::Softplus, scale: 1.0, offset: 0.0 };
    [POSITIVE, POSITIVE, half_tanh(0.0, MOST_LOAD), half_tanh(WIDTHS[0], WIDTHS[1])]
};

impl Transformation {
    fn value(&self, theta: f64) -> f64 {
        self.scale * self.function.curve(theta).value + self.offset
    }

    fn write(&self, builder: &mut Builder, theta: Node) -> Node {
        let value = builder.map(Function::Activation(self.function), theta);
        let value = builder.scaled(self.scale, value);
        let offset = builder.constant(&[self.offset]);
        builder.sum(value, offset)
    }
}

impl Friction {
    /// None at all.
    pub const NONE: Self = Self {
        viscous: FrictionNumber::Known(0.0),
        constant: FrictionNumber::Known(0.0),
        load: FrictionNumber::Known(0.0),
        smoothing: 1.0,
        width: FrictionNumber::Known(1.0),
    };

    /// b, c, c_load and ε.
    fn numbers(&self) -> [FrictionNumber; 4] {
        [self.viscous, self.constant, self.load, self.width]
    }

    /// Numbers θ that it learns.
    fn learned(&self) -> usize {
        self.numbers().iter().filter(|number| **number == FrictionNumber::Learned).count()
    }
}

/// A model with friction of its coordinates, beside whatever forces it has. Its weight block: the model's, then of each group, in
/// order, θ of those of b, c, c_load and ε that are learned.
#[derive(Clone, Debug)]
pub struct WithFriction<E> {
    model: E,
    groups: Vec<Friction>,
    of: Vec<usize>,
}

impl<E: Energies> WithFriction<E> {
    /// Coordinate i has the friction of group `of[i]`; `None` where there are not as many coordinates, or a group is missing.
    pub fn new(model: E, groups: Vec<Friction>, of: Vec<usize>) -> Option<Self> {
        let fits = of.len() == model.n() && of.iter().all(|group| *group < groups.len());
        fits.then_some(Self { model, groups, of })
    }

    /// b and the dry friction of every group, from the weight block: what a model file has. `None` where the block is too short.
    pub fn physical(&self, weights: &[f64]) -> Option<Vec<(f64, DryFriction<f64>)>> {
        let mut thetas = weights.get(self.model.parameters()..)?.iter();
        let of_group = |friction: &Friction| {
            let mut values = [0.0; 4];
            for ((value, number), transformation) in
                values.iter_mut().zip(friction.numbers()).zip(&TRANSFORMATIONS)
            {
                *value = match number {
                    FrictionNumber::Known(known) => known,
                    FrictionNumber::Learned => transformation.value(*thetas.next()?),
                };
            }
            let [viscous, constant, load, width] = values;
            Some((viscous, DryFriction { constant, load, smoothing: friction.smoothing, width }))
        };
        self.groups.iter().map(of_group).collect()
    }

    /// Number `which` of every coordinate.
    fn of_coordinates(&self, builder: &mut Builder, which: usize) -> Node {
        let mut place = self.model.parameters();
        let mut each = Vec::new();
        for friction in &self.groups {
            let numbers = friction.numbers();
            let before = numbers[..which].iter().filter(|number| **number == FrictionNumber::Learned).count();
            each.push(match numbers[which] {
                FrictionNumber::Known(known) => builder.constant(&[known]),
                FrictionNumber::Learned => {
                    let theta = builder.parameters(place + before, 1);
                    TRANSFORMATIONS[which].write(builder, theta)
                }
            });
            place += friction.learned();
        }
        let all = builder.joined(&each);
        builder.gather(all, &self.of)
    }

    /// Whether a number is other than 0 in any group.
    fn has(&self, number: impl Fn(&Friction) -> FrictionNumber) -> bool {
        self.groups.iter().any(|group| number(group) != FrictionNumber::Known(0.0))
    }

    fn is_dry(&self) -> bool {
        self.has(|friction| friction.constant) || self.has(|friction| friction.load)
    }

    /// c + c_load τ²/(√(τ² + τ_s²) + τ_s), without the second term where there is none.
    fn level(&self, builder: &mut Builder, tau: Node) -> Node {
        let constant = self.of_coordinates(builder, 1);
        if !self.has(|friction| friction.load) {
            return constant;
        }
        let smoothing: Vec<f64> = self.of.iter().map(|group| self.groups[*group].smoothing).collect();
        let smoothing = builder.constant(&smoothing);
        let [square, own] = [tau, smoothing].map(|x| builder.product(x, x));
        let sum = builder.sum(square, own);
        let root = builder.map(Function::SquareRoot, sum);
        let sum = builder.sum(root, smoothing);
        let inverse = builder.map(Function::Reciprocal, sum);
        let grown = builder.product(square, inverse);
        let load = self.of_coordinates(builder, 2);
        let grown = builder.product(load, grown);
        builder.sum(constant, grown)
    }
}

impl<E: Energies> Energies for WithFriction<E> {
    fn n(&self) -> usize {
        self.model.n()
    }

    fn parameters(&self) -> usize {
        self.model.parameters() + self.groups.iter().map(Friction::learned).sum::<usize>()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        self.model.energies(builder, q, v)
    }

    /// Half the width of the change of sign.
    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        self.is_dry().then(|| {
            let width = self.of_coordinates(builder, 3);
            builder.scaled(0.5, width)
        })
    }

    fn force(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        let mut force = self.model.force(builder, q, v, tau);
        if self.has(|friction| friction.viscous) {
            let b = self.of_coordinates(builder, 0);
            let drag = builder.product(b, v);
            force = builder.difference(force, drag);
        }
        if self.is_dry() {
            let level = self.level(builder, tau);
            let width = self.of_coordinates(builder, 3);
            let inverse = builder.map(Function::Reciprocal, width);
            let relative = builder.product(v, inverse);
            let direction = builder.map(Function::Activation(Activation::Tanh), relative);
            let dry = builder.product(level, direction);
            force = builder.difference(force, dry);
        }
        force
    }
}
