//! Fits the coefficients from which `leastaction inspect --target` predicts to the measurements of `firmware-sim/chip/shapes.jsonl`, and
//! prints the fits.

#[path = "../shapes/mod.rs"]
mod shapes;

use leastaction_cost::processor::{Coefficients, CostFactors, Evaluation, Fit, Processor};
use leastaction_models::file::decode;
use std::collections::BTreeMap;
use std::error::Error;

/// The terms whose sum was measured, and the measured number.
type Equation = (Coefficients, f64);

fn main() -> Result<(), Box<dyn Error>> {
    let measured = shapes::measured()?;
    let mut fits = BTreeMap::new();
    for processor in Processor::ALL {
        let mut families = BTreeMap::<_, Equations>::new();
        for shape in shapes::all()?.iter().filter(|shape| shape.fitted) {
            let known = CostFactors::of(&decode(&shape.file)?).ok_or(shape.name.as_str())?;
            let equations = families.entry(known.family).or_default();
            for line in measured.iter().filter(|line| line.is(processor.name(), &shape.name)) {
                equations.add(&known, line);
            }
        }
        let families: BTreeMap<_, _> = families.into_iter().map(|(family, e)| (family, e.fit())).collect();
        fits.insert(processor.name(), families);
    }
    println!("{}", serde_json::to_string_pretty(&fits)?);
    Ok(())
}

/// All measurements of a family on a processor.
#[derive(Default)]
struct Equations {
    instructions: Vec<Equation>,
    stack: Vec<Equation>,
    code: Vec<Equation>,
}

impl Equations {
    fn add(&mut self, shape: &CostFactors, line: &shapes::Measured) {
        let step = Evaluation::Step(line.order);
        if line.order == 2 {
            let acceleration = Evaluation::Acceleration;
            self.instructions.push((shape.work(acceleration), line.acceleration_instructions));
            self.stack.push((shape.stack(acceleration), line.acceleration_stack_bytes));
        }
        self.instructions.push((shape.work(step), line.step_instructions));
        self.stack.push((shape.stack(step), line.stack_bytes));
        self.code.push((shape.code(line.order), line.text_bytes));
    }

    fn fit(&self) -> Fit {
        Fit {
            instructions: solved(&self.instructions, INSTRUCTIONS, 0.05),
            stack: solved(&self.stack, &[], WEAK),
            code: solved(&self.code, &[], WEAK),
        }
    }
}

/// Approximate number of instructions of an operation on a processor with a floating-point unit, as counted by
/// `src/bin/kernels.rs` of the chip and shown by a trace of the emulator. If the shapes do not distinguish two
/// operations, the fitted numbers stay near these.
const INSTRUCTIONS: &[(&str, f64)] = &[
    ("tangents", 100.0),
    ("exponentials", 70.0),
    ("logarithms", 110.0),
    ("roots", 14.0),
    ("sines", 60.0),
    ("divisions", 16.0),
    ("flops", 2.5),
    ("multiply_adds_8", 2.25),
    ("multiply_adds_4", 2.6),
    ("multiply_adds_1", 5.0),
    ("panels", 30.0),
    ("passes", 80.0),
    ("moved", 3.0),
    ("components", 80.0),
    ("layers", 40.0),
    ("recorded", 30.0),
    ("acceleration", 300.0),
    ("step_2", 1000.0),
    ("step_4", 1500.0),
];

/// Weight of a pull that only decides what the measurements leave open.
const WEAK: f64 = 1e-6;

/// Number of sweeps over the numbers, each of which is set to its optimum with the rest held.
const SWEEPS: usize = 200_000;

/// Returns the nonnegative numbers whose sums have the smallest relative errors against the measurements. Each number is pulled to its
/// `known` value with the weight of one more measurement of relative error 1/`pull`; unknown numbers are pulled very weakly to 1.
fn solved(equations: &[Equation], known: &[(&str, f64)], pull: f64) -> Coefficients {
    let mut names: Vec<&String> = equations.iter().flat_map(|(terms, _)| terms.keys()).collect();
    names.sort();
    names.dedup();
    let n = names.len();
    let mut rows: Vec<(Vec<f64>, f64)> = equations
        .iter()
        .map(|(terms, y)| {
            (names.iter().map(|name| terms.get(*name).copied().unwrap_or(0.0) / y).collect(), 1.0)
        })
        .collect();
    for (i, name) in names.iter().enumerate() {
        let known = known.iter().find(|(of, _)| of == name);
        let (known, pull) = known.map_or((1.0, WEAK), |(_, x)| (*x, pull));
        let row = (0..n).map(|j| if i == j { pull / known } else { 0.0 }).collect();
        rows.push((row, pull));
    }
    let normal = |i: usize, j: usize| rows.iter().map(|(row, _)| row[i] * row[j]).sum::<f64>();
    let matrix: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| normal(i, j)).collect()).collect();
    let target: Vec<f64> = (0..n).map(|i| rows.iter().map(|(row, y)| row[i] * y).sum()).collect();
    let mut x = vec![0.0; n];
    for _ in 0..SWEEPS {
        for i in 0..n {
            let others: f64 = (0..n).filter(|j| *j != i).map(|j| matrix[i][j] * x[j]).sum();
            x[i] = ((target[i] - others) / matrix[i][i]).max(0.0);
        }
    }
    // Three digits: the fit has no more.
    let rounded = |x: f64| format!("{x:.2e}").parse().unwrap_or(x);
    names.into_iter().cloned().zip(x.into_iter().map(rounded)).collect()
}
