// Numbers that follow the machine while it runs. Written by `leastaction adapt`.

use leastaction_core::adapt::{Limits, Number, Tuning};
use leastaction_core::forces::Coefficient;

/// Number of coordinates.
pub const N: usize = 3;
/// Number of numbers that follow.
pub const P: usize = 16;
/// Number of their pairs.
pub const T: usize = P * (P - 1) / 2;
/// Ticks of the loop in a tick of the adapter.
pub const BLOCK: u16 = 8;
/// Settings of the adapter.
#[rustfmt::skip]
pub const TUNING: Tuning<f32, N, P> = Tuning {
    numbers: [
        Number::Inertia { body: 2, index: 0 },
        Number::Inertia { body: 2, index: 1 },
        Number::Inertia { body: 2, index: 2 },
        Number::Inertia { body: 2, index: 3 },
        Number::Inertia { body: 2, index: 4 },
        Number::Inertia { body: 2, index: 5 },
        Number::Inertia { body: 2, index: 6 },
        Number::Inertia { body: 2, index: 7 },
        Number::Inertia { body: 2, index: 8 },
        Number::Inertia { body: 2, index: 9 },
        Number::Friction(Coefficient::Viscous, 0),
        Number::Friction(Coefficient::Viscous, 1),
        Number::Friction(Coefficient::Viscous, 2),
        Number::Friction(Coefficient::Coulomb, 0),
        Number::Friction(Coefficient::Coulomb, 1),
        Number::Friction(Coefficient::Coulomb, 2),
    ],
    half: 13,
    h: 0.008,
    deviation: [0.1, 0.3, 0.7],
    prior: [1.25, 0.44194174, 0.44194174, 0.44194174, 0.15625, 0.15625, 0.15625, 0.15625, 0.15625, 0.15625, 0.15, 0.15, 0.075, 0.15, 0.15, 0.075],
    forgotten: 0.0052,
    walk: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0001875, 0.0001875, 4.6875e-5, 0.0001875, 0.0001875, 4.6875e-5],
    change: 50.0,
    limits: Limits {
        model: [1.0, 0.25, 0.0, 0.0, 0.03125, 0.0, 0.125, 0.0, 0.0, 0.125, 0.5, 0.5, 0.25, 0.5, 0.5, 0.25],
        lower: [-5.0, -3.535534, -3.535534, -3.535534, -2.5, -2.5, -2.5, -2.5, -2.5, -2.5, -0.5, -0.5, -0.25, -0.5, -0.5, -0.25],
        upper: [5.0, 3.535534, 3.535534, 3.535534, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 1.5, 1.5, 0.75, 1.5, 1.5, 0.75],
        kept: 0.1,
    },
    dry: Some((Coefficient::Coulomb, [0.5, 0.5, 0.25])),
};
