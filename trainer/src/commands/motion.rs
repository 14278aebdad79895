//! The file of a motion: a Fourier series of every coordinate, which `excite` writes and `simulate` follows.

use serde::{Deserialize, Serialize};

/// Its keys.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionFile {
    /// Of the first harmonic, Hz.
    pub frequency: f64,
    /// Seconds in which it is entered from rest.
    #[serde(default = "ramp")]
    pub ramp: f64,
    /// The centre of every coordinate, rad or m.
    pub centre: Vec<f64>,
    /// Largest forces, N m or N.
    pub limit: Vec<f64>,
    /// Of every coordinate a row of harmonics, rad or m.
    pub cosine: Vec<Vec<f64>>,
    /// The same.
    pub sine: Vec<Vec<f64>>,
}

fn ramp() -> f64 {
    2.0
}
