use crate::{FmuError, Unit};
use crc::{CRC_32_ISO_HDLC, Crc};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Interface of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interface {
    /// The importer integrates.
    ModelExchange,
    /// The unit steps itself.
    CoSimulation,
}

impl Interface {
    /// Name in a message.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ModelExchange => "model exchange",
            Self::CoSimulation => "co-simulation",
        }
    }
}

/// Phase of an instance, called mode or state in the standards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Before the initialisation.
    Instantiated,
    /// Between the beginning and the end of the initialisation.
    Initialization,
    /// Event mode, of model exchange.
    Event,
    /// Continuous-time mode, of model exchange.
    ContinuousTime,
    /// Step mode, of co-simulation.
    Step,
    /// After the end of the simulation.
    Terminated,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "before the initialisation",
            Self::Initialization => "during the initialisation",
            Self::Event => "in event mode",
            Self::ContinuousTime => "in continuous-time mode",
            Self::Step => "in step mode",
            Self::Terminated => "after the end of the simulation",
        })
    }
}

/// Everything that changes in an instance, which an importer may keep and restore.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Fingerprint of the model file.
    pub(crate) fingerprint: u32,
    pub(crate) interface: Interface,
    pub(crate) phase: Phase,
    /// Time at the start of the simulation, s.
    pub(crate) start: f64,
    /// Time t, s.
    pub(crate) time: f64,
    /// Number of steps of co-simulation since the start.
    pub(crate) steps: u64,
    /// Step of co-simulation, s.
    pub(crate) h: f64,
    /// Force u of each coordinate.
    pub(crate) u: Vec<f64>,
    pub(crate) start_q: Vec<f64>,
    pub(crate) start_v: Vec<f64>,
    /// States of model exchange; in co-simulation a copy of those of the motion.
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    /// Numbers of the motion of co-simulation; empty before the first step.
    pub(crate) motion: Vec<f32>,
}

/// Checksum of the bytes of a state.
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

impl State {
    /// State of a new instance: at rest at q = 0, without a force.
    pub fn new(unit: &Unit, interface: Interface) -> Self {
        let zero = vec![0.0; unit.n()];
        Self {
            fingerprint: unit.fingerprint(),
            interface,
            phase: Phase::Instantiated,
            start: 0.0,
            time: 0.0,
            steps: 0,
            h: unit.h().unwrap_or(Unit::DEFAULT_H),
            u: zero.clone(),
            start_q: zero.clone(),
            start_v: zero.clone(),
            q: zero.clone(),
            v: zero,
            motion: Vec::new(),
        }
    }

    /// The state as bytes, with a checksum.
    ///
    /// # Errors
    /// [`FmuError::Bytes`]; none for a state of an instance.
    pub fn to_bytes(&self) -> Result<Vec<u8>, FmuError> {
        postcard::to_allocvec_crc32(self, CRC.digest()).map_err(FmuError::Bytes)
    }

    /// Reads a state from its bytes.
    ///
    /// # Errors
    /// [`FmuError::Bytes`] if they are damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FmuError> {
        postcard::from_bytes_crc32(bytes, CRC.digest()).map_err(FmuError::Bytes)
    }
}
