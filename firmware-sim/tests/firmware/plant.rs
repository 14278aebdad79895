//! Plants whose coordinates stick and run against stops.

use leastaction_core::continuous::ContinuousState;
use leastaction_core::energy::trigonometric::{PENDULUM, Trigonometric, Wave};
use leastaction_core::forces::{Forces, Sticking, StickingFriction, Stop, Stops, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_firmware_sim::Timeline;
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

/// Steps of 10 ms under a force that changes.
fn moved<L, F>(plant: &mut Plant<System<L, F>, 1>, ticks: std::ops::Range<u16>) -> ContinuousState<f32, 1>
where
    L: Lagrangian<f32, 1>,
    F: Forces<f32, 1>,
{
    for k in ticks {
        plant.change(0.01 * f32::from(k) + 0.005);
        plant.advance(0.01, |_| [(0.3 * f32::from(k)).sin()]).unwrap();
    }
    *plant.state()
}

/// Two kilograms at the end of the rod, and half of them.
const LOADED: [Trigonometric<'static, 1>; 2] = [
    Trigonometric {
        inertia: &[(0, 0, Wave { amplitude: 7.0 / 3.0, wave: [0.0] })],
        potential: &[Wave { amplitude: 2.5 * 9.81, wave: [1.0] }],
    },
    Trigonometric {
        inertia: &[(0, 0, Wave { amplitude: 4.0 / 3.0, wave: [0.0] })],
        potential: &[Wave { amplitude: 1.5 * 9.81, wave: [1.0] }],
    },
];

/// A mechanism that changes moves on as another one that begins with its position and velocity, with smooth friction and friction that sticks;
/// momentum and energy jump by those of the load.
#[test]
fn position_and_velocity_are_continuous_where_the_mechanism_changes() {
    let stuck = StickingFriction { constant: 0.1, ..StickingFriction::none() };
    for friction in [StickingFriction::none(), stuck] {
        let [light, heavy, half] = [PENDULUM, LOADED[0], LOADED[1]]
            .map(|lagrangian| System { lagrangian, forces: Sticking { coordinates: [friction] } });
        let start = ContinuousState { q: [1.0], v: [0.5] };
        let later = [(0.4, &heavy), (0.7, &half)];
        let mut changing = Plant::new(Timeline::new(&light, &later), start, 8);
        let mut expected = start;
        for (system, ticks) in [(&light, 0..40), (&heavy, 40..70), (&half, 70..100)] {
            let mut alone = Plant::new(system, expected, 8);
            expected = moved(&mut alone, ticks.clone());
            assert_eq!(moved(&mut changing, ticks), expected);
        }
        assert!(expected.v[0].abs() > 0.1);
    }
    let light = System::conservative(PENDULUM);
    let heavy = System::conservative(LOADED[0]);
    let state = ContinuousState { q: [2.0], v: [1.5] };
    let later = [(0.1, &heavy)];
    let mut plant = Plant::new(Timeline::new(&light, &later), state, 8);
    plant.change(0.1);
    let energy = |state: &ContinuousState<f32, 1>| LOADED[0].energy(&state.q, &state.v);
    let before = energy(plant.state());
    for _ in 0..200 {
        plant.advance(0.01, |_| [0.0]).unwrap();
    }
    assert_eq!(before, energy(&state));
    assert!(
        (energy(plant.state()) - before).abs() < 1e-4 * before.abs(),
        "{}",
        energy(plant.state()) - before
    );
}
