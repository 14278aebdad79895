//! temp
#[path = "../shapes/mod.rs"]
mod shapes;
use leastaction::model_cost::processor::{Evaluation, Processor, Shape};
use leastaction::model_file::decode;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let measured = shapes::measured()?;
    for processor in Processor::ALL {
        for shape in shapes::all()?.iter() {
            let known = Shape::of(&decode(&shape.file)?).ok_or(shape.name.as_str())?;
            for line in measured.iter().filter(|line| line.is(processor.name(), &shape.name)) {
                let step = Evaluation::Step(line.order);
                let a = Evaluation::Acceleration;
                println!(
                    "{}",
                    serde_json::json!({"board": processor.name(), "name": shape.name, "fitted": shape.fitted, "order": line.order, "family": known.family,
                 "work_a": known.work(a), "stack_a": known.stack(a), "work": known.work(step), "stack": known.stack(step), "code": known.code(line.order),
                 "ma": line.acceleration_instructions, "msa": line.acceleration_stack_bytes, "m": line.step_instructions, "ms": line.stack_bytes, "mc": line.text_bytes})
                );
            }
        }
    }
    Ok(())
}
