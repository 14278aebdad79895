//! Optimal control of a plant that is stepped: linear regulators, and motions that meet a goal within limits.
//!
//! Data flows one way: [`Plant`] (a step and its derivatives) → [`riccati`] (gains of linear regulators), [`Ilqr`] (motions, by iterating
//! such gains) and [`RecedingHorizon`] (a decision at every tick) over the caller's array of [`Node`]s. Nothing here knows a mechanism;
//! [`Stepped`] makes a plant of a Lagrangian and its integrator.
//!
//! A state x has D numbers, of a mechanism (q, v); a control u has M. A node is a time of t ticks over which u is held.
//!
//! # Problem
//!
//! minimise Σ_k t_k[½(x_k − x*)ᵀQ(x_k − x*) + ½u_kᵀRu_k] + ½(x_K − x*)ᵀQ_K(x_K − x*), Q and R diagonal, Q_K symmetric,
//! x_{k+1} = f(x_k, u_k, t_k), subject to
//!
//! - limits of the controls, which every iterate satisfies: a projected Newton method in each backward step;
//! - limits of the states, and the goal, which is a set of states at the end: an augmented Lagrangian.
//!
//! # Iterative LQR
//!
//! 1. Rollout: x_{k+1} = f(x_k, u_k) from the start.
//! 2. Linearisation: A_k, B_k of every node.
//! 3. Backward pass: from the end to the start, a quadratic model of the cost to go; the change of control that minimises it within the
//!    limits, k_k, and its dependence on the state, K_k.
//! 4. Line search: u = u_k + αk_k − K_k(x − x_k) clamped to the limits, for α = 1, ½, … until the cost falls.
//!
//! # Receding horizon
//!
//! [`RecedingHorizon`] decides at every tick, or every few, by a fixed number of iterations. The grid of nodes is fixed in time: ticks that
//! pass shorten the first node; when it is over, the others move up and one enters at the end, under the regulator there. The motion from
//! the present state that follows the last one by its gains is where the iterations begin, or another that the caller proposes.
//!
//! Sources: Li and Todorov, "Iterative linear quadratic regulator design for nonlinear biological movement systems", 2004; Tassa, Mansard
//! and Todorov, "Control-limited differential dynamic programming", 2014; Howell, Jackson and Manchester, "ALTRO: a fast solver for
//! constrained trajectory optimization", 2019.

mod backward;
mod box_newton;
mod cost;
mod ilqr;
mod limits;
mod node;
mod plant;
mod problem;
mod receding;
pub mod riccati;
mod rollout;
mod rounds;
mod sample;
mod shooting;
mod states;
mod stepped;

pub use backward::{Decision, NodeModel, Value};
pub use cost::Cost;
pub use ilqr::Ilqr;
pub use limits::{Limits, Penalty};
pub use node::Node;
pub use plant::{Plant, Transition};
pub use problem::{Diagonal, GoalMultipliers, Iteration, Options, Problem, Solution, Status};
pub use receding::{Action, Horizon, RecedingHorizon, Terminal};
pub use sample::sample;
pub use shooting::Progress;
pub use states::{Coordinates, States};
pub use stepped::Stepped;
