//! Names of control kinds, as used in files and on the command line.

use leastaction_core::forces::ControlKind;

/// All kinds with their names.
pub const CONTROL_KINDS: [(&str, ControlKind); 2] =
    [("held", ControlKind::Held), ("linear", ControlKind::Linear)];

/// Returns the name of a kind.
#[must_use]
pub fn control_name(kind: ControlKind) -> &'static str {
    match kind {
        ControlKind::Held => "held",
        ControlKind::Linear => "linear",
    }
}

/// Returns the kind with this name; `None` if there is none.
#[must_use]
pub fn control_of_name(name: &str) -> Option<ControlKind> {
    CONTROL_KINDS.into_iter().find(|(known, _)| *known == name).map(|(_, kind)| kind)
}
