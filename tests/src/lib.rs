//! Common parts of the cross-crate tests and the peer programs.

pub mod arm;
#[path = "../../firmware-sim/examples/cartpole.rs"]
pub mod cartpole;
pub mod faults;
pub mod panda;
pub mod sticking;

/// Programs shown in the book, as tests.
#[cfg(doctest)]
mod book {
    #[doc = include_str!("../../docs/book/src/board.md")]
    mod board {}
    #[doc = include_str!("../../docs/book/src/bodies.md")]
    mod bodies {}
    #[doc = include_str!("../../docs/book/src/graphs.md")]
    mod graphs {}
    #[doc = include_str!("../../docs/book/src/trees.md")]
    mod trees {}
}

use leastaction_core::constraints::ConstraintError;
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Path, StepError};
use leastaction_core::discrete::{
    Order,
    rattle::{ParticleState, Rattle},
};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{Entry, ModelError, entry_of};
use leastaction_firmware_sim::damage::{Damage, Refusals};
use leastaction_firmware_sim::trajectory::carrying::{Carrying, NoArm, adapting, tuning};
use leastaction_firmware_sim::trajectory::reference::{
    Arm, BOBS, Bobs, Cartpole, Double, DryBodies, GRAPH, HalfCartpole, Links, STEP, StickingBodies, TREE,
    aslant, chain, dry, newton,
};
use leastaction_firmware_sim::trajectory::{ParticleMotion, SystemMotion, fingerprint};
use std::fmt::{self, Write};

/// Reason why a run has no fingerprint; this does not happen for the models of this repository.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// The model file was refused.
    Model(ModelError),
    /// The arm that carries a load was refused.
    Arm(NoArm),
    /// A step failed.
    Step(StepError<f32>),
    /// A step of particles failed.
    Particles(ConstraintError<f32>),
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{self:?}")
    }
}

impl std::error::Error for Refused {}

/// Model files that the chip's images contain.
const CARTPOLE: &Aligned<[u8]> =
    &Aligned(*include_bytes!("../../firmware-sim/chip/models/cartpole.postcard"));
const HALF_CARTPOLE: &Aligned<[u8]> =
    &Aligned(*include_bytes!("../../firmware-sim/chip/models/cartpole-f16.postcard"));
const DOUBLE: &Aligned<[u8]> = &Aligned(*include_bytes!("../../firmware-sim/chip/models/double.postcard"));
const PENDULUMS: &Aligned<[u8]> =
    &Aligned(*include_bytes!("../../firmware-sim/chip/models/pendulums.postcard"));
const ACROBOT: &Aligned<[u8]> = &Aligned(*include_bytes!("../../firmware-sim/chip/models/acrobot.postcard"));
const ARM: &Aligned<[u8]> = &Aligned(*include_bytes!("../../firmware-sim/chip/models/arm.postcard"));
const DRY_CARTPOLE: &Aligned<[u8]> =
    &Aligned(*include_bytes!("../../firmware-sim/chip/models/cartpole-dry.postcard"));

const STICKING_CARTPOLE: &Aligned<[u8]> =
    &Aligned(*include_bytes!("../../firmware-sim/chip/models/cartpole-sticking.postcard"));

#[repr(align(4))]
struct Aligned<T: ?Sized>(T);

/// A run whose fingerprint must be equal on every target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reference {
    /// Family of the model: inertia-network, modular, graph, bodies, inertia-network-f16, inertia-network-dry, bodies-dry, arm, bodies-sticking, or
    /// adapting, an arm whose firmware finds what it carries.
    pub family: &'static str,
    /// Order of the integrator, 2 or 4.
    pub order: u8,
}

impl Reference {
    /// Returns all reference runs.
    pub fn all() -> impl Iterator<Item = Self> {
        let orders = |family| [2, 4].map(|order| Self { family, order });
        let others = ["inertia-network-f16", "inertia-network-dry", "adapting"]
            .map(|family| Self { family, order: 2 });
        let families = ["inertia-network", "modular", "graph", "bodies"].into_iter().flat_map(orders);
        families.chain(others).chain(["bodies-dry", "arm", "bodies-sticking"].into_iter().flat_map(orders))
    }

    /// Steps of the fingerprints that are compared between optimisation levels: fewer where every step is one of a whole firmware.
    pub fn steps(&self) -> u32 {
        if self.family == "adapting" { 10_000 } else { 100_000 }
    }

