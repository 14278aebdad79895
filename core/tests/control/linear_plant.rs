//! Linear plants, whose optimal controls are known.

use crate::common::Random;
use leastaction_core::control::{
    Cost, Ilqr, Limits, Node, Options, Penalty, Plant, Problem, Solution, Status, Transition,
};
use leastaction_core::discrete::StepError;
use leastaction_core::linear::{add_scaled_matrix, diagonal, dot, product};

/// x⁺ = Ax + Bu.
#[derive(Clone, Copy, Debug)]
pub struct Linear<const D: usize, const M: usize>(pub Transition<f64, D, M>);

impl<const D: usize, const M: usize> Linear<D, M> {
    /// A random system that neither grows nor decays much.
    pub fn random(seed: u64) -> Self {
        let mut random = Random(seed);
        let a = core::array::from_fn(|i| {
            let row: [f64; D] = random.array(0.3);
            core::array::from_fn(|j| row[j] + f64::from(i == j))
        });
        Self(Transition { a, b: core::array::from_fn(|_| random.array(0.8)) })
    }
}

impl<const D: usize, const M: usize> Plant<f64, D, M> for Linear<D, M> {
    type Motion = [f64; D];
    type Frame = ();

    fn begin(&self, x: &[f64; D]) -> Result<[f64; D], StepError<f64>> {
        Ok(*x)
    }

    fn advance(
        &self,
        motion: &mut [f64; D],
        (ticks, u): (u16, &[f64; M]),
        _: &mut [f64; D],
    ) -> Result<[f64; D], StepError<f64>> {
        for _ in 0..ticks {
            *motion = self.0.apply(motion, u);
        }
        Ok(*motion)
    }

    fn frame(&self, _: &[f64; D]) {}

    fn linearise(
        &self,
        _: [(&[f64; D], &()); 2],
        (ticks, _): (u16, &[f64; M]),
        _: &[f64; D],
    ) -> Result<Transition<f64, D, M>, StepError<f64>> {
        let Transition { a, b } = self.0;
        Ok((1..ticks).fold(self.0, |all, _| Transition {
            a: product(&a, &all.a),
            b: add_scaled_matrix(&product(&a, &all.b), 1.0, &b),
        }))
    }
}

pub const OPTIONS: Options<f64> =
    Options { iterations: 200, tolerance: 1e-14, violation: 1e-9, penalty: 1.0, growth: 10.0 };

/// A problem of five states and two controls over a linear plant.
pub fn problem() -> Problem<Linear<5, 2>, f64, 5, 2> {
    Problem {
        plant: Linear::random(4),
        cost: Cost {
            goal: [0.3, -0.2, 0.1, 0.0, 0.5],
            turns: [false; 5],
            x: [0.5, 0.2, 0.0, 0.7, 0.3],
            u: [0.6, 1.1],
            end: diagonal([2.0, 1.0, 3.0, 0.0, 1.5]),
        },
        controls: Limits { least: [-100.0; 2], most: [100.0; 2] },
        hard: Penalty::none(),
        soft: Penalty::none(),
        goal: Penalty::none(),
        energy: Penalty::none(),
    }
}

pub const START: [f64; 5] = [1.0, -0.7, 0.4, 0.9, -1.2];
pub const NODES: usize = 12;

pub fn nodes() -> Vec<Node<f64, 5, 2>> {
    vec![Node::new(1, [0.0; 2]); NODES]
}

/// Slope of the cost in every control, from the adjoint equation.
pub fn slopes(
    problem: &Problem<Linear<5, 2>, f64, 5, 2>,
    nodes: &[Node<f64, 5, 2>],
    end: &[f64; 5],
) -> Vec<[f64; 2]> {
    let (Transition { a, b }, cost) = (problem.plant.0, &problem.cost);
    let mut adjoint: [f64; 5] = core::array::from_fn(|i| dot(&cost.end[i], &cost.deviation(end)));
    let mut slopes = vec![];
    for node in nodes.iter().rev() {
        let by_u = |j: usize| cost.u[j] * node.u[j] + (0..5).map(|i| b[i][j] * adjoint[i]).sum::<f64>();
        slopes.push([by_u(0), by_u(1)]);
        let by_x = |i: usize| cost.x[i] * (node.x[i] - cost.goal[i]);
        adjoint = core::array::from_fn(|i| by_x(i) + (0..5).map(|k| a[k][i] * adjoint[k]).sum::<f64>());
    }
    slopes.reverse();
    slopes
}

