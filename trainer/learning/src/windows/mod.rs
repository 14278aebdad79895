//! Positions over windows of many steps, each from a start state of its own: the loss for logs that are not exact.
//!
//! min over θ, c, x₀ of Σ ρ((q̂_k(θ, c, x₀) + z − q̃_k)/s) + priors of c, with θ the weights of the model, c the
//! [`Calibration`] of sensors and actuators, x₀ = (q, v) at the start of every window, and q̂ by explicit Runge–Kutta steps or by those of
//! the discrete Euler–Lagrange equation ([`Integrator`]). One step of a noisy log says hardly anything of the forces, and its noise
//! biases what is learned from it; over many steps noise averages out, and forces add up.
//!
//! - ρ(r) = 2κ²(√(1 + r²/κ²) − 1), the pseudo-Huber function: r² for what is small, so that single bad samples pull little.
//! - s of every coordinate is the larger of the sensor's noise and a robust scale of the residuals, set anew before every
//!   iteration.
//! - Gauss–Newton with x₀ eliminated window by window (Golub and Pereyra's variable projection, in Kaufman's form): the columns of
//!   x₀ are projected out of the others, and after every step x₀ is solved anew.

mod calibration;
mod certainty;
#[cfg(test)]
mod certainty_tests;
mod control;
mod elimination;
mod first_guess;
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
