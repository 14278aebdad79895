//! Model of any family.

use super::{ModelError, ShapeHeader};
use crate::scalar::FileWeightFormat;

macro_rules! families {
    ($($(#[$doc:meta])* $variant:ident($header:ident): $number:literal, $name:literal;)*) => {
        /// A family of energies and its shape.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        #[allow(clippy::large_enum_variant, reason = "read once, and there is no heap to box it on")]
        pub enum Family<'a> {
            $($(#[$doc])* $variant(super::$header<'a>),)*
        }

        impl Family<'_> {
            /// Number in a file and name of every family.
            pub(super) const ALL: &'static [(u32, &'static str)] = &[$(($number, $name)),*];

            /// Name of the family.
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $name,)*
                }
            }

            /// Number of groups of coordinates; every law of friction has separate parameters for each group. Groups
            /// are the coordinates of inertia networks, bodies and arms, the element types of modular models and the
            /// node types of graphs.
            pub fn groups(&self) -> usize {
                match self {
                    $(Self::$variant(shape) => shape.groups(),)*
                }
            }

            /// Length of the weight block, in numbers.
            ///
            /// # Errors
            /// [`ModelError::OutOfRange`] for a shape that the format does not allow.
            pub fn parameters(&self) -> Result<usize, ModelError> {
                match self {
                    $(Self::$variant(shape) => shape.parameters(),)*
                }
            }
        }

        $(impl<'a> ShapeHeader<'a> for super::$header<'a> {
            const FAMILY: (u32, &'static str) = ($number, $name);

            fn parameters(&self) -> Result<usize, ModelError> {
                self.parameters()
            }

            fn groups(&self) -> usize {
                self.groups()
            }

            fn coordinates(&self) -> usize {
                self.common_coordinates()
            }

            fn validate<W: FileWeightFormat>(&self, weights: &[W]) -> Result<(), ModelError> {
                self.validate(weights)
            }
        })*
    };
}

with_families!(families);