#[test]
fn one_iteration_solves_a_linear_quadratic_problem() {
    let (problem, mut nodes) = (problem(), nodes());
    let mut search = Ilqr::new(problem, OPTIONS, START, &mut nodes).unwrap();
    let iteration = search.iterate().unwrap();
    assert_eq!(iteration.part, 1.0);
    let slopes = slopes(&problem, search.nodes(), search.end());
    assert!(slopes.as_flattened().iter().all(|slope| slope.abs() < 1e-12), "{slopes:?}");
}

/// A limit at one side alone, and none at all, hold no control back that stays inside.
#[test]
fn a_control_without_limits_is_no_control_at_one() {
    let infinite = f64::INFINITY;
    let one_side = Limits { least: [-100.0, -infinite], most: [infinite, 100.0] };
    for controls in [Limits::none(), one_side] {
        let (problem, mut nodes) = (Problem { controls, ..problem() }, nodes());
        let mut search = Ilqr::new(problem, OPTIONS, START, &mut nodes).unwrap();
        search.iterate().unwrap();
        let slopes = slopes(&problem, search.nodes(), search.end());
        assert!(slopes.as_flattened().iter().all(|slope| slope.abs() < 1e-12), "{slopes:?}");
    }
}

/// At a minimum within limits, the slope vanishes in every control inside, and points outward in every control at a limit.
#[test]
fn controls_at_their_limits_are_optimal() {
    let problem = Problem { controls: Limits { least: [-0.9, -1.2], most: [0.8, 0.7] }, ..problem() };
    let mut nodes = nodes();
    let mut search = Ilqr::new(problem, OPTIONS, START, &mut nodes).unwrap();
    let Solution { status, .. } = search.solve(|_| true).unwrap();
    assert_eq!(status, Status::Solved);
    let slopes = slopes(&problem, search.nodes(), search.end());
    let (mut inside, mut at_limit) = (0, 0);
    for (node, slopes) in search.nodes().iter().zip(slopes) {
        for (j, slope) in slopes.into_iter().enumerate() {
            let (least, most) = (problem.controls.least[j], problem.controls.most[j]);
            assert!((least..=most).contains(&node.u[j]));
            if node.u[j] == least {
                assert!(slope > 0.0, "{slope} at the lower limit");
                at_limit += 1;
            } else if node.u[j] == most {
                assert!(slope < 0.0, "{slope} at the upper limit");
                at_limit += 1;
            } else {
                assert!(slope.abs() < 1e-6, "{slope} inside");
                inside += 1;
            }
        }
    }
    assert!(inside > 3 && at_limit > 3, "{inside} inside, {at_limit} at a limit");
}

/// With the goal as an equation, the slope is B_kᵀ times one and the same multiplier, passed back: a system of more controls than
/// conditions, solved by least norm.
#[test]
fn a_goal_is_met_at_the_least_cost() {
    let base = problem();
    let cost = Cost { x: [0.0; 5], end: [[0.0; 5]; 5], u: [1.0; 2], ..base.cost };
    let limits = Limits { least: cost.goal, most: cost.goal };
    let problem = Problem { cost, goal: Penalty { limits, weights: [1.0; 5] }, ..base };
    let mut nodes = nodes();
    let mut search = Ilqr::new(problem, OPTIONS, START, &mut nodes).unwrap();
    let solution = search.solve(|_| true).unwrap();
    assert_eq!(solution.status, Status::Solved);
    let expected = least_norm(&problem.plant, &problem.cost.goal);
    assert!((solution.cost - expected).abs() < 1e-7 * expected, "{} instead of {expected}", solution.cost);
}

/// ½ |u|² of the controls of least norm that lead from the start to a goal.
fn least_norm(plant: &Linear<5, 2>, goal: &[f64; 5]) -> f64 {
    use leastaction_core::linear::{multiply, solve, transpose};
    let Transition { a, b } = plant.0;
    let (mut free, mut gram, mut spread) = (START, [[0.0; 5]; 5], b);
    for _ in 0..NODES {
        free = multiply(&a, &free);
        let square = product(&spread, &transpose(&spread));
        gram = add_scaled_matrix(&gram, 1.0, &square);
        spread = product(&a, &spread);
    }
    let missing: [f64; 5] = core::array::from_fn(|i| goal[i] - free[i]);
    0.5 * dot(&missing, &solve(gram, missing).unwrap())
}
