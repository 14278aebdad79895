//! `[model]` of inertia networks.

use super::coordinates::Coordinates;
use crate::architecture::Architecture;
use crate::config::family::{FamilyConfig, NetworksBeside, Source};
use crate::config::fields;
use crate::config::origin::Open;
use crate::config::origin::Origin;
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::inertia_network::{InertiaNetworkArchitecture, largest_factor};
use crate::laws::corrections::Corrections;
use crate::laws::corrections::config::{DissipationConfig, Known, PotentialConfig, assemble};
use crate::laws::friction::config::FrictionConfig;
use crate::laws::group::GroupLaws;
use crate::laws::servo::ServoConfig;
use crate::laws::stops::StopsConfig;
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::network::Activation;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Form of the inertia matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum InertiaKind {
    /// LLᵀ + εI.
    Cholesky,
    /// diag(softplus).
    Diagonal,
    /// BᵀB + εI.
    Factor,
}

/// Shape of an inertia network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InertiaNetworkConfig {
    /// Kinds of the coordinates.
    pub coordinates: Coordinates,
    /// Numbers of units in the hidden layers.
    #[serde(default = "hidden", deserialize_with = "fields::widths")]
    pub hidden: Vec<u16>,
    /// Activation of the hidden layers.
    #[serde(default = "activation", with = "fields::ActivationName")]
    pub activation: Activation,
    /// Form of the inertia matrix; by default diagonal for one coordinate, Cholesky for two, otherwise a factor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<InertiaKind>,
    /// Number of rows of the factor; by default the largest possible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<u8>,
    /// Constant ε ≥ 0 of the Cholesky form and of the factor.
    #[serde(default = "epsilon", deserialize_with = "fields::epsilon")]
    pub epsilon: f32,
    /// Whether viscous damping is learned.
    #[serde(default)]
    pub damping: bool,
    /// Run or model file, of any family, at whose inertia, potential and friction training begins.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_from: Option<PathBuf>,
    /// Friction of the coordinates, damping included.
    #[serde(default, skip_serializing_if = "FrictionConfig::is_none")]
    pub friction: FrictionConfig,
    /// Servos, whose commands are positions. By default commands are forces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub servo: Option<ServoConfig>,
    /// End stops, which no coordinate passes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stops: Option<StopsConfig>,
    /// Network that dissipates energy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipation: Option<DissipationConfig>,
    /// Network that is added to the potential.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub potential: Option<PotentialConfig>,
}

fn hidden() -> Vec<u16> {
    vec![24, 24]
}

fn activation() -> Activation {
    Activation::Tanh
}

fn epsilon() -> f32 {
    1e-9
}

impl InertiaNetworkConfig {
    /// Returns the default configuration for these coordinates.
    pub fn new(coordinates: Coordinates) -> Self {
        Self {
            coordinates,
            hidden: hidden(),
            activation: activation(),
            inertia: None,
            rows: None,
            epsilon: epsilon(),
            damping: false,
            start_from: None,
            friction: FrictionConfig::default(),
            servo: None,
            stops: None,
            dissipation: None,
            potential: None,
        }
    }

    /// Returns the shape of the model.
    ///
    /// # Errors
    /// An error for an invalid number of rows, rows without a factor, or invalid friction.
    fn shape(&self) -> Result<Architecture, ShapeError> {
        let Self { coordinates, hidden, activation, damping, .. } = self;
        let (n, plain) = (coordinates.0.len(), InertiaNetworkArchitecture::new(&coordinates.0, 0));
        let inertia = match self.inertia {
            None => plain.inertia.with_epsilon(self.epsilon),
            Some(InertiaKind::Diagonal) => Inertia::Diagonal,
            Some(InertiaKind::Cholesky) => Inertia::Cholesky { epsilon: self.epsilon },
            Some(InertiaKind::Factor) => {
                let rows = largest_factor(n).ok_or_else(|| self.bad_rows(Problem::TooManyForFactor { n }))?;
                Inertia::Factor { rows, epsilon: self.epsilon }
            }
        };
        let (group_laws, corrections) = self.laws()?;
        let family = InertiaNetworkArchitecture {
            widths: hidden.clone(),
            activation: *activation,
            inertia: self.with_rows(inertia)?,
            damped: *damping,
            ..plain
        };
        Ok(Architecture { family: family.into(), group_laws, corrections })
    }

