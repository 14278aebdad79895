use super::Setup;
use crate::Mechanism;
use crate::angle::difference;
use crate::control::Controller;
use crate::devices::{Actuator, Arrival, Clock, Encoders};
use crate::firmware::{Firmware, Outcome};
use crate::plant::Plant;
use crate::summary::{Recorder, Summary};
use crate::tick::Tick;

/// The world as the firmware meets it.
struct World<'a, P, const N: usize> {
    plant: Plant<'a, P, N>,
    encoders: Encoders<N>,
    actuator: Actuator<N>,
    clock: Clock,
    h: f32,
    errors: u32,
}

impl<'a, P: Mechanism<N>, const N: usize> World<'a, P, N> {
    fn new(mechanism: &'a P, setup: &Setup<N>) -> Self {
        Self {
            plant: Plant::new(mechanism, setup.start.draw(setup.seed), setup.substeps),
            encoders: Encoders::new(setup.devices.encoders, setup.seed),
            actuator: Actuator::new(setup.devices.actuator),
            clock: Clock::new(setup.devices.clock, setup.seed),
            h: setup.tick,
            errors: 0,
        }
    }

    /// Lets a fraction of a tick go by under the force that acts.
    fn pass(&mut self, fraction: f32) {
        let moved = self.plant.advance(fraction * self.h, &self.actuator.force());
        self.errors += u32::from(moved.is_err());
    }
}

/// The firmware in its world, tick by tick.
struct Loop<'a, P, M, C, const N: usize> {
    world: World<'a, P, N>,
    firmware: Firmware<'a, M, C, N>,
    recorder: Recorder<N>,
    angle: [bool; N],
    /// Ticks since the firmware last ran.
    elapsed: u32,
}

impl<P: Mechanism<N>, M: Mechanism<N>, C: Controller<M, N>, const N: usize> Loop<'_, P, M, C, N> {
    /// One tick of world and firmware.
    fn tick(&mut self, index: u32) -> Tick<N> {
        let (arrival, true_state) = (self.world.clock.tick(), *self.world.plant.state());
        let time = index as f32 * self.world.h;
        self.world.pass(arrival.lateness);
        let measured = self.world.encoders.sample(&self.world.plant.state().q);
        let measured = if arrival.missed { [None; N] } else { measured };
        let outcome = self.run(time, &arrival, &measured);
        let command = (!arrival.missed).then_some(outcome.command.u);
        let applied = self.world.actuator.advance(command);
        self.world.pass(1.0 - arrival.lateness);
        let reference = self.firmware.reference(time);
        Tick {
            index,
            time,
            q: true_state.q,
            v: true_state.v,
            measured,
            q_estimate: outcome.estimate.q,
            v_estimate: outcome.estimate.v,
            reference,
            error: difference(&true_state.q, &reference, &self.angle),
            commanded: outcome.command.u,
            applied,
            newton: outcome.newton,
            lateness: arrival.lateness * self.world.h,
            missed: arrival.missed,
            mode: outcome.command.mode,
        }
    }

    /// The firmware's part.
    fn run(&mut self, time: f32, arrival: &Arrival, measured: &[Option<f32>; N]) -> Outcome<N> {
        self.elapsed += 1;
        if arrival.missed {
            return *self.firmware.last();
        }
        let outcome = self.firmware.run(time, self.elapsed, measured);
        self.elapsed = 0;
        self.recorder.errors(outcome.errors, 0);
        outcome
    }
}

/// Runs a controller over a model against a plant; the setup has been validated.
pub(super) fn run<P, M, C, const N: usize>(
    plant: &P,
    model: &M,
    controller: C,
    setup: &Setup<N>,
    mut sink: impl FnMut(&Tick<N>),
) -> Summary<N>
where
    P: Mechanism<N>,
    M: Mechanism<N>,
    C: Controller<M, N>,
{
    let angle = setup.devices.angles();
    let limits = setup.devices.actuator;
    let mut looped = Loop {
        world: World::new(plant, setup),
        firmware: Firmware::new(model, controller, setup.tick, angle, &setup.observer, limits),
        recorder: Recorder::new(setup.goal, angle),
        angle,
        elapsed: 0,
    };
    for index in 0..setup.ticks() {
        let tick = looped.tick(index);
        looped.recorder.record(&tick);
        sink(&tick);
    }
    looped.recorder.errors(0, looped.world.errors);
    looped.recorder.finish()
}
