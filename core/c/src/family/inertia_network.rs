use super::{Laws, Weight};
use crate::config::{LEASTACTION_COORDINATES as N, LEASTACTION_HIDDEN as H, LEASTACTION_LAYERS as L};
use core::ffi::CStr;
use leastaction_core::energy::inertia_network::InertiaNetwork;
use leastaction_core::model::InertiaNetworkModel;

pub(crate) const FAMILY: &CStr = c"inertia-network";

/// An inertia network.
pub(crate) type Mechanism = InertiaNetworkModel<'static, N, H, L, Weight, Laws>;

/// Kinetic and potential energy of the mechanism.
pub(crate) type Energy = InertiaNetwork<'static, Weight, N, H, L>;
