//! Laws of force with numbers for every group of coordinates, after the model's own in the weight block.

use super::Energies;
use crate::builder::Builder;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::model::{DirectionalNumber, FrictionNumber, Law, StickingNumber, StopsNumber};
use leastaction_core::network::Activation;

/// A law of force in addition to a model's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupForce {
    /// Viscous damping, Q = −b v: [`leastaction_core::forces::Viscous`].
    Viscous,
    /// Dry friction with a smooth change of sign: [`leastaction_core::forces::Coulomb`].
    Coulomb {
        /// Whether some c_load is learned or not 0.
        loaded: bool,
    },
    /// Position servos, τ + Q = k (τ − q) + the model's own forces: [`leastaction_core::forces::Servo`].
    Servo,
    /// Friction that differs by direction: [`leastaction_core::forces::Directional`].
    Directional,
    /// The smooth law of friction that sticks: [`leastaction_core::forces::Sticking`].
    Sticking {
        /// Whether some c_load is learned or not 0.
        loaded: bool,
    },
    /// End stops, which are no force but of steps that solve them: [`leastaction_core::forces::Stops`].
    Stops,
}

/// A model with such a law. The law's numbers ([`Law::ranges`]), group after group, follow the model's in the weight block.
#[derive(Clone, Debug)]
pub struct WithGroupLaw<E> {
    model: E,
    force: GroupForce,
    groups: usize,
    of: Vec<usize>,
}

impl GroupForce {
    /// The force of a law of a model file, which may grow with the load or not; `None` for a law with a network.
    pub const fn new(law: Law, loaded: bool) -> Option<Self> {
        match law {
            Law::Viscous => Some(Self::Viscous),
            Law::Coulomb => Some(Self::Coulomb { loaded }),
            Law::Dissipation | Law::Potential => None,
            Law::Servo => Some(Self::Servo),
            Law::Directional => Some(Self::Directional),
            Law::Sticking => Some(Self::Sticking { loaded }),
            Law::Stops => Some(Self::Stops),
        }
    }

    /// The law of a model file.
    pub const fn law(self) -> Law {
        match self {
            Self::Viscous => Law::Viscous,
            Self::Coulomb { .. } => Law::Coulomb,
            Self::Servo => Law::Servo,
            Self::Directional => Law::Directional,
            Self::Sticking { .. } => Law::Sticking,
            Self::Stops => Law::Stops,
        }
    }

    /// Position of the width of the law among its numbers, if it bends.
    const fn width(self) -> Option<usize> {
        match self {
            Self::Viscous | Self::Servo | Self::Stops => None,
            Self::Coulomb { .. } => Some(FrictionNumber::Width as usize),
            Self::Directional => Some(DirectionalNumber::Width as usize),
            Self::Sticking { .. } => Some(StickingNumber::Width as usize),
        }
    }
}

impl<E: Energies> WithGroupLaw<E> {
    /// Gives coordinate i the numbers of group `of[i]`, out of `groups` groups; `None` if the number of coordinates differs or a group
    /// does not exist.
    pub fn new(model: E, force: GroupForce, groups: usize, of: Vec<usize>) -> Option<Self> {
        let fits = of.len() == model.n() && of.iter().all(|group| *group < groups);
        fits.then_some(Self { model, force, groups, of })
    }

    /// Count of the law's numbers.
    fn count(&self) -> usize {
        self.groups * self.force.law().ranges().len()
    }

    /// One of the law's numbers for every coordinate.
    fn number(&self, builder: &mut Builder, number: usize) -> Node {
        let all = builder.parameters(self.model.parameters(), self.count());
        let each = self.force.law().ranges().len();
        let own: Vec<usize> = self.of.iter().map(|group| each * group + number).collect();
        builder.gather(all, &own)
    }

