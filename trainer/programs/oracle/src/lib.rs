//! Tests only: `tests/` holds programs of energies against leastaction-core in f64.
