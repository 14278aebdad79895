//! The loss for noisy logs: positions over windows of many steps, each from a start state of its own.
//!
//! min over θ, c, x₀ of Σ ρ((q̂_k(θ, c, x₀) + z − q̃_k)/s) + priors of c. Here θ are the weights of the model, c is the
//! [`Calibration`] of sensors and actuators, x₀ = (q, v) is the start state of every window, and q̂ is the result of
//! explicit Runge–Kutta steps or of discrete Euler–Lagrange steps ([`Integrator`]). A single step of a noisy log says
//! hardly anything about the forces, and its noise biases the result; over many steps noise averages out and the effect
//! of forces adds up.
//!
//! - ρ(r) = 2κ²(√(1 + r²/κ²) − 1) is the pseudo-Huber function: r² for small residuals, but linear for large ones,
//!   so that single outliers have little influence.
//! - s of every coordinate is the larger of the sensor's noise and a robust scale of the residuals, updated before
//!   every iteration.
//! - x₀ is eliminated window by window in Gauss–Newton (Golub and Pereyra's variable projection, in Kaufman's form):
//!   the columns of x₀ are projected out of the others, and after every step x₀ is solved for again.

mod calibration;
mod certainty;
#[cfg(test)]
mod certainty_tests;
mod control;
mod elimination;
mod first_guess;
mod lagging;
mod logs;
mod loss;
mod model;
mod noise;
mod pace;
mod rollout;
mod scales;
mod starts;

pub use calibration::{Calibrated, Calibration, CalibrationLayout, Setting};
pub use certainty::{Certainty, LearnedNumber, Shown, certainty};
pub use first_guess::first_guess;
pub use logs::{TooShort, WindowLogs};
pub use loss::WindowLoss;
pub use model::{Integrator, WindowModel, WindowSettings};
pub use noise::{Noise, noise_of};
pub use pace::Pace;
