//! Serialization that `serde` does not provide: arrays of any length, and types of core.

use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::{Newton, Order, Report};
use serde::{Deserialize, Serialize};

/// Bounds of Newton's method.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Newton::<f32>")]
pub(crate) struct NewtonWire {
    max_iterations: u8,
    stop: f32,
    accept: f32,
}

/// Order of a step.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Order")]
pub(crate) enum OrderWire {
    Two,
    Four,
}

/// Report of a step.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Report::<f32>")]
pub(crate) struct ReportWire {
    iterations: u8,
    residual: f32,
}

/// Position and velocity.
#[derive(Serialize, Deserialize)]
#[serde(
    remote = "ContinuousState",
    bound(serialize = "R: Serialize", deserialize = "R: Deserialize<'de> + Copy + Default")
)]
pub(crate) struct StateWire<R, const N: usize> {
    #[serde(with = "array")]
    q: [R; N],
    #[serde(with = "array")]
    v: [R; N],
}

/// An array as a tuple: its elements one after another, without their count.
pub(crate) mod array {
    use core::fmt;
    use core::marker::PhantomData;
    use serde::de::{Error, SeqAccess, Visitor};
    use serde::ser::SerializeTuple;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer, T: Serialize, const N: usize>(
        array: &[T; N],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let mut tuple = to.serialize_tuple(N)?;
        for element in array {
            tuple.serialize_element(element)?;
        }
        tuple.end()
    }

    pub(crate) fn deserialize<'de, D, T, const N: usize>(from: D) -> Result<[T; N], D::Error>
    where
        D: Deserializer<'de>,
        T: Deserialize<'de> + Copy + Default,
    {
        from.deserialize_tuple(N, Elements(PhantomData))
    }

    struct Elements<T, const N: usize>(PhantomData<T>);

    impl<'de, T: Deserialize<'de> + Copy + Default, const N: usize> Visitor<'de> for Elements<T, N> {
        type Value = [T; N];

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("an array")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<[T; N], A::Error> {
            let mut array = [T::default(); N];
            for (i, element) in array.iter_mut().enumerate() {
                *element = elements.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?;
            }
            Ok(array)
        }
    }
}
