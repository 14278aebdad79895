//! The file format of a motion: a Fourier series of every coordinate, written by `excite` and followed by `simulate`.

use serde::{Deserialize, Serialize};

/// Keys of the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionFile {
    /// Frequency of the first harmonic, Hz.
    pub frequency: f64,
    /// Time in which the motion is entered from rest, s.
    #[serde(default = "ramp")]
    pub ramp: f64,
    /// Centre of every coordinate, rad or m.
    pub centre: Vec<f64>,
    /// Largest force on every coordinate, N m or N.
    pub limit: Vec<f64>,
    /// Cosine coefficients: a row of harmonics per coordinate, rad or m.
    pub cosine: Vec<Vec<f64>>,
    /// Sine coefficients: a row of harmonics per coordinate, rad or m.
    pub sine: Vec<Vec<f64>>,
}

fn ramp() -> f64 {
    2.0
}
