//! States of RATTLE: allowed starts, the state after refused steps, and the forces of constraints.

use crate::common::cases::{Case, distance};
use crate::common::particles::{Exact, rod_error, rods, rounded, workspaces};
use crate::common::{Random, assert_close};
use leastaction_core::constraints::{ConstraintError, Holonomic};
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::discrete::{Newton, Order, Report};

/// At rest a rod carries the weight below it; pushed sideways, the pendulum hangs along the whole force.
#[test]
fn multipliers_are_the_forces_of_rods() {
    let mut case = Case::<f64>::pendulum(&[0.75_f64.atan(); 3]);
    case.force = Some(vec![[7.5, 0.0]; 3]);
    let mechanism = case.mechanism();
    let (mut workspace, mut work) = workspaces(&mechanism);
    let mut state =
        ParticleState::new(&mechanism, &case.start.0, &case.start.1, &mut workspace, &mut work).unwrap();
    for order in [Order::Two, Order::Four] {
        Rattle::new(0.01, order).step(&mechanism, &mut state, case.force.as_deref(), &mut work).unwrap();
        for (lambda, below) in state.lambda().iter().zip([3.0, 2.0, 1.0]) {
            assert_close("tension", -lambda, 12.5 * below, 1e-11);
        }
        assert!(distance(state.q(), &case.start.0) < 1e-12);
    }
}

/// A pivot can also be a held node instead of an anchor.
#[test]
fn a_held_node_is_an_anchor() {
    let anchored = Case::<f64>::pendulum(&[1.0, 0.4]);
    let (mut q, mut v) = anchored.start.clone();
    q.insert(0, [0.0; 2]);
    v.insert(0, [0.0; 2]);
    let constraints = Holonomic::held(0, [0.0; 2]).into_iter().chain(rods(&[1.0; 2], false)).collect();
    let system = Exact::under_gravity(&[1.0; 3], 10.0);
    let held = Case { system, constraints, start: (q, v), force: None };
    let found = held.run((0.01, Order::Two), 300, |_, _| ());
    let expected = anchored.run((0.01, Order::Two), 300, |_, _| ());
    assert!(distance(&found.0[1..], &expected.0) < 1e-11);
    assert!(found.0[0].iter().all(|x| x.abs() < 1e-15));
}

/// Velocities along rods are removed at the start; the consistent part of the velocity stays.
#[test]
fn initial_velocities_are_projected() {
    let case = Case::<f64>::pendulum(&[0.5, -0.2]);
    let mechanism = case.mechanism();
    let (mut workspace, mut work) = workspaces(&mechanism);
    let along = [case.start.0[0].map(|x| 3.0 * x), [0.0; 2]];
    let state = ParticleState::new(&mechanism, &case.start.0, &along, &mut workspace, &mut work).unwrap();
    let (q, v) = (state.q().to_vec(), state.v().to_vec());
    assert!((q[0][0] * v[0][0] + q[0][1] * v[0][1]).abs() < 1e-15);
    assert!(distance(state.p(), &v) < 1e-30, "masses are 1 kg, and what is left of both is rounding");
    let state = ParticleState::new(&mechanism, &q, &v, &mut workspace, &mut work).unwrap();
    assert!(distance(state.v(), &v) < 1e-15);
}

#[test]
fn a_state_off_its_constraints_is_refused() {
    let mut case = Case::<f64>::pendulum(&[0.5, -0.2]);
    let new = |case: &Case<f64>| {
        let mechanism = case.mechanism();
        let (mut workspace, mut work) = workspaces(&mechanism);
        ParticleState::new(&mechanism, &case.start.0, &case.start.1, &mut workspace, &mut work)
            .map(|_| ())
            .unwrap_err()
    };
    case.start.0[1][0] += 0.01;
    let ConstraintError::Off { constraint: 1, residual } = new(&case) else { panic!("{:?}", new(&case)) };
    assert_close("residual", residual, 0.01 * (-0.2_f64).sin().abs(), 1e-4);
    case.start.0[1][0] = f64::NAN;
    assert_eq!(new(&case), ConstraintError::NotFinite);
    let mut twice = Case::<f64>::pendulum(&[0.5, -0.2]);
    twice.constraints.push(twice.constraints[0]);
    assert_eq!(new(&twice), ConstraintError::Redundant { constraint: 2 });
    let other = Holonomic::Anchor { node: 0, to: [0.0; 2], length: 1.2 };
    twice.constraints[2] = other;
    assert!(matches!(new(&twice), ConstraintError::Off { constraint: 2, .. }));
}

