//! Descriptions of the families' shapes in words.

use crate::registry::AnyFamily;
use crate::words::Describe;
use serde::Serialize;
use std::ops::Deref;

/// Defines the enum of all descriptions.
macro_rules! any_description {
    ($($(#[$doc:meta])* $variant:ident: $name:literal $(| $former:literal)*, $get:ident, $shape:ty, $config:ty, $words:ty;)*) => {
        /// Description of a shape in words, for any family.
        #[derive(Serialize)]
        #[serde(untagged)]
        pub enum Description {
            $($(#[$doc])* $variant($words),)*
        }

        impl Description {
            /// Describes a shape with its initial numbers.
            pub fn of(family: &AnyFamily) -> Self {
                match family {
                    $(AnyFamily::$variant(shape) => Self::$variant(shape.into()),)*
                }
            }
        }

        impl Deref for Description {
            type Target = dyn Describe;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$variant(words) => words,)*
                }
            }
        }
    };
}

with_families!(any_description);
