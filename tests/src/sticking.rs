//! The model of `firmware-sim/chip/models` whose cart sticks and runs against stops: a cart-pole of rigid bodies of round numbers.

use leastaction_core::model::{BodiesHeader, Family, Header, Law, Laws, WriteError, write};

/// A cart that slides on the ground, and a pole that turns on it.
const TREE: [u8; 4] = [1, 0, 0, 1];
/// Gravity in x and y, y points down, m/s².
const GRAVITY: [f32; 2] = [0.0, 9.81];
/// Place, angle, mass, centre of mass, moment of inertia, rotor and gear of the cart, and of the pole, which is upright at 0.
const BODIES: [[f32; 9]; 2] = [
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, -std::f32::consts::FRAC_PI_2, 0.125, 0.5, 0.0, 0.0078125, 0.0, 0.0],
];
/// Damping b of cart and pole, N s/m and N m s/rad.
const DAMPING: [f32; 2] = [0.0625, 0.001953125];
/// c, δ, c_load, τ_s, s and ε of cart and pole.
const STICKING: [[f32; 6]; 2] =
    [[0.375, 0.25, 0.125, 0.0625, 1.25, 0.0625], [0.00390625, 0.0, 0.0, 1.0, 1.0, 0.0625]];
/// Centre, half distance and restitution of the stops of the cart; none of the pole.
const STOPS: [[f32; 3]; 2] = [[0.09375, 0.03125, 0.5], [0.0, f32::MAX, 0.0]];

/// Returns the model file.
///
/// # Errors
/// If it is longer than 1 KB, which it is not.
pub fn model_file() -> Result<Vec<u8>, WriteError> {
    let header = Header {
        laws: Laws::VISCOUS.with(Law::Sticking).with(Law::Stops),
        provenance: "a cart between stops, on a rail to which it sticks, with a pole",
        ..Header::new(Family::Bodies(BodiesHeader::planar(&TREE)))
    };
    let laws = [&DAMPING, STICKING.as_flattened(), STOPS.as_flattened()].concat();
    let weights = [&GRAVITY, BODIES.as_flattened(), &laws].concat();
    let bytes: Vec<u8> = weights.iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut memory = [0; 1024];
    write(&header, &bytes, &mut memory).map(<[u8]>::to_vec)
}