#[test]
fn refused_steps_leave_the_state() {
    let case = Case::<f64>::pendulum(&[0.5, -0.2, 1.1]);
    let mechanism = case.mechanism();
    let (mut workspace, mut work) = workspaces(&mechanism);
    let (state_workspace, work_workspace) = (workspace.len(), work.len());
    let refused =
        ParticleState::new(&mechanism, &case.start.0, &case.start.1, &mut workspace[1..], &mut work);
    assert_eq!(
        refused.unwrap_err(),
        ConstraintError::Workspace { needed: state_workspace, given: state_workspace - 1 }
    );
    let mut state =
        ParticleState::new(&mechanism, &case.start.0, &case.start.1, &mut workspace, &mut work).unwrap();
    let rattle = Rattle::new(0.01, Order::Four);
    rattle.step(&mechanism, &mut state, None, &mut work).unwrap();
    let before = format!("{state:?}");
    let visible = |state: &ParticleState<f64, 2>| {
        (state.q().to_vec(), state.p().to_vec(), state.v().to_vec(), state.lambda().to_vec())
    };
    let kept = visible(&state);

    let mut refuse = |rattle: &Rattle<f64>, force: Option<&[[f64; 2]]>, work: &mut [f64]| {
        let error = rattle.step(&mechanism, &mut state, force, work).unwrap_err();
        assert_eq!(visible(&state), kept, "{error:?} changed the state");
        error
    };
    let short = refuse(&rattle, None, &mut work[1..]);
    assert_eq!(short, ConstraintError::Workspace { needed: work_workspace, given: work_workspace - 1 });
    let few = refuse(&rattle, Some(&[[0.0; 2]; 2]), &mut work);
    assert_eq!(few, ConstraintError::Shape { expected: 3, given: 2 });
    let infinite = refuse(&rattle, Some(&[[0.0, f64::INFINITY], [0.0; 2], [0.0; 2]]), &mut work);
    assert_eq!(infinite, ConstraintError::NotFinite);
    let hurried = Newton { max_iterations: 1, stop: 1e-15, accept: 1e-15 };
    let error = refuse(&Rattle::with_newton(0.05, Order::Two, hurried), None, &mut work);
    assert!(
        matches!(error, ConstraintError::NotConverged(Report { iterations: 1, residual }) if residual > 1e-15)
    );
    let leap = refuse(&Rattle::new(40.0, Order::Two), None, &mut work);
    assert!(
        matches!(
            leap,
            ConstraintError::NotConverged(_) | ConstraintError::Redundant { .. } | ConstraintError::NotFinite
        ),
        "{leap:?}"
    );
    // The step then goes on as if nothing had been tried.
    rattle.step(&mechanism, &mut state, None, &mut work).unwrap();
    assert_ne!(format!("{state:?}"), before);
    let again = case.run((0.01, Order::Four), 2, |_, _| ());
    assert_eq!(state.q(), again.0);

    let other = Case::<f64>::pendulum(&[0.5, -0.2]);
    let wrong = rattle.step(&other.mechanism(), &mut state, None, &mut work).unwrap_err();
    assert_eq!(wrong, ConstraintError::Shape { expected: 2, given: 3 });
}

/// An offset at the start is removed by the first step.
#[test]
fn a_start_slightly_off_is_corrected() {
    let mut case = Case::<f64>::pendulum(&[0.5, -0.2]);
    case.start.0[1][1] -= 1e-9;
    let mut errors = vec![];
    case.run((0.01, Order::Two), 1, |_, state| errors.push(rod_error(&case.constraints, state.q())));
    assert!(errors[0] > 9e-10 && errors[1] < 1e-15, "{errors:?}");
}

/// On the chip the workspace of a state is an array.
#[test]
fn the_room_of_a_state_is_known_at_compile_time() {
    const WORKSPACE: usize = ParticleState::<f32, 2>::workspace(2, 2);
    const WORK: usize = Rattle::<f32>::workspace_of::<2>(2, 2, 1, 0);
    let case = Case::<f32>::pendulum(&[0.5, -0.2]);
    let mechanism = case.mechanism();
    assert_eq!(WORK, Rattle::workspace(&mechanism));
    let (mut workspace, mut work) = ([0.0_f32; WORKSPACE], [0.0; WORK]);
    let (q, v) = (rounded(&case.start.0), rounded(&case.start.1));
    let mut state = ParticleState::new(&mechanism, &q, &v, &mut workspace, &mut work).unwrap();
    let mut random = Random(1);
    for _ in 0..50 {
        let push = [random.array::<2>(3.0), random.array(3.0)].map(|f| f.map(|f| f as f32));
        Rattle::new(0.01, Order::Two).step(&mechanism, &mut state, Some(&push), &mut work).unwrap();
    }
    assert!(rod_error(&case.constraints, state.q()) < 1e-6);
}
