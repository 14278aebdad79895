//! Decisions over a receding horizon.

use crate::common::Random;
use crate::linear_plant::{Linear, START, problem};
use core::array::from_fn;
use core::f64::consts::PI;
use leastaction_core::continuous::{ContinuousState, rk4_step};
use leastaction_core::control::riccati::{Regulator, Weights, stationary};
use leastaction_core::control::{
    Action, Cost, Horizon, Limits, Node, Penalty, Plant, Problem, RecedingHorizon, Stepped, Terminal,
    Transition, sample,
};
use leastaction_core::discrete::{Del, Midpoint, StepError};
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM, Trigonometric, Wave};
use leastaction_core::forces::{Actuator, System};
use leastaction_core::linear::{dot, identity, multiply};
use leastaction_core::scalar::Real;

type Springy = Problem<Linear<5, 2>, f64, 5, 2>;

/// The problem of a linear plant whose end costs what remains under the regulator of `ticks` ticks, and that regulator.
fn regulated(ticks: u16) -> (Springy, Terminal<f64, 5, 2>) {
    let mut problem = problem();
    // A goal at which the plant rests without control, and a weight that sees every state.
    (problem.cost.goal, problem.cost.x[2]) = ([0.0; 5], 0.1);
    let transition = problem.plant.linearise_at(&[0.0; 5], (ticks, &[0.0; 2])).unwrap();
    let all = f64::from(ticks);
    let weights = Weights { x: problem.cost.x.map(|w| all * w), u: problem.cost.u.map(|w| all * w) };
    let Regulator { gain, cost } = stationary(&transition, &weights).unwrap();
    problem.cost.end = cost;
    (problem, Terminal { u: [0.0; 2], gain })
}

fn horizon(ticks: u16, terminal: Option<Terminal<f64, 5, 2>>) -> Horizon<f64, 5, 2> {
    Horizon { ticks, iterations: 1, trials: 12, penalty: 1.0, terminal }
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * (1.0 + expected.abs()), "{found} instead of {expected}");
}

/// An optimal motion stays what it is as its nodes move up: nothing is gained, and the cost to go falls by that of the ticks that passed.
#[test]
fn an_optimal_motion_stays_as_time_passes() {
    for (count, elapsed) in [(8, 1), (8, 3), (1, 1), (3, 3), (3, 7)] {
        let (problem, terminal) = regulated(1);
        let mut nodes = vec![Node::new(1, [0.0; 2]); count];
        let mut control =
            RecedingHorizon::new(problem, horizon(1, Some(terminal)), START, &mut nodes).unwrap();
        control.improve();
        for _ in 0..5 {
            let (before, mut x, mut passed) = (control.cost(), control.nodes()[0].x, 0.0);
            for tick in 0..elapsed {
                let law = || terminal.gain.map(|row| -dot(&row, &x));
                let u = control.nodes().get(tick).map_or_else(law, |node| node.u);
                passed += problem.running_cost(1, &x, &u);
                x = problem.plant.0.apply(&x, &u);
            }
            let action = control.decide(elapsed as u16, &x).unwrap();
            assert_eq!(control.nodes().len(), count);
            assert!(action.fall.abs() < 1e-12 * (1.0 + before), "{action:?}");
            assert_near(action.cost, before - passed, 1e-10);
            assert_near(action.u[0], -dot(&terminal.gain[0], &x), 1e-9);
        }
    }
}

/// Nodes of three ticks become shorter at the start until they are over; the motion and its cost to go are those of the same controls.
#[test]
fn the_grid_is_fixed_in_time() {
    let (mut problem, terminal) = regulated(3);
    // Costs of controls alone do not depend on where a node is divided.
    problem.cost.x = [0.0; 5];
    let mut nodes = vec![Node::new(2, [0.3, -0.1]), Node::new(3, [0.1, 0.4]), Node::new(3, [-0.2, 0.2])];
    let still = Horizon { iterations: 0, ..horizon(3, Some(terminal)) };
    let mut control = RecedingHorizon::new(problem, still, START, &mut nodes).unwrap();
    let mut x = START;
    for (first, ticks) in [[1, 3, 3], [3, 3, 3], [2, 3, 3], [1, 3, 3], [3, 3, 3]].into_iter().enumerate() {
        let (before, end, u) = (control.cost(), *control.end(), control.nodes()[0].u);
        x = problem.plant.0.apply(&x, &u);
        let action = control.decide(1, &x).unwrap();
        let found: Vec<u16> = control.nodes().iter().map(|node| node.ticks).collect();
        assert_eq!(found, ticks, "after {} ticks", first + 1);
        if ticks[0] < 3 {
            assert_near(action.cost, before - problem.running_cost(1, &x, &u), 1e-12);
            assert!(control.end().iter().zip(end).all(|(x, end)| (x - end).abs() < 1e-12));
        }
    }
}