    /// A force with that of the law.
    fn added(&self, builder: &mut Builder, own: Node, [q, v, tau]: [Node; 3]) -> Node {
        let friction = match self.force {
            GroupForce::Servo => {
                let drive = self.drive(builder, q, tau);
                return builder.sum(own, drive);
            }
            GroupForce::Stops => return own,
            GroupForce::Viscous => self.viscous(builder, v),
            GroupForce::Coulomb { loaded } => self.coulomb(builder, loaded, v, tau),
            GroupForce::Directional => self.directional(builder, v),
            GroupForce::Sticking { loaded } => self.sticking(builder, loaded, v, tau),
        };
        builder.difference(own, friction)
    }

    /// b v.
    fn viscous(&self, builder: &mut Builder, v: Node) -> Node {
        let b = self.number(builder, 0);
        builder.product(b, v)
    }

    /// (c + c_load (√(τ² + τ_s²) − τ_s)) t.
    fn coulomb(&self, builder: &mut Builder, loaded: bool, v: Node, tau: Node) -> Node {
        use FrictionNumber::{Constant, Load, Smoothing, Width};
        let constant = self.number(builder, Constant as usize);
        let growth = loaded.then_some([Load as usize, Smoothing as usize]);
        let level = self.grown(builder, constant, growth, tau);
        let t = self.direction(builder, Width as usize, v);
        builder.product(level, t)
    }

    /// A level of friction with its growth c_load (√(τ² + τ_s²) − τ_s), given the places of c_load and τ_s if it grows.
    fn grown(&self, builder: &mut Builder, level: Node, growth: Option<[usize; 2]>, tau: Node) -> Node {
        let Some([load, smoothing]) = growth else { return level };
        let smoothing = self.number(builder, smoothing);
        let growth = load_growth(builder, tau, smoothing);
        let load = self.number(builder, load);
        let grown = builder.product(load, growth);
        builder.sum(level, grown)
    }

    /// x (1 + at) of a number x and its asymmetry a.
    fn by_direction(&self, builder: &mut Builder, [number, asymmetry]: [usize; 2], t: Node) -> Node {
        let [number, asymmetry] = [number, asymmetry].map(|number| self.number(builder, number));
        let share = builder.product(asymmetry, t);
        let turned = builder.product(number, share);
        builder.sum(number, turned)
    }

    /// t = tanh(v/ε).
    fn direction(&self, builder: &mut Builder, width: usize, v: Node) -> Node {
        let width = self.number(builder, width);
        smooth_sign(builder, v, width)
    }

    /// k (τ − q) − τ.
    fn drive(&self, builder: &mut Builder, q: Node, tau: Node) -> Node {
        let stiffness = self.number(builder, 0);
        let away = builder.difference(tau, q);
        let drive = builder.product(stiffness, away);
        builder.difference(drive, tau)
    }

    /// b (1 + βt) v + c (1 + δt) t.
    fn directional(&self, builder: &mut Builder, v: Node) -> Node {
        use DirectionalNumber::{Asymmetry, Constant, Viscous, ViscousAsymmetry, Width};
        let t = self.direction(builder, Width as usize, v);
        let damping = self.by_direction(builder, [Viscous as usize, ViscousAsymmetry as usize], t);
        let level = self.by_direction(builder, [Constant as usize, Asymmetry as usize], t);
        let [viscous, dry] = [(damping, v), (level, t)].map(|(a, b)| builder.product(a, b));
        builder.sum(viscous, dry)
    }

    /// c (1 + δ) and c (1 − δ), each with its growth under load, and s.
    fn levels(&self, builder: &mut Builder, loaded: bool, tau: Node) -> [Node; 3] {
        use StickingNumber::{Asymmetry, Breakaway, Constant, Load, Smoothing};
        let constant = self.number(builder, Constant as usize);
        let asymmetry = self.number(builder, Asymmetry as usize);
        let more = builder.product(constant, asymmetry);
        let both = [builder.sum(constant, more), builder.difference(constant, more)];
        let growth = loaded.then_some([Load as usize, Smoothing as usize]);
        let [forward, backward] = both.map(|level| self.grown(builder, level, growth, tau));
        [forward, backward, self.number(builder, Breakaway as usize)]
    }

