//! Exact mechanisms that carry a load.

use crate::Mechanism;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::energy::trigonometric::{Trigonometric, Wave};
use leastaction_models::{ChangeError, PointMass};

/// Acceleration of gravity, m/s².
const G: f64 = 9.81;

/// Waves of a [`Trigonometric`] mechanism, which may have those of loads among them.
#[derive(Clone, Debug, PartialEq)]
pub struct Waves<const N: usize> {
    inertia: Vec<(usize, usize, Wave<N>)>,
    potential: Vec<Wave<N>>,
}

/// A rigid body of an exact mechanism.
struct Body {
    mass: f64,
    /// First moment about its joint along the body, kg m.
    moment: f64,
    /// Moment of inertia about its joint, kg m².
    inertia: f64,
    /// Distance from its joint to its end, where the next joint is, m; 0 for a cart.
    length: f64,
}

const ROD: Body = Body { mass: 1.0, moment: 0.5, inertia: 1.0 / 3.0, length: 1.0 };
/// A cart does not turn, so that any moment of inertia is possible.
const CART: Body = Body { mass: 1.0, moment: 0.0, inertia: f64::INFINITY, length: 0.0 };
const POLE: Body = Body { mass: 0.1, moment: 0.05, inertia: 0.1 / 3.0, length: 1.0 };
const LINK: Body = Body { mass: 1.0, moment: 0.5, inertia: 1.25, length: 1.0 };

impl<const N: usize> Waves<N> {
    /// The mechanism's Lagrangian.
    pub fn lagrangian(&self) -> Trigonometric<'_, N> {
        Trigonometric { inertia: &self.inertia, potential: &self.potential }
    }
}

impl Mechanism {
    /// The bodies, one per coordinate, and the sign of gravity: 1 if angles are 0 upright, −1 if hanging.
    const fn bodies(self) -> (&'static [Body], f64) {
        match self {
            Self::Pendulum => (&[ROD], 1.0),
            Self::Cartpole => (&[CART, POLE], 1.0),
            Self::Acrobot => (&[LINK, LINK], -1.0),
        }
    }

    /// Place of a load in its body's frame, m: x leads from the joint along the body.
    ///
    /// # Errors
    /// [`ChangeError::NoBody`].
    pub fn place_of(self, load: &PointMass) -> Result<[f64; 3], ChangeError> {
        let (bodies, _) = self.bodies();
        let body = load.body_of(bodies.len())?;
        let end = || [bodies.get(body).map_or(0.0, |body| body.length), 0.0, 0.0];
        Ok(load.place.unwrap_or_else(end))
    }

    /// Waves of the mechanism `own` of N coordinates, with those of a load, if any.
    ///
    /// # Errors
    /// [`ChangeError`] for a load beside the line of its body, and a negative mass that leaves no possible body.
    pub fn waves<const N: usize>(
        self,
        own: &Trigonometric<N>,
        load: Option<&PointMass>,
    ) -> Result<Waves<N>, ChangeError> {
        let mut waves = Waves { inertia: own.inertia.to_vec(), potential: own.potential.to_vec() };
        let Some(load) = load else { return Ok(waves) };
        let (bodies, up) = self.bodies();
        let (k, [d, y, z]) = (load.body_of(bodies.len())?, self.place_of(load)?);
        if y != 0.0 || z != 0.0 {
            return Err(ChangeError::Place("on the line of its body, with y = z = 0"));
        }
        let (m, body) = (load.mass, &bodies[k]);
        let (mass, moment) = (body.mass + m, body.moment + m * d);
        let is_possible = mass > 0.0 && mass * (body.inertia + m * d * d) > moment * moment;
        if m < 0.0 && !is_possible {
            return Err(ChangeError::Impossible(k));
        }
        let slopes: Vec<_> = (0..=k).map(|a| self.slopes::<N>(a, (k, d))).collect();
        for (a, of_a) in slopes.iter().enumerate() {
            for (b, of_b) in slopes[..=a].iter().enumerate() {
                let products = of_a.iter().flat_map(|one| of_b.iter().map(move |other| (one, other)));
                waves.inertia.extend(products.map(|(one, other)| (a, b, product(m, one, other))));
            }
        }
        let heights = (0..=k).filter_map(|j| self.slopes::<N>(j, (k, d)).into_iter().next());
        let turning = heights.filter(|arm| arm.wave != [0.0; N]);
        waves.potential.extend(turning.map(|arm| Wave { amplitude: up * m * G * arm.amplitude, ..arm }));
        Ok(waves)
    }

