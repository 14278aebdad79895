//! Numbers that follow a machine, and what is known of them before.

use crate::AdaptationError;
use leastaction_core::adapt::{Announcement, Blocks, Following, Number};
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, INERTIAL_PARAMETERS};
use leastaction_core::energy::bodies::{BODY_PARAMETERS, GRAVITY_PARAMETERS, PLANAR_INERTIAL_PARAMETERS};
use leastaction_core::forces::Coefficient;
use leastaction_core::model::{Family, Layout};
use leastaction_models::Model;
use leastaction_replica::AdapterSettings;

/// Wishes of a user; what is not given follows from the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Body to which something may be attached, from 0; the last one if not given.
    pub body: Option<usize>,
    /// Standard deviation of the attached mass before anything was seen, kg; a quarter of the mechanism if not given.
    pub mass: Option<f64>,
    /// Whether friction follows, too.
    pub friction: bool,
    /// Whether the last layer of the correcting potential's network and the strength of the network's dissipation follow, too, where there are any.
    pub networks: bool,
    /// Length of a window, s: at least 40 ticks, and .2 s, if not given.
    pub window: Option<f64>,
    /// Time that is remembered, s.
    pub memory: f64,
    /// False alarms in an hour.
    pub false_alarms: f64,
}

impl Default for Request {
    fn default() -> Self {
        Self {
            body: None,
            mass: None,
            friction: true,
            networks: false,
            window: None,
            memory: 20.0,
            false_alarms: 1e-3,
        }
    }
}

/// Numbers of a model that follow, with the settings of their adapter but for the deviations.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Settings; the deviations are 1.
    pub settings: AdapterSettings,
    /// Test whether something is attached, if the model has bodies.
    pub announcement: Option<Announcement<f32>>,
    /// Ticks of a loop in a tick of the adapter, [`Choice::blocks`].
    pub block: u16,
}

/// Share of its own inertia that a body keeps.
const KEPT: f64 = 0.1;
/// Largest attached mass, in standard deviations of the prior.
const LARGEST: f64 = 4.0;
/// Largest distance of an attached mass from the joint, in reaches of the mechanism.
const FARTHEST: f64 = 2.0;
/// Deviation of friction and of a dissipation's strength, as a share of itself; it may at most be doubled twice, or vanish.
const FRICTION: f64 = 0.3;
/// Time in which friction goes as far as the deviation, s: grease that warms up.
const WARMS: f32 = 120.0;
/// Deviation of a weight in the last layer of a potential's network, as a share of their root mean square; it may go as far as that.
const POTENTIAL: f64 = 0.1;
/// Smallest mass worth announcing, in standard deviations of the prior.
const LEAST: f64 = 0.02;
/// Length of a block, s.
const BLOCK: f64 = 8e-3;
/// Length of a window, s.
const WINDOW: f64 = 0.2;
/// Smallest number of blocks of a window.
const LEAST_BLOCKS: f64 = 24.0;
/// Threshold of a change.
const CHANGE: f32 = 50.0;

impl Choice {
    /// Chooses the numbers of a model for ticks of h seconds.
    ///
    /// # Errors
    /// [`AdaptationError`] if the model has none, or not the body.
    pub fn new(model: &Model, h: f64, request: &Request) -> Result<Self, AdaptationError> {
        let (weights, laws) = (model.weights_f32(), model.architecture.laws());
        model.architecture.with_header(|family| {
            let layout = Layout::of(&family, laws)?;
            let bodies = Bodies::new(&family, &weights, model.n());
            let mut numbers = Vec::new();
            let announcement = match &bodies {
                Some(bodies) => Some(bodies.attached((&layout, &weights), &mut numbers, request)?),
                None => None,
            };
            let dry = [Coefficient::Coulomb, Coefficient::Directional, Coefficient::Sticking];
            let levels = |coefficient| friction(&layout, &weights, coefficient, model.n());
            let dry = dry.into_iter().find_map(|coefficient| Some((coefficient, levels(coefficient)?)));
            if request.friction {
                for coefficient in [Coefficient::Viscous, Coefficient::DirectionalViscous] {
                    follow(&mut numbers, coefficient, levels(coefficient).unwrap_or_default());
                }
                if let Some((coefficient, levels)) = &dry {
                    follow(&mut numbers, *coefficient, levels.clone());
                }
            }
            if request.networks {
                numbers.extend(networks(&layout, &weights));
            }
            if numbers.is_empty() {
                return Err(AdaptationError::Nothing);
            }
            let settings = settings(model.n(), h, request, (numbers, dry));
            Ok(Self { settings, announcement, block: 1 })
        })
    }

