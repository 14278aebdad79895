//! Values that a check made earlier guarantees.
//!
//! Code for a controller may not hold a panic, so indexing and slicing return options even where a constructor has made sure
//! that they succeed. These functions take the value out: a debug build stops where it is missing, a release build goes on
//! with less.

/// The value of `option`, which is never `None`; `fallback` is what a release build would go on with.
#[inline(always)]
#[track_caller]
pub(crate) fn expected<T>(option: Option<T>, fallback: T) -> T {
    debug_assert!(option.is_some(), "a value that was checked before is missing");
    option.unwrap_or(fallback)
}

/// The first `n` items of a slice that has at least as many.
#[inline(always)]
#[track_caller]
pub(crate) fn first<T>(items: &[T], n: usize) -> &[T] {
    expected(items.get(..n), items)
}

/// The first `n` items of a slice that has at least as many, to be written.
#[inline(always)]
#[track_caller]
pub(crate) fn first_mut<T>(items: &mut [T], n: usize) -> &mut [T] {
    debug_assert!(n <= items.len(), "{n} items expected of {}", items.len());
    let n = n.min(items.len());
    items.get_mut(..n).unwrap_or_default()
}
