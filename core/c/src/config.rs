//! Sizes for which the library is built, from environment variables that the compiler reads.

/// A size from the environment, or its default.
macro_rules! size {
    ($name:literal, $default:literal, $least:literal ..= $most:literal) => {
        match option_env!($name) {
            None => $default,
            Some(text) => match number(text) {
                Some(size) if $least <= size && size <= $most => size,
                _ => panic!(concat!($name, " must be a whole number from ", $least, " to ", $most)),
            },
        }
    };
}

/// Number of the binary interface; it changes with any struct or function that a program was compiled with.
pub const LEASTACTION_ABI: u32 = 4;
/// Number of coordinates of the mechanism.
pub const LEASTACTION_COORDINATES: usize = size!("LEASTACTION_COORDINATES", 2, 1..=64);
/// Maximum number of units of a hidden layer.
#[cfg(not(any(feature = "bodies", feature = "arm")))]
pub const LEASTACTION_HIDDEN: usize = size!("LEASTACTION_HIDDEN", 32, 1..=1024);
/// Maximum number of hidden layers of a network.
#[cfg(not(any(feature = "bodies", feature = "arm")))]
pub const LEASTACTION_LAYERS: usize = size!("LEASTACTION_LAYERS", 2, 1..=4);
/// Maximum number of units of a hidden layer of a law's network.
#[cfg(feature = "networks")]
pub const LEASTACTION_LAW_HIDDEN: usize = size!("LEASTACTION_LAW_HIDDEN", 8, 1..=1024);
/// Maximum number of hidden layers of a law's network.
#[cfg(feature = "networks")]
pub const LEASTACTION_LAW_LAYERS: usize = size!("LEASTACTION_LAW_LAYERS", 2, 1..=4);
/// Maximum number of element types.
#[cfg(feature = "modular")]
pub const LEASTACTION_TYPES: usize = size!("LEASTACTION_TYPES", 2, 1..=5);
/// Dimensions of the space of particles.
#[cfg(feature = "graph")]
pub const LEASTACTION_DIMENSIONS: usize = size!("LEASTACTION_DIMENSIONS", 2, 2..=3);
/// Maximum number of networks of all types together.
#[cfg(feature = "graph")]
pub const LEASTACTION_NETWORKS: usize = size!("LEASTACTION_NETWORKS", 6, 1..=11);
/// Maximum number of edges of the graph.
#[cfg(feature = "graph")]
pub const LEASTACTION_EDGES: usize = size!("LEASTACTION_EDGES", 8, 1..=4096);
/// Maximum number of rods of the graph.
#[cfg(feature = "rods")]
pub const LEASTACTION_RODS: usize = size!("LEASTACTION_RODS", 4, 1..=64);
/// Maximum number of rods of the graph.
#[cfg(all(feature = "graph", not(feature = "rods")))]
pub const LEASTACTION_RODS: usize = 0;

/// Maximum number of numbers that follow the machine.
#[cfg(feature = "adapt")]
pub const LEASTACTION_NUMBERS: usize = size!("LEASTACTION_NUMBERS", 24, 1..=64);

/// Words of a network: weights, biases and number of inputs, layer by layer.
#[cfg(not(any(feature = "bodies", feature = "arm")))]
const NETWORK: usize = 5 * (LEASTACTION_LAYERS + 1);

// The sizes fit a model with 2 words to spare where pointers have 32 bits; where they have 64 bits, a model takes
// fewer words. The build fails if a model no longer fits (`contents.rs`).

/// Words that dry friction takes, four numbers per coordinate, servos, one, and the laws of axes, fourteen.
#[cfg(not(feature = "graph"))]
const FRICTION: usize = {
    let friction = if cfg!(feature = "friction") { 4 } else { 0 };
    let servo = if cfg!(feature = "servo") { 1 } else { 0 };
    let axes = if cfg!(feature = "axes") { 14 } else { 0 };
    (friction + servo + axes) * LEASTACTION_COORDINATES
};

/// Words that both laws with networks take: the network, the coordinates that it sees, and scales.
#[cfg(all(feature = "networks", not(feature = "graph")))]
const LAWS: usize = 2 * (5 * (LEASTACTION_LAW_LAYERS + 1) + LEASTACTION_COORDINATES.div_ceil(2) + 6);
#[cfg(not(any(feature = "networks", feature = "graph")))]
const LAWS: usize = 0;

/// Pointer-sized words of a loaded model.
#[cfg(feature = "inertia-network")]
pub const LEASTACTION_MODEL_WORDS: usize =
    NETWORK + LEASTACTION_COORDINATES + LEASTACTION_COORDINATES.div_ceil(4) + FRICTION + LAWS + 13;
