//! Models in the table, one item each.

use super::configured::{self, Chain};
use super::identified::Identified;
use super::log::Log;
use super::machine::Machine;
use super::predictor::{ConstantVelocity, Predictor};
use super::rivals::Rival;
use crate::task::{TaskError, Tell};

/// Data that a model may learn from.
pub struct Training<'t> {
    /// The machine.
    pub machine: Machine,
    /// Training logs, in order of name; never a tested one.
    pub logs: Vec<&'t Log>,
    /// Parameters that others identified, if known.
    pub baseline: Option<&'t Identified>,
    /// Seed of the initial weights.
    pub seed: u64,
    /// Whether to take fewer iterations, for a first look.
    pub quick: bool,
    /// Reports progress.
    pub tell: &'t Tell<'t>,
}

impl<'t> Training<'t> {
    /// Logs to learn from, and logs that judge the result: if there are several logs, the last one is held back.
    pub fn split(&self) -> [&[&'t Log]; 2] {
        match self.logs.split_last() {
            Some((_, rest)) if !rest.is_empty() => {
                let (learned, judges) = self.logs.split_at(rest.len());
                [learned, judges]
            }
            _ => [&self.logs, &self.logs],
        }
    }
}

/// A learned model.
pub struct Fitted {
    /// Predictor of the tested logs.
    pub predictor: Box<dyn Predictor>,
    /// Number of learned parameters.
    pub parameters: usize,
    /// Learning time, s.
    pub seconds: f64,
}

impl Fitted {
    /// Creates a model that needs no training.
    fn known(predictor: impl Predictor + 'static) -> Self {
        Self { predictor: Box::new(predictor), parameters: 0, seconds: 0.0 }
    }
}

/// A row of the table.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Name in the table and, in small letters, in the names of tasks.
    pub model: &'static str,
    /// Whether it is the model that `leastaction train` learns with the configuration that `leastaction look` writes
    /// for the logs.
    pub is_default: bool,
    /// Whether it is our model.
    pub is_ours: bool,
    /// Whether it depends on the zeros of the encoders, so that there is also a calibrated row.
    pub has_zeros: bool,
    /// Whether it depends on the seed.
    pub is_seeded: bool,
    /// Rough time to learn from ten logs, s.
    pub expected_seconds: f64,
    /// Learns from training logs.
    pub fit: fn(&Training) -> Result<Fitted, TaskError>,
}

impl Entry {
    /// Label in the names of tasks.
    pub fn label(&self) -> String {
        label(self.model)
    }
}

/// Returns the words of a name in small letters, joined by hyphens.
pub(super) fn label(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-")
}

/// A network of another method.
const NETWORK: Entry = Entry {
    model: "",
    is_default: false,
    is_ours: false,
    has_zeros: true,
    is_seeded: true,
    expected_seconds: 30.0,
    fit: |_| Err("no model".into()),
};

/// Defaults for our models, which use simple physics.
const BODIES: Entry = Entry { is_ours: true, is_seeded: false, expected_seconds: 10.0, ..NETWORK };

/// Defaults for a model that is known beforehand.
const KNOWN: Entry = Entry { is_seeded: false, expected_seconds: 0.5, ..NETWORK };

/// Parameters identified elsewhere; the row is in the table only if they are known.
const IDENTIFIED: Entry = Entry {
    model: "baseline: identified parameters",
    fit: |training| {
        let identified = training.baseline.ok_or("no identified parameters are known")?;
        Ok(Fitted::known(identified.clone()))
    },
    ..KNOWN
};

const VISCOUS: Chain = Chain { dry: false, commanded: false, load: false };
const COULOMB: Chain = Chain { dry: true, ..VISCOUS };
const COMMANDED: Chain = Chain { commanded: true, ..COULOMB };
const LOADED: Chain = Chain { load: true, ..COMMANDED };

/// All other rows of the table, in order.
const ENTRIES: [Entry; 10] = [
    Entry {
        model: "constant velocity",
        has_zeros: false,
        fit: |_| Ok(Fitted::known(ConstantVelocity)),
        ..KNOWN
    },
    Entry { model: "rigid bodies, viscous", fit: |training| VISCOUS.fit(training), ..BODIES },
    Entry { model: "rigid bodies, viscous + Coulomb", fit: |training| COULOMB.fit(training), ..BODIES },
    Entry {
        model: "… commanded torque, gain and delay learned",
        fit: |training| COMMANDED.fit(training),
        ..BODIES
    },
    Entry { model: "… Coulomb that grows with the load", fit: |training| LOADED.fit(training), ..BODIES },
    Entry {
        model: "leastaction, as look configures it",
        is_default: true,
        expected_seconds: 30.0,
        fit: configured::default,
        ..BODIES
    },
    Entry { model: "L-NODE", fit: |training| Rival::LNode.fit(training, false), ..NETWORK },
    Entry { model: "L-NODE with friction", fit: |training| Rival::LNode.fit(training, true), ..NETWORK },
    Entry { model: "DeLaN, torque loss", fit: |training| Rival::Delan.fit(training, false), ..NETWORK },
    Entry {
        model: "DeLaN, torque loss, with friction",
        fit: |training| Rival::Delan.fit(training, true),
        ..NETWORK
    },
];

/// Returns the rows of a table, with or without identified parameters.
pub fn entries(has_baseline: bool) -> Vec<Entry> {
    let (first, rest) = ENTRIES.split_at(1);
    let identified = Some(IDENTIFIED).filter(|_| has_baseline);
    first.iter().copied().chain(identified).chain(rest.iter().copied()).collect()
}
