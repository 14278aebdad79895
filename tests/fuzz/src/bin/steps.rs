//! Loads, evaluates and steps model files.
#![no_main]

use leastaction_fuzz::{HEAD, sections, steps};
use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

fuzz_target!(|data: &[u8]| steps::steps(data));
fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    if size <= HEAD || seed.is_multiple_of(16) {
        return fuzzer_mutate(data, size, max_size);
    }
    let (most, sections) = (max_size - HEAD, &mut data[HEAD..]);
    HEAD + sections::mutate(sections, size - HEAD, most, seed, fuzzer_mutate)
});
