//! The interior-point method on linear plants, against iterative LQR and against optimality itself.

use leastaction_core::control::{
    Cost, GoalMultipliers, Ilqr, Limits, Node, Options, Penalty, Plant, Problem, Status, Transition,
};
use leastaction_core::discrete::StepError;
use leastaction_core::linear::diagonal;
use leastaction_planning::interior::{Ended, FreeMotion, Interior};

/// x⁺ = Ax + Bu: two coupled masses on springs, pushed at both.
#[derive(Clone, Copy)]
struct Springs;

const STEP: Transition<f64, 4, 2> = Transition {
    a: [[1.0, 0.0, 0.1, 0.0], [0.0, 1.0, 0.0, 0.1], [-0.3, 0.1, 0.97, 0.01], [0.2, -0.25, 0.02, 0.99]],
    b: [[0.0, 0.0], [0.0, 0.0], [0.1, 0.0], [0.0, 0.07]],
};

impl Plant<f64, 4, 2> for Springs {
    type Motion = [f64; 4];
    type Frame = ();

    fn begin(&self, x: &[f64; 4]) -> Result<[f64; 4], StepError<f64>> {
        if x.iter().all(|x| x.is_finite()) { Ok(*x) } else { Err(StepError::NotFinite) }
    }

    fn advance(
        &self,
        x: &mut [f64; 4],
        (_, u): (u16, &[f64; 2]),
        _: &mut [f64; 4],
    ) -> Result<[f64; 4], StepError<f64>> {
        *x = STEP.apply(x, u);
        Ok(*x)
    }

    fn frame(&self, _: &[f64; 4]) {}

    fn linearise(
        &self,
        _: [(&[f64; 4], &()); 2],
        _: (u16, &[f64; 2]),
        _: &[f64; 4],
    ) -> Result<Transition<f64, 4, 2>, StepError<f64>> {
        Ok(STEP)
    }
}

type Springy = Problem<Springs, f64, 4, 2>;

const START: [f64; 4] = [1.0, -0.5, 0.0, 0.3];
const NODES: usize = 40;

/// No limits, no goal: a cost of all states, of the controls and of the end.
fn free() -> Springy {
    Problem {
        plant: Springs,
        cost: Cost {
            goal: [0.2, 0.1, 0.0, -0.1],
            turns: [false; 4],
            x: [0.3, 0.1, 0.05, 0.2],
            u: [0.1, 0.4],
            end: diagonal([3.0, 2.0, 1.0, 0.5]),
        },
        controls: Limits { least: [-1e3; 2], most: [1e3; 2] },
        hard: Penalty::none(),
        soft: Penalty::none(),
        goal: Penalty::none(),
        energy: Penalty::none(),
    }
}

/// Limits of all kinds that are reached, and a goal with equations, a range and a number that may be any.
fn limited() -> Springy {
    let mut problem = free();
    problem.controls = Limits { least: [-1.2, -2.0], most: [0.9, 1.5] };
    problem.hard.limits = Limits { least: [f64::NEG_INFINITY, -1.0, -1.3, -9.0], most: [1.4, 9.0, 9.0, 1.1] };
    let any = f64::INFINITY;
    problem.goal.limits = Limits { least: [0.5, -any, 0.0, 0.2], most: [0.5, any, 0.0, 0.3] };
    problem
}

const OPTIONS: Options<f64> =
    Options { iterations: 500, tolerance: 1e-13, violation: 1e-9, penalty: 10.0, growth: 10.0 };

/// Cost, nodes and multipliers of the goal from states that no controls make.
fn solved(problem: &Springy) -> (f64, Vec<Node<f64, 4, 2>>, [f64; 4]) {
    let line: Vec<_> = (0..NODES).map(|k| START.map(|x| x * (1.0 - k as f64 / NODES as f64))).collect();
    let begin = FreeMotion { x: line, u: vec![[0.0; 2]; NODES], end: [0.0; 4] };
    let mut search = Interior::new(problem, &begin, 1, 1e-9).unwrap();
    let mut last = None;
    let ended = search.solve(100, |iteration| {
        last = Some(*iteration);
        true
    });
    assert_eq!(ended.unwrap(), Ended::Solved);
    assert!(search.gap() < 1e-9);
    let (nodes, goal) = search.into_nodes();
    (last.unwrap().cost, nodes, goal)
}