/// Without a regulator the node that enters keeps the last control; several nodes and a part of one may pass at once.
#[test]
fn nodes_enter_with_the_last_control() {
    let (problem, _) = regulated(1);
    let controls = [[0.3, -0.1], [0.1, 0.4], [-0.2, 0.2]];
    let mut nodes = controls.map(|u| Node::new(2, u));
    let still = Horizon { iterations: 0, ..horizon(4, None) };
    let mut control = RecedingHorizon::new(problem, still, START, &mut nodes).unwrap();
    control.decide(3, &START).unwrap();
    let found: Vec<_> = control.nodes().iter().map(|node| (node.ticks, node.u)).collect();
    assert_eq!(found, [(1, controls[1]), (2, controls[2]), (4, controls[2])]);
    // Beyond the horizon of seven ticks, nodes of four that entered have passed, too.
    control.decide(7 + 4 + 1, &START).unwrap();
    let found: Vec<_> = control.nodes().iter().map(|node| (node.ticks, node.u)).collect();
    assert_eq!(found, [(3, controls[2]), (4, controls[2]), (4, controls[2])]);
}

/// From another state than expected, the motion follows the last one by its gains, in a node that is partly over too.
#[test]
fn a_deviation_is_fed_back() {
    let (problem, terminal) = regulated(2);
    let mut nodes = vec![Node::new(2, [0.0; 2]); 4];
    let mut control = RecedingHorizon::new(problem, horizon(2, Some(terminal)), START, &mut nodes).unwrap();
    let Action { u, gain, .. } = control.improve();
    let still = problem.plant.0.apply(&START, &u);
    let pushed: [f64; 5] = from_fn(|i| still[i] + 0.01 * i as f64);
    control.follow(1, &pushed).unwrap();
    let deviation = from_fn(|i| pushed[i] - still[i]);
    for (j, row) in gain.iter().enumerate() {
        assert_near(control.nodes()[0].u[j], u[j] - dot(row, &deviation), 1e-12);
    }
    assert_eq!((control.nodes()[0].ticks, control.nodes()[0].x), (1, pushed));
}

#[test]
fn a_proposal_is_taken_if_it_costs_less() {
    let (problem, terminal) = regulated(1);
    let mut nodes = vec![Node::new(1, [0.7; 2]); 6];
    let mut control = RecedingHorizon::new(problem, horizon(1, Some(terminal)), START, &mut nodes).unwrap();
    let before = (control.cost(), control.nodes().to_vec());
    assert_eq!(control.propose(&[[5.0; 2]; 6]), Ok(false));
    assert_eq!((control.cost(), control.nodes()[3].u), (before.0, before.1[3].u));
    // No controls: the regulator, which is optimal here.
    assert_eq!(control.propose(&[]), Ok(true));
    let expected = 0.5 * dot(&START, &multiply(&problem.cost.end, &START));
    assert_near(control.cost(), expected, 1e-10);
    assert_eq!(control.nodes()[2].gain, terminal.gain);
    assert!(control.improve().fall.abs() < 1e-12 * expected);
}

/// Decisions that are resumed from their progress are those of a search that stays.
#[test]
fn a_search_is_resumed() {
    let (problem, terminal) = regulated(2);
    let horizon = horizon(2, Some(terminal));
    let (mut nodes, mut kept) = (vec![Node::new(2, [0.4; 2]); 5], vec![Node::new(2, [0.4; 2]); 5]);
    let mut stays = RecedingHorizon::new(problem, horizon, START, &mut nodes).unwrap();
    let begun = RecedingHorizon::new(problem, horizon, START, &mut kept).unwrap();
    let (mut progress, mut x) = (begun.progress(), START);
    for elapsed in [1, 2, 1, 3] {
        let expected = stays.decide(elapsed, &x).unwrap();
        let mut resumed = RecedingHorizon::resume(problem, horizon, progress, &mut kept);
        assert_eq!(resumed.decide(elapsed, &x).unwrap(), expected);
        progress = resumed.progress();
        x = problem.plant.0.apply(&x, &expected.u).map(|x| 1.02 * x);
    }
}

