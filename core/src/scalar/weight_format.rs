use super::Scalar;
use bytemuck::AnyBitPattern;
use core::fmt::Debug;
use leastaction_fpu::f16;

/// Storage format of a model's numbers: `f32` in flash, [`struct@f16`] in half of it, `f64` in training. The numbers
/// are read as the wider type that scalars compute with.
pub trait WeightFormat: Copy + Debug + Default + PartialEq {
    /// Type that holds each number exactly.
    type Wide: Copy + Debug;

    /// The number in the wider type, unchanged.
    fn wide(self) -> Self::Wide;

    /// The numbers as [`Weights`], if a model file can have their type.
    #[inline(always)]
    fn in_file(_: &[Self]) -> Option<Weights<'_>> {
        None
    }

    /// The number as a scalar (broadcast to every lane).
    #[inline(always)]
    fn scalar<S: Scalar<Weight = Self::Wide>>(self) -> S {
        S::weight(self.wide())
    }
}

/// The weights of a model file, in the precision of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weights<'a> {
    /// Two bytes per number.
    Half(&'a [f16]),
    /// Four bytes per number.
    Single(&'a [f32]),
}

/// A type in which a model file stores its weights.
pub trait FileWeightFormat: WeightFormat<Wide = f32> + AnyBitPattern {
    /// Number of bits of a number.
    const BITS: u8;
    /// Number of bits of a number of the other type.
    const OTHER_BITS: u8;

    /// The numbers as [`Weights`].
    fn weights(numbers: &[Self]) -> Weights<'_>;
}

impl FileWeightFormat for f16 {
    const BITS: u8 = 16;
    const OTHER_BITS: u8 = 32;

    #[inline(always)]
    fn weights(numbers: &[Self]) -> Weights<'_> {
        Weights::Half(numbers)
    }
}

impl FileWeightFormat for f32 {
    const BITS: u8 = 32;
    const OTHER_BITS: u8 = 16;

    #[inline(always)]
    fn weights(numbers: &[Self]) -> Weights<'_> {
        Weights::Single(numbers)
    }
}

impl WeightFormat for f16 {
    type Wide = f32;

    #[inline(always)]
    fn wide(self) -> f32 {
        leastaction_fpu::widened(self)
    }
    #[inline(always)]
    fn in_file(numbers: &[Self]) -> Option<Weights<'_>> {
        Some(Self::weights(numbers))
    }
}

impl WeightFormat for f32 {
    type Wide = Self;

    #[inline(always)]
    fn wide(self) -> Self {
        self
    }
    #[inline(always)]
    fn in_file(numbers: &[Self]) -> Option<Weights<'_>> {
        Some(Self::weights(numbers))
    }
}

impl WeightFormat for f64 {
    type Wide = Self;

    #[inline(always)]
    fn wide(self) -> Self {
        self
    }
}

impl Weights<'_> {
    /// Number of bits of a number.
    pub fn bits(&self) -> u8 {
        match self {
            Self::Half(_) => <f16 as FileWeightFormat>::BITS,
            Self::Single(_) => <f32 as FileWeightFormat>::BITS,
        }
    }

    /// Number of weights.
    pub fn len(&self) -> usize {
        match self {
            Self::Half(w) => w.len(),
            Self::Single(w) => w.len(),
        }
    }

    /// Whether the list is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number `i` in single precision.
    pub fn get(&self, i: usize) -> Option<f32> {
        match self {
            Self::Half(w) => w.get(i).map(|w| w.wide()),
            Self::Single(w) => w.get(i).copied(),
        }
    }

    /// The numbers in single precision.
    pub fn iter(&self) -> impl Iterator<Item = f32> {
        (0..self.len()).filter_map(|i| self.get(i))
    }
}
