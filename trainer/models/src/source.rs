//! Names of a family's types in the source of a firmware.

/// Type of a loaded model of a family in a Rust program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadedType {
    /// Name of the type in `leastaction_core::model`, for example `BodiesModel`.
    pub name: &'static str,
    /// Size parameters after its lifetime, for example `N, H, L`: N coordinates (M for a selected tree), and L hidden
    /// layers of H units.
    pub sizes: &'static str,
    /// Constants beside those sizes, each with a comment.
    pub constants: String,
}

impl LoadedType {
    /// Creates a type without constants of its own.
    pub fn new(name: &'static str, sizes: &'static str) -> Self {
        Self { name, sizes, constants: String::new() }
    }
}

/// Energies as constants of a Rust program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConstantType {
    /// Type of the energies, for example `PlanarBodies`.
    pub energies: &'static str,
    /// Path that the program imports from `leastaction_core::energy`, for example `bodies::PlanarBodies`.
    pub module: &'static str,
    /// Type of the shape, for example `BodiesHeader`.
    pub header: &'static str,
    /// Shape, as an expression.
    pub shape: String,
    /// Units of the widest hidden layer and number of hidden layers, for a family with a single network.
    pub network: Option<[usize; 2]>,
}

/// Names in the form and order of a `use` declaration.
pub(crate) fn listed(mut names: Vec<&str>) -> String {
    names.sort_unstable_by_key(|name| (*name != "self", *name));
    match names[..] {
        [name] => name.to_owned(),
        _ => format!("{{{}}}", names.join(", ")),
    }
}
