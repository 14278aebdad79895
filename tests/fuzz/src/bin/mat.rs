//! Logs as MATLAB files.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| leastaction_fuzz::logs::mat(data));
