//! `[model]` of a configuration, for any family.

use super::family::FamilyConfig;
use crate::inertia_network::config::InertiaNetworkConfig;
use crate::inertia_network::coordinates::Coordinates;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::ops::{Deref, DerefMut};

/// Defines the enum of all configurations, and everything that follows from the list of families.
macro_rules! any_config {
    ($($(#[$doc:meta])* $variant:ident: $name:literal $(| $former:literal)*, $get:ident, $shape:ty, $config:ty, $words:ty;)*) => {
        /// `[model]` of a configuration, for any family.
        #[derive(Clone, Debug, PartialEq, Serialize)]
        #[serde(untagged)]
        pub enum ModelConfig {
            $($(#[$doc])* $variant($config),)*
        }

        $(impl From<$config> for ModelConfig {
            fn from(config: $config) -> Self {
                Self::$variant(config)
            }
        })*

        impl Deref for ModelConfig {
            type Target = dyn FamilyConfig;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$variant(config) => config,)*
                }
            }
        }

        impl DerefMut for ModelConfig {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self {
                    $(Self::$variant(config) => config,)*
                }
            }
        }

        impl Visitor<'_> for FamilyName {
            type Value = &'static str;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("the name of a family")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<&'static str, E> {
                match name {
                    $($name $(| $former)* => Ok($name),)*
                    other => Err(E::unknown_variant(other, ModelConfig::FAMILIES)),
                }
            }
        }

        impl ModelConfig {
            /// Names of all families.
            pub const FAMILIES: &[&str] = &[$($name),*];

            /// Reads the name of a family; a former name is accepted too.
            ///
            /// # Errors
            /// An error if no family has that name.
            pub fn read_family<'de, D: Deserializer<'de>>(from: D) -> Result<&'static str, D::Error> {
                from.deserialize_str(FamilyName)
            }

            /// Reads `[model]` for the family of this name; the name itself is not part of it.
            ///
            /// # Errors
            /// An error if it is no configuration of that family.
            pub fn read<'de, D: Deserializer<'de>>(family: &str, from: D) -> Result<Self, D::Error> {
                match family {
                    $($name => <$config>::deserialize(from).map(Self::$variant),)*
                    other => Err(D::Error::unknown_variant(other, Self::FAMILIES)),
                }
            }

            /// Returns a TOML configuration for the family of this name, with every key of `[model]` explained.
            pub fn defaults(family: &str) -> Option<&'static str> {
                match family {
                    $($name $(| $former)* => Some(<$config>::defaults()),)*
                    _ => None,
                }
            }
        }
    };
}

/// Reader of the name of a family, which lets an error state its place.
struct FamilyName;

with_families!(any_config);

impl ModelConfig {
    /// Returns this configuration with exactly the requested correction networks, each as it is given or else with its
    /// defaults; `None` if its coordinates can have none.
    pub fn with_networks(&self, with_dissipation: bool, with_potential: bool) -> Option<Self> {
        let mut own = self.clone();
        let (dissipation, potential) = own.networks()?;
        *dissipation = with_dissipation.then(|| dissipation.take().unwrap_or_default());
        *potential = with_potential.then(|| potential.take().unwrap_or_default());
        Some(own)
    }
}

impl From<Coordinates> for ModelConfig {
    fn from(coordinates: Coordinates) -> Self {
        Self::InertiaNetwork(InertiaNetworkConfig::new(coordinates))
    }
}
