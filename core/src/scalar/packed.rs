use super::{LANES, Lanes, Real, Scalar};

/// A real number that is evaluated several at a time where that is faster: the same operations in the same order, so
/// every lane has the bits that it has alone.
pub trait Packed: Real {
    /// [`Packed::WIDTH`] of them side by side.
    type Pack: Scalar<Weight = Self::Weight>;
    /// Lanes of a pack, at least 1.
    const WIDTH: usize;

    /// The pack whose lane l is `lane(l)`.
    fn pack(lane: impl FnMut(usize) -> Self) -> Self::Pack;
    /// One lane of a pack; the last for those beyond.
    fn lane(pack: &Self::Pack, lane: usize) -> Self;
}

impl Packed for f64 {
    type Pack = Lanes;
    const WIDTH: usize = LANES;

    #[inline(always)]
    fn pack(mut lane: impl FnMut(usize) -> Self) -> Lanes {
        // Written out: not every call of a closure in a loop over an array is inlined.
        Lanes([lane(0), lane(1), lane(2), lane(3), lane(4), lane(5), lane(6), lane(7)])
    }
    #[inline(always)]
    fn lane(pack: &Lanes, lane: usize) -> Self {
        pack.0[lane.min(LANES - 1)]
    }
}

/// Alone: chips have no vector registers for them.
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
