//! One type for all families.

use crate::family::Family;
use leastaction_core::model::{Family as FamilyHeader, Header, Laws, ModelError};
use serde::{Deserialize, Serialize};
use std::ops::{Deref, DerefMut};

/// Defines the enum of all families, and everything that follows from their list: conversions, names, reading and
/// writing of headers.
macro_rules! any_family {
    ($($(#[$doc:meta])* $variant:ident: $name:literal $(| $former:literal)*, $get:ident, $shape:ty, $config:ty, $words:ty;)*) => {
        /// A model's family, one of all.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        pub enum AnyFamily {
            $($(#[$doc])* $variant($shape),)*
        }

        $(impl From<$shape> for AnyFamily {
            fn from(shape: $shape) -> Self {
                Self::$variant(shape)
            }
        })*

        impl Deref for AnyFamily {
            type Target = dyn Family;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$variant(shape) => shape,)*
                }
            }
        }

        impl DerefMut for AnyFamily {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self {
                    $(Self::$variant(shape) => shape,)*
                }
            }
        }

        impl AnyFamily {
            /// Name of the family in configurations and messages.
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $name,)*
                }
            }

            /// Returns the family described by a model file with these laws; if the file has several trees or graphs,
            /// the first one is selected. All its numbers are known.
            ///
            /// # Errors
            /// [`ModelError::OtherFamily`] for a family that this program does not know.
            pub(crate) fn from_header(header: &FamilyHeader, laws: Laws, weights: &[f64]) -> Result<Self, ModelError> {
                match header {
                    $(FamilyHeader::$variant(header) => Ok(<$shape>::from_header(header, laws, weights).into()),)*
                    other => Err(ModelError::OtherFamily { found: other.name() }),
                }
            }

            /// Calls `read` with the shape as the model file states it.
            pub fn with_header<T>(&self, read: impl FnOnce(FamilyHeader) -> T) -> T {
                match self {
                    $(Self::$variant(shape) => shape.with_header(|header| read(FamilyHeader::$variant(header))),)*
                }
            }

            $(
                #[doc = concat!("Shape, if the family is `", $name, "`.")]
                pub fn $get(&self) -> Option<&$shape> {
                    match self {
                        Self::$variant(shape) => Some(shape),
                        _ => None,
                    }
                }
            )*
        }
    };
}

with_families!(any_family);

impl AnyFamily {
    /// Number of entries in the family's part of the weight block, which comes first.
    ///
    /// # Errors
    /// An error if the shape is outside the range of the format.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.with_header(|family| Header { laws: self.laws(), ..Header::new(family) }.parameters())
    }
}
