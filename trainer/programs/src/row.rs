use leastaction_core::scalar::{LANES, Lanes, Scalar};
use wide::f64x8;

/// Number of groups of lanes in a row.
pub(crate) const GROUPS: usize = 2;

/// Number of samples that a program evaluates side by side.
pub const WIDTH: usize = GROUPS * LANES;

/// Vector register: a part of a row.
#[cfg(target_feature = "avx512f")]
pub type Part = wide::f64x8;
/// Vector register: a part of a row.
#[cfg(not(target_feature = "avx512f"))]
pub type Part = wide::f64x4;

/// Number of parts of a row.
pub(crate) const PARTS: usize = size_of::<Row>() / size_of::<Part>();

/// Positions of the numbers of a row among those of all rows; positions beyond the rows give zeros.
pub(crate) type Places = [u32; WIDTH];

/// One number of every sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Row(pub [f64; WIDTH]);

impl Row {
    /// Creates a row with the same number in every sample.
    #[inline(always)]
    pub const fn splat(x: f64) -> Self {
        Self([x; WIDTH])
    }

    /// Loads the numbers into vector registers.
    #[inline(always)]
    pub(crate) fn load(&self) -> [f64x8; GROUPS] {
        let (groups, _) = self.0.as_chunks::<LANES>();
        std::array::from_fn(|g| f64x8::new(groups[g]))
    }

    /// Loads the numbers of one group of samples.
    #[inline(always)]
    pub(crate) fn group(&self, g: usize) -> f64x8 {
        f64x8::new(self.0.as_chunks::<LANES>().0[g])
    }

    /// Writes the numbers of one group of samples.
    #[inline(always)]
    pub(crate) fn set_group(&mut self, g: usize, x: f64x8) {
        self.0.as_chunks_mut::<LANES>().0[g] = x.to_array();
    }

    /// Loads a part of the row into a register.
    #[inline(always)]
    pub(crate) fn part(&self, k: usize) -> Part {
        Part::new(self.0.as_chunks().0[k])
    }

    /// Writes a part of the row.
    #[inline(always)]
    pub(crate) fn set_part(&mut self, k: usize, x: Part) {
        self.0.as_chunks_mut().0[k] = x.to_array();
    }

    /// Returns the numbers at these positions of rows.
    #[inline(always)]
    pub(crate) fn picked(rows: &[Self], places: &Places) -> Self {
        let number = |i: u32| rows.get(i as usize / WIDTH).map_or(0.0, |row| row.0[i as usize % WIDTH]);
        Self(std::array::from_fn(|k| number(places[k])))
    }

    /// Stores numbers from vector registers.
    #[inline(always)]
    pub(crate) fn store(x: [f64x8; GROUPS]) -> Self {
        let mut row = Self::default();
        for (group, x) in row.0.as_chunks_mut::<LANES>().0.iter_mut().zip(x) {
            *group = x.to_array();
        }
        row
    }

    /// Applies `f` to the numbers of this row and of another row, sample by sample.
    #[inline(always)]
    pub(crate) fn zip(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut result = *self;
        result.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a = f(*a, *b));
        result
    }

    /// Linear interpolation from this row to another: self + part (end − self).
    #[inline(always)]
    #[must_use]
    pub fn towards(&self, end: &Self, part: f64) -> Self {
        self.zip(end, |a, b| a + part * (b - a))
    }

    /// Applies `f` to every sample's number, eight at a time.
    #[inline(always)]
    pub(crate) fn map_lanes(&self, f: impl Fn(Lanes) -> Lanes) -> Self {
        let mut result = *self;
        for group in result.0.as_chunks_mut::<LANES>().0 {
            *group = f(Lanes(*group)).0;
        }
        result
    }

    /// Adds cx.
    #[inline(always)]
    pub fn add_scaled(&mut self, c: f64, x: &Self) {
        let (sum, x, c) = (self.load(), x.load(), f64x8::splat(c));
        *self = Self::store(std::array::from_fn(|g| sum[g] + c * x[g]));
    }

    /// Returns xy.
    #[inline(always)]
    pub fn product(&self, y: &Self) -> Self {
        let (x, y) = (self.load(), y.load());
        Self::store(std::array::from_fn(|g| x[g] * y[g]))
    }

    /// Adds xy.
    #[inline(always)]
    pub fn add_product(&mut self, x: &Self, y: &Self) {
        let (sum, x, y) = (self.load(), x.load(), y.load());
        *self = Self::store(std::array::from_fn(|g| sum[g] + x[g] * y[g]));
    }
}

impl Default for Row {
    fn default() -> Self {
        Self::splat(0.0)
    }
}

/// Sine and cosine of every sample's number.
pub(crate) fn sin_cos(x: &Row) -> [Row; 2] {
    let (mut sin, mut cos) = (*x, *x);
    let groups = sin.0.as_chunks_mut::<LANES>().0.iter_mut().zip(cos.0.as_chunks_mut::<LANES>().0);
    for (sin, cos) in groups {
        let (own_sin, own_cos) = Lanes(*sin).sin_cos();
        (*sin, *cos) = (own_sin.0, own_cos.0);
    }
    [sin, cos]
}
