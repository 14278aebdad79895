//! Execution of the operations.

use super::{Numbers, Operation};
use crate::row::Row;
use wide::f64x8;

impl Numbers {
    /// Computes the outputs, and passes their numbers to `output`.
    pub fn run_outputs(
        &self,
        weights: &[f64],
        inputs: &[&[Row]],
        registers: &mut [Row],
        mut output: impl FnMut(usize, usize, Row),
    ) {
        for operation in &self.parts[0] {
            operation.run(weights, inputs, registers, &mut []);
        }
        for (number, places) in self.outputs.iter().enumerate() {
            for (k, place) in places.iter().enumerate() {
                output(number, k, registers[*place as usize]);
            }
        }
    }

    /// Adds the rows, after the outputs.
    pub fn run_rows(&self, weights: &[f64], inputs: &[&[Row]], registers: &mut [Row], rows: &mut [Vec<Row>]) {
        for operation in &self.parts[1] {
            operation.run(weights, inputs, registers, rows);
        }
    }
}

impl Operation {
    #[inline(always)]
    fn run(&self, weights: &[f64], inputs: &[&[Row]], registers: &mut [Row], rows: &mut [Vec<Row>]) {
        match *self {
            Self::Input { number, at, to } => registers[to as usize] = inputs[number as usize][at as usize],
            Self::Parameter { at, to } => registers[to as usize] = Row::splat(weights[at as usize]),
            Self::Sum { x, y, to } => of_two(registers, [x, y, to], |x, y| x + y),
            Self::Difference { x, y, to } => of_two(registers, [x, y, to], |x, y| x - y),
            Self::Product { x, y, to } => of_two(registers, [x, y, to], |x, y| x * y),
            Self::ProductSum { x, y, z, to } => {
                let [x, y, z] = [x, y, z].map(|at| registers[at as usize].load());
                registers[to as usize] = Row::store(std::array::from_fn(|g| x[g].mul_add(y[g], z[g])));
            }
            Self::Curve { function, x, to } => {
                let curve = function.curve(&registers[x as usize], to.map(|to| to.is_some()));
                for (to, row) in to.iter().zip(&curve) {
                    if let Some(to) = to {
                        registers[*to as usize] = *row;
                    }
                }
            }
            Self::Add { row, at, x } => {
                rows[row as usize][at as usize].add_scaled(1.0, &registers[x as usize]);
            }
        }
    }
}

#[inline(always)]
fn of_two(registers: &mut [Row], [x, y, to]: [u32; 3], f: impl Fn(f64x8, f64x8) -> f64x8) {
    let [x, y] = [x, y].map(|at| registers[at as usize].load());
    registers[to as usize] = Row::store(std::array::from_fn(|g| f(x[g], y[g])));
}
