//! Reads, writes and follows plans.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| leastaction_fuzz::plan::plan(data));
