/// A number of coordinates N, as a type.
#[derive(Clone, Copy, Debug)]
pub struct Coordinates<const N: usize>;

/// Number of numbers in a state (q, v): D is 2N, for N up to 12. The length of an array cannot be computed from N.
pub trait States<const D: usize> {}

macro_rules! states {
    ($($n:literal)*) => { $(impl States<{ 2 * $n }> for Coordinates<$n> {})* };
}
states!(1 2 3 4 5 6 7 8 9 10 11 12);
