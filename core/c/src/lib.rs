//! leastaction-core for C: a static library for one family of models and one shape, with a header.
//!
//! Family and shape are compiled in, so nothing is allocated, and the storage of a model and of a state is a C struct. A Cargo feature
//! chooses the family (`inertia-network`, `modular`, `graph`, `bodies`, `arm`), environment variables the shape (`config.rs`). No callback,
//! no allocation, no panic: wherever it could panic, the library calls `leastaction_panicked`, which nobody defines, so a program that
//! could panic does not link.
//!
//! `include/leastaction.h` is generated from the documentation here: `cargo run --bin header` in `tools`.
#![cfg_attr(not(test), no_std)]

/// Number of families that the library is to be built for; must be one.
const FAMILIES: usize = cfg!(feature = "inertia-network") as usize
    + cfg!(feature = "modular") as usize
    + cfg!(feature = "graph") as usize
    + cfg!(feature = "bodies") as usize
    + cfg!(feature = "arm") as usize;
const _: () = assert!(
    FAMILIES == 1,
    "choose one family: --no-default-features --features inertia-network, modular, graph, bodies or arm"
);
#[cfg(all(feature = "rods", not(feature = "graph")))]
compile_error!("rods are of graphs: --no-default-features --features graph,rods");
#[cfg(all(feature = "friction", feature = "graph"))]
compile_error!(
    "graphs have no dry friction: --no-default-features --features inertia-network,friction, modular,friction, bodies,friction or arm,friction"
);

#[cfg(all(any(feature = "networks", feature = "servo", feature = "axes"), feature = "graph"))]
compile_error!(
    "graphs have no such laws: --no-default-features --features inertia-network,networks, modular,networks, bodies,networks or arm,networks"
);

#[cfg(all(
    feature = "adapt",
    any(not(any(feature = "bodies", feature = "arm")), feature = "networks", feature = "half")
))]
compile_error!(
    "numbers follow in models of bodies in single precision, without networks: --no-default-features --features bodies,adapt or arm,adapt"
);

#[cfg(feature = "adapt")]
mod adapter;
mod arguments;
mod config;
mod contents;
mod error;
mod evaluate;
mod family;
mod follow;
#[cfg(feature = "adapt")]
mod found;
mod load;
mod messages;
mod motion;
#[cfg(feature = "adapt")]
mod patch;
mod plan;
#[cfg(feature = "rods")]
mod rods;
mod said;
mod start;
mod status;
mod step;
mod storage;
#[cfg(not(feature = "rods"))]
mod terms;

#[cfg(not(test))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe extern "C" {
        fn leastaction_panicked() -> !;
    }
    // SAFETY: it is never called: a program that could get here does not link, since nobody defines it.
    unsafe { leastaction_panicked() }
}
