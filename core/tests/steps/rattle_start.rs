//! Other starts of RATTLE than a position and a velocity: a saved state, and two positions.

use crate::common::file::{Aligned, golden_web};
use crate::common::particles::{Exact, Spring, hanging, rods, rounded, workspaces};
use leastaction_core::constraints::{Constrained, ConstraintError, Holonomic};
use leastaction_core::discrete::{
    Order,
    rattle::{ParticleState, Rattle},
};
use leastaction_core::energy::graph::{Edge, Graph};
use leastaction_core::model::GraphModel;
use leastaction_core::particles::Particles;
use leastaction_core::scalar::Real;

const LENGTHS: [f64; 2] = [1.0, 0.8];
const H: f64 = 0.005;

/// Two bobs on rods and a third on a spring; drag, a kinetic energy that is not quadratic, a force.
struct Case<R> {
    system: Exact<R, 2>,
    constraints: Vec<Holonomic<R, 2>>,
    q: Vec<[R; 2]>,
    v: Vec<[R; 2]>,
    force: Vec<[R; 2]>,
}

impl<R: Real> Case<R> {
    fn new() -> Self {
        let mut system = Exact::under_gravity(&[1.0, 1.5, 0.7], 10.0).hard();
        system.springs = vec![Spring { nodes: [1, 2], stiffness: R::constant(30.0), rest: R::constant(0.9) }];
        let (mut q, mut v) = hanging(&LENGTHS, &[0.7, -0.5], &[0.4, 1.2]);
        q.push([0.1, -1.9]);
        v.push([-0.6, 0.3]);
        let force = rounded(&[[3.0, 0.7], [1.0, -0.7], [-1.0, 0.2]]);
        Self { system, constraints: rods(&LENGTHS, true), q: rounded(&q), v: rounded(&v), force }
    }

    fn mechanism(&self) -> Constrained<'_, R, Exact<R, 2>, [Holonomic<R, 2>], 2> {
        Constrained::new(&self.system, &self.constraints[..]).unwrap()
    }

    /// Takes a step, and saves the state.
    fn step(&self, rattle: &Rattle<R>, state: &mut ParticleState<R, 2>) -> Vec<R> {
        let mechanism = self.mechanism();
        let (_, mut work) = workspaces(&mechanism);
        rattle.step(&mechanism, state, Some(&self.force), &mut work).unwrap();
        saved(state)
    }

    /// A motion that is resumed from a saved state before every step has the bits of a motion that is not
    /// interrupted.
    fn resumes(&self, order: Order) {
        let (mechanism, rattle) = (self.mechanism(), Rattle::new(R::constant(H), order));
        let (mut numbers, mut work) = workspaces(&mechanism);
        let mut state = ParticleState::new(&mechanism, &self.q, &self.v, &mut numbers, &mut work).unwrap();
        let mut last = saved(&state);
        for k in 0..100 {
            // Earlier contents of the workspace do not matter.
            let mut place = vec![R::constant(7.0); ParticleState::<R, 2>::workspace(3, 2)];
            let mut resumed = ParticleState::resume(&mechanism, &last, &mut place).unwrap();
            assert_eq!(saved(&resumed), last);
            last = self.step(&rattle, &mut state);
            assert_eq!(self.step(&rattle, &mut resumed), last, "step {k}");
            assert_eq!((resumed.q(), resumed.lambda()), (state.q(), state.lambda()));
        }
    }

    /// Two consecutive positions of a motion give the state at the second.
    fn starts_between(&self, order: Order, tolerance: f64) {
        let (mechanism, rattle) = (self.mechanism(), Rattle::new(R::constant(H), order));
        let (mut numbers, mut work) = workspaces(&mechanism);
        let mut state = ParticleState::new(&mechanism, &self.q, &self.v, &mut numbers, &mut work).unwrap();
        for _ in 0..20 {
            let q0 = state.q().to_vec();
            self.step(&rattle, &mut state);
            let (mut place, _) = workspaces(&mechanism);
            let found =
                rattle.start(&mechanism, [&q0, state.q()], Some(&self.force), &mut place, &mut work).unwrap();
            for (name, found, expected) in
                [("q", found.q(), state.q()), ("v", found.v(), state.v()), ("p", found.p(), state.p())]
            {
                assert!(distance(found, expected) < tolerance, "{name}: {found:?}, {expected:?}");
            }
        }
    }
}

fn saved<R: Real>(state: &ParticleState<R, 2>) -> Vec<R> {
    let mut numbers = vec![R::zero(); ParticleState::<R, 2>::saved(state.q().len(), state.lambda().len())];
    state.save(&mut numbers).unwrap();
    numbers
}

fn distance<R: Real>(a: &[[R; 2]], b: &[[R; 2]]) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.fold(0.0, |most, (a, b)| most.max((a.to_f64() - b.to_f64()).abs()))
}

