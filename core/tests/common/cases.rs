//! Systems of particles with their starts, and their motion by RATTLE.

use super::particles::{Exact, Spring, hanging, rods, rounded, workspaces};
use leastaction_core::constraints::{Constrained, Holonomic};
use leastaction_core::discrete::Order;
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::particles::Particles;
use leastaction_core::scalar::Real;

/// The mechanism that the solvers step.
pub type Mechanism<'a, R, const D: usize> = Constrained<'a, R, Exact<R, D>, [Holonomic<R, D>], D>;
/// Positions and velocities of all nodes.
pub type Motion<R> = (Vec<[R; 2]>, Vec<[R; 2]>);

/// A system, its constraints, and its start.
pub struct Case<R> {
    pub system: Exact<R, 2>,
    pub constraints: Vec<Holonomic<R, 2>>,
    pub start: Motion<f64>,
    pub force: Option<Vec<[R; 2]>>,
}

impl<R: Real> Case<R> {
    /// A pendulum of rods of 1 m and masses of 1 kg, released at rest.
    pub fn pendulum(angles: &[f64]) -> Self {
        let ones = vec![1.0; angles.len()];
        Self {
            system: Exact::under_gravity(&ones, 10.0),
            constraints: rods(&ones, true),
            start: hanging(&ones, angles, &vec![0.0; angles.len()]),
            force: None,
        }
    }

    /// Two bobs on rods, and two more that springs join to each other and to the first two; gravity acts on all.
    pub fn hybrid() -> Self {
        let mut system = Exact::under_gravity(&[1.0, 1.5, 0.7, 1.2], 10.0);
        let spring = |a, b| Spring { nodes: [a, b], stiffness: R::constant(30.0), rest: R::constant(0.9) };
        system.springs = vec![spring(0, 2), spring(2, 1), spring(1, 3), spring(3, 0)];
        let (mut q, mut v) = hanging(&[1.0, 0.8], &[0.7, -0.5], &[0.4, 1.2]);
        q.extend([[0.1, -1.9], [1.3, -1.4]]);
        v.extend([[-0.6, 0.3], [0.2, 0.9]]);
        Self { system, constraints: rods(&[1.0, 0.8], true), start: (q, v), force: None }
    }

    /// A chain in free flight, turning and bending, without a field.
    pub fn free() -> Self {
        let lengths = [1.0, 0.7, 1.3];
        let (mut q, mut v) = hanging(&lengths, &[0.4, 2.0, -0.9], &[2.0, -1.5, 0.8]);
        q.insert(0, [0.0; 2]);
        v.insert(0, [0.0; 2]);
        let v = v.iter().map(|v| [v[0] + 0.3, v[1] - 0.2]).collect();
        let system = Exact::under_gravity(&[1.0, 0.6, 1.7, 0.9], 0.0);
        Self { system, constraints: rods(&lengths, false), start: (q, v), force: None }
    }

    /// The case with a kinetic energy that is not quadratic, drag and a force.
    pub fn forced(mut self) -> Self {
        let push = |node: usize| [R::constant(3.0 - 2.0 * node as f64), R::constant(0.7)];
        self.force = Some((0..self.system.nodes()).map(push).collect());
        Self { system: self.system.hard(), ..self }
    }

    pub fn mechanism(&self) -> Mechanism<'_, R, 2> {
        Constrained::new(&self.system, &self.constraints[..]).unwrap()
    }

    /// Steps and calls `look` before the first step and after each; returns the state at the end.
    pub fn run(
        &self,
        (h, order): (f64, Order),
        steps: usize,
        mut look: impl FnMut(usize, &ParticleState<R, 2>),
    ) -> Motion<R> {
        let mechanism = self.mechanism();
        let (mut workspace, mut work) = workspaces(&mechanism);
        let (q, v) = (rounded(&self.start.0), rounded(&self.start.1));
        let mut state = ParticleState::new(&mechanism, &q, &v, &mut workspace, &mut work).unwrap();
        let rattle = Rattle::new(R::constant(h), order);
        look(0, &state);
        for k in 1..=steps {
            rattle.step(&mechanism, &mut state, self.force.as_deref(), &mut work).unwrap();
            look(k, &state);
        }
        (state.q().to_vec(), state.v().to_vec())
    }
}

/// Distance between two sets of vectors, each taken as one long vector.
pub fn distance(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let squares = a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}