#[test]
fn the_last_motion_is_held_without_a_plant() {
    let (problem, terminal) = regulated(2);
    let mut nodes = vec![Node::new(2, [0.0; 2]); 2];
    let mut control = RecedingHorizon::new(problem, horizon(2, Some(terminal)), START, &mut nodes).unwrap();
    control.improve();
    let [first, last] = [0, 1].map(|k| control.nodes()[k]);
    assert_eq!(control.held(0, &first.x), Some(first.u));
    assert_eq!(control.held(2, &last.x), Some(last.u));
    // Half way the reference is the mean of both ends.
    let middle = from_fn(|i| 0.5 * (last.x[i] + control.end()[i]));
    let u = control.held(3, &middle).unwrap();
    assert!((0..2).all(|j| (u[j] - last.u[j]).abs() < 1e-12));
    let off: [f64; 5] = from_fn(|i| first.x[i] + 0.01 * i as f64);
    let expected = first.u[0] - dot(&first.gain[0], &from_fn(|i| off[i] - first.x[i]));
    assert_near(control.held(0, &off).unwrap()[0], expected, 1e-12);
    assert_eq!(control.held(4, &last.x), None);
    assert_eq!(control.held(0, &[f64::NAN; 5]), None);
}

#[test]
fn samples_repeat_within_their_limits() {
    let limits = Limits { least: [-2.0_f32, f32::NEG_INFINITY], most: [6.0, -1.0] };
    let filled = |seed: u64| {
        let mut controls = [[0.0; 2]; 10];
        sample(seed, 4, &limits, &mut controls);
        controls
    };
    let controls = filled(7);
    assert_eq!(controls, filled(7));
    assert_ne!(controls, filled(8));
    assert!(controls.iter().all(|u| (-2.0..6.0).contains(&u[0]) && u[1] == -1.0), "{controls:?}");
    for piece in controls.chunks(4) {
        assert!(piece.iter().all(|u| u == &piece[0]));
    }
    assert!(controls[0] != controls[4] && controls[4] != controls[8]);
    let mut all = vec![[0.0; 2]; 4000];
    sample(3, 1, &limits, &mut all);
    let mean = all.iter().map(|u| f64::from(u[0])).sum::<f64>() / 4000.0;
    assert!((mean - 2.0).abs() < 0.15, "{mean}");
}

#[test]
fn a_horizon_without_nodes_is_its_terminal_law() {
    let (problem, terminal) = regulated(1);
    let mut control = RecedingHorizon::new(problem, horizon(1, Some(terminal)), START, &mut []).unwrap();
    let action = control.decide(1, &[0.1; 5]).unwrap();
    assert_eq!(action.u, terminal.gain.map(|row| -dot(&row, &[0.1; 5])));
    assert_eq!((action.x, action.gain), ([0.1; 5], terminal.gain));
}

/// A plant that cannot be stepped far away, and which may have no derivatives.
#[derive(Clone, Copy, Debug)]
struct Bounded {
    plant: Linear<5, 2>,
    linearises: bool,
}

fn bounded(linearises: bool) -> (Problem<Bounded, f64, 5, 2>, Terminal<f64, 5, 2>) {
    let (base, terminal) = regulated(2);
    let Problem { plant, cost, controls, hard, soft, goal, energy } = base;
    let plant = Bounded { plant, linearises };
    (Problem { plant, cost, controls, hard, soft, goal, energy }, terminal)
}

impl Plant<f64, 5, 2> for Bounded {
    type Motion = [f64; 5];
    type Frame = ();

    fn begin(&self, x: &[f64; 5]) -> Result<[f64; 5], StepError<f64>> {
        if x.iter().all(|x| x.is_finite()) { Ok(*x) } else { Err(StepError::NotFinite) }
    }

    fn advance(
        &self,
        motion: &mut [f64; 5],
        held: (u16, &[f64; 2]),
        course: &mut [f64; 5],
    ) -> Result<[f64; 5], StepError<f64>> {
        let x = self.plant.advance(motion, held, course)?;
        if x.iter().all(|x| x.abs() < 20.0) { Ok(x) } else { Err(StepError::Singular { column: 3 }) }
    }

    fn frame(&self, _: &[f64; 5]) {}

    fn linearise(
        &self,
        ends: [(&[f64; 5], &()); 2],
        held: (u16, &[f64; 2]),
        course: &[f64; 5],
    ) -> Result<Transition<f64, 5, 2>, StepError<f64>> {
        if !self.linearises {
            return Err(StepError::Singular { column: 1 });
        }
        self.plant.linearise(ends, held, course)
    }
}

