use super::{Description, Version};
use crate::Variable;
use crate::xml::escaped;

impl Description {
    /// A page in HTML about the unit.
    pub(crate) fn page(&self, version: Version) -> String {
        let Self { name, family, provenance, order, .. } = self;
        let rows: String = self.all().into_iter().map(|variable| self.row(variable)).collect();
        let drives = if self.has_actuator {
            "<p>The model has gains, offsets, a delay or a lag of its drives. They are not part of the unit: u is the force itself.</p>\n"
        } else {
            ""
        };
        let step = match self.h {
            Some(h) => format!("h = {h} s, with which the model was trained"),
            None => "the parameter h, since the model was trained without a step".to_owned(),
        };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{name}</title></head>\n<body>\n\
             <h1>{name}</h1>\n\
             <p>{summary}: a unit of FMI {version} by {tool}. Family: {family}. {provenance}</p>\n\
             <h2>Equations</h2>\n\
             <p>L(q, v) = T(q, v) − V(q); d/dt ∂L/∂v − ∂L/∂q = Q(q, v) + u, with q̇ = v, Q the friction and the other laws of the model, \
             and u the generalised force at the output of the actuators. Everything is computed in single precision, as on a \
             microcontroller.</p>\n\
             <p><b>Co-simulation</b> takes steps of order {order} of the discrete Euler–Lagrange equation; their length is {step}. u is \
             constant over a communication step, which must be a whole multiple of h; any other is refused.</p>\n\
             <p><b>Model exchange</b> has the states (q, v) and the derivatives (v, a). Accelerations have about seven digits, so a \
             tolerance of the solver below 1e-6 gains nothing.</p>\n{drives}\
             <h2>Variables</h2>\n\
             <table>\n<tr><th>name</th><th>unit</th><th>role</th><th>meaning</th></tr>\n{rows}</table>\n</body>\n</html>\n",
            name = escaped(name),
            family = escaped(family),
            provenance = escaped(provenance),
            summary = self.summary(),
            tool = Self::tool(),
        )
    }

    fn row(&self, variable: Variable) -> String {
        let [causality, ..] = self.role(variable.kind);
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            variable.name(),
            self.unit(variable),
            causality.unwrap_or_default(),
            escaped(&self.says(variable))
        )
    }
}
