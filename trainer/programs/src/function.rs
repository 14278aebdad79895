use crate::row::{GROUPS, Row, sin_cos};
use leastaction_core::network::Activation;
use leastaction_core::scalar::{LANES, Lanes, Scalar};
use wide::f64x8;

/// A smooth function of one number, with its derivatives up to the third.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Activation of hidden units.
    Activation(Activation),
    /// sin x, x in rad.
    Sine,
    /// √x, x > 0.
    SquareRoot,
    /// 1/x.
    Reciprocal,
    /// |x|; its slope jumps at 0.
    Magnitude,
    /// Angle x in rad wrapped to [0, 2π); the value jumps, its slope is 1 everywhere.
    Wrapped,
}

/// Number of known derivatives, counting the function itself.
pub(crate) const ORDERS: usize = 4;

impl Function {
    /// Number of the function, which identifies equal operations.
    pub(crate) fn number(self) -> u32 {
        match self {
            Self::Activation(activation) => 16 + activation as u32,
            Self::Sine => 0,
            Self::SquareRoot => 1,
            Self::Reciprocal => 2,
            Self::Magnitude => 3,
            Self::Wrapped => 4,
        }
    }

    /// Value of the derivative of this order, if it is constant.
    pub(crate) fn constant_derivative(self, order: usize) -> Option<f64> {
        match (self, order) {
            (Self::Wrapped | Self::Activation(Activation::Identity), 1) => Some(1.0),
            (Self::Wrapped | Self::Magnitude | Self::Activation(Activation::Identity), 2..) => Some(0.0),
            _ => None,
        }
    }

    /// Writes f and its derivatives at x, for those orders that have a buffer.
    pub(crate) fn write(self, x: &[Row], to: [Option<&mut [Row]>; ORDERS]) {
        let wanted = to.each_ref().map(Option::is_some);
        let mut to = to.map(Option::unwrap_or_default);
        if self == Self::Activation(Activation::Squareplus) {
            return squareplus_writer(wanted)(x, to);
        }
        for (i, x) in x.iter().enumerate() {
            let curve = self.curve(x, wanted);
            for (order, to) in to.iter_mut().enumerate().filter(|(order, _)| wanted[*order]) {
                to[i] = curve[order];
            }
        }
    }

    /// Returns f and its derivatives at x; those that are not `wanted` may have any value.
    #[inline]
    pub(crate) fn curve(self, x: &Row, wanted: [bool; ORDERS]) -> [Row; ORDERS] {
        match self {
            Self::Activation(Activation::Squareplus) => {
                let mut curve = [Row::default(); ORDERS];
                squareplus_writer(wanted)(
                    std::slice::from_ref(x),
                    curve.each_mut().map(std::slice::from_mut),
                );
                curve
            }
            Self::Activation(activation) => activated(activation, x, wanted[3]),
            Self::Sine => {
                let [sin, cos] = sin_cos(x);
                // Higher derivatives are the same functions with other signs; nothing asks for them.
                [sin, cos, Row::default(), Row::default()]
            }
            Self::SquareRoot => {
                let root = x.map_lanes(Scalar::sqrt);
                let inverse = root.map_lanes(|root| Lanes::one() / root);
                let scaled = |order: usize, c: f64, power: i32| {
                    let mut result = Row::splat(c);
                    let factors = if wanted[order] { power } else { 0 };
                    (0..factors).for_each(|_| result = result.zip(&inverse, |a, b| a * b));
                    result
                };
                [root, scaled(1, 0.5, 1), scaled(2, -0.25, 3), scaled(3, 0.375, 5)]
            }
            Self::Reciprocal => {
                let inverse = x.map_lanes(|x| Lanes::one() / x);
                let power = |c: f64, power: &Row| power.zip(&inverse, |a, b| c * (a * b));
                let square = power(-1.0, &inverse);
                let cube = power(-2.0, &square);
                [inverse, square, cube, power(-3.0, &cube)]
            }
            Self::Magnitude => {
                let sign = Row(x.0.map(|x| if x < 0.0 { -1.0 } else { 1.0 }));
                [x.zip(&sign, |x, sign| x * sign), sign, Row::default(), Row::default()]
            }
            Self::Wrapped => [x.map_lanes(Scalar::wrapped), Row::splat(1.0), Row::default(), Row::default()],
        }
    }
}

/// Writes those derivatives of ½(z + √(z² + 4)) whose bits are set in `WANTED`.
///
/// The function is computed as max(z, 0) + 2/(|z| + √(z² + 4)); its derivatives take one division.
fn squareplus<const WANTED: usize>(x: &[Row], to: [&mut [Row]; ORDERS]) {
    let (zero, two) = (f64x8::ZERO, f64x8::splat(2.0));
    for (i, x) in x.iter().enumerate() {
        for g in 0..GROUPS {
            let z = x.group(g);
            let root = z.mul_add(z, f64x8::splat(4.0)).sqrt();
            let sum = root + z.abs();
            let inverse = f64x8::ONE / (root * sum);
            let of_root = inverse * sum;
            let value = z.max(zero) + two * inverse * root;
            let square = of_root * of_root;
            let curvature = two * of_root * square;
            let third = f64x8::splat(-3.0) * z * curvature * square;
            for (order, own) in [value, value * of_root, curvature, third].into_iter().enumerate() {
                if WANTED >> order & 1 == 1 {
                    to[order][i].set_group(g, own);
                }
            }
        }
    }
}

/// Writer of the derivatives of a function.
type Writer = fn(&[Row], [&mut [Row]; ORDERS]);

/// Returns [`squareplus`] for the derivatives that are wanted.
fn squareplus_writer(wanted: [bool; ORDERS]) -> Writer {
    SQUAREPLUS[(0..ORDERS).map(|order| usize::from(wanted[order]) << order).sum::<usize>()]
}

/// Writers for every set of derivatives of [`squareplus`].
const SQUAREPLUS: [Writer; 1 << ORDERS] = [
    squareplus::<0>,
    squareplus::<1>,
    squareplus::<2>,
    squareplus::<3>,
    squareplus::<4>,
    squareplus::<5>,
    squareplus::<6>,
    squareplus::<7>,
    squareplus::<8>,
    squareplus::<9>,
    squareplus::<10>,
    squareplus::<11>,
    squareplus::<12>,
    squareplus::<13>,
    squareplus::<14>,
    squareplus::<15>,
];

fn activated(activation: Activation, x: &Row, third: bool) -> [Row; ORDERS] {
    let mut curve = [Row::default(); ORDERS];
    let [value, slope, curvature, thirds] = &mut curve;
    let groups = x.0.as_chunks::<LANES>().0.iter();
    let places = value.0.as_chunks_mut::<LANES>().0.iter_mut().zip(slope.0.as_chunks_mut::<LANES>().0);
    let places = places.zip(curvature.0.as_chunks_mut::<LANES>().0).zip(thirds.0.as_chunks_mut::<LANES>().0);
    for (x, (((value, slope), curvature), thirds)) in groups.zip(places) {
        let c = activation.curve(Lanes(*x));
        (*value, *slope, *curvature) = (c.value.0, c.slope.0, c.curvature.0);
        if third {
            *thirds = activation.third(Lanes(*x), &c).0;
        }
    }
    curve
}
