//! Gains that follow a motion, and how far they reach.

use crate::Task;
use crate::plan::{PlanNode, Tube};
use leastaction_core::continuous::inverse_dynamics;
use leastaction_core::control::riccati::{Regulator, Weights, back, stationary};
use leastaction_core::control::{Node, Plant};
use leastaction_core::linear::{diagonal, dot, identity, multiply, solve_columns};
use leastaction_models::Model;
use leastaction_replica::SystemOf;
use std::array::from_fn;

/// Largest force without which a rest counts as held, relative to the largest force of gravity or 1.
const UNHELD: f64 = 1e-3;

/// Gains of a motion.
pub struct Gains<const N: usize, const D: usize> {
    /// Regulator of every node.
    pub nodes: Vec<Regulator<f64, D, N>>,
    /// Regulator at the end.
    pub end: Regulator<f64, D, N>,
    /// Command at the end.
    pub command: [f64; N],
    /// Whether the command holds the end.
    pub holds: bool,
}

impl Task {
    pub(crate) fn weights<const N: usize, const D: usize>(&self) -> Weights<f64, D, N> {
        let inverse = |x: Option<&f64>| x.map_or(1.0, |x| 1.0 / (x * x));
        Weights {
            x: from_fn(|i| inverse(self.follow.x.get(i))),
            u: from_fn(|i| inverse(self.follow.u.get(i))),
        }
    }

    /// Deviations of the velocities that weigh alike, rad/s or m/s.
    pub(crate) fn velocity_deviations<const N: usize>(&self) -> [f32; N] {
        from_fn(|i| self.follow.x.get(N + i).map_or(1.0, |v| *v as f32))
    }

    /// Gains of time-varying LQR along a motion that ends at x.
    pub(crate) fn gains<P: Plant<f64, D, N>, const N: usize, const D: usize>(
        &self,
        (plant, system, model): (&P, &SystemOf<N>, &Model),
        (nodes, x): (&[Node<f64, D, N>], &[f64; D]),
    ) -> Gains<N, D> {
        let weights = self.weights();
        let (command, holds) = self.holding(system, model, x);
        let at_end = plant.linearise_at(x, (self.ticks_per_node, &command)).ok().filter(|_| holds);
        let regulator = at_end.and_then(|transition| stationary(&transition, &weights).ok());
        let holds = regulator.is_some();
        let end = regulator
            .unwrap_or(Regulator { gain: [[0.0; D]; N], cost: diagonal(weights.x.map(|w| 100.0 * w)) });
        let mut cost = end.cost;
        let mut regulators: Vec<_> = nodes
            .iter()
            .rev()
            .map(|node| {
                let none = Regulator { gain: [[0.0; D]; N], cost };
                let found = back(&node.transition, &weights, &cost).unwrap_or(none);
                cost = found.cost;
                found
            })
            .collect();
        regulators.reverse();
        Gains { nodes: regulators, end, command, holds }
    }

    /// Command that holds the mechanism at x, and whether it does.
    pub(crate) fn holding<const N: usize, const D: usize>(
        &self,
        system: &SystemOf<N>,
        model: &Model,
        x: &[f64; D],
    ) -> ([f64; N], bool) {
        let q: [f32; N] = from_fn(|i| x.get(i).map_or(0.0, |x| *x as f32));
        let Ok(tau) = inverse_dynamics(system, &q, &[0.0; N], &[0.0; N]) else { return ([0.0; N], false) };
        let moving = x.iter().skip(N).any(|v| v.abs() > 1e-2);
        let size = tau.iter().fold(1.0_f64, |most, tau| most.max(f64::from(tau.abs())));
        let mut held = !moving;
        let command = from_fn(|i| {
            let needed = f64::from(tau[i]) - model.facts.actuator.offset(i);
            if !self.limits.is_driven(i) {
                held &= needed.abs() <= UNHELD * size;
                return 0.0;
            }
            let ([least, most], u) = (self.limits.u[i], needed / model.facts.actuator.gain(i));
            held &= (least..=most).contains(&u);
            u.clamp(least, most)
        });
        (command, held)
    }

    /// Half-widths of the states within which the feedback stays inside the limits of the drives.
    ///
    /// |K_j δx| ≤ m_j holds on δxᵀPδx ≤ ρ for ρ = m_j²/(K_j P⁻¹ K_jᵀ). δxᵀPδx falls along the motion, so the least ρ from a node on holds
    /// there.
    pub(crate) fn tube<const N: usize, const D: usize>(
        &self,
        gains: &Gains<N, D>,
        nodes: &[Node<f64, D, N>],
    ) -> Tube {
        let margin = |i: usize, u: f64| {
            let [least, most] = self.limits.u[i];
            (u - least).min(most - u).max(0.0)
        };
        let each = nodes.iter().zip(&gains.nodes).map(|(node, regulator)| (&node.u, regulator));
        let mut least = f64::INFINITY;
        let mut widths: Vec<Vec<f64>> = each
            .rev()
            .map(|(u, Regulator { gain, cost })| {
                let Ok(inverse) = solve_columns(*cost, &identity()) else { return vec![0.0; D] };
                for (i, row) in gain.iter().enumerate().filter(|(i, _)| self.limits.is_driven(*i)) {
                    let spread = dot(row, &multiply(&inverse, row));
                    let margin = margin(i, u[i]);
                    least = least.min(if spread > 0.0 { margin * margin / spread } else { f64::INFINITY });
                }
                (0..D).map(|i| (least * inverse[i][i].max(0.0)).sqrt()).collect()
            })
            .collect();
        widths.reverse();
        Tube { widths }
    }
}

impl PlanNode {
    /// A node with its gain.
    pub(crate) fn new<const N: usize, const D: usize>(
        x: &[f64; D],
        u: &[f64; N],
        gain: &[[f64; D]; N],
    ) -> Self {
        Self { x: x.to_vec(), u: u.to_vec(), gain: gain.iter().map(|row| row.to_vec()).collect() }
    }
}
