//! Programs of short vectors, computed number by number.
//!
//! Energies of bodies are written in vectors of two or three numbers, many of which are 0 or 1. If they are computed
//! number by number, known and equal numbers are computed only once and zeros not at all, and nothing is gathered or
//! scattered. Small networks beside bodies are treated in the same way, since their layers would otherwise need all
//! inputs as vectors.

mod run;
mod values;

use crate::function::{Function, ORDERS};
use crate::program::Program;
use crate::row::Row;
use values::{Id, Results, Value, Values};

/// Maximum number of operations: longer programs have long vectors, with which they are fast anyway. An arm of seven
/// joints takes 20,000 operations on short vectors.
const MOST: usize = 1 << 16;

/// Place for a number of every sample.
type Register = u32;

/// An operation on numbers of samples side by side.
#[derive(Clone, Copy, Debug)]
enum Operation {
    Input {
        number: u32,
        at: u32,
        to: Register,
    },
    Parameter {
        at: u32,
        to: Register,
    },
    Sum {
        x: Register,
        y: Register,
        to: Register,
    },
    Difference {
        x: Register,
        y: Register,
        to: Register,
    },
    Product {
        x: Register,
        y: Register,
        to: Register,
    },
    /// Computes xy + z.
    ProductSum {
        x: Register,
        y: Register,
        z: Register,
        to: Register,
    },
    Curve {
        function: Function,
        x: Register,
        to: [Option<Register>; ORDERS],
    },
    /// Adds to an entry of a row of the Jacobian.
    Add {
        row: u32,
        at: u32,
        x: Register,
    },
}

/// A program that runs number by number.
#[derive(Clone, Debug)]
pub(crate) struct Numbers {
    /// Operations for the outputs, and for the rows after them.
    parts: [Vec<Operation>; 2],
    registers: usize,
    constants: Vec<(Register, f64)>,
    /// Registers of the numbers of every output.
    outputs: Vec<Vec<Register>>,
}

impl Numbers {
    /// Converts a program; `None` if it is too long, or if it applies network layers that may not be split into
    /// numbers.
    pub fn of(program: &Program, with_layers: bool) -> Option<Self> {
        let (values, results) = Values::of(program, with_layers)?;
        (values.len() <= MOST).then(|| Allocation::new(&values).numbers(&results))
    }

    /// Registers that a run needs.
    pub fn registers(&self) -> Vec<Row> {
        let mut registers = vec![Row::default(); self.registers];
        self.constants.iter().for_each(|(to, c)| registers[*to as usize] = Row::splat(*c));
        registers
    }
}

/// Choice of the order of operations, and of the registers.
struct Allocation<'v> {
    values: &'v Values,
    places: Vec<Option<Register>>,
    /// Rank of the last operation that reads a value.
    last_read: Vec<usize>,
    is_needed: Vec<bool>,
    free: Vec<Register>,
    program: Numbers,
}

/// Part number of values that are not computed; part 0 is for the outputs, part 1 for the rows.
const NEVER: usize = 2;

impl<'v> Allocation<'v> {
    fn new(values: &'v Values) -> Self {
        let count = values.len();
        let program =
            Numbers { parts: Default::default(), registers: 0, constants: Vec::new(), outputs: Vec::new() };
        Self {
            values,
            places: vec![None; count],
            last_read: vec![0; count],
            is_needed: vec![false; count],
            free: Vec::new(),
            program,
        }
    }

    fn numbers(mut self, results: &Results) -> Numbers {
        let parts = &self.parts(results);
        let of_part =
            |part: usize| (0..self.values.len()).filter(move |at| parts[*at] == part).map(|at| at as Id);
        let [early, late] = [0, 1].map(|part| of_part(part).collect::<Vec<_>>());
        let mut adds: Vec<Vec<(u32, u32)>> = vec![Vec::new(); self.values.len()];
        results.rows.iter().for_each(|(row, at, x)| adds[*x as usize].push((*row, *at)));
        self.is_needed = parts.iter().map(|part| *part != NEVER).collect();
        self.find_last_reads(early.iter().chain(&late), (results, parts));
        for (rank, value) in early.iter().enumerate() {
            self.compute(0, *value);
            self.release(rank, *value);
        }
        // Values computed for the outputs may also have to be added to rows, after the outputs.
        early.iter().for_each(|value| self.add(*value, &adds));
        for (rank, value) in (early.len()..).zip(&late) {
            self.compute(1, *value);
            self.add(*value, &adds);
            self.release(rank, *value);
        }
        let places = &self.places;
        let register = |x: &Id| places[*x as usize].unwrap_or_default();
        self.program.outputs = results.outputs.iter().map(|of| of.iter().map(register).collect()).collect();
        self.program
    }

