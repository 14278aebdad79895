//! How deep the stack goes: the workspace below it is painted, and looked at afterwards.

use crate::board::stack_pointer;

unsafe extern "C" {
    /// Where static memory ends and the stack may reach to, by the linker script of both runtimes.
    static mut __sheap: u32;
}

const PAINT: u32 = 0xcccc_cccc;
/// Left alone below the painter's own frame, bytes.
const MARGIN: usize = 128;
/// Painted at most, bytes: no image comes near.
const DEPTH: usize = 1 << 16;

/// Bytes of stack that `work` takes below its caller, and what it returns.
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
