use super::config::{LEASTACTION_DIMENSIONS as D, LEASTACTION_RODS as RODS};
use super::{Mechanism, N, Step, Vector, words};
use leastaction_core::constraints::{Constrained, Holonomic};
use leastaction_core::continuous::{
    Drive, constrained_acceleration, constrained_inverse_dynamics, constrained_workspace,
};
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::discrete::{Newton, Order, Report};
use leastaction_core::lagrangian::Energies;
use leastaction_core::particles::Particles;

/// Particles that rods hold together.
pub struct OnRods<'a, S> {
    pub mechanism: Constrained<'a, f32, S, [Holonomic<f32, D>], D>,
}

/// A state that is never saved, and the mean velocity over its last step.
pub struct Moving {
    state: ParticleState<'static, f32, D>,
    w: Vector,
}

impl<S: Particles<f32, D>> OnRods<'_, S> {
    /// Memory for one state. It is leaked, since this program starts few states.
    fn place(&self) -> &'static mut [f32] {
        let (nodes, equations) = (self.mechanism.system().nodes(), self.mechanism.equations());
        Box::leak(vec![0.0; ParticleState::<f32, D>::workspace(nodes, equations)].into())
    }

    fn work(&self) -> Vec<f32> {
        vec![0.0; Rattle::workspace(&self.mechanism)]
    }
}

impl<S: Particles<f32, D>> Mechanism for OnRods<'_, S> {
    type State = Moving;

    fn default_newton(&self) -> Newton<f32> {
        Rattle::default_newton()
    }

    fn acceleration(&self, [q, v, u]: [&Vector; 3]) -> Result<Vector, String> {
        let (mut a, mut lambda) = ([0.0; N], vec![0.0; self.mechanism.equations()]);
        let mut work = vec![0.0; constrained_workspace(&self.mechanism)];
        let drive = Drive { force: Some(u.as_chunks().0), ..Drive::none() };
        let (at, out) = ((q.as_chunks().0, v.as_chunks().0), (a.as_chunks_mut().0, &mut lambda[..]));
        constrained_acceleration(&self.mechanism, at, &drive, &mut work, out).map_err(words)?;
        Ok(a)
    }

    fn inverse_dynamics(&self, at: [&Vector; 3]) -> Result<Vector, String> {
        let mut u = [0.0; N];
        let mut work = vec![0.0; constrained_workspace(&self.mechanism)];
        let (at, out) = (at.map(|x| x.as_chunks().0), u.as_chunks_mut().0);
        constrained_inverse_dynamics(&self.mechanism, at, &mut work, out).map_err(words)?;
        Ok(u)
    }

    fn momentum(&self, [_, v]: [&Vector; 2]) -> Vector {
        let mut p = [0.0; N];
        self.mechanism.system().momenta(0, v.as_chunks().0, p.as_chunks_mut().0);
        p
    }

    fn energies(&self, [q, v]: [&Vector; 2]) -> Energies<f32> {
        self.mechanism.system().energies(q.as_chunks().0, v.as_chunks().0, &mut self.work())
    }

    fn terms(&self, _: &Vector) -> Vec<f32> {
        Vec::new()
    }

    fn start(&self, q: Vector, v: Vector) -> Result<Moving, String> {
        let (q, v) = (q.as_chunks().0, v.as_chunks().0);
        let state =
            ParticleState::new(&self.mechanism, q, v, self.place(), &mut self.work()).map_err(words)?;
        let w = flat(state.v());
        Ok(Moving { state, w })
    }

    fn between(&self, h: f32, order: Order, [q0, q1]: [&Vector; 2]) -> Result<Moving, String> {
        let (rattle, q) = (Rattle::new(h, order), [q0, q1].map(|q| q.as_chunks().0));
        let state = rattle.start(&self.mechanism, q, None, self.place(), &mut self.work()).map_err(words)?;
        Ok(Moving { state, w: core::array::from_fn(|i| (q1[i] - q0[i]) / h) })
    }

    fn step(&self, moving: &mut Moving, step: &Step, u: Vector) -> Result<Report<f32>, String> {
        let Step { h, order, newton } = step;
        let (rattle, state) = (Rattle::with_newton(*h, *order, *newton), &mut moving.state);
        let (q0, carry0) = (flat(state.q()), flat(state.q_carry()));
        let force = Some(u.as_chunks().0);
        let report = rattle.step(&self.mechanism, state, force, &mut self.work()).map_err(words)?;
        let (q1, carry1) = (flat(state.q()), flat(state.q_carry()));
        moving.w = core::array::from_fn(|i| ((q1[i] - q0[i]) + (carry1[i] - carry0[i])) / h);
        Ok(report)
    }

    fn numbers(&self, Moving { state, w }: &Moving) -> Vec<f32> {
        let mut lambda = state.lambda().to_vec();
        lambda.resize(RODS, 0.0);
        [&flat(state.q())[..], &flat(state.p()), w, &lambda].concat()
    }
}

/// Joins vectors, node after node.
fn flat(x: &[[f32; D]]) -> Vector {
    let mut flat = [0.0; N];
    flat.copy_from_slice(x.as_flattened());
    flat
}
