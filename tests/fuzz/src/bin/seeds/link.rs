//! Sessions of a processor.

use super::{Done, Seeds};
use leastaction_firmware_sim::control::{Gains, Law as ControlLaw, Target};
use leastaction_firmware_sim::devices::{ActuatorConfig, Drive};
use leastaction_firmware_sim::link::{LoggedSamples, Request, Samples, VERSION};
use leastaction_firmware_sim::scenario::{MpcConfig, SwingUpConfig, TrackConfig};
use leastaction_firmware_sim::{Program, Task};

/// Writes sessions of a processor: documents, each preceded by its length.
pub fn documents(seeds: &mut Seeds) -> Done {
    let measured = [Some(-0.25), None];
    let target = Target::of(&TrackConfig::<2>::cartpole().reference, 0.5, 0.0125);
    let tick = Request::Tick(Samples { sequence: 258, elapsed: 1, measured, target });
    let logged = Request::Log(LoggedSamples { sequence: 1, elapsed: 1, measured, command: [0.5, 0.0] });
    let swing_up = SwingUpConfig::cartpole().program();
    let float = Program { task: Task::Float { begin: [0.0, 0.1], drag: 1.0 }, ..swing_up };
    let follow = Program { task: Task::Follow { drive: Drive::ideal() }, ..swing_up };
    let track = TrackConfig::<2>::cartpole().program();
    let mpc = MpcConfig::<2>::cartpole().program();
    let begun = [swing_up, track, float, Program { task: Task::Listen, ..swing_up }, follow, mpc];
    for program in begun {
        for model in 0..4_u8 {
            let mut session = vec![model];
            for request in [Request::Begin(program), tick, tick, logged, tick, Request::End] {
                push(&mut session, &postcard::to_stdvec(&(VERSION, 2_u8, request))?);
            }
            seeds.add(&session)?;
        }
    }
    let mut session = vec![2];
    let (reference, measured) = ([0.1_f32; 7], [Some(0.1); 7]);
    let target = Target::of(&reference, 0.0, 0.005);
    let tick = Request::Tick(Samples { sequence: 1, elapsed: 1, measured, target });
    let Program { tick: h, observer, .. } = swing_up;
    let (actuator, gains) = (ActuatorConfig::new([80.0; 7]), Gains { frequency: 20.0, damping: 1.0 });
    let task = Task::Track { begin: reference, gains, law: ControlLaw::ComputedTorque };
    let program = Program { tick: h, angle: [true; 7], actuator, observer, task };
    for request in [Request::Begin(program), tick, tick] {
        push(&mut session, &postcard::to_stdvec(&(VERSION, 7_u8, request))?);
    }
    seeds.add(&session)
}

fn push(session: &mut Vec<u8>, document: &[u8]) {
    session.push(document.len() as u8);
    session.extend(document);
}