    /// Chooses the numbers of a model for a control loop with ticks of h seconds, whose encoders alone tell the motion.
    ///
    /// # Errors
    /// See [`Choice::new`].
    pub fn of_loop(model: &Model, h: f64, request: &Request) -> Result<Self, AdaptationError> {
        let block = (BLOCK / h).round().clamp(1.0, f64::from(u16::MAX));
        let window = request.window.or(Some((LEAST_BLOCKS * block * h).max(WINDOW)));
        Ok(Self { block: block as u16, ..Self::new(model, block * h, &Request { window, ..*request })? })
    }

    /// The motion of the loop, as the adapter takes it.
    pub fn blocks<const N: usize>(&self) -> Blocks<f32, N> {
        self.settings.blocks(self.block)
    }

    /// The model with its numbers at these distances from those of the file.
    ///
    /// # Errors
    /// [`AdaptationError::Model`] for an invalid shape.
    pub fn adapted(&self, model: &Model, distances: &[f32]) -> Result<Model, AdaptationError> {
        with_distances(model, (&self.numbers(), distances))
    }

    /// Numbers that follow.
    pub(crate) fn numbers(&self) -> Vec<Number> {
        self.settings.numbers.iter().map(|following| following.number).collect()
    }

    /// Length of a window, s.
    pub fn window(&self) -> f64 {
        2.0 * f64::from(self.settings.half) * f64::from(self.settings.h)
    }
}

/// A model with numbers at these distances from its own; numbers that its weights do not have are left out.
pub(crate) fn with_distances(
    model: &Model,
    (numbers, distances): (&[Number], &[f32]),
) -> Result<Model, AdaptationError> {
    let (mut weights, laws) = (model.weights_f32(), model.architecture.laws());
    let file = weights.clone();
    let layout = model.architecture.with_header(|family| Layout::of(&family, laws))?;
    layout.write(&file, (numbers, distances), &mut weights);
    let weights = weights.into_iter().map(f64::from).collect();
    Ok(Model { weights, ..model.clone() })
}

fn settings(
    n: usize,
    h: f64,
    request: &Request,
    (numbers, dry): (Vec<Following>, Option<(Coefficient, Vec<f32>)>),
) -> AdapterSettings {
    let half = request.window.map_or((0.5 * WINDOW / h).max(20.0), |window| 0.5 * window / h);
    let half = half.round().clamp(1.0, f64::from(u16::MAX)) as u16;
    AdapterSettings {
        half,
        h: h as f32,
        deviation: vec![1.0; n],
        forgotten: (f64::from(half) * h / request.memory).min(0.5) as f32,
        change: CHANGE,
        dry,
        kept: KEPT as f32,
        numbers,
    }
}

/// Friction of all coordinates, if the model has this coefficient.
fn friction(layout: &Layout, weights: &[f32], coefficient: Coefficient, n: usize) -> Option<Vec<f32>> {
    (0..n).map(|i| layout.value(weights, Number::Friction(coefficient, i as u8))).collect()
}

/// Lets the friction of all coordinates follow.
fn follow(numbers: &mut Vec<Following>, coefficient: Coefficient, levels: Vec<f32>) {
    let of = |(i, model): (usize, f32)| warming(Number::Friction(coefficient, i as u8), model);
    numbers.extend(levels.into_iter().enumerate().map(of));
}

/// Lets a number of friction or damping follow.
fn warming(number: Number, model: f32) -> Following {
    Following {
        number,
        model,
        prior: FRICTION as f32 * model,
        walk: (FRICTION * f64::from(model)).powi(2) as f32 / WARMS,
        limits: [-model, 3.0 * model],
    }
}

