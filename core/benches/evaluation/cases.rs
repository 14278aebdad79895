//! Cases of the measurements: a cart-pole network, and one call of everything on any system.

use leastaction_core::continuous;
use leastaction_core::discrete::{Control, Del, Path, State};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::network::Activation;
use leastaction_core::scalar::{Real, Scalar, WeightFormat};

/// f32 and f64: scalars that are their own weights.
pub trait Plain: Real<Weight = Self> + WeightFormat<Wide = Self> {}
impl Plain for f32 {}
impl Plain for f64 {}

/// The step of the cart-pole, s.
pub const CARTPOLE_STEP: f64 = 0.02;

pub type CartPole<'a, S> = System<InertiaNetwork<'a, <S as Scalar>::Weight, 2, 32, 2>, Viscous<S, 2>>;

/// Weights of (x, cos θ, sin θ) → width tanh → width tanh → 4.
pub struct Network<W> {
    block: Vec<W>,
    widths: [usize; 2],
}

impl<W: Plain> Network<W> {
    /// Weights uniform in ±0.3, from a fixed linear congruential generator.
    pub fn new(width: usize) -> Self {
        let widths = [width; 2];
        let length = shape(widths).parameters().expect("a small network");
        let mut bits = 1_u32;
        let mut next = || {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            W::constant(0.6 * (f64::from(bits) / f64::from(u32::MAX) - 0.5))
        };
        Self { block: (0..length).map(|_| next()).collect(), widths }
    }

    /// The mechanism with these weights, in their scalar or another one.
    pub fn system<S: Real<Weight = W>>(&self) -> CartPole<'_, S> {
        let inertia_network = InertiaNetwork::take(&mut self.block.as_slice(), &shape(self.widths));
        System::conservative(inertia_network.expect("a block of this length"))
    }
}

fn shape(widths: [usize; 2]) -> InertiaNetworkShape<2> {
    let widths = widths.map(|width| width as u16);
    let coordinates = [Coordinate::Translation, Coordinate::Angle];
    let inertia = Inertia::Cholesky { epsilon: 1e-9 };
    InertiaNetworkShape::new(coordinates, &widths, Activation::Tanh, inertia).expect("a small network")
}

/// (q, v, u).
pub type Point<S, const N: usize> = [[S; N]; 3];

/// A point of the cart-pole's motion.
pub fn point<S: Scalar>() -> Point<S, 2> {
    [[0.2, 0.7], [-0.5, 1.5], [1.0, 0.0]].map(|x| x.map(S::constant))
}

/// v̇; NaN if the mass matrix is singular.
pub fn acceleration<R: Real, L, const N: usize>(
    system: &System<L, Viscous<R, N>>,
    [q, v, u]: &Point<R, N>,
) -> [R; N]
where
    L: Lagrangian<R, N>,
{
    let invalid = R::constant(f64::NAN);
    continuous::acceleration(system, q, v, u).unwrap_or([invalid; N])
}

/// A trajectory under way. It has taken the steps from which the initial guess of a step extrapolates.
pub fn moving<R: Real, L: Lagrangian<R, N>, const N: usize>(
    system: &System<L, Viscous<R, N>>,
    [q, v, _]: &Point<R, N>,
) -> State<R, N> {
    State::new(&system.lagrangian, *q, *v).expect("finite numbers")
}

/// One step of h seconds with the default bounds of Newton's method; the number of its updates.
pub fn del_step<R: Real, P: Path, L: Lagrangian<R, N>, const N: usize>(
    system: &System<L, Viscous<R, N>>,
    mut state: State<R, N>,
    [_, _, u]: &Point<R, N>,
    h: f64,
) -> (State<R, N>, u8) {
    let report = Del::<R, P>::new(R::constant(h)).step(system, &mut state, &Control::held(*u));
    (state, report.map_or(0, |report| report.iterations))
}

/// 64 numbers in ±3.
pub fn angles<S: Scalar>() -> [S; 64] {
    core::array::from_fn(|i| S::constant(-3.0 + 6.0 * i as f64 / 63.0))
}

/// tanh in place.
pub fn tanh<S: Scalar>(angles: &mut [S; 64]) {
    angles.iter_mut().for_each(|x| *x = x.tanh());
}

/// sin x cos x in place, so that neither can be left out.
pub fn sin_cos<S: Scalar>(angles: &mut [S; 64]) {
    for x in angles {
        let (sin, cos) = x.sin_cos();
        *x = sin * cos;
    }
}