#[test]
fn errors_change_nothing() {
    let (problem, terminal) = bounded(true);
    let mut nodes = vec![Node::new(2, [0.0; 2]); 4];
    let mut control = RecedingHorizon::new(problem, horizon(2, Some(terminal)), START, &mut nodes).unwrap();
    control.improve();
    let public = |control: &RecedingHorizon<Bounded, f64, 5, 2>| {
        let nodes = control.nodes().iter();
        let each: Vec<_> =
            nodes.map(|node| (node.ticks, node.x, node.u, node.gain, node.change, node.course)).collect();
        (each, *control.end(), control.cost())
    };
    let before = public(&control);
    let failed = Err(StepError::Singular { column: 3 });
    for elapsed in [0, 1, 2, 5, 100] {
        assert_eq!(control.follow(elapsed, &[19.9; 5]), failed);
        assert_eq!(control.follow(elapsed, &[f64::NAN; 5]), Err(StepError::NotFinite));
        assert_eq!(control.decide(elapsed, &[1e200; 5]).map(|_| ()), failed);
    }
    assert_eq!(control.propose(&[[90.0; 2]]), Err(StepError::Singular { column: 3 }));
    assert_eq!(public(&control), before);
    // The last motion goes on.
    let next = control.nodes()[1].x;
    assert!(control.decide(2, &next).unwrap().fall.abs() < 1e-10);
}

/// A linearisation that fails ends the iterations; the motion that follows the last one is still the decision.
#[test]
fn an_iteration_that_fails_leaves_the_motion() {
    let (problem, _) = bounded(false);
    let mut nodes = vec![Node::new(1, [0.1; 2]); 3];
    let horizon = Horizon { iterations: 3, ..horizon(1, None) };
    let mut control = RecedingHorizon::new(problem, horizon, START, &mut nodes).unwrap();
    let action = control.decide(1, &START).unwrap();
    assert_eq!(action.failed, Some(StepError::Singular { column: 1 }));
    assert_eq!((action.x, action.u, action.fall), (START, [0.1; 2], 0.0));
    assert_eq!(action.cost, control.cost());
}

/// Tick, s.
const H: f64 = 0.02;
/// Largest number of ticks of a step.
const STRIDE: u16 = 2;

/// Upright, from anywhere, the angle the short way; it is the last coordinate.
fn swing_up<P: Plant<R, D, 1>, R: Real, const N: usize, const D: usize>(
    plant: P,
    end: [[R; D]; D],
    limit: f64,
    [q, v]: [f64; 2],
) -> Problem<P, R, D, 1> {
    let limit = R::constant(limit);
    Problem {
        plant,
        cost: Cost {
            goal: [R::zero(); D],
            turns: from_fn(|i| i == N - 1),
            x: from_fn(|i| R::constant(if i < N { H * q } else { H * v })),
            u: [R::constant(0.1 * H)],
            end,
        },
        controls: Limits { least: [-limit], most: [limit] },
        hard: Penalty::none(),
        soft: Penalty::none(),
        goal: Penalty::none(),
        energy: Penalty::none(),
    }
}

/// A swing-up of a plant whose masses are 5% off.
struct Task<const N: usize> {
    model: Trigonometric<'static, N>,
    truth: Trigonometric<'static, N>,
    limit: f64,
    /// Weights of position and velocity per second.
    weights: [f64; 2],
    /// Number of nodes of two ticks.
    nodes: usize,
    /// Time after which the pole stands, s.
    seconds: f64,
    /// Push of the velocities then.
    push: [f64; N],
}

const PENDULUM_TASK: Task<1> = Task {
    model: PENDULUM,
    truth: Trigonometric {
        inertia: &[(0, 0, Wave { amplitude: 1.05 / 3.0, wave: [0.0] })],
        potential: &[Wave { amplitude: 1.05 * 9.81 / 2.0, wave: [1.0] }],
    },
    limit: 2.0,
    weights: [1.0, 0.1],
    nodes: 30,
    seconds: 5.0,
    push: [1.0],
};

const CARTPOLE_TASK: Task<2> = Task {
    model: CARTPOLE,
    truth: Trigonometric {
        inertia: &[
            (0, 0, Wave { amplitude: 0.95 + 0.105, wave: [0.0, 0.0] }),
            (1, 0, Wave { amplitude: 1.05 * 0.05, wave: [0.0, 1.0] }),
            (1, 1, Wave { amplitude: 1.05 * 0.1 / 3.0, wave: [0.0, 0.0] }),
        ],
        potential: &[Wave { amplitude: 1.05 * 0.05 * 9.81, wave: [0.0, 1.0] }],
    },
    limit: 12.0,
    weights: [1.0, 0.1],
    nodes: 25,
    seconds: 3.6,
    push: [0.0, 1.5],
};

