//! Loads model files.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

fuzz_target!(|data: &[u8]| leastaction_fuzz::model::load(data));
fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    leastaction_fuzz::sections::mutate(data, size, max_size, seed, fuzzer_mutate)
});
