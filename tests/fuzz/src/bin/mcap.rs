//! Logs as ROS 2 bags.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| leastaction_fuzz::logs::mcap(data));
