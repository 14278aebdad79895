use leastaction_core::adapt::Number;
use leastaction_core::forces::Coefficient;

/// Symbols of the ten inertial numbers of a body in space; those of the plane are m, mc_x, mc_y and I.
const INERTIA: [&str; 10] = ["m", "mc_x", "mc_y", "mc_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz"];

/// Name of a number: its symbol, and the body or coordinate, counted from 0.
pub fn name(number: Number) -> String {
    match number {
        Number::None => String::new(),
        Number::Inertia { body, index } => {
            let symbol = INERTIA.get(usize::from(index)).copied().unwrap_or("?");
            format!("{symbol} of body {body}")
        }
        Number::Rotor(i) => format!("J of coordinate {i}"),
        Number::Friction(coefficient, i) => {
            let symbol = match coefficient {
                Coefficient::Viscous | Coefficient::DirectionalViscous => "b",
                Coefficient::Coulomb | Coefficient::Directional | Coefficient::Sticking => "c",
            };
            format!("{symbol} of coordinate {i}")
        }
        Number::Offset(i) => format!("o of coordinate {i}"),
        Number::Gain(i) => format!("g of coordinate {i}"),
    }
}