    fn add(&mut self, value: Id, adds: &[Vec<(u32, u32)>]) {
        let Some(x) = self.places[value as usize] else { return };
        let own = adds[value as usize].iter();
        self.program.parts[1].extend(own.map(|(row, at)| Operation::Add { row: *row, at: *at, x }));
    }

    /// Part in which each value is computed.
    fn parts(&self, results: &Results) -> Vec<usize> {
        let mut parts = vec![NEVER; self.values.len()];
        results.rows.iter().for_each(|(_, _, x)| parts[*x as usize] = 1);
        results.outputs.iter().flatten().for_each(|x| parts[*x as usize] = 0);
        for at in (0..parts.len()).rev() {
            let own = parts[at];
            self.values.reads(at as Id).for_each(|x| parts[x as usize] = parts[x as usize].min(own));
        }
        parts
    }

    fn find_last_reads<'i>(
        &mut self,
        order: impl Iterator<Item = &'i Id>,
        (results, parts): (&Results, &[usize]),
    ) {
        for (rank, value) in order.enumerate() {
            self.last_read[*value as usize] = rank;
            self.values.reads(*value).for_each(|x| self.last_read[x as usize] = rank);
        }
        // Outputs stay in their registers, and so do values computed for the outputs that are later added to rows.
        let early = results.rows.iter().map(|(_, _, x)| x).filter(|x| parts[**x as usize] == 0);
        results.outputs.iter().flatten().chain(early).for_each(|x| self.last_read[*x as usize] = usize::MAX);
    }

    /// Frees the registers of values that are not read any more; constants stay.
    fn release(&mut self, rank: usize, value: Id) {
        let mut read: Vec<Id> = self.values.reads(value).chain([value]).collect();
        read.sort_unstable();
        read.dedup();
        read.retain(|x| self.last_read[*x as usize] == rank && !self.values.is_constant(*x));
        self.free.extend(read.into_iter().filter_map(|x| self.places[x as usize]));
    }

    fn new_register(&mut self) -> Register {
        self.program.registers += 1;
        (self.program.registers - 1) as Register
    }

    fn place(&self, value: Id) -> Register {
        self.places[value as usize].unwrap_or_default()
    }

    fn compute(&mut self, part: usize, value: Id) {
        if self.places[value as usize].is_some() {
            return;
        }
        let operation = match self.values.get(value) {
            Value::Constant(bits) => {
                let to = self.new_register();
                self.places[value as usize] = Some(to);
                return self.program.constants.push((to, f64::from_bits(bits)));
            }
            Value::Curve { function, x, .. } => {
                let curve = |order: u8| self.values.curve(function, order, x);
                let needed = |order: u8| curve(order).filter(|of| self.is_needed[*of as usize]);
                let to = [0, 1, 2, 3].map(needed).map(|order| order.map(|of| self.reserve(of)));
                Operation::Curve { function: self.values.function(function), x: self.place(x), to }
            }
            Value::Input(number, at) => Operation::Input { number, at, to: self.reserve(value) },
            Value::Parameter(at) => Operation::Parameter { at, to: self.reserve(value) },
            Value::Sum(x, y) => {
                Operation::Sum { x: self.place(x), y: self.place(y), to: self.reserve(value) }
            }
            Value::Difference(x, y) => {
                Operation::Difference { x: self.place(x), y: self.place(y), to: self.reserve(value) }
            }
            Value::Product(x, y) => {
                Operation::Product { x: self.place(x), y: self.place(y), to: self.reserve(value) }
            }
            Value::ProductSum(x, y, z) => {
                let [x, y, z] = [x, y, z].map(|of| self.place(of));
                Operation::ProductSum { x, y, z, to: self.reserve(value) }
            }
        };
        self.program.parts[part].push(operation);
    }

    fn reserve(&mut self, value: Id) -> Register {
        let register = self.free.pop().unwrap_or_else(|| self.new_register());
        self.places[value as usize] = Some(register);
        register
    }
}

