//! End stops: no coordinate passes them, strikes keep their restitution, rest stays, and energy never grows.

use crate::common::Random;
use crate::sticking::{Masses, definite, friction, kinetic};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State};
use leastaction_core::forces::{Forces, Sticking, Stop, Stops, System, Viscous};
use leastaction_core::scalar::Real;

fn stop<R: Real>(lower: f64, upper: f64, restitution: f64) -> Stop<R> {
    let [lower, upper, restitution] = [lower, upper, restitution].map(R::constant);
    Stop { lower, upper, restitution }
}

/// A ball that falls on a floor: every bounce reaches e² of the height before, and in the end it lies still, to the last bit.
#[test]
fn a_ball_bounces_and_comes_to_rest() {
    fn check<R: Real, P: Path>() {
        let (e, height, h) = (0.7, 1.0, 1e-3);
        let ball = Masses { mass: [[0.4]], springs: [[0.0]], force: [-0.4 * 9.81] };
        let floor = Stops { coordinates: [stop::<R>(0.0, f64::INFINITY, e)] };
        let system = System { lagrangian: ball, forces: floor };
        let mut state = State::new(&ball, [R::constant(height)], [R::zero()]).unwrap();
        let (mut tops, mut top, mut falls) = (Vec::new(), 0.0_f64, true);
        for _ in 0..8_000 {
            Del::<R, P>::new(R::constant(h)).step(&system, &mut state, &Control::held([R::zero()])).unwrap();
            let (q, v) = (state.q()[0].to_f64(), state.last_increment()[0].to_f64());
            assert!(q >= 0.0, "{q}");
            if falls && v > 0.0 {
                top = 0.0;
            }
            top = top.max(q);
            if !falls && v < 0.0 {
                tops.push(top);
            }
            falls = v < 0.0;
        }
        for (k, top) in tops.iter().take(5).enumerate() {
            let expected = height * e.powi(2 * (k as i32 + 1));
            assert!(
                (top - expected).abs() < 0.03 * expected + 0.01,
                "bounce {k}: {top} instead of {expected}"
            );
        }
        assert!(tops.len() > 8, "{tops:?}");
        assert!(state.q() == [R::zero()] && state.p() == [R::zero()], "{state:?}");
        let lying = state;
        for _ in 0..10_000 {
            Del::<R, P>::new(R::constant(h)).step(&system, &mut state, &Control::held([R::zero()])).unwrap();
        }
        assert_eq!((state.q(), state.p()), (lying.q(), lying.p()));
        // A stop does not pull.
        for _ in 0..3 {
            let up = Control::held([R::constant(0.4 * 9.81 + 0.1)]);
            Del::<R, P>::new(R::constant(h)).step(&system, &mut state, &up).unwrap();
        }
        assert!(state.q()[0] > R::zero() && state.p()[0] > R::zero(), "{state:?}");
    }
    check::<f32, Midpoint>();
    check::<f64, Midpoint>();
    check::<f32, Galerkin>();
    check::<f64, Galerkin>();
}

/// Coupled coordinates between stops, with friction that sticks in some of them: none passes a stop, and no step gains energy.
#[test]
fn coupled_coordinates_stay_between_their_stops() {
    fn check<R: Real, P: Path>() {
        let mut random = Random(8);
        let mut struck = 0;
        for machine in 0..600 {
            let lagrangian =
                Masses::<3> { mass: definite(&mut random), springs: [[0.0; 3]; 3], force: [0.0; 3] };
            let e = if machine % 3 == 0 { 0.0 } else { 0.5 + random.symmetric(0.5) };
            let limits = [0.3, 0.5, 0.9];
            let coordinates = limits.map(|limit| stop::<R>(-limit, limit, e));
            // Restitution and friction together are known to give energy where inertia couples them (Kane 1984), so only one stop has it.
            let level = [0.0, 0.0, if e == 0.0 { 0.4 } else { 0.0 }];
            let sticking = Sticking { coordinates: level.map(|level| friction(level, level)) };
            let system = System { lagrangian, forces: (sticking, Stops { coordinates }) };
            let h = 10_f64.powf(-2.5 + random.symmetric(0.5));
            let v: [f64; 3] = random.array(3.0);
            let mut state = State::new(&lagrangian, [R::zero(); 3], v.map(R::constant)).unwrap();
            let mut before = kinetic(&lagrangian, state.p());
            let rounding = 200.0 * R::EPSILON.to_f64() * before;
            for _ in 0..300 {
                Del::<R, P>::new(R::constant(h))
                    .step(&system, &mut state, &Control::held([R::zero(); 3]))
                    .unwrap();
                let after = kinetic(&lagrangian, state.p());
                assert!(after <= before + rounding, "{before:e} grew to {after:e}, e = {e}");
                let q = state.q().map(|q| q.to_f64());
                let within = q.iter().zip(limits).all(|(q, limit)| q.abs() <= R::constant(limit).to_f64());
                assert!(within, "{q:?} is beyond {limits:?}");
                struck += usize::from(after < 0.999 * before);
                before = after;
            }
        }
        assert!(struck > 1_000, "{struck}");
    }
    check::<f32, Midpoint>();
    check::<f64, Midpoint>();
    check::<f64, Galerkin>();
}

