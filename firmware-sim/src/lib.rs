//! Fixed-step control loops.
#![no_std]
