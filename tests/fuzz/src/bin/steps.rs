//! Model files are loaded, evaluated and stepped.
#![no_main]

use leastaction_fuzz::{sections, steps};
use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

fuzz_target!(|data: &[u8]| steps::steps(data));
fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    if size <= steps::HEAD || seed.is_multiple_of(16) {
        return fuzzer_mutate(data, size, max_size);
    }
    let (most, sections) = (max_size - steps::HEAD, &mut data[steps::HEAD..]);
    steps::HEAD + sections::mutate(sections, size - steps::HEAD, most, seed, fuzzer_mutate)
});
