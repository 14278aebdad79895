use core::mem::MaybeUninit;
use core::ptr::addr_of_mut;

/// Bytes of a run with its model; the largest takes some 20 KB.
const BYTES: usize = 64 * 1024;

/// Memory at multiples of 16.
#[repr(C, align(16))]
struct Memory([MaybeUninit<u8>; BYTES]);

static mut MEMORY: Memory = Memory([MaybeUninit::uninit(); BYTES]);

/// Memory of one run, in which its parts lie one after the other until it is cleared. The module has one arena, because all share the memory.
pub struct Arena {
    used: usize,
}

impl Arena {
    /// Creates the arena, empty.
    ///
    /// # Safety
    /// There may be no other one.
    pub const unsafe fn new() -> Self {
        Self { used: 0 }
    }

    /// Forgets what is in the arena.
    ///
    /// # Safety
    /// Nobody may use what was put into it before.
    pub unsafe fn clear(&mut self) {
        self.used = 0;
    }

    /// Takes bytes at a multiple of `align`, at most 16; `None` if they do not fit.
    fn take(&mut self, bytes: usize, align: usize) -> Option<*mut u8> {
        let begin = self.used.next_multiple_of(align);
        let end = begin.checked_add(bytes).filter(|end| *end <= BYTES)?;
        self.used = end;
        // SAFETY: the place is inside the memory.
        Some(unsafe { addr_of_mut!(MEMORY).cast::<u8>().add(begin) })
    }

    /// Puts a value into the arena, where it stays until the arena is cleared; `None` if it does not fit. Its destructor does not run.
    pub fn put<T: 'static>(&mut self, value: T) -> Option<&'static mut T> {
        const { assert!(align_of::<T>() <= align_of::<Memory>()) };
        let place = self.take(size_of::<T>(), align_of::<T>())?.cast::<T>();
        // SAFETY: the place is aligned and large enough, and nobody else has it until `clear`, whose caller vouches for the references.
        unsafe {
            place.write(value);
            Some(&mut *place)
        }
    }

    /// Puts a copy of bytes into the arena, at a word.
    pub fn put_bytes(&mut self, bytes: &[u8]) -> Option<&'static [u8]> {
        let place = self.take(bytes.len(), size_of::<u32>())?;
        // SAFETY: as in `put`; `bytes` are not in free memory of the arena.
        unsafe {
            place.copy_from_nonoverlapping(bytes.as_ptr(), bytes.len());
            Some(core::slice::from_raw_parts(place, bytes.len()))
        }
    }
}