    /// Returns the shape with the friction numbers of the model to start from. If the configuration has neither a
    /// `friction` nor a `damping` key, the kind of friction is taken from that model, too.
    fn begun(&self, mut architecture: Architecture, origin: Option<&Origin>) -> Architecture {
        match origin {
            Some(origin) if self.friction.is_none() && !self.damping && self.servo.is_none() => {
                architecture.group_laws = origin.friction_to_learn();
            }
            Some(origin) => origin.set_laws(&mut architecture.group_laws),
            None => {}
        }
        architecture
    }

    /// Returns friction and servos, and the correction networks.
    fn laws(&self) -> Result<(GroupLaws, Corrections), ShapeError> {
        self.friction.check_damping("damping", self.damping)?;
        let letters: String = self.coordinates.0.iter().map(|kind| kind.letter()).collect();
        let known = Known { letters: &letters, common: letters.len() };
        let friction = self.friction.assemble(letters.len(), "coordinate")?;
        let group_laws = ServoConfig::assemble(self.servo.as_ref(), (letters.len(), "coordinate"), friction)?;
        let group_laws =
            StopsConfig::assemble(self.stops.as_ref(), (letters.len(), "coordinate"), None, group_laws)?;
        Ok((group_laws, assemble(self.dissipation.as_ref(), self.potential.as_ref(), &known)?))
    }

    /// Returns the inertia with the requested number of rows.
    fn with_rows(&self, inertia: Inertia) -> Result<Inertia, ShapeError> {
        let n = self.coordinates.0.len();
        match (inertia, self.rows) {
            (inertia, None) => Ok(inertia),
            (Inertia::Factor { rows: most, epsilon }, Some(rows)) => {
                let least = u8::try_from(n).unwrap_or(u8::MAX);
                if !(least..=most).contains(&rows) {
                    return Err(self.bad_rows(Problem::Rows { rows, least, most }));
                }
                Ok(Inertia::Factor { rows, epsilon })
            }
            (_, Some(_)) => Err(self.bad_rows(Problem::RowsWithoutFactor)),
        }
    }

    fn bad_rows(&self, problem: Problem) -> ShapeError {
        let key = if self.rows.is_some() { "rows" } else { "inertia" };
        ShapeError { place: vec!["model".into(), key.into()], problem }
    }
}

impl FamilyConfig for InertiaNetworkConfig {
    fn defaults() -> &'static str {
        include_str!("config.toml")
    }

    fn files(&mut self) -> Vec<&mut PathBuf> {
        self.start_from.iter_mut().collect()
    }

    fn networks(&mut self) -> Option<NetworksBeside<'_>> {
        Some((&mut self.dissipation, &mut self.potential))
    }

    fn source(&self) -> Source {
        if self.start_from.is_some() { Source::Energies } else { Source::Nothing }
    }

    fn origin(&self, open: Open) -> Result<Option<Origin>, ShapeError> {
        let letters: String = self.coordinates.0.iter().map(|kind| kind.letter()).collect();
        Origin::start_from(self.start_from.as_ref(), &letters, open)
    }

    fn architecture(&self, open: Open) -> Result<Architecture, ShapeError> {
        let shape = self.shape()?;
        Ok(self.begun(shape, self.origin(open)?.as_ref()))
    }

    /// The weights of the network are random; the damping is that of the model to start from.
    fn beginning(&self, seed: u64, open: Open) -> Result<(Architecture, Vec<f64>), ShapeError> {
        let shape = self.shape()?;
        let origin = self.origin(open)?;
        let architecture = self.begun(shape, origin.as_ref());
        let mut weights = architecture.initial_weights(seed);
        if let Some(origin) = origin {
            let damping = architecture.family.inertia_network().and_then(InertiaNetworkArchitecture::damping);
            let damping = damping.unwrap_or_default();
            weights.splice(damping.clone(), origin.damping().into_iter().take(damping.len()));
        }
        Ok((architecture, weights))
    }
}
