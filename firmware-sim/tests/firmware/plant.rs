//! Plants whose coordinates stick and run against stops.

use leastaction_core::continuous::ContinuousState;
use leastaction_core::energy::trigonometric::PENDULUM;
use leastaction_core::forces::{Sticking, StickingFriction, Stop, Stops, System};
use leastaction_firmware_sim::plant::Plant;

/// A pendulum that is pushed to and fro stays between its stops; left alone away from the bottom, its friction holds it to the last bit.
#[test]
fn plants_solve_stops_and_friction_that_sticks() {
    let friction = StickingFriction { constant: 0.8, ..StickingFriction::none() };
    let stop = Stop { lower: -0.5, upper: 0.4, restitution: 0.3 };
    let forces = (Sticking { coordinates: [friction] }, Stops { coordinates: [stop] });
    let system = System { lagrangian: PENDULUM, forces };
    let mut plant = Plant::new(&system, ContinuousState { q: [0.1], v: [0.0] }, 8);
    let (mut lowest, mut highest) = (0.0_f32, 0.0_f32);
    for k in 0..400_u16 {
        // Two parts of a tick, as a drive with a delay has them.
        let u = 6.0 * (0.09 * f32::from(k)).sin();
        plant.advance(0.004, |_| [0.7 * u]).unwrap();
        plant.advance(0.006, |_| [u]).unwrap();
        let q = plant.state().q[0];
        (lowest, highest) = (lowest.min(q), highest.max(q));
    }
    assert!((-0.5..-0.49).contains(&lowest) && (0.39..=0.4).contains(&highest), "{lowest} … {highest}");
    let mut held = Plant::new(&system, ContinuousState { q: [0.05], v: [0.0] }, 8);
    for _ in 0..100 {
        held.advance(0.01, |_| [0.0]).unwrap();
    }
    assert_eq!(*held.state(), ContinuousState { q: [0.05], v: [0.0] });
}