#[cfg(test)]
mod tests {
    use crate::energies::{BodiesEnergies, GroupForce, LawNetwork, WithNetworks, with_group_laws};
    use crate::{Row, System};
    use leastaction_core::energy::bodies::{Joint, TreeBody};
    use leastaction_core::energy::inertia_network::Coordinate;
    use leastaction_core::network::Activation;

    const N: usize = 3;

    fn row(k: usize) -> Row {
        Row(std::array::from_fn(|sample| (1.3 * k as f64 + 0.7 * sample as f64).sin()))
    }

    /// A tree of three bodies, some of whose numbers are known, with friction that grows with the load, and with networks on request.
    fn system(with_networks: bool) -> System {
        let parents = [None, Some(0), Some(0)];
        let bodies = parents.map(|parent| TreeBody { joint: Joint::Revolute, parent });
        let bodies = BodiesEnergies::new(bodies.to_vec()).unwrap();
        let known = 0..crate::energies::Energies::parameters(&bodies);
        let known = known.map(|k| (k % 3 == 0).then_some([0.0, 1.0, -9.81][k / 3 % 3])).collect();
        let laws = [GroupForce::Viscous, GroupForce::Coulomb { loaded: true }];
        let bodies = Box::new(bodies.with_known(known).unwrap());
        let rubbing = with_group_laws(bodies, &laws, (2, &[0, 1, 1])).unwrap();
        let law = |coordinates| LawNetwork { coordinates, widths: vec![5], activation: Activation::Tanh };
        let (one, other) = (law(vec![None, Some(Coordinate::Angle)]), law(vec![Some(Coordinate::Angle)]));
        let networks = with_networks.then_some((&one, &other)).unzip();
        System::new(&WithNetworks::new(rubbing, networks.0, networks.1).unwrap())
    }

    /// Outputs and rows equal those of the vector program up to rounding.
    #[test]
    fn number_by_number_the_results_are_the_same() {
        check_results(&system(false));
    }

    /// Small layers beside bodies are computed number by number.
    #[test]
    fn layers_beside_bodies_are_computed_number_by_number() {
        check_results(&system(true));
    }

    fn check_results(system: &System) {
        let weights: Vec<f64> = (0..system.parameters()).map(|k| 0.5 + row(k).0[0].abs()).collect();
        let inputs: Vec<Vec<Row>> = (0..4 + N).map(|k| (0..N).map(|i| row(7 * k + i)).collect()).collect();
        let inputs: Vec<&[Row]> = inputs.iter().map(Vec::as_slice).collect();
        let programs =
            [system.equation_of_motion_with_residual(N).0, system.residual_derivatives_with_control()];
        for program in programs {
            assert!(program.numbers.is_some());
            let mut vectors = program.clone();
            vectors.numbers = None;
            let results = [program, vectors].map(|program| {
                let mut workspace = program.workspace();
                let mut rows = vec![vec![Row::default(); system.parameters()]; program.rows()];
                // The program runs twice, so that a remainder of the first run would spoil the second.
                for _ in 0..2 {
                    rows.iter_mut().flatten().for_each(|row| *row = Row::default());
                    program.run(&weights, &inputs, &mut workspace, &mut rows);
                }
                let outputs = (0..program.outputs.len()).flat_map(|k| workspace.output(k).to_vec());
                outputs.chain(rows.into_iter().flatten()).collect::<Vec<Row>>()
            });
            assert_eq!(results[0].len(), results[1].len());
            for (a, b) in results[0].iter().flat_map(|row| row.0).zip(results[1].iter().flat_map(|row| row.0))
            {
                assert!((a - b).abs() < 1e-11 * (1.0 + b.abs()), "{a} and {b}");
            }
        }
    }
}
