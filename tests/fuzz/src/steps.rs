//! Ten steps of either order and an acceleration of any model in a file, in the chip's arithmetic.

use crate::model::File;
use crate::{HEAD, Random};
use leastaction_core::discrete::Order;
use leastaction_replica::{Control, ModelFile, Replica, Step};

/// Number of steps of a motion.
const STEPS: usize = 10;
/// Maximum number of coordinates: a step with more takes long.
const MOST: usize = 16;

/// Moves a model. The first bytes choose the seed, the size of the numbers and the step; the sections follow.
///
/// A solved step must have finite positions and momenta and a finite residual; a refused step must leave the motion unchanged; repeated
/// steps must have equal bits.
pub fn steps(input: &[u8]) {
    let Some(([seed, size, h], sections)) = input.split_first_chunk::<HEAD>() else { return };
    let Ok(file) = ModelFile::new(File::of(sections).bytes()) else { return };
    let Ok(chip) = file.replica(None) else { return };
    let n = chip.n();
    if n > MOST {
        return;
    }
    let mut random = Random(u64::from(*seed));
    let mut vector = |size: f32| (0..n).map(|_| size * random.signed()).collect::<Vec<f32>>();
    let size = sized(*size);
    let state = [vector(size.min(10.0)), vector(size), vector(size)];
    accelerate(&chip, &state);
    let h = chip.trained_step().map_or(1e-4 * f32::from(*h) + 1e-4, |step| step.h);
    for order in [Order::Two, Order::Four] {
        let step = Step { order, h };
        assert_eq!(moved(&chip, step, &state), moved(&chip, step, &state));
    }
}

/// Size from 10⁻³ to 10³, or infinity.
fn sized(byte: u8) -> f32 {
    if byte == 255 { f32::INFINITY } else { 10_f32.powf(f32::from(byte) / 42.0 - 3.0) }
}

fn accelerate(chip: &Replica, [q, v, u]: &[Vec<f32>; 3]) {
    let Ok(mut evaluator) = chip.evaluator() else { return };
    let mut found = vec![0.0; q.len()];
    if evaluator.acceleration(q, v, u, &mut found).is_ok() {
        assert!(found.iter().all(|x| x.is_finite()), "an acceleration that is not finite: {found:?}");
    }
    let _either = evaluator.energies(q, v);
    if evaluator.inverse_dynamics(q, v, u, &mut found).is_ok() {
        assert!(found.iter().all(|x| x.is_finite()), "a force that is not finite: {found:?}");
    }
}

/// Returns the bits of a motion, as far as it goes.
fn moved(chip: &Replica, step: Step, [q, v, u]: &[Vec<f32>; 3]) -> Vec<u32> {
    let Ok(mut motion) = chip.motion_at(step, q, v) else { return Vec::new() };
    let bits = |x: &[f32]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    for _ in 0..STEPS {
        let before = bits(&[motion.q(), motion.p()].concat());
        match motion.step(Control::held(u)) {
            Ok(report) => {
                assert!(report.residual.is_finite(), "a residual that is not finite");
                let finite = motion.q().iter().chain(motion.p()).all(|x| x.is_finite());
                assert!(finite, "a step that is not finite: {:?} {:?}", motion.q(), motion.p());
            }
            Err(_) => {
                let after = bits(&[motion.q(), motion.p()].concat());
                assert_eq!(before, after, "a refused step moved");
                break;
            }
        }
    }
    bits(&[motion.q(), motion.p()].concat())
}
