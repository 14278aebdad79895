//! The only list of families.

/// Calls a macro with all families, in the order of their numbers in a model file: name in configurations and messages, former names, the
/// accessor of the shape, shape, configuration and description.
macro_rules! with_families {
    ($then:ident) => {
        $then! {
            /// Inertia matrix and potential from one network.
            InertiaNetwork: "inertia-network" | "rigid", inertia_network,
                crate::inertia_network::InertiaNetworkArchitecture, crate::inertia_network::config::InertiaNetworkConfig,
                crate::inertia_network::describe::InertiaNetworkDescription;
            /// A tree of elements.
            Modular: "modular", modular, crate::modular::ModularArchitecture, crate::modular::config::ModularConfig,
                crate::modular::describe::ModularDescription;
            /// A graph of particles.
            Graph: "graph", graph, crate::graph::GraphArchitecture, crate::graph::config::GraphConfig,
                crate::graph::describe::GraphDescription;
            /// A tree of rigid bodies on joints in a plane.
            Bodies: "bodies", bodies, crate::bodies::plane::BodiesArchitecture, crate::bodies::plane::config::BodiesConfig,
                crate::bodies::plane::describe::BodiesDescription;
            /// A tree of rigid bodies on joints in space.
            Arm: "arm", arm, crate::bodies::space::ArmArchitecture, crate::bodies::space::config::ArmConfig,
                crate::bodies::space::describe::ArmDescription;
        }
    };
}

pub(crate) use with_families;
