//! Runs that are taken tick by tick.

use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::System;
use leastaction_firmware_sim::control::{NODES, blank_nodes};
use leastaction_firmware_sim::scenario::{MpcConfig, Push, Run, mpc};
use leastaction_firmware_sim::{InPlace, Mode, Summary};

/// Runs all ticks of a configuration one by one; `push` gives the force from elsewhere in the tick at a time.
fn by_ticks(config: &MpcConfig<2>, push: impl Fn(f32) -> [f32; 2]) -> Summary<2> {
    let (system, mut nodes) = (System::conservative(CARTPOLE), blank_nodes::<2, 4>());
    let firmware = config.program().mpc(&system, &[], &mut nodes).unwrap();
    let mut run =
        Run::new(&system, InPlace { model: &system, firmware }, &config.setup, config.settings.goal).unwrap();
    for index in 0..config.setup.ticks() {
        run.push(push(index as f32 * config.setup.tick));
        run.tick().unwrap();
    }
    run.summary()
}

/// Runs the scenario as a whole.
fn whole(config: &MpcConfig<2>) -> Summary<2> {
    let system = System::conservative(CARTPOLE);
    mpc::<_, _, 2, 4>(&system, &system, &[], config, |_| {}).unwrap().0
}

fn short() -> MpcConfig<2> {
    let mut config = MpcConfig::<2>::cartpole();
    config.setup.seconds = 2.0;
    config
}

#[test]
fn ticks_one_by_one_have_the_trace_of_the_whole_run() {
    assert_eq!(by_ticks(&short(), |_| [0.0; 2]), whole(&short()));
}

/// A force from elsewhere has the trace of the same force in the setup, which is another one than without a push.
#[test]
fn a_push_from_elsewhere_acts_as_that_of_the_setup() {
    let mut pushed = short();
    pushed.setup.push = Push { begin: 0.5, end: 0.7, most: [5.0, 0.5] };
    let force = pushed.setup.push.draw(pushed.setup.seed);
    let from_elsewhere = by_ticks(&short(), |t| if (0.5..0.7).contains(&t) { force } else { [0.0; 2] });
    assert_eq!(from_elsewhere, whole(&pushed));
    assert_ne!(from_elsewhere.hash, whole(&short()).hash);
}

/// Beyond the length of its setup a run goes on, and its summary is that of all its ticks.
#[test]
fn a_run_goes_on_and_shows_its_motion() {
    let (config, system, mut nodes) = (short(), System::conservative(CARTPOLE), blank_nodes::<2, 4>());
    let firmware = config.program().mpc(&system, &[], &mut nodes).unwrap();
    let mut run =
        Run::new(&system, InPlace { model: &system, firmware }, &config.setup, config.settings.goal).unwrap();
    assert!(run.processor().firmware.controller().motion().is_empty());
    let ticks = config.setup.ticks() + 10;
    for index in 0..ticks {
        let tick = run.tick().unwrap();
        assert_eq!(tick.index, index);
        let motion = run.processor().firmware.controller().motion();
        assert_eq!(motion.len(), if tick.mode == Mode::Mpc { NODES } else { 0 });
        // The motion begins where the command takes effect, a tick after the estimate.
        if let Some(first) = motion.first() {
            let moved = first.x[0] - tick.q_estimate[0] - config.setup.tick * tick.v_estimate[0];
            assert!(moved.abs() < 5e-3, "{moved} m at tick {index}");
        }
    }
    assert_eq!(run.summary().ticks, ticks);
}

#[test]
fn a_setup_out_of_range_is_refused() {
    let (config, system, mut nodes) = (short(), System::conservative(CARTPOLE), blank_nodes::<2, 4>());
    let firmware = config.program().mpc(&system, &[], &mut nodes).unwrap();
    let mut setup = config.setup;
    setup.substeps = 0;
    assert!(Run::new(&system, InPlace { model: &system, firmware }, &setup, config.settings.goal).is_err());
}