    /// Middle less and plus half the distance, and e.
    fn limits(&self, builder: &mut Builder) -> [Node; 3] {
        use StopsNumber::{Centre, Half, Restitution};
        let [centre, half, restitution] =
            [Centre, Half, Restitution].map(|number| self.number(builder, number as usize));
        [builder.difference(centre, half), builder.sum(centre, half), restitution]
    }

    /// (c (1 + δt) + c_load (√(τ² + τ_s²) − τ_s)) t.
    fn sticking(&self, builder: &mut Builder, loaded: bool, v: Node, tau: Node) -> Node {
        use StickingNumber::{Asymmetry, Constant, Load, Smoothing, Width};
        let t = self.direction(builder, Width as usize, v);
        let level = self.by_direction(builder, [Constant as usize, Asymmetry as usize], t);
        let growth = loaded.then_some([Load as usize, Smoothing as usize]);
        let level = self.grown(builder, level, growth, tau);
        builder.product(level, t)
    }
}

/// Adds laws to a model, in the order of a weight block; `None` as [`WithGroupLaw::new`].
pub fn with_group_laws(
    model: Box<dyn Energies>,
    forces: &[GroupForce],
    (groups, of): (usize, &[usize]),
) -> Option<Box<dyn Energies>> {
    forces.iter().try_fold(model, |model, force| {
        let with: Box<dyn Energies> = Box::new(WithGroupLaw::new(model, *force, groups, of.to_vec())?);
        Some(with)
    })
}

/// tanh(v/ε).
fn smooth_sign(builder: &mut Builder, v: Node, width: Node) -> Node {
    let inverse = builder.map(Function::Reciprocal, width);
    let relative = builder.product(v, inverse);
    builder.map(Function::Activation(Activation::Tanh), relative)
}

/// √(τ² + τ_s²) − τ_s = τ²/(√(τ² + τ_s²) + τ_s).
fn load_growth(builder: &mut Builder, tau: Node, smoothing: Node) -> Node {
    let [square, own] = [tau, smoothing].map(|x| builder.product(x, x));
    let sum = builder.sum(square, own);
    let root = builder.map(Function::SquareRoot, sum);
    let sum = builder.sum(root, smoothing);
    let inverse = builder.map(Function::Reciprocal, sum);
    builder.product(square, inverse)
}

impl<E: Energies> Energies for WithGroupLaw<E> {
    fn n(&self) -> usize {
        self.model.n()
    }

    fn parameters(&self) -> usize {
        self.model.parameters() + self.count()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        self.model.energies(builder, q, v)
    }

    fn force(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        let model = self.model.force(builder, q, v, tau);
        self.added(builder, model, [q, v, tau])
    }

    fn single_valued(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        let model = self.model.single_valued(builder, q, v, tau);
        let sticks = matches!(self.force, GroupForce::Sticking { .. });
        if sticks { model } else { self.added(builder, model, [q, v, tau]) }
    }

    /// At most one law of a model sticks.
    fn grips(&self, builder: &mut Builder, tau: Node) -> Option<[Node; 3]> {
        match self.force {
            GroupForce::Sticking { loaded } => Some(self.levels(builder, loaded, tau)),
            _ => self.model.grips(builder, tau),
        }
    }

    /// At most one law of a model is that of stops.
    fn stops(&self, builder: &mut Builder) -> Option<[Node; 3]> {
        match self.force {
            GroupForce::Stops => Some(self.limits(builder)),
            _ => self.model.stops(builder),
        }
    }

    /// Half the width of the change of sign; the width of an inner law that bends too is taken to be no narrower.
    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        let Some(width) = self.force.width() else { return self.model.bends(builder) };
        let width = self.number(builder, width);
        Some(builder.scaled(0.5, width))
    }
}
