use super::Description;
use crate::xml::Element;
use crate::{IDENTIFIER, Variable};

impl Description {
    /// Root of the description in FMI 2.0.
    pub(super) fn fmi2(&self) -> Element {
        let interface = |name| {
            Element::new(name)
                .with("modelIdentifier", IDENTIFIER)
                .with("canGetAndSetFMUstate", true)
                .with("canSerializeFMUstate", true)
        };
        let exchange = interface("ModelExchange").with("completedIntegratorStepNotNeeded", true);
        let simulation = interface("CoSimulation").with("canHandleVariableCommunicationStepSize", true);
        let variables = self.all().into_iter().map(|variable| self.fmi2_variable(variable));
        Element::new("fmiModelDescription")
            .with("fmiVersion", "2.0")
            .with("modelName", &self.name)
            .with("guid", &self.token)
            .with("description", self.summary())
            .with("generationTool", Self::tool())
            .with("variableNamingConvention", "structured")
            .with("numberOfEventIndicators", 0)
            .holding([exchange, simulation, Self::unit_definitions(), Self::log_categories()])
            .holding([self.default_experiment(), Element::new("ModelVariables").holding(variables)])
            .holding([self.fmi2_structure()])
    }

    fn fmi2_variable(&self, variable: Variable) -> Element {
        let [causality, variability, initial] = self.role(variable.kind);
        let real = Element::new("Real")
            .with("unit", self.unit(variable))
            .with_some("derivative", Self::integral(variable).map(|integral| self.place(integral)))
            .with_some("start", self.start(variable.kind));
        Element::new("ScalarVariable")
            .with("name", variable.name())
            .with("valueReference", variable.reference())
            .with("description", self.says(variable))
            .with_some("causality", causality)
            .with_some("variability", variability)
            .with_some("initial", initial)
            .holding([real])
    }

    /// Position of a variable in the list of variables, from 1, by which the structure names it.
    fn place(&self, variable: Variable) -> usize {
        self.all().iter().take_while(|other| **other != variable).count() + 1
    }

    fn fmi2_structure(&self) -> Element {
        let all = self.all();
        let unknown = |variable: &Variable| Element::new("Unknown").with("index", self.place(*variable));
        let outputs = || all.iter().filter(|variable| variable.kind.is_output());
        let derivatives = all.iter().filter(|variable| Self::integral(**variable).is_some());
        Element::new("ModelStructure").holding([
            Element::new("Outputs").holding(outputs().map(unknown)),
            Element::new("Derivatives").holding(derivatives.map(unknown)),
            Element::new("InitialUnknowns").holding(outputs().map(unknown)),
        ])
    }
}
