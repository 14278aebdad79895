use super::run::run_in_place;
use super::setup::CART_AND_POLE;
use super::{Push, Setup, Start};
use crate::angle::difference;
use crate::devices::{Devices, EncoderConfig};
use crate::error::SetupError;
use crate::summary::{Goal, Summary};
use crate::tick::Tick;
use crate::{Mechanism, Program, Task, Timeline};
use leastaction_core::scalar::{Scalar, max_abs};

/// Beginning and end of the push, s.
const PUSH: [f32; 2] = [2.0, 2.2];
/// Time until which the estimate may still be affected by the brakes, s.
const FLOATS: f32 = 0.5;
/// Speed below which a mechanism counts as at rest, rad/s or m/s.
const REST: f32 = 0.05;

/// A fully actuated mechanism that floats, held against gravity alone, and is pushed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityConfig<const N: usize> {
    /// Loop, devices, goal and push; the error is the distance from the start.
    pub setup: Setup<N>,
    /// Drag as in [`Float::drag`](crate::control::Float::drag), 1/s.
    pub drag: f32,
}

impl<const N: usize> GravityConfig<N> {
    /// Creates a run of 10 s in ticks of 10 ms from rest at `start`, where brakes hold the mechanism until the first
    /// command acts. It is pushed from 2.0 to 2.2 s by up to `push` (N or N m) in every coordinate; the drag is 1 per
    /// second.
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

    /// Program of the firmware.
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

/// Measures of a floating mechanism, from its ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floating<const N: usize> {
    push: [f32; 2],
    angle: [bool; N],
    quiet: Option<(f32, [f32; N])>,
    pushed: Option<[f32; N]>,
    /// Mean velocity before the push, from half a second on; rad/s or m/s. It shows the error of the model's gravity,
    /// as far as friction does not bear it.
    pub drift: [f32; N],
    /// Largest distance from the point of the push, rad or m.
    pub peak: [f32; N],
    /// Time from the end of the push until every speed stays below 0.05 rad/s or m/s, s; `None` if the mechanism still moves at the end.
    pub rest_after: Option<f32>,
}

impl<const N: usize> Floating<N> {
    /// Creates the measures before the first tick of a run.
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

    /// Whether the mechanism was at rest at the end.
    pub fn rests(&self) -> bool {
        self.rest_after.is_some()
    }
}

/// Lets a mechanism float, held by the model's gravity alone, and pushes it; the run succeeds if the mechanism is at rest at the end.
///
/// # Errors
/// Numbers out of range, a step that the model was not trained for, and a kinetic energy that is not quadratic in v.
pub fn gravity<'a, P: Mechanism<N> + 'a, M: Mechanism<N>, const N: usize>(
    plant: impl Into<Timeline<'a, P>>,
    model: &M,
    config: &GravityConfig<N>,
    mut sink: impl FnMut(&Tick<N>),
) -> Result<(Summary<N>, Floating<N>), SetupError> {
    config.setup.validate()?;
    let firmware = config.program().follow(model)?;
    let mut floating = Floating::new(&config.setup);
    let summary = run_in_place(plant, (model, firmware), &config.setup, config.setup.start.q, |tick| {
        floating.update(tick);
        sink(tick);
    })?;
    Ok((Summary { success: summary.success && floating.rests(), ..summary }, floating))
}