/// Pressed against a stop, a coordinate stays there to the last bit beside one that moves on.
#[test]
fn what_is_pressed_against_a_stop_stays() {
    let lagrangian =
        Masses { mass: [[1.0, 0.3], [0.3, 0.5]], springs: [[0.0; 2], [0.0, 4.0]], force: [2.0, 0.0] };
    let stops = Stops { coordinates: [stop::<f64>(-1.0, 0.25, 0.6), Stop::none()] };
    let system = System { lagrangian, forces: stops };
    let mut state = State::new(&lagrangian, [0.0, 0.2], [0.5, 0.0]).unwrap();
    let mut rested = 0;
    for k in 0..20_000 {
        Del::<f64, Midpoint>::new(1e-3).step(&system, &mut state, &Control::held([0.0; 2])).unwrap();
        if k > 10_000 {
            assert_eq!(state.q()[0], 0.25);
            rested += 1;
        }
    }
    assert!(rested > 9_000 && state.last_increment()[1] != 0.0);
}

/// Pushed to and fro on springs, against stops and friction, coupled coordinates find a motion in every step, also where a path that bends
/// within the step would begin in one direction and end in the other.
#[test]
fn coordinates_that_are_driven_always_find_a_motion() {
    fn check<R: Real, P: Path>() {
        let mut random = Random(17);
        let mut rests = 0;
        for _ in 0..400 {
            let (mass, stiffness) = (definite(&mut random), definite(&mut random));
            let springs = stiffness.map(|row| row.map(|k: f64| 300.0 * k));
            let lagrangian = Masses::<3> { mass, springs, force: [0.0; 3] };
            let coordinates = [0.02, 0.05, 0.5].map(|limit| stop::<R>(-limit, limit, 0.0));
            let levels: [f64; 3] = core::array::from_fn(|_| 0.6 + random.symmetric(0.5));
            let sticking = Sticking { coordinates: levels.map(|level| friction(level, 0.7 * level)) };
            let system = System { lagrangian, forces: (sticking, Stops { coordinates }) };
            let mut state = State::new(&lagrangian, [R::zero(); 3], [R::zero(); 3]).unwrap();
            for k in 0..300 {
                let push: [f64; 3] =
                    core::array::from_fn(|i| 4.0 * (0.05 * (i + 1) as f64 * f64::from(k) + i as f64).sin());
                let control = Control::held(push.map(R::constant));
                Del::<R, P>::new(R::constant(0.01)).step(&system, &mut state, &control).unwrap();
                rests += state.last_increment().iter().filter(|w| **w == R::zero()).count();
            }
        }
        assert!(rests > 20_000, "{rests}");
    }
    check::<f32, Midpoint>();
    check::<f64, Galerkin>();
    check::<f32, Galerkin>();
}

/// Positions and momenta of a hundred steps of two coupled coordinates on springs.
fn motion_under<F: Forces<f32, 2>, P: Path>(forces: F) -> Vec<[f32; 4]> {
    let lagrangian =
        Masses { mass: [[1.0, 0.3], [0.3, 0.5]], springs: [[9.0, 0.0], [0.0, 4.0]], force: [2.0, 0.0] };
    let system = System { lagrangian, forces };
    let mut state = State::new(&lagrangian, [0.1, 0.2], [0.5, -0.75]).unwrap();
    let step = |_| {
        Del::<f32, P>::new(1e-2).step(&system, &mut state, &Control::held([0.125, 0.0])).unwrap();
        let ([q0, q1], [p0, p1]) = (state.q(), state.p());
        [q0, q1, p0, p1]
    };
    (0..100).map(step).collect()
}

/// Stops that no motion reaches, as a file has them for a coordinate without stops, leave it free; and coordinates whose stops coincide,
/// or where they are out of all proportion, still step.
#[test]
fn stops_may_be_far_away_or_coincide() {
    fn check<P: Path>() {
        let far = |centre| Stop::about(centre, f32::MAX, 0.5);
        let free = motion_under::<_, P>(Viscous::none());
        for centre in [0.0, 7.5, -1e30] {
            let stopped = motion_under::<_, P>(Stops { coordinates: [far(centre), far(-centre)] });
            for (found, expected) in stopped.iter().zip(&free) {
                let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(off < 2e-5, "{found:?} instead of {expected:?}");
            }
        }
        // Half the distance is lost beside the centre.
        let shut = Stop::about(0.1, 1e-10, 1.0);
        assert_eq!(shut.lower, shut.upper);
        let stuck = motion_under::<_, P>(Stops { coordinates: [shut, far(0.0)] });
        assert!(stuck.iter().all(|[q, ..]| *q == 0.1), "{stuck:?}");
        let moves = stuck.windows(2).filter(|pair| pair[0][1] != pair[1][1]).count();
        assert!(moves > 90, "{moves}");
        for centre in [f32::MAX, -f32::MAX] {
            let beyond =
                motion_under::<_, P>(Stops { coordinates: [far(0.0), Stop::about(centre, 1.0, 0.0)] });
            assert!(beyond.as_flattened().iter().all(|x| x.is_finite()), "{beyond:?}");
        }
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

/// A coordinate that begins beyond a stop comes back freely, and does not jump onto the stop.
#[test]
fn what_is_beyond_a_stop_goes_no_further() {
    let stops = [Stop::about(1.5, 0.5, 0.5), Stop::about(0.0, f32::MAX, 0.5)];
    let motion = motion_under::<_, Midpoint>(Stops { coordinates: stops });
    let q = || motion.iter().map(|[q, ..]| *q);
    let highest = q().fold(0.1, f32::max);
    assert!(q().all(|q| q > 0.1) && highest < 1.0, "{motion:?}");
    assert!(q().is_sorted(), "{motion:?}");
    assert_eq!(motion[99][0], highest);
    assert_eq!(motion[90][0], highest);
}