    /// Fingerprint of the given number of steps.
    ///
    /// # Errors
    /// An error if the model or a step is refused.
    pub fn hash(&self, steps: u32) -> Result<u64, Refused> {
        match (self.family, self.order) {
            ("inertia-network", order) => {
                let model = Cartpole::load(&CARTPOLE.0).map_err(Refused::Model)?;
                free(&model.system, order, steps)
            }
            ("inertia-network-dry", order) => {
                let model = Cartpole::load(&CARTPOLE.0).map_err(Refused::Model)?;
                free(&dry(&model), order, steps)
            }
            ("adapting", _) => {
                let tuning = tuning(&ARM.0).map_err(Refused::Arm)?;
                let firmware = adapting(&ARM.0, &tuning).map_err(Refused::Arm)?;
                let mut arm = Carrying::new(&ARM.0, firmware).map_err(Refused::Arm)?;
                Ok(fingerprint(&mut arm, steps).map_err(Refused::Step)?.value())
            }
            ("inertia-network-f16", order) => {
                let model = HalfCartpole::load(&HALF_CARTPOLE.0).map_err(Refused::Model)?;
                free(&model.system, order, steps)
            }
            ("modular", order) => {
                let model = Double::load(&DOUBLE.0, TREE).map_err(Refused::Model)?;
                free(&model.system, order, steps)
            }
            ("bodies", order) => {
                let model = Links::load(&ACROBOT.0).map_err(Refused::Model)?;
                free(&model.system, order, steps)
            }
            ("bodies-dry", order) => {
                let model = DryBodies::load(&DRY_CARTPOLE.0).map_err(Refused::Model)?;
                free(&model.system, order, steps)
            }
            ("bodies-sticking", order) => {
                let model = sticking_bodies()?;
                free(&model.system, order, steps)
            }
            ("arm", order) => {
                let model = Arm::load(&ARM.0).map_err(Refused::Model)?;
                free(&model.system, order, steps)
            }
            (_, 2) => bobs(Order::Two, steps),
            _ => bobs(Order::Four, steps),
        }
    }
}

/// The cart that sticks and runs against stops.
///
/// # Errors
/// An error if the model is refused.
pub fn sticking_bodies() -> Result<StickingBodies<'static>, Refused> {
    StickingBodies::load(&STICKING_CARTPOLE.0).map_err(Refused::Model)
}

fn free<L: Lagrangian<f32, N>, F: Forces<f32, N>, const N: usize>(
    system: &System<L, F>,
    order: u8,
    steps: u32,
) -> Result<u64, Refused> {
    if order == 2 {
        along::<_, _, Midpoint, N>(system, steps)
    } else {
        along::<_, _, Galerkin, N>(system, steps)
    }
    .map_err(Refused::Step)
}

fn along<L: Lagrangian<f32, N>, F: Forces<f32, N>, P: Path, const N: usize>(
    system: &System<L, F>,
    steps: u32,
) -> Result<u64, StepError<f32>> {
    let mut motion = SystemMotion::new(system, Del::<f32, P>::with_newton(STEP, newton()))?;
    Ok(fingerprint(&mut motion, steps)?.value())
}

fn bobs(order: Order, steps: u32) -> Result<u64, Refused> {
    let mut rods = chain();
    let model = Bobs::load(&PENDULUMS.0, GRAPH, &mut [], &mut rods).map_err(Refused::Model)?;
    let mechanism = model.system.constrained().map_err(Refused::Particles)?;
    let mut workspace = vec![0.0; Rattle::workspace(&mechanism)];
    let mut numbers = vec![0.0; ParticleState::<f32, 2>::workspace(BOBS, BOBS)];
    let state = ParticleState::new(&mechanism, &aslant(), &[[0.0; 2]; BOBS], &mut numbers, &mut workspace)
        .map_err(Refused::Particles)?;
    let mut force = [[0.0; 2]; BOBS];
    let rattle = Rattle::with_newton(STEP, order, newton());
    let mut motion = ParticleMotion::new(&mechanism, rattle, state, &mut force, &mut workspace);
    Ok(fingerprint(&mut motion, steps).map_err(Refused::Particles)?.value())
}

/// A table of refusals: a model, a damage, and the results.
pub type Refusal = (&'static str, Damage, Refusals);

/// Results of the loader for every damage to the two small models.
pub fn all_refusals() -> Vec<Refusal> {
    let double = |file: &[u8]| Double::load(file, TREE).map(drop);
    let pendulums = |file: &[u8]| Bobs::load(file, GRAPH, &mut [], &mut chain()).map(drop);
    let of_double = Damage::ALL.map(|damage| {
        let mut file = Aligned(*include_bytes!("../../firmware-sim/chip/models/double.postcard"));
        ("double", damage, damage.refusals(&mut file.0, double))
    });
    let of_pendulums = Damage::ALL.map(|damage| {
        let mut file = Aligned(*include_bytes!("../../firmware-sim/chip/models/pendulums.postcard"));
        ("pendulums", damage, damage.refusals(&mut file.0, pendulums))
    });
    [of_double, of_pendulums].concat()
}

/// Prints the results in the form of the chip's image.
pub fn refusals() -> String {
    let mut text = String::new();
    for (model, damage, refusals) in all_refusals() {
        // Writing to a string cannot fail.
        let _infallible = writeln!(text, "{model} {}", damage.name());
        for (reason, count) in refusals.occurred() {
            let _infallible = writeln!(text, "{} {count}", reason.name);
        }
        let _infallible = writeln!(text, "accepted {}", refusals.accepted);
    }
    text
}

/// Reason for refusing a file as a cart-pole; `None` if it is accepted.
pub fn refused_cartpole(file: &[u8]) -> Option<&'static Entry> {
    let mut words = vec![0_u32; file.len().div_ceil(4)];
    let workspace = bytemuck::cast_slice_mut::<u32, u8>(&mut words);
    workspace.iter_mut().zip(file).for_each(|(to, from)| *to = *from);
    let aligned = bytemuck::cast_slice(&words).get(..file.len()).unwrap_or_default();
    Cartpole::load(aligned).err().and_then(|error| entry_of(error.coded().code))
}
