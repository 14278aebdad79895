use super::guesses::{coasting, cubic, resampled, turned};
use super::{Library, Setting};
use crate::interior::{FreeMotion, Interior};
use leastaction_core::control::{Cost, Limits, Penalty, Plant, Problem};
use std::array::from_fn;

/// The search for the shortest motion from a state to the goal.
#[derive(Clone, Copy, Debug)]
pub struct Reaching<'s, P, const D: usize, const M: usize> {
    setting: &'s Setting<P, D, M>,
    start: [f64; D],
}

/// Error at which the interior-point method is content, and largest gap of its motion.
const TOLERANCE: f64 = 1e-3;
/// Maximum number of its iterations.
const ITERATIONS: u16 = 80;
/// Part of the nodes that is tried first when a motion is shortened.
const SHORTER: f64 = 0.85;
/// Maximum number of shorter motions that are tried in vain.
const MISSES: usize = 3;
/// Parts of the box about the goal at which motions end, tried in turn: a motion that ends at rest takes longer.
const PARTS: [f64; 3] = [1.0, 0.5, 0.0];
/// Number of neighbours from which a search begins.
const NEIGHBOURS: usize = 6;
/// Number of motions that are shortened.
const SHORTENED: usize = 2;
/// Parts of the longest time over which a motion without neighbours is sought.
const TIMES: [f64; 3] = [0.4, 0.6, 0.9];
/// Gains of the drives in motions that coast.
const GAINS: [f64; 3] = [0.0, -0.3, 0.3];

impl<'s, P: Plant<f64, D, M>, const D: usize, const M: usize> Reaching<'s, P, D, M> {
    /// A search from a state.
    pub fn new(setting: &'s Setting<P, D, M>, start: [f64; D]) -> Self {
        Self { setting, start }
    }

    /// The shortest motion near those of a library.
    pub fn from_neighbours(&self, library: &Library<D, M>) -> Option<FreeMotion<D, M>> {
        let neighbours = library.nearest(self.setting, &self.start, NEIGHBOURS);
        let found = neighbours.iter().filter_map(|near| {
            let goal = self.setting.aim.goal_near(&near.end);
            Some((self.motion(&goal, near)?, goal))
        });
        self.shortest(found.collect())
    }

    /// The shortest motion near cubic ones, or near those that coast.
    pub fn from_afar(&self) -> Option<FreeMotion<D, M>> {
        let Setting { aim, .. } = self.setting;
        let counts = TIMES.map(|part| ((part * aim.longest as f64) as usize).max(1));
        let near = |goal: &[f64; D], count: usize| {
            let seconds = count as f64 * self.setting.seconds();
            Some((self.motion(goal, &cubic(&self.start, goal, (count, seconds)))?, *goal))
        };
        let goals = turned(&aim.goal_near(&self.start), &aim.turns);
        let straight = goals.iter().filter_map(|goal| counts.iter().find_map(|count| near(goal, *count)));
        let found: Vec<_> = straight.collect();
        self.shortest(if found.is_empty() { self.coasted(&counts) } else { found })
    }

    /// Motions near those that coast.
    fn coasted(&self, counts: &[usize]) -> Vec<(FreeMotion<D, M>, [f64; D])> {
        let near = |count: usize, gain: f64| {
            let guess = coasting(self.setting, &self.start, count, gain)?;
            let goal = self.setting.aim.goal_near(&guess.end);
            Some((self.motion(&goal, &guess)?, goal))
        };
        let each = counts.iter().flat_map(|count| GAINS.map(|gain| (*count, gain)));
        each.filter_map(|(count, gain)| near(count, gain)).collect()
    }

    /// Shortens the shortest motions, and returns the shortest of all.
    fn shortest(&self, mut found: Vec<(FreeMotion<D, M>, [f64; D])>) -> Option<FreeMotion<D, M>> {
        found.sort_by_key(|(motion, _)| motion.x.len());
        let shortened = found.into_iter().take(SHORTENED);
        shortened.map(|(motion, goal)| self.shorten(motion, &goal)).min_by_key(|motion| motion.x.len())
    }

    /// Takes away nodes as long as the goal is reached.
    fn shorten(&self, mut best: FreeMotion<D, M>, goal: &[f64; D]) -> FreeMotion<D, M> {
        let (mut least, mut misses) = (0, 0);
        while misses < MISSES {
            let now = best.x.len();
            let count = if least == 0 { (now as f64 * SHORTER) as usize } else { (least + now) / 2 };
            if count <= least.max(1) || count >= now {
                break;
            }
            match self.motion(goal, &resampled(&best, count)) {
                Some(motion) => best = motion,
                None => (least, misses) = (count, misses + 1),
            }
        }
        best
    }

    /// The motion of least effort near a guess that ends where the regulator catches it, as far from the goal as it does.
    fn motion(&self, goal: &[f64; D], guess: &FreeMotion<D, M>) -> Option<FreeMotion<D, M>> {
        let mut motion = self.ending(goal, PARTS[0], guess)?;
        for part in &PARTS[1..] {
            if self.setting.catches(&motion.end) {
                return Some(motion);
            }
            motion = self.ending(goal, *part, &motion)?;
        }
        self.setting.catches(&motion.end).then_some(motion)
    }

    /// The motion of least effort near a guess that ends in a part of the box about the goal.
    fn ending(&self, goal: &[f64; D], part: f64, guess: &FreeMotion<D, M>) -> Option<FreeMotion<D, M>> {
        let problem = self.problem(goal, part);
        let mut begin = FreeMotion { x: guess.x.clone(), u: guess.u.clone(), end: guess.end };
        *begin.x.first_mut()? = self.start;
        let mut search = Interior::new(&problem, &begin, self.setting.ticks, TOLERANCE).ok()?;
        search.solve(ITERATIONS, |_| true).ok()?;
        let FreeMotion { x, u, .. } = search.within(TOLERANCE)?;
        let mut motion = self.setting.plant.begin(x.last()?).ok()?;
        let end =
            self.setting.plant.advance(&mut motion, (self.setting.ticks, u.last()?), &mut [0.0; D]).ok()?;
        Some(FreeMotion { x, u, end })
    }

    fn problem(&self, goal: &[f64; D], part: f64) -> Problem<&'s P, f64, D, M> {
        let Setting { plant, aim, .. } = self.setting;
        let side = |sign: f64| from_fn(|i| goal[i] + sign * part * aim.catch[i]);
        Problem {
            plant,
            cost: Cost {
                goal: *goal,
                turns: [false; D],
                x: [0.0; D],
                u: aim.effort.map(|r| r * self.setting.h),
                end: [[0.0; D]; D],
            },
            controls: aim.planned,
            hard: Penalty { limits: aim.states, weights: [1.0; D] },
            soft: Penalty::none(),
            goal: Penalty { limits: Limits { least: side(-1.0), most: side(1.0) }, weights: [1.0; D] },
            energy: Penalty::none(),
        }
    }
}
