//! Values guaranteed by an earlier check.
//!
//! Code for a controller may not contain a panic, so indexing and slicing return options even if a constructor has
//! made sure that they succeed. These functions take the value out: a debug build stops if the value is missing, a
//! release build goes on without it.

/// The value of `option`, which is never `None`; a release build would go on with `fallback`.
#[inline(always)]
#[track_caller]
pub(crate) fn expected<T>(option: Option<T>, fallback: T) -> T {
    present(option).unwrap_or(fallback)
}

/// `option` itself, which is never `None`; a release build would skip the code that needs the value.
#[inline(always)]
#[track_caller]
pub(crate) fn present<T>(option: Option<T>) -> Option<T> {
    debug_assert!(option.is_some(), "a value that was checked before is missing");
    option
}

/// The first `n` items of a slice, which has at least `n`.
#[inline(always)]
#[track_caller]
pub(crate) fn first<T>(items: &[T], n: usize) -> &[T] {
    expected(items.get(..n), &[])
}

/// The first `n` items of a slice, which has at least `n`, mutable.
#[inline(always)]
#[track_caller]
pub(crate) fn first_mut<T>(items: &mut [T], n: usize) -> &mut [T] {
    expected(items.get_mut(..n), &mut [])
}
