//! This package has only tests: `tests/` compares programs of energies with leastaction-core in f64.