    /// Derivative of the place at distance d along body k by coordinate a, as a sum of vectors c (cos φ, ∓sin φ) with φ = k·q: those of the
    /// links that the coordinate turns, or one along the rail.
    fn slopes<const N: usize>(self, a: usize, (k, d): (usize, f64)) -> Vec<Wave<N>> {
        let (kinds, (bodies, _)) = (self.coordinates(), self.bodies());
        let is_angle = |i: usize| kinds.get(i) == Some(&Coordinate::Angle);
        if !is_angle(a) {
            return vec![Wave { amplitude: 1.0, wave: [0.0; N] }];
        }
        let angle = |j: usize| std::array::from_fn(|i| f64::from(u8::from(i <= j && is_angle(i))));
        let length = |j: usize| if j == k { d } else { bodies[j].length };
        (a..=k).map(|j| Wave { amplitude: length(j), wave: angle(j) }).collect()
    }
}

/// Wave of m times the scalar product of two such vectors.
fn product<const N: usize>(m: f64, one: &Wave<N>, other: &Wave<N>) -> Wave<N> {
    let wave = std::array::from_fn(|i| one.wave[i] - other.wave[i]);
    Wave { amplitude: m * one.amplitude * other.amplitude, wave }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM};
    use leastaction_core::lagrangian::Lagrangian;

    const M: f64 = 0.7;

    /// Energies that the load adds, and those of a point that moves as the load does, by central differences.
    fn check<const N: usize>(
        mechanism: Mechanism,
        own: &Trigonometric<N>,
        (body, d): (usize, f64),
        point: impl Fn([f64; N]) -> [f64; 2],
    ) {
        let load = PointMass { body: Some(body), mass: M, place: Some([d, 0.0, 0.0]) };
        let waves = mechanism.waves(own, Some(&load)).unwrap();
        let (q, v): ([f64; N], [f64; N]) =
            (std::array::from_fn(|i| 0.4 + 0.9 * i as f64), std::array::from_fn(|i| 1.3 - 3.1 * i as f64));
        let add = |q: &[f64; N]| {
            let (with, without) = (waves.lagrangian().energies(q, &v), own.energies(q, &v));
            (with.kinetic - without.kinetic, with.potential - without.potential)
        };
        let moved = |h: f64| point(std::array::from_fn(|i| q[i] + h * v[i]));
        let (after, before) = (moved(1e-5), moved(-1e-5));
        let speed = [0, 1].map(|axis| (after[axis] - before[axis]) / 2e-5);
        let (kinetic, potential) = add(&q);
        assert!((kinetic - 0.5 * M * (speed[0].powi(2) + speed[1].powi(2))).abs() < 1e-8);
        let (_, at_zero) = add(&[0.0; N]);
        let height = point(q)[1] - point([0.0; N])[1];
        assert!((potential - at_zero - M * G * height).abs() < 1e-12);
    }

    #[test]
    fn loads_move_with_their_bodies() {
        check(Mechanism::Pendulum, &PENDULUM, (0, 0.8), |[a]| [0.8 * a.sin(), 0.8 * a.cos()]);
        check(Mechanism::Cartpole, &CARTPOLE, (0, 0.3), |[x, _]| [x, 0.0]);
        check(Mechanism::Cartpole, &CARTPOLE, (1, 0.6), |[x, a]| [x + 0.6 * a.sin(), 0.6 * a.cos()]);
        check(Mechanism::Acrobot, &ACROBOT, (0, 0.6), |[a, _]| [0.6 * a.sin(), -0.6 * a.cos()]);
        check(Mechanism::Acrobot, &ACROBOT, (1, 1.2), |[a, b]| {
            [a.sin() + 1.2 * (a + b).sin(), -a.cos() - 1.2 * (a + b).cos()]
        });
    }

    #[test]
    fn impossible_loads_are_refused() {
        let waves =
            |mass, place| Mechanism::Pendulum.waves(&PENDULUM, Some(&PointMass { body: None, mass, place }));
        assert!(waves(-0.24, None).is_ok());
        assert_eq!(waves(-0.26, None), Err(ChangeError::Impossible(0)));
        assert!(matches!(waves(1.0, Some([0.5, 0.1, 0.0])), Err(ChangeError::Place(_))));
        let on = |body| {
            Mechanism::Cartpole
                .waves(&CARTPOLE, Some(&PointMass { body: Some(body), mass: -0.5, place: None }))
        };
        assert!(on(0).is_ok());
        assert_eq!(on(1), Err(ChangeError::Impossible(1)));
        assert_eq!(on(2), Err(ChangeError::NoBody { body: 2, bodies: 2 }));
    }
}
