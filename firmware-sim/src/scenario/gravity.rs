use super::run::run_in_place;
use super::setup::CART_AND_POLE;
use super::{Push, Setup, Start};
use crate::angle::difference;
use crate::devices::{Devices, EncoderConfig};
use crate::error::SetupError;
use crate::summary::{Goal, Summary};
use crate::tick::Tick;
use crate::{Mechanism, Program, Task};
use leastaction_core::scalar::{Scalar, max_abs};

/// When the push begins and ends, s.
const PUSH: [f32; 2] = [2.0, 2.2];
/// Until then what the observer took the brakes for may still be in its estimate, s.
const FLOATS: f32 = 0.5;
/// Below this speed a mechanism is at rest, rad/s or m/s.
const REST: f32 = 0.05;

/// A fully actuated mechanism that floats, held against gravity alone, and is pushed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityConfig<const N: usize> {
    /// Loop, devices, goal, push; the error is the way from the start.
    pub setup: Setup<N>,
    /// [`Float::drag`](crate::control::Float::drag), 1/s.
    pub drag: f32,
}

impl<const N: usize> GravityConfig<N> {
    /// From rest at `start`, where brakes hold it until the first command acts, 10 s of 10 ms, pushed from 2.0 to 2.2 s by up to `push` (N or N m) in every coordinate; a drag of 1/s.
    pub const fn new(
        encoders: [EncoderConfig; N],
        limit: [f32; N],
        (start, push): ([f32; N], [f32; N]),
    ) -> Self {
        let devices = Devices::new(encoders, limit);
        let goal = Goal { tolerance: [f32::INFINITY; N], hold: 0.0, bounds: [f32::INFINITY; N] };
        let setup = Setup {
            push: Push { begin: PUSH[0], end: PUSH[1], most: push },
            brakes: true,
            ..Setup::new(Start::at_rest(start), devices, goal)
        };
        Self { setup, drag: 1.0 }
    }

    /// What the firmware is told.
    pub fn program(&self) -> Program<N> {
        self.setup.program(Task::Float { begin: self.setup.start.q, drag: self.drag })
    }
}

impl GravityConfig<1> {
    /// The pendulum 1 rad from upright.
    pub const fn pendulum() -> Self {
        Self::new([EncoderConfig::rotary()], [10.0], ([1.0], [2.0]))
    }
}

impl GravityConfig<2> {
    /// The cart-pole, cart and pole both actuated, the pole 1 rad from upright.
    pub const fn cartpole() -> Self {
        Self::new(CART_AND_POLE, [15.0, 2.0], ([0.0, 1.0], [2.0, 0.25]))
    }

    /// The acrobot, both joints actuated, halfway up.
    pub const fn acrobot() -> Self {
        Self::new([EncoderConfig::rotary(); 2], [40.0, 40.0], ([1.5, -0.5], [4.0, 2.0]))
    }
}

/// How a mechanism floated, from its ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floating<const N: usize> {
    push: [f32; 2],
    angle: [bool; N],
    quiet: Option<(f32, [f32; N])>,
    pushed: Option<[f32; N]>,
    /// Mean velocity before the push, from half a second on: what the model's gravity is wrong by, less what friction bears; rad/s or m/s.
    pub drift: [f32; N],
    /// Largest way from where it was pushed, rad or m.
    pub peak: [f32; N],
    /// From the end of the push until every speed is below 0.05 rad/s or m/s for good, s; `None` where it is not at the end.
    pub rest_after: Option<f32>,
}

impl<const N: usize> Floating<N> {
    /// Before the first tick of a run.
    pub fn new(setup: &Setup<N>) -> Self {
        let (push, angle) = ([setup.push.begin, setup.push.end], setup.devices.angles());
        let zero = [0.0; N];
        Self { push, angle, quiet: None, pushed: None, drift: zero, peak: zero, rest_after: None }
    }

    /// Takes in a tick.
    pub fn update(&mut self, tick: &Tick<N>) {
        let [begin, end] = self.push;
        let way = |from: &[f32; N]| difference(&tick.q, from, &self.angle);
        if tick.time < begin {
            let (since, from) = *self.quiet.get_or_insert((tick.time.max(FLOATS), tick.q));
            if tick.time <= FLOATS {
                self.quiet = Some((FLOATS, tick.q));
            } else {
                self.drift = way(&from).map(|way| way / (tick.time - since));
            }
            return;
        }
        let from = *self.pushed.get_or_insert(tick.q);
        let peak = way(&from);
        self.peak = core::array::from_fn(|i| Scalar::max(self.peak[i], peak[i].abs()));
        if tick.time >= end {
            let since = self.rest_after.unwrap_or(tick.time - end);
            self.rest_after = (max_abs(&tick.v) <= REST).then_some(since);
        }
    }

    /// Whether it was at rest at the end.
    pub fn rests(&self) -> bool {
        self.rest_after.is_some()
    }
}

/// Lets a mechanism float, held by the model's gravity alone, and pushes it; a success where it is at rest at the end.
///
/// # Errors
/// Numbers out of range, a step that the model was not trained for, and a kinetic energy that is not quadratic in v.
pub fn gravity<P: Mechanism<N>, M: Mechanism<N>, const N: usize>(
    plant: &P,
    model: &M,
    config: &GravityConfig<N>,
    mut sink: impl FnMut(&Tick<N>),
) -> Result<(Summary<N>, Floating<N>), SetupError> {
    config.setup.validate()?;
    let firmware = config.program().follow(model)?;
    let mut floating = Floating::new(&config.setup);
    let summary = run_in_place(plant, firmware, &config.setup, config.setup.start.q, |tick| {
        floating.update(tick);
        sink(tick);
    })?;
    Ok((Summary { success: summary.success && floating.rests(), ..summary }, floating))
}
