//! What the control does between samples, as files and the command line say it.

use leastaction_core::forces::ControlKind;

/// Every kind with its name.
pub const CONTROL_KINDS: [(&str, ControlKind); 2] =
    [("held", ControlKind::Held), ("linear", ControlKind::Linear)];

/// The name of a kind.
#[must_use]
pub fn control_name(kind: ControlKind) -> &'static str {
    match kind {
        ControlKind::Held => "held",
        ControlKind::Linear => "linear",
    }
}

/// The kind of a name.
#[must_use]
pub fn control_of_name(name: &str) -> Option<ControlKind> {
    CONTROL_KINDS.into_iter().find(|(known, _)| *known == name).map(|(_, kind)| kind)
}
