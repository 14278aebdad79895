//! Fingerprint of the bits of every elementary function, which every target must reproduce.

use super::Fingerprint;
use leastaction_core::scalar::{Real, Scalar, WeightFormat, f16};

/// Number of inputs of each function.
const INPUTS: u32 = 1 << 14;
/// Inputs at which functions turn, end or change their formula.
const EDGES: [f32; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f32::MIN_POSITIVE,
    1e-45,
    -1e-45,
    10.0,
    88.722_84,
    -103.972_08,
    65_536.0,
    65_536.01,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

impl Fingerprint {
    /// Takes in a number; all NaN count as one, since processors differ in their bits.
    fn add(&mut self, x: f32) {
        self.bits(if x.is_nan() { f32::NAN } else { x }.to_bits());
    }

    /// Fingerprint of √x, eˣ, ln(1 + x), tanh x, sin x, cos x, both ways to wrap an angle, and widening from half
    /// precision: at edges, at numbers of every size up to 2¹⁶, and at arbitrary bits.
    pub fn of_elementary_functions() -> Self {
        let mut fingerprint = Self::default();
        EDGES.into_iter().for_each(|x| fingerprint.functions_at(x));
        let mut bits = 1_u32;
        for index in 0..INPUTS {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let exponent = 103 + bits.rotate_left(9) % 41;
            let usual = bits & 0x807f_ffff | exponent << 23;
            fingerprint.functions_at(f32::from_bits(if index % 4 == 0 { bits } else { usual }));
        }
        for half in (0..=u16::MAX).step_by(7) {
            fingerprint.add(f16::from_bits(half).wide());
        }
        fingerprint
    }

    fn functions_at(&mut self, x: f32) {
        let (sin, cos) = Scalar::sin_cos(x);
        self.add(Scalar::sqrt(x));
        self.add(Scalar::exp(x));
        self.add(Scalar::ln_1p(x));
        self.add(Scalar::tanh(x));
        self.add(sin);
        self.add(cos);
        self.add(x.wrapped());
        self.add(x.short_way());
    }
}