/// Lets the last layer of a potential's network, and the strength of a network's dissipation, follow.
fn networks(layout: &Layout, weights: &[f32]) -> impl Iterator<Item = Following> {
    let all = |number: fn(u8) -> Number| {
        let value = move |number| Some((number, layout.value(weights, number)?));
        (0..=u8::MAX).map_while(move |j| value(number(j)))
    };
    let units: Vec<(Number, f32)> = all(Number::Potential).collect();
    let squares: f64 = units.iter().map(|(_, weight)| f64::from(*weight).powi(2)).sum();
    let largest = (squares / units.len().max(1) as f64).sqrt() as f32;
    let prior = POTENTIAL as f32 * largest;
    let unit =
        move |(number, model)| Following { number, model, prior, walk: 0.0, limits: [-largest, largest] };
    let columns = all(Number::Dissipation).map(|(number, model)| warming(number, model));
    units.into_iter().map(unit).chain(columns)
}

/// Size of a mechanism of bodies.
struct Bodies {
    count: usize,
    /// Number of inertial numbers of a body.
    numbers: usize,
    /// Mass of all bodies, kg.
    mass: f64,
    /// Root of the mean square distance between joints, m.
    reach: f64,
}

impl Bodies {
    /// Measures the bodies of a family that has some.
    fn new(family: &Family, weights: &[f32], count: usize) -> Option<Self> {
        let (first, width, dimensions, numbers) = match family {
            Family::Bodies(_) => (GRAVITY_PARAMETERS, BODY_PARAMETERS, 2, PLANAR_INERTIAL_PARAMETERS),
            Family::Arm(_) => (ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, 3, INERTIAL_PARAMETERS),
            _ => return None,
        };
        // Positions of the place and the mass among the numbers of a body.
        let (place, mass) =
            if dimensions == 2 { (0, 3) } else { (9, ARM_PARAMETERS - 1 - INERTIAL_PARAMETERS) };
        let bodies = || weights.get(first..).unwrap_or_default().chunks_exact(width).take(count);
        let squares =
            |body: &[f32]| body[place..place + dimensions].iter().map(|x| f64::from(x * x)).sum::<f64>();
        let reach = (bodies().map(squares).sum::<f64>() / count.max(1) as f64).sqrt();
        let mass = bodies().map(|body| f64::from(body[mass])).sum();
        Some(Self { count, numbers, mass, reach: if reach > 0.0 { reach } else { 0.1 } })
    }

    /// Lets the inertia of the asked body follow, and returns the test of what is attached to it. An attached mass m lies about the reach r from
    /// the joint, so that its moments are of the size of mr, its inertia of mr².
    fn attached(
        &self,
        (layout, weights): (&Layout, &[f32]),
        to: &mut Vec<Following>,
        request: &Request,
    ) -> Result<Announcement<f32>, AdaptationError> {
        let body = request.body.unwrap_or(self.count - 1);
        if body >= self.count {
            return Err(AdaptationError::NoSuchBody { found: body, count: self.count });
        }
        let mass = request.mass.unwrap_or(0.25 * self.mass);
        let moments = if self.numbers == INERTIAL_PARAMETERS { 3 } else { 2 };
        let first = to.len();
        for index in 0..self.numbers {
            let number = Number::Inertia { body: body as u8, index: index as u8 };
            let model = layout.value(weights, number).unwrap_or(0.0);
            let power = match index {
                0 => 0,
                _ if index <= moments => 1,
                _ => 2,
            };
            let prior = (mass * self.reach.powi(power)) as f32;
            // The share that a body keeps limits its losses, too.
            let largest = (LARGEST * FARTHEST.powi(power)) as f32 * prior;
            to.push(Following { number, model, prior, walk: 0.0, limits: [-largest, largest] });
        }
        // A rate of f an hour is a probability of f times the hours that are remembered.
        let probability = request.false_alarms * request.memory / 3600.0;
        Ok(Announcement {
            number: first as u8,
            threshold: (-2.0 * probability.ln()) as f32,
            least: (LEAST * mass) as f32,
            prior: (mass * mass) as f32,
        })
    }
}
