//! Arguments of Python that several methods take, and the exception for a state without a value.

use crate::arrays::{Table, table};
use crate::errors::{Kind, input};
use crate::single::{Quantity, Unsolved};
use leastaction_core::discrete::Order;
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;

/// The exception for a state at which a quantity cannot be computed.
pub fn unsolved(Unsolved { index, error }: Unsolved) -> PyErr {
    Kind::Solve.says(format!("state {index}: {error}"))
}

/// The order of a step, from its number 2 or 4.
pub fn order(number: u8) -> PyResult<Order> {
    Order::from_number(number).ok_or_else(|| input(format!("order {number}: it must be 2 or 4")))
}

pub fn quantity(name: &str) -> PyResult<Quantity> {
    Quantity::named(name).ok_or_else(|| input(format!("{name:?} is no quantity")))
}

/// The inputs of a quantity, and the number of rows. All inputs have this number of rows or a single row.
pub fn inputs<T: numpy::Element + Copy>(
    quantity: Quantity,
    arrays: &[PyReadonlyArrayDyn<T>],
    n: usize,
) -> PyResult<(Vec<Table<T>>, usize)> {
    let names: [&str; 3] = match quantity {
        Quantity::InverseDynamics => ["q", "v", "a"],
        _ => ["q", "v", "u"],
    };
    if arrays.len() != quantity.inputs() {
        return Err(input(format!("{} arrays are needed, not {}", quantity.inputs(), arrays.len())));
    }
    let tables: Vec<Table<T>> =
        names.iter().zip(arrays).map(|(name, array)| table(name, array, &[n])).collect::<PyResult<_>>()?;
    let count = common(tables.iter().map(|table| table.count))?;
    Ok((tables, count))
}

/// The common number of rows; an array with a single row fits any number.
pub fn common(counts: impl Iterator<Item = usize> + Clone) -> PyResult<usize> {
    let count = counts.clone().find(|count| *count != 1).unwrap_or(1);
    match counts.into_iter().find(|own| *own != 1 && *own != count) {
        Some(other) => Err(input(format!("arrays of {count} and of {other} states do not fit each other"))),
        None => Ok(count),
    }
}

/// Name of the second vector of a start.
pub fn second(positions: bool) -> &'static str {
    if positions { "q1" } else { "v" }
}
