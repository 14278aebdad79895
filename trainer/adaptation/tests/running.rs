//! Controllers whose model follows the machine.

mod common;

use common::{AS_LEARNED, Machine, N, TREE, model};
use leastaction_adaptation::{Choice, Request, of_windows};
use leastaction_core::adapt::Tunable;
use leastaction_core::energy::arm::{ArmBodies, BodyTree};
use leastaction_core::forces::{Coulomb, System, Viscous};
use leastaction_core::model::ArmHeader;
use leastaction_firmware_sim::control::{NoMpc, NoPump, Reference, TaskController, Trajectory};
use leastaction_firmware_sim::devices::EncoderConfig;
use leastaction_firmware_sim::scenario::{Run, TrackConfig};
use leastaction_firmware_sim::{Adapting, Tick, Timeline};
use leastaction_replica::{AdapterOf, ModelFile, PAIRS, PLACES, TunedOf, TuningOf};

/// Tick of the loop, s.
const H: f32 = 2e-3;

type Controller = TaskController<'static, NoPump, NoMpc, N>;
type Processor<'f> = Adapting<'f, TunedOf<'f, N>, Controller, N, PLACES, PAIRS>;
type Plant<'w> = System<ArmBodies<'w, f32, N>, (Viscous<f32, N>, Coulomb<f32, N>)>;

/// Calls a function with the machine as a plant.
fn with_plant<T>(machine: Machine, of: impl FnOnce(&Plant) -> T) -> T {
    let weights: Vec<f32> = machine.weights().into_iter().map(|w| w as f32).collect();
    let mut block = weights.as_slice();
    let tree = BodyTree::new(ArmHeader { bodies: TREE }.bodies().flatten()).expect("a tree");
    let lagrangian = ArmBodies::take(&mut block, tree).expect("weights");
    of(&System { lagrangian, forces: machine.forces_f32() })
}

/// A motion of all joints.
fn config(seconds: f32) -> TrackConfig<N> {
    let rows = [[0.5, 0.3, 0.2], [0.4, 0.2, 0.25], [0.6, 0.3, 0.2]];
    let mut waves = [[[0.0; 2]; 5]; N];
    for (wave, row) in waves.iter_mut().zip(rows) {
        for (k, (of, amplitude)) in wave.iter_mut().zip(row).enumerate() {
            let phase = 0.9 * k as f32;
            *of = [amplitude * phase.cos() / (1.0 + k as f32), amplitude * phase.sin()];
        }
    }
    let reference =
        Reference { begin: 0.2, ramp: 1.0, centre: [0.2, 0.4, 0.5], frequency: [0.25, 0.3, 0.35], waves };
    let start = reference.at(0.0).q;
    let mut config = TrackConfig::new([EncoderConfig::rotary(); N], [150.0; N], (start, reference));
    config.setup.tick = H;
    config.setup.seconds = seconds;
    config.setup.substeps = 2;
    config.setup.observer.memory = 25;
    config.setup.brakes = true;
    config
}

/// Time at which the load is taken up, s.
const TAKEN_UP: f32 = 3.0;

fn processor<'f>(
    file: &'f ModelFile,
    (choice, tuning): (&Choice, &'f TuningOf<N>),
    config: &TrackConfig<N>,
) -> Processor<'f> {
    let tuned = TunedOf::<N>::new(file).expect("a model");
    let firmware = config.program().follow(tuned.of_file()).expect("a program");
    Adapting::new(tuned, firmware, (choice.blocks(), tuning)).expect("numbers")
}

/// Numbers that follow, and how well the model explains the machine as it was learned.
fn choice(file: &ModelFile) -> Choice {
    let mut choice = Choice::of_loop(&model(), H.into(), &Request::default()).expect("a choice");
    choice.settings.deviation = vec![1e6; N];
    let config = config(TAKEN_UP);
    let tuning = choice.settings.tuning().expect("a tuning");
    let residuals = with_plant(AS_LEARNED, |plant| {
        let processor = processor(file, (&choice, &tuning), &config);
        let mut run = Run::new(plant, processor, &config.setup, &config.reference).expect("a run");
        let mut residuals = Vec::new();
        for _ in 0..config.setup.ticks() {
            run.tick().expect("a tick");
            if run.processor().agreement().is_some() {
                residuals.push(run.processor().adapter().residuals().to_vec());
            }
        }
        residuals
    });
    choice.settings.deviation = of_windows(&[residuals], N);
    choice
}

/// Runs a processor while the machine takes up a load; returns the root mean square of the error after the time `from`, and the adapter.
fn carry(processor: Processor, mass: f64, from: f32, seconds: f32) -> (f32, AdapterOf<N>) {
    let config = config(seconds);
    with_plant(AS_LEARNED, |plant| {
        with_plant(Machine { mass, friction: 1.0 }, |loaded| {
            let later = [(TAKEN_UP, loaded)];
            let plant = Timeline::new(plant, &later);
            let mut run = Run::new(plant, processor, &config.setup, &config.reference).expect("a run");
            let mut squares = Vec::new();
            for _ in 0..config.setup.ticks() {
                let tick: Tick<N> = run.tick().expect("a tick");
                if tick.time >= from {
                    squares.push(tick.error.iter().map(|e| e * e).sum::<f32>());
                }
            }
            ((squares.iter().sum::<f32>() / squares.len() as f32).sqrt(), *run.processor().adapter())
        })
    })
}

#[test]
fn a_load_is_carried_within_a_second() {
    let bytes = model().to_bytes().expect("bytes");
    let file = ModelFile::new(&bytes).expect("a file");
    let choice = choice(&file);
    let tuning = choice.settings.tuning().expect("a tuning");
    let config = config(1.0);
    let (error, after) =
        carry(processor(&file, (&choice, &tuning), &config), 2.0, TAKEN_UP + 1.5, TAKEN_UP + 3.0);
    let mass = choice.announcement.expect("bodies").of(after.filter()).expect("an announcement");
    assert!((mass.estimate - 2.0).abs() < 0.06, "{mass:?}");
    assert!((after.applied()[0] - 2.0).abs() < 0.06, "{:?}", after.applied());
    assert!(!after.unlike());
    let mut frozen = processor(&file, (&choice, &tuning), &config);
    frozen.frozen = true;
    let (without, frozen) = carry(frozen, 2.0, TAKEN_UP + 1.5, TAKEN_UP + 3.0);
    assert!(frozen.applied().iter().all(|applied| *applied == 0.0));
    assert!(error < 0.1 * without, "{error} rad, without adaptation {without} rad");
}
