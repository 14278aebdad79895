//! The only list of families.

/// Calls a macro with all families, in the order of their numbers in a model file: name in configurations and messages, former names, the
/// accessor of the shape, shape and configuration.
macro_rules! with_families {
    ($then:ident) => {
        $then! {
            /// Inertia matrix and potential from one network.
            InertiaNetwork: "inertia-network" | "rigid", inertia_network,
                crate::inertia_network::InertiaNetworkArchitecture, crate::inertia_network::config::InertiaNetworkConfig;
            /// A tree of elements.
            Modular: "modular", modular, crate::modular::ModularArchitecture, crate::modular::config::ModularConfig;
            /// A graph of particles.
            Graph: "graph", graph, crate::graph::GraphArchitecture, crate::graph::config::GraphConfig;
            /// A tree of rigid bodies on joints in a plane.
            Bodies: "bodies", bodies, crate::bodies::plane::BodiesArchitecture, crate::bodies::plane::config::BodiesConfig;
            /// A tree of rigid bodies on joints in space.
            Arm: "arm", arm, crate::bodies::space::ArmArchitecture, crate::bodies::space::config::ArmConfig;
        }
    };
}

pub(crate) use with_families;
