//! Adaptation: chosen numbers of a model follow the machine while it runs.
//!
//! A model that was learned is right until the gripper takes something or the grease warms up. Over a window, the balance of momentum
//!
//! p(t₁) − p(t₀) = ∫ (L_q + Q + τ) dt
//!
//! is linear in many [numbers](Number) π of the model — the inertial numbers of a body, rotors, friction, offsets and gains of drives, the last
//! layer of a potential's network, the strength of dissipation — and contains no acceleration. [`Balance`] takes it over windows of a smooth
//! weight, [`Filter`] estimates from it how far the numbers are from the model's, with their standard errors, and forgets only what is excited.
//! An [`Adapter`] does both at every tick, in bounded time; [`Blocks`] give it the motion of a fast loop, a [`Patch`] keeps what was found, and
//! a [`SettingsFile`] tells a controller which numbers follow, and how.

mod adapter;
mod balance;
mod blocks;
mod catalogue;
mod filter;
mod follow;
mod limits;
mod number;
mod patch;
mod possible;
mod settings;
mod tunable;
mod unfit;
mod verdict;

pub use adapter::{Adapter, Agreement, Tuning};
pub use balance::{Balance, Row, Terms};
pub use blocks::{Block, Blocks, Reading};
pub use catalogue::CATALOGUE;
pub use filter::{Filter, Innovation, Measurement};
pub use limits::Limits;
pub use number::{Moment, Number};
pub use patch::{PATCH_MAGIC, Patch, PatchError, Saved};
pub use settings::{Following, SETTINGS_MAGIC, Settings, SettingsError, SettingsFile, StoredSettings};
pub use tunable::Tunable;
pub use unfit::Unfit;
pub use verdict::{Announcement, Changes, Difference};
