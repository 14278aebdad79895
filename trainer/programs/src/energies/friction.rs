//! Friction in addition to the forces of a family: damping, and dry friction that grows with the load.

use super::Energies;
use super::group_law::{load_growth, smooth_sign};
use crate::builder::Builder;
use crate::operation::Node;
use leastaction_core::model::FrictionNumber;

/// Count of the numbers of dry friction of one group.
const DRY_NUMBERS: usize = FrictionNumber::ALL.len();

/// Dry friction, Q = −(c + c_load (√(τ² + τ_s²) − τ_s)) tanh(v/ε), see [`leastaction_core::forces::Coulomb`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DryLaw {
    /// No dry friction, and no numbers for it.
    #[default]
    None,
    /// Friction that does not grow with the load: every c_load is known to be 0.
    Unloaded,
    /// The complete law.
    Loaded,
}

/// Laws of friction for which a weight block has numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrictionLaws {
    /// Q = −b v.
    pub viscous: bool,
    /// Law of dry friction.
    pub dry: DryLaw,
}

/// A model with friction of its coordinates, in addition to its own forces. Its weight block is that of a model file.
/// The model's numbers come first; then, with damping, b ≥ 0 of each group (N s/m or N m s/rad); then, with dry
/// friction, c ≥ 0, 0 ≤ c_load < 1, τ_s > 0 and ε > 0 of each group, group after group (N or N m; 1; N or N m; m/s or
/// rad/s).
#[derive(Clone, Debug)]
pub struct WithFriction<E> {
    model: E,
    laws: FrictionLaws,
    groups: usize,
    of: Vec<usize>,
}

impl<E: Energies> WithFriction<E> {
    /// Gives coordinate i the friction of group `of[i]`, out of `groups` groups; `None` if the number of coordinates
    /// differs or a group does not exist.
    pub fn new(model: E, laws: FrictionLaws, groups: usize, of: Vec<usize>) -> Option<Self> {
        let fits = of.len() == model.n() && of.iter().all(|group| *group < groups);
        fits.then_some(Self { model, laws, groups, of })
    }

    /// Count of the numbers of damping.
    fn viscous_numbers(&self) -> usize {
        if self.laws.viscous { self.groups } else { 0 }
    }

    /// Count of the numbers of dry friction.
    fn dry_numbers(&self) -> usize {
        if self.laws.dry == DryLaw::None { 0 } else { DRY_NUMBERS * self.groups }
    }

    /// Damping b of every coordinate.
    fn viscous(&self, builder: &mut Builder) -> Node {
        let all = builder.parameters(self.model.parameters(), self.viscous_numbers());
        builder.gather(all, &self.of)
    }

    /// One number of dry friction for every coordinate.
    fn dry(&self, builder: &mut Builder, number: FrictionNumber) -> Node {
        let all = builder.parameters(self.model.parameters() + self.viscous_numbers(), self.dry_numbers());
        let own: Vec<usize> = self.of.iter().map(|group| DRY_NUMBERS * group + number as usize).collect();
        builder.gather(all, &own)
    }

    /// Level c + c_load τ²/(√(τ² + τ_s²) + τ_s); without load dependence, c alone.
    fn level(&self, builder: &mut Builder, tau: Node) -> Node {
        let constant = self.dry(builder, FrictionNumber::Constant);
        if self.laws.dry != DryLaw::Loaded {
            return constant;
        }
        let smoothing = self.dry(builder, FrictionNumber::Smoothing);
        let grown = load_growth(builder, tau, smoothing);
        let load = self.dry(builder, FrictionNumber::Load);
        let grown = builder.product(load, grown);
        builder.sum(constant, grown)
    }

    /// tanh(v/ε).
    fn direction(&self, builder: &mut Builder, v: Node) -> Node {
        let width = self.dry(builder, FrictionNumber::Width);
        smooth_sign(builder, v, width)
    }
}

impl<E: Energies> Energies for WithFriction<E> {
    fn n(&self) -> usize {
        self.model.n()
    }

    fn parameters(&self) -> usize {
        self.model.parameters() + self.viscous_numbers() + self.dry_numbers()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        self.model.energies(builder, q, v)
    }

    /// Half the width of the change of sign.
    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        (self.laws.dry != DryLaw::None).then(|| {
            let width = self.dry(builder, FrictionNumber::Width);
            builder.scaled(0.5, width)
        })
    }

    fn force(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        let mut force = self.model.force(builder, q, v, tau);
        if self.laws.viscous {
            let b = self.viscous(builder);
            let drag = builder.product(b, v);
            force = builder.difference(force, drag);
        }
        if self.laws.dry != DryLaw::None {
            let (level, direction) = (self.level(builder, tau), self.direction(builder, v));
            let dry = builder.product(level, direction);
            force = builder.difference(force, dry);
        }
        force
    }
}
