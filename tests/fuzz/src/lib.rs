//! Fuzz targets: for each one a function of any bytes, which returns if all is well and panics if it is not.
//!
//! A target adds to its input whatever the fuzzer would not find by chance — magic letters, checksums, lengths — and passes the result to
//! its reader. Accepted input must be consistent: see each function.

#[cfg(feature = "learning")]
pub mod checkpoint;
#[cfg(feature = "link")]
pub mod link;
#[cfg(feature = "logs")]
pub mod logs;
pub mod model;
pub mod plan;
pub mod sections;
#[cfg(feature = "steps")]
pub mod steps;
#[cfg(any(feature = "arms", feature = "learning"))]
pub mod texts;
#[cfg(feature = "learning")]
pub mod weights;

/// Number of bytes of the target `steps` before the sections.
pub const HEAD: usize = 3;
/// Number of bytes of the target `plan` before the numbers of a plan that it writes.
pub const PLAN_HEAD: usize = 9;
/// First bytes of a checkpoint.
pub const CHECKPOINT: &[u8] = b"LARUN\x0a";

/// A reproducible stream of numbers (Knuth's multiplier).
#[derive(Clone, Copy, Debug)]
pub struct Random(pub u64);

impl Random {
    /// Returns the next number below `end`, which must not be 0.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end
    }

    /// Returns a number in ±1.
    pub fn signed(&mut self) -> f32 {
        self.below(1 << 24) as f32 / (1 << 23) as f32 - 1.0
    }
}
