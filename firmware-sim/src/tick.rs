use crc::{CRC_64_XZ, Crc, Digest, NoTable};
use leastaction_core::discrete::Report;
use serde::{Deserialize, Serialize};

/// Mode of the firmware in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Mode {
    /// Waiting until the estimate can be trusted: at the start, or after an encoder fell silent; no force.
    Wait,
    /// Stepping the model without feedback.
    Open,
    /// Following a reference.
    Track,
    /// Pumping energy.
    Swing,
    /// Holding the upright position.
    Hold,
    /// The model could not be stepped or asked for a force that is not finite; no force.
    Safe,
    /// Holding against gravity alone.
    Float,
    /// Deciding at every tick.
    Mpc,
}

/// Record of one tick. Angles are not wrapped, except in `measured` and `error`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick<const N: usize> {
    /// Number of ticks before this one.
    pub index: u32,
    /// Due time of the tick, s.
    pub time: f32,
    /// True position at the due time, rad or m.
    pub q: [f32; N],
    /// True velocity at the due time, rad/s or m/s.
    pub v: [f32; N],
    /// Encoder readings, rad or m; `None` for a dropped reading or a missed tick.
    pub measured: [Option<f32>; N],
    /// Estimated position; the last estimate if the tick was missed.
    pub q_estimate: [f32; N],
    /// Estimated velocity; the last estimate if the tick was missed.
    pub v_estimate: [f32; N],
    /// Desired position of the mechanism.
    pub reference: [f32; N],
    /// Position minus reference, angles in [−π, π]. (In `predict` the reference is the model's position.)
    pub error: [f32; N],
    /// Command that the firmware gave in this tick, within the limits.
    pub commanded: [f32; N],
    /// Force that acts from this tick on, N or N m.
    pub applied: [f32; N],
    /// Newton's iterations and residual in the model's step; zero if no step was taken.
    pub newton: Report<f32>,
    /// Lateness of the tick, s.
    pub lateness: f32,
    /// Whether the firmware did not run.
    pub missed: bool,
    /// Mode of the firmware.
    pub mode: Mode,
}

impl<const N: usize> Tick<N> {
    /// Number of readings that did not arrive; 0 for a missed tick.
    pub fn dropped(&self) -> usize {
        if self.missed { 0 } else { self.measured.iter().filter(|sample| sample.is_none()).count() }
    }
}

static CRC: Crc<u64, NoTable> = Crc::<u64, NoTable>::new(&CRC_64_XZ);

/// Fingerprint of a trace: CRC-64/XZ over the little-endian bits of every tick, field by field as declared.
#[derive(Clone)]
pub struct TraceHash(Digest<'static, u64, NoTable>);

impl Default for TraceHash {
    fn default() -> Self {
        Self(CRC.digest())
    }
}

impl TraceHash {
    /// Takes in one tick.
    pub fn update<const N: usize>(&mut self, tick: &Tick<N>) {
        self.0.update(&tick.index.to_le_bytes());
        self.numbers(&[tick.time]);
        self.numbers(&tick.q);
        self.numbers(&tick.v);
        for sample in tick.measured {
            self.0.update(&[u8::from(sample.is_some())]);
            self.numbers(&[sample.unwrap_or(0.0)]);
        }
        for numbers in [&tick.q_estimate, &tick.v_estimate, &tick.reference, &tick.error] {
            self.numbers(numbers);
        }
        self.numbers(&tick.commanded);
        self.numbers(&tick.applied);
        self.numbers(&[tick.newton.residual, tick.lateness]);
        self.0.update(&[tick.newton.iterations, tick.missed.into(), tick.mode as u8]);
    }

    /// Hash of all ticks taken in.
    pub fn finish(self) -> u64 {
        self.0.finalize()
    }

    fn numbers(&mut self, x: &[f32]) {
        for x in x {
            self.0.update(&x.to_le_bytes());
        }
    }
}
