//! Logs as ROS 2 bags of SQLite.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| leastaction_fuzz::logs::db3(data));
