use super::guesses::braking;
use super::{Library, Reaching, Setting};
use crate::interior::FreeMotion;
use leastaction_core::control::Plant;
use leastaction_core::control::riccati::back;
use leastaction_core::linear::multiply;
use std::array::from_fn;
use std::sync::Arc;

/// State of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Following a motion.
    Follow,
    /// Holding the goal.
    Hold,
    /// Braking, because no motion was found.
    Brake,
}

/// Command of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<const M: usize> {
    /// Command of every control, within the limits.
    pub u: [f64; M],
    /// State of the law.
    pub state: State,
    /// Whether a motion was searched in this tick.
    pub searched: bool,
}

/// A node of a motion with its gain.
struct Followed<const D: usize, const M: usize> {
    x: [f64; D],
    u: [f64; M],
    gain: [[f64; D]; M],
}

/// Knowledge that laws share.
pub struct Known<P, const D: usize, const M: usize> {
    /// The mechanism and its aim.
    pub setting: Setting<P, D, M>,
    /// Motions to the goal.
    pub library: Library<D, M>,
}

/// Commands of a tick, without limits: the planned one, and the one with feedback.
struct Present<const M: usize> {
    planned: [f64; M],
    u: [f64; M],
    state: State,
}

/// Doing of a law.
enum Doing<const D: usize, const M: usize> {
    Following(Vec<Followed<D, M>>, [f64; D]),
    Holding,
    Braking,
}

/// The law of one mechanism: follows a motion by time-varying LQR, holds the goal by LQR, and searches a new motion where the feedback asks
/// for more than the drives have.
pub struct Law<P, const D: usize, const M: usize> {
    known: Arc<Known<P, D, M>>,
    doing: Doing<D, M>,
    /// Ticks since the present motion began.
    ticks: usize,
}

/// Feedback that counts as lost, in parts of a command's range.
const TOO_MUCH: f64 = 1.0;
/// Time for which the drives brake before the next search, s.
const BRAKED: f64 = 0.1;
/// Gain of the brakes.
const BRAKES: f64 = -0.3;

impl<P: Plant<f64, D, M>, const D: usize, const M: usize> Law<P, D, M> {
    /// A law that begins by looking where it is.
    pub fn new(known: Arc<Known<P, D, M>>) -> Self {
        // Brakes that have had their time are followed by a search.
        Self { known, doing: Doing::Braking, ticks: usize::MAX }
    }

    /// Command at a state, `elapsed` ticks after the last one.
    pub fn command(&mut self, x: &[f64; D], elapsed: usize) -> Command<M> {
        self.ticks = self.ticks.saturating_add(elapsed);
        let mut present = self.present(x);
        let searched = self.is_lost(&present);
        if searched {
            self.search(x);
            present = self.present(x);
        }
        let u = self.known.setting.aim.controls.clamped(&present.u);
        Command { u, state: present.state, searched }
    }

    /// Whether the present doing no longer leads to the goal.
    fn is_lost(&self, Present { planned, u, state }: &Present<M>) -> bool {
        match state {
            State::Brake => self.ticks as f64 * self.known.setting.h >= BRAKED,
            State::Follow | State::Hold => self.asks_too_much(planned, u),
        }
    }

    /// Whether feedback asks for more than the drives have.
    fn asks_too_much(&self, planned: &[f64; M], u: &[f64; M]) -> bool {
        let aim = &self.known.setting.aim;
        let range = |j: usize| aim.controls.most[j] - aim.controls.least[j];
        (0..M).any(|j| aim.is_driven(j) && (u[j] - planned[j]).abs() > TOO_MUCH * range(j))
    }

    /// Searches what to do from x on.
    fn search(&mut self, x: &[f64; D]) {
        self.ticks = 0;
        self.doing = if self.known.setting.catches(x) {
            Doing::Holding
        } else {
            let reaching = Reaching::new(&self.known.setting, *x);
            match reaching.from_neighbours(&self.known.library).or_else(|| reaching.from_afar()) {
                Some(motion) => self.following(&motion),
                None => Doing::Braking,
            }
        };
    }

    /// Gains of time-varying LQR along a motion.
    fn following(&self, FreeMotion { x, u, end }: &FreeMotion<D, M>) -> Doing<D, M> {
        let Setting { plant, ticks, aim, regulator, .. } = &self.known.setting;
        let weights = aim.weights_over(self.known.setting.seconds());
        let mut cost = regulator.cost;
        let mut motion: Vec<_> = x
            .iter()
            .zip(u)
            .rev()
            .map(|(x, u)| {
                let found =
                    plant.linearise_at(x, (*ticks, u)).ok().and_then(|at| back(&at, &weights, &cost).ok());
                let gain = found.map_or([[0.0; D]; M], |found| {
                    cost = found.cost;
                    found.gain
                });
                Followed { x: *x, u: *u, gain }
            })
            .collect();
        motion.reverse();
        Doing::Following(motion, *end)
    }

    /// Commands of the present doing.
    fn present(&self, x: &[f64; D]) -> Present<M> {
        let Known { setting, .. } = &*self.known;
        let (planned, u, state) = match &self.doing {
            Doing::Holding => (setting.held, setting.holding(x), State::Hold),
            Doing::Braking => {
                let u = braking(setting, x, BRAKES);
                (u, u, State::Brake)
            }
            Doing::Following(motion, end) => {
                let (planned, u) = self.followed(motion, end, x);
                (planned, u, State::Follow)
            }
        };
        Present { planned, u, state }
    }

    /// Planned command and command with feedback of a motion; after its end those of the regulator about the goal.
    fn followed(&self, motion: &[Followed<D, M>], end: &[f64; D], x: &[f64; D]) -> ([f64; M], [f64; M]) {
        let Setting { ticks, aim, .. } = &self.known.setting;
        let ticks = usize::from(*ticks);
        let (k, part) = (self.ticks / ticks, (self.ticks % ticks) as f64 / ticks as f64);
        let Some(now) = motion.get(k) else {
            return (self.known.setting.held, self.known.setting.holding(x));
        };
        let next = motion.get(k + 1).map_or(end, |next| &next.x);
        let planned: [f64; D] = from_fn(|i| now.x[i] + part * (next[i] - now.x[i]));
        let feedback = multiply(&now.gain, &aim.deviation(x, &planned));
        (now.u, from_fn(|j| now.u[j] - feedback[j]))
    }
}
