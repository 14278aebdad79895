use super::Description;
use crate::xml::Element;
use crate::{IDENTIFIER, Variable};

impl Description {
    /// Root of the description in FMI 3.0.
    pub(super) fn fmi3(&self) -> Element {
        let interface = |name| {
            Element::new(name)
                .with("modelIdentifier", IDENTIFIER)
                .with("canGetAndSetFMUState", true)
                .with("canSerializeFMUState", true)
        };
        let exchange = interface("ModelExchange").with("needsCompletedIntegratorStep", false);
        let simulation = interface("CoSimulation")
            .with("canHandleVariableCommunicationStepSize", true)
            .with_some("fixedInternalStepSize", self.h);
        let variables = self.all().into_iter().map(|variable| self.fmi3_variable(variable));
        Element::new("fmiModelDescription")
            .with("fmiVersion", "3.0")
            .with("modelName", &self.name)
            .with("instantiationToken", &self.token)
            .with("description", self.summary())
            .with("generationTool", Self::tool())
            .with("variableNamingConvention", "structured")
            .holding([exchange, simulation, Self::unit_definitions(), Self::log_categories()])
            .holding([self.default_experiment(), Element::new("ModelVariables").holding(variables)])
            .holding([self.fmi3_structure()])
    }

    fn fmi3_variable(&self, variable: Variable) -> Element {
        let [causality, variability, initial] = self.role(variable.kind);
        Element::new("Float64")
            .with("name", variable.name())
            .with("valueReference", variable.reference())
            .with("description", self.says(variable))
            .with_some("causality", causality)
            .with_some("variability", variability)
            .with_some("initial", initial)
            .with_some("start", self.start(variable.kind))
            .with("unit", self.unit(variable))
            .with_some("derivative", Self::integral(variable).map(Variable::reference))
    }

    fn fmi3_structure(&self) -> Element {
        let all = self.all();
        let unknown = |name: &'static str| {
            move |variable: &Variable| Element::new(name).with("valueReference", variable.reference())
        };
        let outputs = || all.iter().filter(|variable| variable.kind.is_output());
        let derivatives = all.iter().filter(|variable| Self::integral(**variable).is_some());
        Element::new("ModelStructure")
            .holding(outputs().map(unknown("Output")))
            .holding(derivatives.map(unknown("ContinuousStateDerivative")))
            .holding(outputs().map(unknown("InitialUnknown")))
    }
}
