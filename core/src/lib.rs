//! Learned Lagrangians on a microcontroller.
//!
//! This crate evaluates the acceleration of a mechanical system from a learned Lagrangian L(q, v) = T − V, or steps it by the discrete
//! Euler–Lagrange (DEL) equation, with fixed-size arrays: no allocation, no panic, no unsafe code.
//!
//! Data flows one way through the modules of this crate:
//! [`scalar`] → [`network`] → [`energy`] → [`lagrangian`] and [`particles`] → [`forces`] and [`constraints`] →
//! [`continuous`] and [`discrete`] → [`control`], [`observer`] and [`adapt`] → [`model`] → [`stepper`], [`plan`] and [`guard`].
//!
//! # Notation
//!
//! | symbol | name in code | meaning | unit |
//! |---|---|---|---|
//! | q | `q` | generalised coordinates, `[S; N]` | m or rad |
//! | v = q̇ | `v` | generalised velocities | m/s or rad/s |
//! | u | `u` | generalised control force | N or N m |
//! | y | `y` | command that acts, behind the lag T ẏ = u(t − d) − y of a drive | as u |
//! | h | `h` | step | s |
//! | M = L_vv, H(q) | `mass_matrix` | inertia matrix | kg, kg m, kg m² |
//! | p = L_v | `p`, `l_v` | generalised momentum | kg m/s or kg m²/s |
//! | L_q | `l_q` | ∂L/∂q | N or N m |
//! | L_qq, L_vq, L_vv | `l_qq`, `l_vq`, `l_vv` | second derivatives; `l_vq[i][j]` = ∂²L/∂v_i∂q_j | |
//! | φ(q) = 0, A = ∂φ/∂q | `constraints` | holonomic constraints and their Jacobian | m, 1 |
//! | λ | `lambda` | multipliers; Aᵀλ are the constraint forces | N |
//! | Q | `force` | generalised non-conservative force: control, damping | N or N m |
//! | L_d(q₀, q₁) | `d1_ld`, `d2_ld` | discrete Lagrangian ≈ ∫L dt and its slot derivatives | J s |
//! | w = (q₁ − q₀)/h | `w` | increment, the unknown of a DEL step | m/s or rad/s |
//! | A, B | `transition` | derivatives of a step's or node's end in its start and in the control | |
//! | K | `gain` | feedback u = ū − K(x − x̄), x = (q, v) | |
//! | π, δ | `Number`, `estimate`, `applied` | number of a model that follows the machine, and its distance from the file | |
//! | s | `bubble` | mid-path deviation of the order-4 path over h | m/s or rad/s |
//!
//! The papers: **SyMo** (Santos, Ekal, Ventura, L4DC 2022), **ModLaNet** (Lu, Lin, Shi, Chen, ICML 2022),
//! **LGNN** (Bhattoo, Ranu, Krishnan, MLST 2023); variational integration after Marsden and West (Acta Numerica 2001).
#![no_std]

pub mod adapt;
mod checksum;
pub mod constraints;
pub mod continuous;
pub mod control;
pub mod discrete;
pub mod energy;
mod expected;
pub mod forces;
pub mod frame;
pub mod guard;
pub mod lagrangian;
pub mod linear;
pub mod model;
pub mod network;
mod newton;
pub mod observer;
pub mod particles;
pub mod plan;
pub mod scalar;
#[cfg(feature = "nalgebra")]
pub mod static_vectors;
pub mod stepper;
