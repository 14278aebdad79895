//! Depth of the stack: the memory below it is painted, and inspected afterwards.

use crate::board::stack_pointer;

unsafe extern "C" {
    /// End of static memory, down to which the stack may reach, as both runtimes' linker scripts define it.
    static mut __sheap: u32;
}

const PAINT: u32 = 0xcccc_cccc;
/// Bytes left alone below the painter's own frame.
const MARGIN: usize = 128;
/// Maximum number of painted bytes: no image comes near.
const DEPTH: usize = 1 << 16;

/// Runs `work`, and returns the bytes of stack that it takes below its caller, and its result.
#[inline(never)]
pub fn deepest<T>(work: impl FnOnce() -> T) -> (usize, T) {
    let top = stack_pointer();
    let bottom = bottom(top);
    for address in (bottom..top - MARGIN).step_by(4) {
        // SAFETY: between the end of static memory and the frame of this function, where nothing lives.
        unsafe { (address as *mut u32).write_volatile(PAINT) };
    }
    let outcome = work();
    // SAFETY: as above; only read.
    let painted = |address: &usize| unsafe { (*address as *const u32).read_volatile() } == PAINT;
    let untouched = (bottom..top - MARGIN).step_by(4).take_while(painted).count();
    (top - bottom - 4 * untouched, outcome)
}

fn bottom(top: usize) -> usize {
    let end = (&raw const __sheap) as usize;
    end.max(top - DEPTH)
}
