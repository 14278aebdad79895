#[cfg(feature = "graph")]
use super::{H, L, Weight};
use super::{Mechanism, N, Step, Vector, words};
use leastaction_core::continuous::{acceleration, inverse_dynamics, momentum};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Newton, Order, Report, State};
#[cfg(feature = "graph")]
use leastaction_core::energy::graph::{Fixed, Graph};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::{Energies, Lagrangian};

impl<L: Lagrangian<f32, N>, F: Forces<f32, N>> Mechanism for System<L, F> {
    type State = State<f32, N>;

    fn default_newton(&self) -> Newton<f32> {
        Newton::default()
    }

    fn acceleration(&self, [q, v, u]: [&Vector; 3]) -> Result<Vector, String> {
        acceleration(self, q, v, u).map_err(words)
    }

    fn inverse_dynamics(&self, [q, v, a]: [&Vector; 3]) -> Result<Vector, String> {
        inverse_dynamics(self, q, v, a).map_err(words)
    }

    fn momentum(&self, [q, v]: [&Vector; 2]) -> Vector {
        momentum(&self.lagrangian, q, v)
    }

    fn energies(&self, [q, v]: [&Vector; 2]) -> Energies<f32> {
        System::energies(self, q, v)
    }

    fn terms(&self, q: &Vector) -> Vec<f32> {
        let rest = [0.0; N];
        let mass = self.lagrangian.linearization(q, &rest).l_vv;
        let l_q = self.lagrangian.gradient(q, &rest).l_q;
        let force = self.forces.force(q, &rest, &rest);
        let torque: Vector = std::array::from_fn(|i| -l_q[i] - force[i]);
        [mass.as_flattened(), &torque].concat()
    }

    fn start(&self, q: Vector, v: Vector) -> Result<Self::State, String> {
        State::new(&self.lagrangian, q, v).map_err(words)
    }

    fn between(&self, h: f32, order: Order, [q0, q1]: [&Vector; 2]) -> Result<Self::State, String> {
        let none = Control::none();
        match order {
            Order::Two => Del::<f32, Midpoint>::new(h).start(self, q0, q1, &none),
            Order::Four => Del::<f32, Galerkin>::new(h).start(self, q0, q1, &none),
        }
        .map_err(words)
    }

    fn step(&self, state: &mut Self::State, step: &Step, u: Vector) -> Result<Report<f32>, String> {
        let (Step { h, order, newton }, u) = (step, Control::held(u));
        match order {
            Order::Two => Del::<f32, Midpoint>::with_newton(*h, *newton).step(self, state, &u),
            Order::Four => Del::<f32, Galerkin>::with_newton(*h, *newton).step(self, state, &u),
        }
        .map_err(words)
    }

    fn numbers(&self, state: &Self::State) -> Vec<f32> {
        [state.q(), state.p(), state.last_increment()].concat()
    }
}

/// A graph, which is its own drag.
#[cfg(feature = "graph")]
pub fn graph<const D: usize, const K: usize>(
    graph: Graph<'_, Weight, D, K, H, L>,
) -> Result<System<Fixed<'_, Weight, D, K, H, L, N>, Fixed<'_, Weight, D, K, H, L, N>>, String> {
    let fixed = Fixed::new(graph).map_err(words)?;
    Ok(System { lagrangian: fixed, forces: fixed })
}
