//! The search for a plan.

use crate::attempt::{Attempt, Reached};
use crate::follow::Gains;
use crate::guess::{Guess, Guesser};
use crate::machine::visit;
use crate::plan::{Plan, PlanNode, StartReport, Tube};
use crate::problem::{ACCEPTED, array};
use crate::{Machine, PlanError, Task};
use leastaction_core::control::{Iteration, Node, Plant, Solution};
use leastaction_core::discrete::StepError;
use leastaction_models::Model;
use leastaction_replica::{StateVisitor, SystemOf};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Observer of a search, called from several threads.
pub trait Progress: Sync {
    /// Sees an iteration from a start guess with `nodes` nodes.
    fn iteration(&self, guess: &str, nodes: usize, iteration: &Iteration<f64>);
}

impl Progress for () {
    fn iteration(&self, _: &str, _: usize, _: &Iteration<f64>) {}
}

/// Finds a plan. `given` replaces the start guesses by commands, one row per node; `stop` ends the search, which keeps the best motion so
/// far.
///
/// # Errors
/// [`PlanError::Motion`] if no motion from the start can be computed, or the model has no states of a fixed size.
pub fn plan(
    machine: &Machine,
    task: &Task,
    given: Option<Vec<Vec<f64>>>,
    (stop, progress): (&AtomicBool, &dyn Progress),
) -> Result<Plan, PlanError> {
    visit(&machine.model, Searching { task, model: &machine.model, given, stop, progress })
}

/// Maximum number of iterations from other guesses once a motion has been found near the straight line.
const BRIEF: u16 = 100;

/// A search whose sizes become types.
struct Searching<'t> {
    task: &'t Task,
    model: &'t Model,
    given: Option<Vec<Vec<f64>>>,
    stop: &'t AtomicBool,
    progress: &'t dyn Progress,
}

impl<'c> StateVisitor<'c> for Searching<'_> {
    type Output = Result<Plan, PlanError>;

    fn states<const N: usize, const D: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output {
        self.search::<N, D>(system)
    }

    fn graph(self) -> Self::Output {
        Err(PlanError::Motion(
            "graphs of particles cannot be planned; plans are for inertia networks and trees".to_owned(),
        ))
    }
}

/// A motion that a search found.
struct Found<const N: usize, const D: usize> {
    nodes: Vec<Node<f64, D, N>>,
    end: [f64; D],
    report: StartReport,
    /// Whether it was found near the states of its guess.
    direct: bool,
}

impl<const N: usize, const D: usize> Found<N, D> {
    /// Order in which motions are preferred: feasible ones by their cost, others by their violation.
    fn rank(&self, time: f64) -> (bool, f64) {
        let Solution { cost, violation, .. } = self.report.solution;
        let misses = violation > ACCEPTED;
        (misses, if misses { violation } else { cost + time * self.nodes.len() as f64 })
    }
}

