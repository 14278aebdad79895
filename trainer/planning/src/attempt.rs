use crate::Task;
use crate::guess::Motion;
use crate::interior::{Ended, Interior};
use crate::problem::{ACCEPTED, array};
use crate::search::Progress;
use leastaction_core::control::{GoalMultipliers, Ilqr, Iteration, Node, Options, Plant, Solution, Status};
use leastaction_core::discrete::StepError;
use std::sync::atomic::{AtomicBool, Ordering};

/// Search from one start guess.
pub struct Attempt<'a, P> {
    /// The task.
    pub task: &'a Task,
    /// The plant.
    pub plant: &'a P,
    /// Name of the guess.
    pub guess: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Maximum number of iterations.
    pub most: u16,
    /// Stop of the search, and its observer.
    pub watched: (&'a AtomicBool, &'a dyn Progress),
    /// Iterations so far.
    pub iterations: Vec<Iteration<f64>>,
}

/// Motion that an attempt found.
pub struct Reached<const D: usize, const N: usize> {
    /// Nodes.
    pub nodes: Vec<Node<f64, D, N>>,
    /// Last state.
    pub end: [f64; D],
    /// Result.
    pub solution: Solution<f64>,
    /// Whether it was found near the guess's states, by no rollout of its commands.
    pub direct: bool,
}

/// Error at which the interior-point method is content.
const TOLERANCE: f64 = 3e-5;
/// Maximum number of its iterations: one that needs more is lost.
const ITERATIONS: u16 = 150;
/// Violation with which the plant's own motion about a solution is content.
const CONTENT: f64 = 0.5 * ACCEPTED;
/// Penalty of the last, shooting iterations about a motion whose multipliers are known.
const CLOSE: f64 = 100.0;

impl<P> Attempt<'_, P> {
    /// Searches near a motion whose states are free, if the guess has states; then by its commands.
    ///
    /// # Errors
    /// [`StepError`] if the motion of the commands cannot be computed.
    pub fn run<const D: usize, const N: usize>(
        &mut self,
        guess: &Motion<D, N>,
    ) -> Result<Reached<D, N>, StepError<f64>>
    where
        P: Plant<f64, D, N>,
    {
        if let Some(found) = self.direct(guess) {
            return Ok(found);
        }
        let (start, problem) = (array::<D>(&self.task.start), self.task.problem(self.plant));
        let mut nodes: Vec<Node<f64, D, N>> =
            guess.commands.iter().map(|u| Node::new(self.task.ticks_per_node, *u)).collect();
        let search = Ilqr::new(problem, self.task.options(), start, &mut nodes)?;
        let (end, solution) = self.shoot(search)?;
        Ok(Reached { nodes, end, solution, direct: false })
    }

    /// Searches with free states, and makes the motion that was found one of the plant; `None` if it meets no limits or no goal.
    fn direct<const D: usize, const N: usize>(&mut self, guess: &Motion<D, N>) -> Option<Reached<D, N>>
    where
        P: Plant<f64, D, N>,
    {
        let begin = guess.free.as_ref().filter(|_| !self.is_stopped())?;
        // The method has no equation of the energy.
        if self.task.goal.energy.is_some() {
            return None;
        }
        let problem = self.task.problem(self.plant);
        let mut search = Interior::new(&problem, begin, self.task.ticks_per_node, TOLERANCE).ok()?;
        let ended = search.solve(self.left().min(ITERATIONS), |iteration| self.watch(iteration)).ok()?;
        // Near the solution the search may stop at the rounding of the plant's steps.
        if ended == Ended::Stuck && search.gap() > ACCEPTED {
            return None;
        }
        let (mut nodes, goal) = search.into_nodes();
        let options = Options { penalty: CLOSE, ..self.task.options() };
        let start = array::<D>(&self.task.start);
        let near =
            Ilqr::near(problem, options, (start, &mut nodes), GoalMultipliers { state: goal, energy: 0.0 })
                .ok()?;
        let violation = near.violation();
        let (end, solution) = if violation <= CONTENT {
            let (status, cost) = (Status::Solved, near.plain_cost());
            (*near.end(), Solution { status, cost, violation, iterations: self.count() })
        } else {
            self.shoot(near).ok()?
        };
        (solution.violation <= ACCEPTED).then_some(Reached { nodes, end, solution, direct: true })
    }

    /// Searches by iterative LQR.
    fn shoot<Q: Plant<f64, D, N>, const D: usize, const N: usize>(
        &mut self,
        mut search: Ilqr<'_, Q, f64, D, N>,
    ) -> Result<([f64; D], Solution<f64>), StepError<f64>> {
        let solution = search.solve(|iteration| self.watch(iteration))?;
        Ok((*search.end(), Solution { iterations: self.count(), ..solution }))
    }

    /// Records an iteration; returns whether the search goes on.
    fn watch(&mut self, iteration: &Iteration<f64>) -> bool {
        let iteration = Iteration { count: self.count().saturating_add(1), ..*iteration };
        self.iterations.push(iteration);
        self.watched.1.iteration(&self.guess, self.nodes, &iteration);
        self.left() > 0 && !self.is_stopped()
    }

    fn is_stopped(&self) -> bool {
        self.watched.0.load(Ordering::Relaxed)
    }

    /// Number of iterations so far.
    fn count(&self) -> u16 {
        u16::try_from(self.iterations.len()).unwrap_or(u16::MAX)
    }

    /// Number of iterations that are left.
    fn left(&self) -> u16 {
        self.most.saturating_sub(self.count())
    }
}
