//! Rows of weights at addresses that loads of many registers can read.

/// Calls `pass(first, rows)` with all rows if they begin at a multiple of four bytes, as loads of many registers require; else with copies
/// of a few rows at a time, the first being row `first`.
#[inline(always)]
pub fn aligned<W: Copy, const P: usize>(rows: &[[W; P]], mut pass: impl FnMut(usize, &[[W; P]])) {
    #[repr(align(4))]
    struct Workspace<R>([R; COPIED]);
    if rows.as_ptr().cast::<u32>().is_aligned() {
        return pass(0, rows);
    }
    for (rows, first) in rows.chunks(COPIED).zip((0..).step_by(COPIED)) {
        let Some(row) = rows.first() else { continue };
        let mut workspace = Workspace([*row; COPIED]);
        workspace.0.iter_mut().zip(rows).for_each(|(copy, row)| *copy = *row);
        debug_assert!(rows.len() <= COPIED, "a chunk");
        pass(first, workspace.0.get(..rows.len()).unwrap_or(&workspace.0));
    }
}

/// Number of rows copied at a time.
const COPIED: usize = 8;
