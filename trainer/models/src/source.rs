//! Names of a family in the source of a firmware.

/// How a Rust program names a loaded model of a family.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadedType {
    /// Type in `leastaction_core::model`, as `BodiesModel`.
    pub name: &'static str,
    /// Sizes behind its lifetime, as `N, H, L`: N coordinates (M of a tree that is chosen), hidden layers of H units, L of them.
    pub sizes: &'static str,
    /// Constants of its own beside those sizes, each with a comment.
    pub constants: String,
}

impl LoadedType {
    /// A type without constants of its own.
    pub fn new(name: &'static str, sizes: &'static str) -> Self {
        Self { name, sizes, constants: String::new() }
    }
}

/// How a Rust program makes the energies of constants.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConstantType {
    /// Type of the energies, as `PlanarBodies`.
    pub energies: &'static str,
    /// What the program takes from `leastaction_core::energy`, as `bodies::PlanarBodies`.
    pub module: &'static str,
    /// Type of the shape, as `BodiesHeader`.
    pub header: &'static str,
    /// Shape, as an expression.
    pub shape: String,
    /// Units of the widest hidden layer, and hidden layers, of a family of one network.
    pub network: Option<[usize; 2]>,
}

/// Names as a `use` has them.
pub(crate) fn listed(mut names: Vec<&str>) -> String {
    names.sort_unstable_by_key(|name| (*name != "self", *name));
    match names[..] {
        [name] => name.to_owned(),
        _ => format!("{{{}}}", names.join(", ")),
    }
}
