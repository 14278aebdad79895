//! Parts that both versions of the standard state alike.

use super::{Description, UNITS};
use crate::xml::Element;
use crate::{Kind, Variable};

/// Category of all messages.
pub(super) const CATEGORY: &str = "logStatusError";

/// Length of the experiment that the description proposes, s.
const STOP_TIME: f64 = 10.0;

impl Description {
    /// Definitions of the units.
    pub(super) fn unit_definitions() -> Element {
        let exponents = |si: &[(&'static str, i8)]| {
            si.iter().fold(Element::new("BaseUnit"), |base, (name, exponent)| base.with(name, exponent))
        };
        let unit = |(name, si): (&str, &[(&'static str, i8)])| {
            Element::new("Unit").with("name", name).holding([exponents(si)])
        };
        Element::new("UnitDefinitions").holding(UNITS.map(unit))
    }

    /// Categories of messages.
    pub(super) fn log_categories() -> Element {
        let category = Element::new("Category").with("name", CATEGORY);
        Element::new("LogCategories")
            .holding([category.with("description", "Reasons why a call was refused, in words")])
    }

    /// An experiment to begin with.
    pub(super) fn default_experiment(&self) -> Element {
        Element::new("DefaultExperiment")
            .with("startTime", 0)
            .with("stopTime", STOP_TIME)
            .with("stepSize", self.h())
    }

    /// All variables.
    pub(super) fn all(&self) -> Vec<Variable> {
        Variable::all(self.n())
    }

    /// Variable whose derivative this one is.
    pub(super) fn integral(variable: Variable) -> Option<Variable> {
        let kind = match variable.kind {
            Kind::Velocity => Kind::Position,
            Kind::Acceleration => Kind::Velocity,
            _ => return None,
        };
        Some(Variable { kind, ..variable })
    }
}
