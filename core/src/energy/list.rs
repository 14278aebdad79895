//! Lists with a compiled maximum length, for the shapes in model files.

use core::fmt;
use core::marker::PhantomData;

use serde::de::{Error as _, SeqAccess, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A list of at most `MAX` items.
///
/// A list in a model file is `MAX` consecutive options, like an array. A file may hold a `None` before an item: such a list has a
/// [gap](List::has_gap), its items end at the gap, and shapes with a gap are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct List<T, const MAX: usize> {
    /// The items, then `None` up to the end of the array.
    pub slots: [Option<T>; MAX],
}

impl<T, const MAX: usize> List<T, MAX> {
    /// The item at `index`, from 0.
    #[inline(always)]
    pub fn get(&self, index: impl Into<usize>) -> Option<&T> {
        self.slots.get(index.into())?.as_ref()
    }

    /// Iterates over the items in order.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = &T> + Clone {
        self.slots.iter().map_while(Option::as_ref)
    }

    /// Iterates over the items in order, mutably.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.slots.iter_mut().map_while(Option::as_mut)
    }

    /// Number of items.
    pub fn len(&self) -> usize {
        self.iter().count()
    }

    /// Whether there is no item.
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// Whether a `None` stands before an item.
    pub fn has_gap(&self) -> bool {
        self.slots.iter().flatten().count() != self.len()
    }

    /// Converts all items in order; `None` if `convert` returns `None` for an item, or there are more than `TO` items.
    #[inline(always)]
    pub fn try_map<'t, U, const TO: usize>(
        &'t self,
        mut convert: impl FnMut(&'t T) -> Option<U>,
    ) -> Option<List<U, TO>> {
        let mut to = List::default();
        let mut slots = to.slots.iter_mut();
        for item in self.iter() {
            *slots.next()? = Some(convert(item)?);
        }
        Some(to)
    }
}

impl<T: Copy, const MAX: usize> List<T, MAX> {
    /// Creates a list of the given items; `None` for more than `MAX`.
    pub fn new(items: &[T]) -> Option<Self> {
        let mut list = Self::default();
        for (slot, item) in list.slots.get_mut(..items.len())?.iter_mut().zip(items) {
            *slot = Some(*item);
        }
        Some(list)
    }
}

/// The empty list.
impl<T, const MAX: usize> Default for List<T, MAX> {
    fn default() -> Self {
        Self { slots: [const { None }; MAX] }
    }
}

impl<T: Serialize, const MAX: usize> Serialize for List<T, MAX> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(MAX)?;
        self.slots.iter().try_for_each(|slot| tuple.serialize_element(slot))?;
        tuple.end()
    }
}

impl<'de, T: Deserialize<'de>, const MAX: usize> Deserialize<'de> for List<T, MAX> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple(MAX, Slots(PhantomData))
    }
}

/// Reads the slots of a list.
struct Slots<T, const MAX: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const MAX: usize> Visitor<'de> for Slots<T, MAX> {
    type Value = List<T, MAX>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{MAX} optional items")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
        let mut list = List::default();
        for (i, slot) in list.slots.iter_mut().enumerate() {
            *slot = sequence.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?;
        }
        Ok(list)
    }
}
