//! Processors whose memory is guarded.

use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::System;
use leastaction_core::model::{ModelError, checksum};
use leastaction_firmware_sim::control::Target;
use leastaction_firmware_sim::scenario::{TrackConfig, run_on, track};
use leastaction_firmware_sim::{InPlace, Mode, Outcome, Processor, Swept, Voting};

/// Guards find nothing in a healthy run, and change none of its bits.
#[test]
fn a_healthy_run_is_the_same_with_guards() {
    let (system, config) = (System::conservative(CARTPOLE), TrackConfig::cartpole());
    let bare = track(&system, &system, &config, |_| ()).unwrap();
    let firmware = config.program().follow(&system).unwrap();
    let (file, voting) = (file(), Voting::new(system, firmware));
    let mut guarded = Swept::new(voting, &file, config.setup.observer.settling());
    let by_ticks = run_on(&system, Borrowed(&mut guarded), &config.setup, config.reference, |_| ()).unwrap();
    assert_eq!(by_ticks, bare);
    assert_eq!(
        (guarded.damage(), guarded.processor().outvoted(), guarded.processor().lost()),
        (None, 0, false)
    );
}

/// Damage to the file is found in time, and from then on no force is commanded.
#[test]
fn damage_to_the_file_ends_all_forces() {
    let (system, config) = (System::conservative(CARTPOLE), TrackConfig::cartpole());
    let firmware = config.program().follow(&system).unwrap();
    let mut file = file();
    file[77] ^= 4;
    let (stored, computed) = (checksum(&self::file()[..1000]), checksum(&file[..1000]));
    let ticks = config.setup.observer.settling();
    let mut swept = Swept::new(InPlace { model: &system, firmware }, &file, ticks);
    let target = Target::of(&[0.5, 1.0], 0.0, config.setup.tick);
    let mut run = || swept.run(1, &[Some(0.0), Some(3.0)], &target).unwrap().command;
    let commands: Vec<_> = (0..ticks).map(|_| run()).collect();
    let found = commands.iter().position(|command| command.mode == Mode::Safe).unwrap();
    assert!(commands[..found].iter().any(|command| command.u != [0.0; 2]));
    assert!(commands[found..].iter().all(|command| command.mode == Mode::Safe && command.u == [0.0; 2]));
    assert_eq!(swept.damage(), Some(ModelError::Checksum { stored, computed }));
}

/// A file of any content.
fn file() -> Vec<u8> {
    let body: Vec<_> = (0..1000_u32).map(|i| ((i * i) >> 3) as u8).collect();
    [&body[..], &checksum(&body).to_le_bytes()].concat()
}

/// A processor that is looked at afterwards.
struct Borrowed<'a, P>(&'a mut P);

impl<P: Processor<N>, const N: usize> Processor<N> for Borrowed<'_, P> {
    type Error = P::Error;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, P::Error> {
        self.0.run(elapsed, measured, target)
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, P::Error> {
        self.0.replay(elapsed, measured, u)
    }

    fn last(&self) -> &Outcome<N> {
        self.0.last()
    }
}
