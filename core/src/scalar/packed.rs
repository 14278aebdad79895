use super::{LANES, Lanes, Real, Scalar};

/// A real number type that is evaluated several numbers at a time where that is faster. Every lane takes the same
/// operations in the same order as a single number would, and so has the same bits.
pub trait Packed: Real {
    /// [`Packed::WIDTH`] numbers side by side.
    type Pack: Scalar<Weight = Self::Weight>;
    /// Number of lanes of a pack, at least 1.
    const WIDTH: usize;

    /// The pack with `lane(l)` in lane l.
    fn pack(lane: impl FnMut(usize) -> Self) -> Self::Pack;
    /// One lane of a pack; the last lane if `lane` is out of range.
    fn lane(pack: &Self::Pack, lane: usize) -> Self;
}

impl Packed for f64 {
    type Pack = Lanes;
    const WIDTH: usize = LANES;

    #[inline(always)]
    fn pack(mut lane: impl FnMut(usize) -> Self) -> Lanes {
        // Written out: not every closure call in a loop over an array is inlined.
        Lanes([lane(0), lane(1), lane(2), lane(3), lane(4), lane(5), lane(6), lane(7)])
    }
    #[inline(always)]
    fn lane(pack: &Lanes, lane: usize) -> Self {
        pack.0[lane.min(LANES - 1)]
    }
}

/// A pack of one number: chips have no vector registers for more.
impl Packed for f32 {
    type Pack = Self;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn pack(mut lane: impl FnMut(usize) -> Self) -> Self {
        lane(0)
    }
    #[inline(always)]
    fn lane(pack: &Self, _: usize) -> Self {
        *pack
    }
}