impl Searching<'_> {
    fn search<'c, const N: usize, const D: usize>(
        self,
        system: &'c SystemOf<'c, N>,
    ) -> Result<Plan, PlanError> {
        let (least, most) = (*self.task.nodes.start(), *self.task.nodes.end());
        let guesses = match &self.given {
            Some(rows) => vec![Guess::Given(rows.clone())],
            None => Guess::of_search(self.task.search.starts),
        };
        let first = if least == most { most } else { (2 * most + least) / 3 };
        let (mut all, mut failed) = (Vec::new(), Vec::new());
        for (guess, found) in self.each_of::<N, D>(system, &guesses, first) {
            match found {
                Ok(found) => all.push(found),
                Err(error) => failed.push((guess.name(), error.to_string())),
            }
        }
        let per_node = self.task.time_per_node();
        let best = |all: &[Found<N, D>]| {
            let ranks = all.iter().map(|found| found.rank(per_node)).enumerate();
            ranks.min_by(|a, b| a.1.0.cmp(&b.1.0).then(a.1.1.total_cmp(&b.1.1))).map(|(index, _)| index)
        };
        if least < most {
            self.shorten::<N, D>(system, &mut all, best, (least, most))?;
        }
        let Some(index) = best(&all) else {
            let reason =
                failed.pop().map_or_else(String::new, |(guess, error)| format!("; {guess}: {error}"));
            return Err(PlanError::Motion(format!("no motion from the start can be computed{reason}")));
        };
        let chosen = all.remove(index);
        let others = all.into_iter().map(|found| found.report);
        Ok(self.finished::<N, D>(system, chosen, (others.collect(), failed)))
    }

    /// Searches from all guesses. If a motion is found near the straight line, the others are only looked at briefly, and not at all if the
    /// drives hold the whole line: nothing needs to be swung.
    fn each_of<'c, 'g, const N: usize, const D: usize>(
        &self,
        system: &'c SystemOf<'c, N>,
        guesses: &'g [Guess],
        count: usize,
    ) -> Vec<(&'g Guess, Result<Found<N, D>, StepError<f64>>)> {
        let all = self.task.search.iterations;
        let one = |guess: &'g Guess, most: u16| (guess, self.from::<N, D>(system, guess, (count, most)));
        let first = usize::from(guesses.first() == Some(&Guess::Line) && self.task.is_fully_driven());
        let (first, others) = guesses.split_at(first);
        let mut found: Vec<_> = first.iter().map(|guess| one(guess, all)).collect();
        let direct = found.iter().any(|(_, found)| found.as_ref().is_ok_and(|found| found.direct));
        if direct && (Guesser { task: self.task, model: self.model, system }).holds_line() {
            return found;
        }
        let most = if direct { all.min(BRIEF) } else { all };
        // A search that is stopped begins no other guess.
        let begins = |k: usize| k == 0 && first.is_empty() || !self.stop.load(Ordering::Relaxed);
        let each = others.par_iter().enumerate().filter(|(k, _)| begins(*k));
        found.extend(each.map(|(_, guess)| one(guess, most)).collect::<Vec<_>>());
        found
    }

    /// Searches from a start guess.
    fn from<'c, const N: usize, const D: usize>(
        &self,
        system: &'c SystemOf<'c, N>,
        guess: &Guess,
        (count, most): (usize, u16),
    ) -> Result<Found<N, D>, StepError<f64>> {
        let plant = self.task.plant::<N>(system, self.model);
        let (start, goal) = (array::<D>(&self.task.start), array::<D>(&self.task.goal.middle()));
        let guesser = Guesser { task: self.task, model: self.model, system };
        let roll = |command: &mut dyn FnMut(usize, &[f64]) -> [f64; N]| -> f64 {
            let ended =
                rolled(&plant, &start, (count, self.task.ticks_per_node), |k, x: &[f64; D]| command(k, x));
            ended
                .map_or(f64::INFINITY, |x| x.iter().zip(&goal).map(|(x, goal)| (x - goal) * (x - goal)).sum())
        };
        let motion = guesser.motion::<D>(guess, count, roll);
        let begun = Instant::now();
        let mut attempt = Attempt {
            task: self.task,
            plant: &plant,
            guess: guess.name(),
            nodes: count,
            most,
            watched: (self.stop, self.progress),
            iterations: Vec::new(),
        };
        let Reached { nodes, end, solution, direct } = attempt.run(&motion)?;
        let Attempt { guess, iterations, .. } = attempt;
        let seconds = begun.elapsed().as_secs_f64();
        let report = StartReport { guess, nodes: count, solution, iterations, seconds };
        Ok(Found { nodes, end, report, direct })
    }

    /// Looks for a better time by golden sections, each from the best motion so far.
    fn shorten<'c, const N: usize, const D: usize>(
        &self,
        system: &'c SystemOf<'c, N>,
        all: &mut Vec<Found<N, D>>,
        best: impl Fn(&[Found<N, D>]) -> Option<usize>,
        (mut least, mut most): (usize, usize),
    ) -> Result<(), PlanError> {
        let per_node = self.task.time_per_node();
        while most - least > ((most + least) / 200).max(1) && !self.stop.load(Ordering::Relaxed) {
            let Some(now) = best(all).map(|index| &all[index]) else { return Ok(()) };
            let (count, rank) = (now.nodes.len(), now.rank(per_node));
            // The larger of the two sides of the best time is tried next.
            let shorter = count.saturating_sub(least) >= most.saturating_sub(count);
            let tried = if shorter { count - golden(count - least) } else { count + golden(most - count) };
            let states = now.nodes.iter().map(|node| node.x.to_vec()).collect();
            let commands = now.nodes.iter().map(|node| node.u.to_vec()).collect();
            let near = Guess::Near([states, commands], now.end.to_vec());
            let better = match self.from::<N, D>(system, &near, (tried, self.task.search.iterations)) {
                Ok(found) => {
                    let better = found.rank(per_node) < rank;
                    all.push(found);
                    better
                }
                Err(_) => false,
            };
            match (shorter, better) {
                (true, true) => most = count,
                (true, false) => least = tried,
                (false, true) => least = count,
                (false, false) => most = tried,
            }
        }
        Ok(())
    }

    /// The plan of the chosen motion.
    fn finished<'c, const N: usize, const D: usize>(
        &self,
        system: &'c SystemOf<'c, N>,
        chosen: Found<N, D>,
        (others, failed): (Vec<StartReport>, Vec<(String, String)>),
    ) -> Plan {
        let Found { mut nodes, end, report, .. } = chosen;
        let plant = self.task.plant::<N>(system, self.model);
        // Feedback meets friction at velocities off the motion's: the slope at the motion itself, c/ε at rest, would be that of a strong
        // brake which no real motion feels, and would ask for gains that noise drives into the limits.
        let met = system.lagrangian.with_forces(system.forces.spread_over(&self.task.velocity_deviations()));
        let linearised = self.task.plant::<N>(&met, self.model);
        for node in &mut nodes {
            if let Ok(transition) = linearised.linearise_at(&node.x, (node.ticks, &node.u)) {
                node.transition = transition;
            }
        }
        let gains = self.task.gains((&linearised, system, self.model), (&nodes, &end));
        let tube: Tube = self.task.tube(&gains, &nodes);
        let Gains { nodes: regulators, end: at_end, command, holds } = gains;
        let each = nodes.iter().zip(&regulators);
        let per_node = self.task.time_per_node();
        Plan {
            task: self.task.clone(),
            nodes: each.map(|(node, of)| PlanNode::new(&node.x, &node.u, &of.gain)).collect(),
            end: PlanNode::new(&end, &command, &at_end.gain),
            energy: self.task.goal.energy.and(plant.energy(&end).map(|(energy, _): (f64, [f64; D])| energy)),
            holds,
            cost: report.solution.cost + per_node * nodes.len() as f64,
            solution: report.solution,
            starts: std::iter::once(report).chain(others).collect(),
            failed,
            tube,
            interrupted: self.stop.load(Ordering::Relaxed),
        }
    }
}

/// The smaller part of a golden section, at least 1.
fn golden(length: usize) -> usize {
    ((length as f64 * 0.382).round() as usize).max(1)
}

/// The end of a motion under commands that may depend on the state; `None` if it cannot be computed.
fn rolled<P: Plant<f64, D, N>, const N: usize, const D: usize>(
    plant: &P,
    start: &[f64; D],
    (count, ticks): (usize, u16),
    mut command: impl FnMut(usize, &[f64; D]) -> [f64; N],
) -> Option<[f64; D]> {
    let mut motion = plant.begin(start).ok()?;
    let mut x = *start;
    for k in 0..count {
        x = plant.advance(&mut motion, (ticks, &command(k, &x)), &mut [0.0; D]).ok()?;
    }
    Some(x)
}