/// Cost that iterative LQR finds.
fn by_shooting(problem: Springy) -> f64 {
    let mut nodes = vec![Node::new(1, [0.0; 2]); NODES];
    let mut search = Ilqr::new(problem, OPTIONS, START, &mut nodes).unwrap();
    let solution = search.solve(|_| true).unwrap();
    assert_eq!(solution.status, Status::Solved);
    solution.cost
}

#[test]
fn shooting_and_free_states_find_the_same_motion() {
    for problem in [free(), limited()] {
        let (cost, ..) = solved(&problem);
        let expected = by_shooting(problem);
        assert!((cost - expected).abs() < 1e-6 * expected, "{cost} instead of {expected}");
    }
}

#[test]
fn limits_hold_and_are_reached() {
    let problem = limited();
    let (_, nodes, _) = solved(&problem);
    let Problem { controls, hard, .. } = &problem;
    let inside = |x: f64, least: f64, most: f64| x > least && x < most;
    for node in &nodes {
        assert!((0..2).all(|j| inside(node.u[j], controls.least[j], controls.most[j])), "{node:?}");
    }
    for node in &nodes[1..] {
        assert!((0..4).all(|i| inside(node.x[i], hard.limits.least[i], hard.limits.most[i])), "{node:?}");
    }
    let near =
        |of: &dyn Fn(&Node<f64, 4, 2>) -> f64| nodes.iter().filter(|node| of(node).abs() < 1e-6).count();
    assert!(near(&|node| node.u[0] + 1.2) > 1, "a control at its limit");
    assert!(near(&|node| node.x[2] + 1.3) > 0, "a state at its limit");
}

/// The multipliers are those of the augmented Lagrangian: from them and the motion, it finds nothing to change.
#[test]
fn multipliers_are_those_of_shooting() {
    let problem = limited();
    let (_, mut nodes, goal) = solved(&problem);
    let options = Options { penalty: 1e3, ..OPTIONS };
    let goal = GoalMultipliers { state: goal, energy: 0.0 };
    let mut near = Ilqr::near(problem, options, (START, &mut nodes), goal).unwrap();
    assert!(near.violation() < 1e-6);
    let iteration = near.iterate().unwrap();
    assert!(iteration.expected.abs() < 1e-6 * iteration.cost, "{iteration:?}");
}

#[test]
fn a_goal_out_of_reach_is_not_called_solved() {
    let mut problem = limited();
    problem.goal.limits = Limits { least: [90.0; 4], most: [90.0; 4] };
    let begin = FreeMotion { x: vec![START; NODES], u: vec![[0.0; 2]; NODES], end: START };
    let mut search = Interior::new(&problem, &begin, 1, 1e-9).unwrap();
    assert_ne!(search.solve(300, |_| true).unwrap(), Ended::Solved);
    assert!(search.gap() > 0.1);
}

#[test]
fn a_search_ends_when_it_is_told_to() {
    let problem = limited();
    let begin = FreeMotion { x: vec![START; NODES], u: vec![[0.0; 2]; NODES], end: START };
    let mut search = Interior::new(&problem, &begin, 1, 1e-9).unwrap();
    let mut seen = 0;
    let ended = search.solve(100, |_| {
        seen += 1;
        seen < 3
    });
    assert_eq!((ended.unwrap(), seen), (Ended::Stopped, 3));
}

#[test]
fn a_state_that_is_not_a_number_is_refused() {
    let problem = free();
    let begin = FreeMotion { x: vec![[f64::NAN; 4]; NODES], u: vec![[0.0; 2]; NODES], end: START };
    assert!(matches!(Interior::new(&problem, &begin, 1, 1e-9), Err(StepError::NotFinite)));
}