/// Number of samples that are proposed at a decision.
const LANES: u64 = 2;

impl<const N: usize> Task<N> {
    /// Controls the plant from a random state; returns the largest deviation of the pole in the last half second before the push, and that
    /// long after it, with the last command.
    fn run<R: Real, const D: usize>(&self, seed: u64) -> [f64; 3] {
        let system = System::conservative(self.model);
        let (del, actuator) = (Del::<R, Midpoint>::new(R::constant(H)), Actuator::ideal());
        let plant = Stepped { system: &system, del, actuator, inputs: [0], stride: STRIDE };
        let problem = swing_up::<_, R, N, D>(&plant, identity(), self.limit, self.weights);
        let transition = plant.linearise_at(&[R::zero(); D], (2, &[R::zero()])).unwrap();
        let twice = |w: R| w + w;
        let weights = Weights { x: problem.cost.x.map(twice), u: problem.cost.u.map(twice) };
        let Regulator { gain, cost: end } = stationary(&transition, &weights).unwrap();
        let problem = Problem { cost: Cost { end, ..problem.cost }, ..problem };
        let terminal = Some(Terminal { u: [R::zero()], gain });
        let horizon = Horizon { ticks: 2, iterations: 2, trials: 12, penalty: R::one(), terminal };
        let mut random = Random(seed);
        let mut x: [f64; D] = from_fn(|i| random.symmetric(if i == N - 1 { PI } else { 0.5 }));
        let mut nodes = vec![Node::new(2, [R::zero()]); self.nodes];
        let mut control = RecedingHorizon::new(problem, horizon, x.map(R::constant), &mut nodes).unwrap();
        let (ticks, half) = ((self.seconds / H) as u64, (0.5 / H) as u64);
        let (mut worst, mut controls, mut u) = ([0.0_f64; 2], vec![[R::zero()]; self.nodes], R::zero());
        for tick in 0..2 * ticks {
            control.follow((tick > 0).into(), &x.map(R::constant)).unwrap();
            for lane in 0..LANES {
                sample(seed + 1000 * (LANES * tick + lane), 6, &problem.controls, &mut controls);
                control.propose(&controls).unwrap();
            }
            let action = control.improve();
            assert_eq!(action.failed, None);
            u = action.u[0];
            assert!(u.abs() <= R::constant(self.limit));
            x = self.moved(x, u.to_f64());
            if tick == ticks {
                x = from_fn(|i| if i < N { x[i] } else { x[i] + self.push[i - N] });
            }
            if tick % ticks >= ticks - half {
                let worst = &mut worst[(tick / ticks) as usize];
                *worst = worst.max(x[N - 1].short_way().abs());
            }
        }
        [worst[0], worst[1], u.to_f64()]
    }

    /// A tick of the plant, in finer steps.
    fn moved<const D: usize>(&self, x: [f64; D], u: f64) -> [f64; D] {
        let system = System::conservative(self.truth);
        let tau = from_fn(|i| if i == 0 { u } else { 0.0 });
        let mut state = ContinuousState { q: from_fn(|i| x[i]), v: from_fn(|i| x[N + i]) };
        for _ in 0..10 {
            state = rk4_step(&system, &state, &tau, H / 10.0).unwrap();
        }
        from_fn(|i| if i < N { state.q[i] } else { state.v[i - N] })
    }

    fn check<R: Real, const D: usize>(&self) {
        for seed in 0..20 {
            let [before, after, _] = self.run::<R, D>(seed);
            assert!(before < 0.05 && after < 0.05, "start {seed}: {before} and {after} rad");
        }
    }
}

#[test]
fn a_pendulum_swings_up_and_survives_a_push() {
    PENDULUM_TASK.check::<f64, 2>();
}

#[test]
fn a_pendulum_swings_up_in_single_precision() {
    PENDULUM_TASK.check::<f32, 2>();
}

#[test]
fn a_cart_pole_swings_up_and_survives_a_push() {
    CARTPOLE_TASK.check::<f64, 4>();
}

#[test]
fn a_cart_pole_swings_up_in_single_precision() {
    CARTPOLE_TASK.check::<f32, 4>();
}

#[test]
fn decisions_repeat() {
    let runs = [0, 1].map(|_| CARTPOLE_TASK.run::<f32, 4>(3).map(f64::to_bits));
    assert_eq!(runs[0], runs[1]);
}
