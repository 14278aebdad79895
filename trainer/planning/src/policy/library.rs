use super::{Reaching, Setting, Starts};
use crate::interior::FreeMotion;
use leastaction_core::control::Plant;
use rayon::prelude::*;
use std::array::from_fn;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Motions to the goal, each the shortest that was found from its start.
#[derive(Default)]
pub struct Library<const D: usize, const M: usize> {
    /// The motions.
    pub motions: Vec<FreeMotion<D, M>>,
}

/// Number of starts that are searched side by side, from the motions found before them.
const BATCH: usize = 16;
/// Time that a deviation of one unit of equal weight is worth, s.
const WORTH: f64 = 0.05;

/// Searches that somebody watches.
struct Watched<'w> {
    watch: &'w (dyn Fn(usize) -> bool + Sync),
    done: Mutex<usize>,
    stopped: AtomicBool,
}

impl Watched<'_> {
    /// Tells that some more starts were searched.
    fn tell(&self, more: usize) {
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *done += more;
        if !(self.watch)(*done) {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}

impl<const D: usize, const M: usize> Library<D, M> {
    /// Searches from given and from random starts, outwards from the goal, each with the help of the motions found before. The result is the
    /// same on any number of threads. `watch` sees the number of starts that were searched after every search, also when one is tried again,
    /// and ends the searches by returning `false`.
    pub fn build<P: Plant<f64, D, M> + Sync>(
        setting: &Setting<P, D, M>,
        starts: &Starts<D>,
        (first, count): (&[[f64; D]], usize),
        watch: &(dyn Fn(usize) -> bool + Sync),
    ) -> Self {
        let mut library = Self { motions: Vec::new() };
        let drawn = (0..).map(|k| starts.draw(setting, k));
        let mut starts: Vec<[f64; D]> = first.iter().copied().chain(drawn).take(count).collect();
        starts.sort_by(|a, b| setting.distance(a).total_cmp(&setting.distance(b)));
        let watched = Watched { watch, done: Mutex::new(0), stopped: AtomicBool::new(false) };
        let mut missed = Vec::new();
        for batch in starts.chunks(BATCH).take_while(|_| !watched.is_stopped()) {
            let found = library.extended(setting, batch, (&watched, 1), &|reaching, library| {
                reaching.from_neighbours(library).or_else(|| reaching.from_afar())
            });
            missed.extend(found);
        }
        // More neighbours than at the first time.
        for batch in missed.chunks(BATCH).take_while(|_| !watched.is_stopped()) {
            let again = |reaching: &Reaching<P, D, M>, library: &Self| reaching.from_neighbours(library);
            library.extended(setting, batch, (&watched, 0), &again);
        }
        library
    }

    /// Adds the motions from some starts, and returns the starts from which there is none. Starts from which the goal is caught need none.
    /// A start counts as `counted` searches.
    fn extended<P: Plant<f64, D, M> + Sync>(
        &mut self,
        setting: &Setting<P, D, M>,
        starts: &[[f64; D]],
        (watched, counted): (&Watched, usize),
        search: &(dyn Fn(&Reaching<P, D, M>, &Self) -> Option<FreeMotion<D, M>> + Sync),
    ) -> Vec<[f64; D]> {
        let needy: Vec<_> = starts.iter().filter(|start| !setting.catches(start)).copied().collect();
        watched.tell(counted * (starts.len() - needy.len()));
        let one = |start: &[f64; D]| {
            let sought = !watched.is_stopped();
            let found = sought.then(|| search(&Reaching::new(setting, *start), self)).flatten();
            watched.tell(counted);
            found
        };
        let found: Vec<_> = needy.par_iter().map(one).collect();
        let missed = needy.iter().zip(&found).filter(|(_, found)| found.is_none()).map(|(start, _)| *start);
        let missed = missed.collect();
        self.motions.extend(found.into_iter().flatten());
        missed
    }

    /// Rests of the motions that begin nearest to x, moved by whole turns next to it.
    pub fn nearest<P>(&self, setting: &Setting<P, D, M>, x: &[f64; D], count: usize) -> Vec<FreeMotion<D, M>>
    where
        P: Plant<f64, D, M>,
    {
        let mut places: Vec<_> =
            self.motions.iter().filter_map(|motion| Some((nearest(setting, motion, x)?, motion))).collect();
        places.sort_by(|(a, _), (b, _)| a.1.total_cmp(&b.1));
        places.into_iter().take(count).map(|((k, _), motion)| rest(setting, motion, k, x)).collect()
    }
}

/// Node of a motion from which the goal is reached first, the deviation counted in.
fn nearest<P, const D: usize, const M: usize>(
    setting: &Setting<P, D, M>,
    motion: &FreeMotion<D, M>,
    x: &[f64; D],
) -> Option<(usize, f64)>
where
    P: Plant<f64, D, M>,
{
    let seconds = setting.seconds();
    let far = |k: usize, node: &[f64; D]| {
        let deviation = setting.aim.deviation(x, node);
        let squares = deviation.iter().zip(&setting.aim.unit).map(|(d, unit)| (d / unit) * (d / unit));
        squares.sum::<f64>().sqrt() * WORTH + (motion.x.len() - k) as f64 * seconds
    };
    // A motion of less than two nodes leaves nothing to search.
    let nodes = motion.x.iter().take(motion.x.len().saturating_sub(1)).enumerate();
    nodes.map(|(k, node)| (k, far(k, node))).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Motion from node k on, moved by whole turns next to x.
fn rest<P: Plant<f64, D, M>, const D: usize, const M: usize>(
    setting: &Setting<P, D, M>,
    motion: &FreeMotion<D, M>,
    k: usize,
    x: &[f64; D],
) -> FreeMotion<D, M> {
    let near = setting.aim.deviation(x, &motion.x[k]);
    let shift: [f64; D] =
        from_fn(|i| if setting.aim.turns[i] { x[i] - near[i] - motion.x[k][i] } else { 0.0 });
    let moved = |x: &[f64; D]| from_fn(|i| x[i] + shift[i]);
    FreeMotion {
        x: motion.x[k..].iter().map(moved).collect(),
        u: motion.u[k..].to_vec(),
        end: moved(&motion.end),
    }
}