/// Pointer-sized words of a loaded model.
#[cfg(feature = "modular")]
pub const LEASTACTION_MODEL_WORDS: usize =
    LEASTACTION_TYPES * (3 * NETWORK + 13) + NETWORK + 6 * LEASTACTION_COORDINATES + FRICTION + LAWS + 16;
/// Pointer-sized words of a loaded model.
#[cfg(feature = "graph")]
pub const LEASTACTION_MODEL_WORDS: usize =
    LEASTACTION_NETWORKS * (NETWORK + 2) + (3 * LEASTACTION_EDGES).div_ceil(2) + LIST_OF_RODS + 72;

/// Pointer-sized words of a loaded model.
#[cfg(any(feature = "bodies", feature = "arm"))]
pub const LEASTACTION_MODEL_WORDS: usize =
    LEASTACTION_COORDINATES + (3 * LEASTACTION_COORDINATES).div_ceil(4) + FRICTION + LAWS + 13;

/// Pointer-sized words of a list of rods, if there may be one.
#[cfg(feature = "graph")]
const LIST_OF_RODS: usize =
    if LEASTACTION_RODS == 0 { 0 } else { LEASTACTION_RODS * (LEASTACTION_DIMENSIONS + 3) + 2 };

/// Pointer-sized words of a loaded plan: exactly what it takes where pointers have 32 bits, of any size of plan.
pub const LEASTACTION_PLAN_WORDS: usize = 13;

/// Numbers of the laws of force in a model of bodies, at most: viscous friction of every coordinate, and the laws beside it.
#[cfg(feature = "adapt")]
const LAW_NUMBERS: usize = LEASTACTION_COORDINATES + FRICTION;

/// Length of the largest weight block of a model of bodies: gravity, the bodies, the laws of force.
#[cfg(feature = "adapt")]
pub const BLOCK: usize = {
    let (gravity, body) = if cfg!(feature = "arm") { (3, 26) } else { (2, 9) };
    gravity + body * LEASTACTION_COORDINATES + LAW_NUMBERS
};

/// Pointer-sized words of an adapter beside its model. The model's numbers: those of the file stay in flash, those in use are a block of their
/// own. The settings: six numbers for each that follows, two for each coordinate. The estimate with its covariance; two windows of the balance
/// for every coordinate; the sums of three blocks.
#[cfg(feature = "adapt")]
pub const LEASTACTION_ADAPTER_WORDS: usize = {
    let (n, p) = (LEASTACTION_COORDINATES, LEASTACTION_NUMBERS);
    let model = BLOCK + 2 * LAW_NUMBERS + (3 * n).div_ceil(4) + 12;
    let settings = 5 * p + (3 * p).div_ceil(4) + 2 * n + 10;
    let estimate = p * p.saturating_sub(1) / 2 + 4 * p + 2 * n + 12;
    let balance = n * (2 * p + 5) + 8;
    let blocks = 5 * n + 6;
    model + settings + estimate + balance + blocks + 2 * n + 8
};

/// Bytes of a saved patch, at most.
#[cfg(feature = "adapt")]
pub const LEASTACTION_PATCH_BYTES: usize = 16 + 11 * LEASTACTION_NUMBERS;

/// Words of 32 bits of a state: 12 numbers per coordinate, and 2.
#[cfg(not(feature = "rods"))]
pub const LEASTACTION_STATE_WORDS: usize = 12 * LEASTACTION_COORDINATES + 2;
/// Words of 32 bits of a state: 7 numbers per coordinate, one per rod, and 1.
#[cfg(feature = "rods")]
pub const LEASTACTION_STATE_WORDS: usize = 7 * LEASTACTION_COORDINATES + LEASTACTION_RODS + 1;

#[cfg(feature = "graph")]
const _: () = assert!(
    LEASTACTION_COORDINATES.is_multiple_of(LEASTACTION_DIMENSIONS),
    "LEASTACTION_COORDINATES must be a multiple of LEASTACTION_DIMENSIONS"
);

/// Parses a text of digits.
const fn number(text: &str) -> Option<usize> {
    let (mut digits, mut number) = (text.as_bytes(), 0);
    if digits.is_empty() || digits.len() > 4 {
        return None;
    }
    while let Some((digit, rest)) = digits.split_first() {
        if !digit.is_ascii_digit() {
            return None;
        }
        number = 10 * number + (*digit - b'0') as usize;
        digits = rest;
    }
    Some(number)
}
