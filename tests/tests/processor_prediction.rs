//! Predictions of `leastaction inspect --target`, compared with measurements on the emulated chips (`firmware-sim/chip/shapes.sh`).

#[path = "../shapes/mod.rs"]
mod shapes;

use leastaction_cost::processor::{Prediction, Processor};
use leastaction_models::file::decode;
use shapes::{Measured, RandomModel};

/// Allowed relative error of a prediction, for models that were held out when the predictor was fitted.
const TOLERANCE: f64 = 0.1;

/// Predicted and measured numbers, with their names.
fn compared(prediction: &Prediction, line: &Measured) -> Vec<(&'static str, f64, f64)> {
    let (step, code) = if line.order == 2 {
        (prediction.step_order_2, prediction.code_bytes[0])
    } else {
        (prediction.step_order_4, prediction.code_bytes[1])
    };
    let acceleration = prediction.acceleration;
    vec![
        ("acceleration", acceleration.instructions as f64, line.acceleration_instructions),
        ("step", step.instructions as f64, line.step_instructions),
        ("stack of an acceleration", acceleration.stack_bytes as f64, line.acceleration_stack_bytes),
        ("stack of a step", step.stack_bytes as f64, line.stack_bytes),
        ("code", code as f64, line.text_bytes),
    ]
}

fn check(processor: Processor, shape: &RandomModel, lines: &[Measured]) -> (usize, Vec<String>) {
    let model = decode(&shape.file).expect("a model file");
    let prediction = processor.predict(&model).expect("a shape that is compiled");
    let (mut count, mut off) = (0, Vec::new());
    for line in lines.iter().filter(|line| line.is(processor.name(), &shape.name)) {
        for (what, predicted, measured) in compared(&prediction, line) {
            let error = predicted / measured - 1.0;
            println!(
                "{} {} {} {what}: {predicted} of {measured} ({:+.1}%)",
                processor.name(),
                shape.name,
                line.order,
                100.0 * error
            );
            count += 1;
            if error.abs() > TOLERANCE {
                off.push(format!(
                    "{} {} {} {what}: {predicted}, measured {measured}",
                    processor.name(),
                    shape.name,
                    line.order
                ));
            }
        }
    }
    (count, off)
}

#[test]
fn models_that_were_held_out_are_predicted_within_a_tenth() {
    let (shapes, lines) =
        (shapes::all().expect("the list of shapes"), shapes::measured().expect("measurements"));
    let (mut count, mut off) = (0, Vec::new());
    for processor in Processor::ALL {
        for shape in shapes.iter().filter(|shape| !shape.fitted) {
            let (checked, beyond) = check(processor, shape, &lines);
            count += checked;
            off.extend(beyond);
        }
    }
    assert!(count > 0, "nothing was measured");
    assert!(off.is_empty(), "{} of {count} are off by more than a tenth:\n{}", off.len(), off.join("\n"));
}
