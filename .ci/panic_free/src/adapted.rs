//! Numbers that follow a machine, and are saved.

use crate::Flash;
use core::hint::black_box;
use leastaction_core::adapt::{
    Adapter, Announcement, Block, Blocks, Limits, Moment, Number, Patch, Reading, Tunable, Tuning,
};
use leastaction_core::forces::Coefficient;
use leastaction_core::model::fingerprint;

#[inline(never)]
fn tuning<const N: usize, const P: usize>() -> Tuning<f32, N, P> {
    let limits = Limits { model: [1.0; P], lower: [-1.0; P], upper: [1.0; P], kept: 0.1 };
    black_box(Tuning {
        numbers: [Number::None; P],
        half: 10,
        h: 0.01,
        deviation: [1.0; N],
        prior: [1.0; P],
        forgotten: 0.01,
        walk: [0.1; P],
        change: 50.0,
        limits,
        dry: Some((Coefficient::Coulomb, [0.1; N])),
    })
}

/// Everything that a firmware asks of an adapter.
#[inline(never)]
pub fn follow<M: Tunable<N>, const N: usize, const P: usize, const T: usize>(
    model: &mut M,
    [file, saved]: [&'static Flash; 2],
) -> Option<()> {
    let tuning = tuning::<N, P>();
    let mut adapter = Adapter::<f32, N, P, T>::new(&tuning).ok()?;
    let model_of = fingerprint(file.bytes()).ok()?;
    adapter.begin_with(&tuning, &Patch::read(saved.bytes(), model_of).ok()?);
    let mut blocks = Blocks::new(black_box(4), black_box(0.001));
    let reading = Reading { q: black_box([0.1; N]), force: black_box([0.1; N]) };
    if let Some(Some(Block { q, v, force })) = blocks.take(Some(&reading)) {
        let moment = Moment { q, v, command: force, force };
        black_box(adapter.take(&tuning, model.of_file(), &moment));
    }
    adapter.work(&tuning);
    adapter.skip(&tuning);
    adapter.hold();
    model.set(&tuning.numbers, adapter.applied());
    black_box(model.in_use());
    let test = black_box(Announcement { number: 0, threshold: 30.0, least: 0.1, prior: 1.0 });
    black_box((test.of(adapter.filter()), adapter.unlike(), adapter.residuals()));
    let mut memory = [0; 256];
    black_box(adapter.patch(&tuning, model_of).write(&mut memory).ok()?);
    Some(())
}