#[test]
fn a_resumed_motion_has_the_bits_of_the_whole_one() {
    for order in [Order::Two, Order::Four] {
        Case::<f32>::new().resumes(order);
        Case::<f64>::new().resumes(order);
    }
    let mut free = Case::<f32>::new();
    free.constraints.clear();
    let mechanism = free.mechanism();
    let (mut numbers, mut work) = workspaces(&mechanism);
    let state = ParticleState::new(&mechanism, &free.q, &free.v, &mut numbers, &mut work).unwrap();
    let last = saved(&state);
    let (mut place, _) = workspaces(&mechanism);
    assert_eq!(saved(&ParticleState::resume(&mechanism, &last, &mut place).unwrap()), last);
}

#[test]
fn saved_numbers_are_in_the_order_that_is_said() {
    let case = Case::<f32>::new();
    let mechanism = case.mechanism();
    let (mut numbers, mut work) = workspaces(&mechanism);
    let mut state = ParticleState::new(&mechanism, &case.q, &case.v, &mut numbers, &mut work).unwrap();
    let all = case.step(&Rattle::new(0.01, Order::Two), &mut state);
    let vectors = [state.q(), state.q_carry(), state.p(), state.p_carry(), state.v()];
    assert_eq!(all[..30], vectors.map(|x| x.as_flattened()).concat());
    assert_eq!(&all[36..], state.lambda());
    let mut internal = [[0.0; 2]; 3];
    case.system.l_q(state.q(), &mut [], &mut internal);
    for (node, (found, v)) in internal.iter().zip(state.v()).enumerate() {
        let drag = case.system.drag(node, v);
        assert_eq!(all[30 + 2 * node..][..2], [found[0] + drag[0], found[1] + drag[1]]);
    }
}

#[test]
fn what_is_no_saved_state_is_refused() {
    let case = Case::<f64>::new();
    let mechanism = case.mechanism();
    let (mut numbers, mut work) = workspaces(&mechanism);
    let state = ParticleState::new(&mechanism, &case.q, &case.v, &mut numbers, &mut work).unwrap();
    let all = saved(&state);
    assert_eq!(all.len(), 38);
    for given in [0, 37, 39] {
        let wrong = ConstraintError::Shape { expected: 38, given };
        assert_eq!(state.save(&mut vec![0.0; given]), Err(wrong));
        let (mut place, _) = workspaces(&mechanism);
        let resumed = ParticleState::resume(&mechanism, &vec![0.0; given], &mut place);
        assert_eq!(resumed.map(drop), Err(wrong));
    }
    let mut place = [0.0; 75];
    let short = ParticleState::resume(&mechanism, &all, &mut place);
    assert_eq!(short.map(drop), Err(ConstraintError::Workspace { needed: 76, given: 75 }));
    for bad in [f64::NAN, f64::INFINITY] {
        for slot in [0, 20, 37] {
            let (mut broken, (mut place, _)) = (all.clone(), workspaces(&mechanism));
            broken[slot] = bad;
            let resumed = ParticleState::resume(&mechanism, &broken, &mut place);
            assert_eq!(resumed.map(drop), Err(ConstraintError::NotFinite));
        }
    }
}

#[test]
fn two_positions_determine_the_state() {
    for order in [Order::Two, Order::Four] {
        Case::<f64>::new().starts_between(order, 1e-12);
        // Positions of 2 m are known to 1.2e-7 m, which is 2.4e-5 m/s over a step, and each of the three masses adds
        // its share.
        Case::<f32>::new().starts_between(order, 2e-4);
    }
}

#[test]
fn two_positions_that_determine_none_are_refused() {
    let mut case = Case::<f64>::new();
    let refused = |case: &Case<f64>, h: f64, q: [&[[f64; 2]]; 2]| {
        let (mechanism, rattle) = (case.mechanism(), Rattle::new(h, Order::Two));
        let (mut place, mut work) = workspaces(&mechanism);
        let started = rattle.start(&mechanism, q, Some(&case.force), &mut place, &mut work);
        started.map(drop).unwrap_err()
    };
    let (q, mut off) = (case.q.clone(), case.q.clone());
    off[1][0] += 0.01;
    for pair in [[&q[..], &off[..]], [&off[..], &q[..]]] {
        assert!(matches!(refused(&case, H, pair), ConstraintError::Off { constraint: 1, .. }));
    }
    assert_eq!(refused(&case, H, [&q, &q[..2]]), ConstraintError::Shape { expected: 3, given: 2 });
    // A step in which the spring swings several times.
    assert!(matches!(refused(&case, 2.0, [&q, &q]), ConstraintError::NotConverged(_)));
    case.force.pop();
    assert_eq!(refused(&case, H, [&q, &q]), ConstraintError::Shape { expected: 3, given: 2 });
}

/// The workspace for any graph is enough for a graph with messages.
#[test]
fn the_workspace_of_any_graph_is_enough() {
    let (file, mut edges, mut list) =
        (Aligned::new(&golden_web()), [Edge::default(); 3], [Holonomic::default(); 2]);
    let model = GraphModel::<2, 6, 5, 1>::load(file.bytes(), "ring", &mut edges, &mut list).unwrap();
    let needed = Particles::<f32, 2>::workspace(&model.system.graph);
    assert_eq!((needed, Graph::<f32, 2, 6, 5, 1>::most_workspace(3)), (12, 48));
}
