//! Swing-ups of exact mechanisms.

use core::f64::consts::PI;
use leastaction_core::control::{
    Cost, Ilqr, Limits, Node, Options, Penalty, Plant, Problem, Solution, Status, Stepped,
};
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Path};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{Actuator, System};
use leastaction_core::scalar::Real;

const H: f64 = 0.02;

/// A swing-up from rest to rest.
struct Task<const N: usize, const D: usize> {
    mechanism: Trigonometric<'static, N>,
    input: usize,
    start: [f64; D],
    goal: [f64; D],
    limit: f64,
    track: f64,
    nodes: usize,
}

const PENDULUM_TASK: Task<1, 2> = Task {
    mechanism: PENDULUM,
    input: 0,
    start: [PI, 0.0],
    goal: [0.0, 0.0],
    limit: 1.8,
    track: f64::INFINITY,
    nodes: 150,
};

const CARTPOLE_TASK: Task<2, 4> = Task {
    mechanism: CARTPOLE,
    input: 0,
    start: [0.0, PI, 0.0, 0.0],
    goal: [0.0; 4],
    limit: 12.0,
    track: 0.5,
    nodes: 100,
};

const ACROBOT_TASK: Task<2, 4> = Task {
    mechanism: ACROBOT,
    input: 1,
    start: [0.0; 4],
    goal: [PI, 0.0, 0.0, 0.0],
    limit: 12.0,
    track: f64::INFINITY,
    nodes: 200,
};

/// Result of a search, with the controls and the last state that it found.
struct Found<R, const D: usize> {
    solution: Solution<R>,
    nodes: Vec<Node<R, D, 1>>,
    end: [R; D],
}

impl<const N: usize, const D: usize> Task<N, D> {
    fn solve<R: Real, P: Path>(&self, options: Options<R>) -> Found<R, D> {
        let system = System::conservative(self.mechanism);
        let del = Del::<R, P>::new(R::constant(H));
        let plant =
            Stepped { system: &system, del, actuator: Actuator::ideal(), inputs: [self.input], stride: 1 };
        let (goal, limit) = (self.goal.map(R::constant), R::constant(self.limit));
        let mut hard = Penalty::none();
        (hard.limits.least[0], hard.limits.most[0]) = (R::constant(-self.track), R::constant(self.track));
        let problem = Problem {
            plant: &plant,
            cost: Cost {
                goal,
                turns: [false; D],
                x: [R::zero(); D],
                u: [R::constant(H)],
                end: [[R::zero(); D]; D],
            },
            controls: Limits { least: [-limit], most: [limit] },
            hard,
            soft: Penalty::none(),
            goal: Penalty { limits: Limits { least: goal, most: goal }, weights: [R::one(); D] },
            energy: Penalty::none(),
        };
        let mut nodes: Vec<Node<R, D, 1>> =
            (0..self.nodes).map(|k| Node::new(1, [R::constant(0.01 * (5.0 * H * k as f64).sin())])).collect();
        let mut search = Ilqr::new(problem, options, self.start.map(R::constant), &mut nodes).unwrap();
        let solution = search.solve(|_| true).unwrap();
        let end = *search.end();
        self.check(&plant, &nodes, &end);
        Found { solution, nodes, end }
    }

    /// The nodes are the motion of the plant under their controls, which are within limits.
    fn check<R: Real>(&self, plant: &impl Plant<R, D, 1>, nodes: &[Node<R, D, 1>], end: &[R; D]) {
        let mut motion = plant.begin(&nodes[0].x).unwrap();
        let mut x = nodes[0].x;
        for node in nodes {
            assert_eq!(node.x, x);
            assert!(node.u[0].abs() <= R::constant(self.limit));
            x = plant.advance(&mut motion, (node.ticks, &node.u), &mut [R::zero(); D]).unwrap();
        }
        assert_eq!(*end, x);
    }
}

const OPTIONS: Options<f64> =
    Options { iterations: 1000, tolerance: 1e-7, violation: 1e-6, penalty: 1.0, growth: 10.0 };

#[track_caller]
fn assert_reached<const D: usize>(found: &Found<f64, D>, goal: &[f64; D]) {
    assert_eq!(found.solution.status, Status::Solved, "{:?}", found.solution);
    assert!(found.end.iter().zip(goal).all(|(x, goal)| (x - goal).abs() < 1e-6), "{:?}", found.end);
}

#[test]
fn mechanisms_swing_up_within_their_limits() {
    assert_reached(&PENDULUM_TASK.solve::<f64, Midpoint>(OPTIONS), &PENDULUM_TASK.goal);
    assert_reached(&PENDULUM_TASK.solve::<f64, Galerkin>(OPTIONS), &PENDULUM_TASK.goal);
    assert_reached(&ACROBOT_TASK.solve::<f64, Midpoint>(OPTIONS), &ACROBOT_TASK.goal);
    let cartpole = CARTPOLE_TASK.solve::<f64, Midpoint>(OPTIONS);
    assert_reached(&cartpole, &CARTPOLE_TASK.goal);
    let farthest = cartpole.nodes.iter().map(|node| node.x[0].abs()).fold(0.0, f64::max);
    assert!(
        farthest > 0.49 && farthest < CARTPOLE_TASK.track + 1e-6,
        "the limit of the track holds: {farthest}"
    );
}

#[test]
fn single_precision_finds_the_same_motion() {
    let options =
        Options { iterations: 300, tolerance: 1e-5_f32, violation: 1e-4, penalty: 1.0, growth: 10.0 };
    let single = PENDULUM_TASK.solve::<f32, Midpoint>(options);
    assert_eq!(single.solution.status, Status::Solved);
    let double = PENDULUM_TASK.solve::<f64, Midpoint>(OPTIONS);
    let error = (single.solution.cost.to_f64() / double.solution.cost - 1.0).abs();
    assert!(error < 1e-3, "{error}");
}

/// A torque too small for the time leaves the pendulum below: the search says so.
#[test]
fn a_goal_out_of_reach_is_not_called_solved() {
    let task = Task { limit: 0.2, nodes: 50, ..PENDULUM_TASK };
    let found = task.solve::<f64, Midpoint>(OPTIONS);
    assert_eq!(found.solution.status, Status::Infeasible, "{:?}", found.solution);
    assert!(found.solution.violation > 0.1);
}

#[test]
fn a_search_ends_when_it_is_told_to() {
    let task = PENDULUM_TASK;
    let options = Options { iterations: 5, ..OPTIONS };
    let found = task.solve::<f64, Midpoint>(options);
    assert_eq!((found.solution.status, found.solution.iterations), (Status::Stopped, 5));
}
