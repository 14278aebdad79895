//! `leastaction-papers hardware`.

use super::selection::{Selection, cases, given};
use clap::Args;
use leastaction::cli::{Done, Failure, Output};
use leastaction_papers::HARDWARE;
use leastaction_papers::hardware::{
    ArmData, AxisData, CurrentData, HardwareError, Machine, MachineData, Split, arm_tasks, axis_tasks,
    current_tasks, read_swings, swing_tasks, tasks,
};
use leastaction_papers::task::Task;
use std::path::PathBuf;
use std::sync::Arc;

/// Real machines: pendulums of one to three arms and two robots' arms, learned from some of their logs and predicted along the others.
///
/// Prints the median window error after 0.1, 0.5 and 1 s (rad), as is and with the encoders' zeros calibrated from the first 2 s of a
/// tested log, for our models and for those that they are compared with. The logs are not part of this program: DIR has a folder of .csv
/// files for each machine, double-pendulum, pendulum, panda, ur10e and emps. For the Panda, whose log is panda/excitation.csv, the error is that of
/// the torques along motion that was not learned from; for the UR10e, beside whose logs lies ur10e.urdf, that of the currents along each
/// log. For multi-arm, whose logs are multi-arm/single_id.npz, double_id.npz and triple_id.npz, it is that of free swings; for emps, whose log is
/// emps/train.csv, and test.csv where there is another, that of the position along a whole log (mm). With -o also
/// writes a page.
///
/// Example: leastaction-papers hardware --data DIR --machine double-pendulum --test 1,3,5 --json
#[derive(Args)]
pub struct Hardware {
    /// Folder with the machines' logs, any number for each machine, in the layout of the published ones.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Only this machine; by default all machines that have a folder in DIR.
    #[arg(long)]
    machine: Option<Machine>,
    /// Test these logs, counted from 0 in order of name, and learn from all others. By default, for the double pendulum the last three of
    /// ten and then 1, 3 and 5; for the pendulum every log in turn.
    #[arg(long, value_name = "LOG,…", value_delimiter = ',', requires = "machine")]
    test: Vec<usize>,
    /// Identified parameters of the double pendulum, lines of `name: number`; by default model_parameters.yml beside its logs.
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    #[command(flatten)]
    selection: Selection,
}

impl Hardware {
    /// Learns, predicts and prints.
    pub fn run(self, output: Output) -> Done {
        let mut all = Vec::new();
        for machine in self.machines()? {
            all.extend(self.tasks(machine).map_err(|error| Failure::Input(error.to_string()))?);
        }
        self.selection.run(&HARDWARE, all, output)
    }

    fn machines(&self) -> Result<Vec<Machine>, Failure> {
        let is_other = |machine: Machine| machine != Machine::DoublePendulum;
        if self.baseline.is_some() && self.machine.is_some_and(is_other) {
            return Err(Failure::Input("--baseline is of the double pendulum; leave it out".to_owned()));
        }
        let is_there = |machine: &Machine| self.data.join(machine.name()).is_dir();
        if let Some(what) = self.machine.filter(|_| !self.test.is_empty()).and_then(without_test) {
            return Err(Failure::Input(format!("--test names logs; {what}, so leave it out")));
        }
        let machines = match self.machine {
            Some(machine) => vec![machine],
            None => cases(None).into_iter().filter(is_there).collect(),
        };
        if machines.is_empty() {
            let names = cases(None).into_iter().map(Machine::name).collect::<Vec<_>>().join(", ");
            return Err(Failure::input(
                &self.data,
                format!("there is none of the folders {names} with logs"),
            ));
        }
        Ok(machines)
    }

    fn tasks(&self, machine: Machine) -> Result<Vec<Task>, HardwareError> {
        if machine == Machine::Panda {
            let arguments = given("data", Some(self.data.display())) + &self.selection.arguments();
            return Ok(arm_tasks(&Arc::new(ArmData::read(&self.data)?), &arguments));
        }
        if machine == Machine::MultiArm {
            let arguments = given("data", Some(self.data.display())) + &self.selection.arguments();
            return Ok(swing_tasks(&read_swings(&self.data)?, (self.selection.quick, &arguments)));
        }
        if machine == Machine::Ur10e {
            let arguments = given("data", Some(self.data.display())) + &self.selection.arguments();
            return Ok(current_tasks(&Arc::new(CurrentData::read(&self.data)?), &arguments));
        }
        if machine == Machine::Emps {
            let arguments = given("data", Some(self.data.display())) + &self.selection.arguments();
            return Ok(axis_tasks(
                &Arc::new(AxisData::read(&self.data)?),
                (self.selection.quick, &arguments),
            ));
        }
        let data = MachineData::read(&self.data, machine, self.baseline.as_deref())?;
        let splits = match &self.test[..] {
            [] => Split::usual(machine, data.logs.len()),
            test => vec![Split::of(test.to_vec(), data.logs.len())?],
        };
        let seeds: Vec<u64> = self.selection.seeds().collect();
        Ok(tasks(&data, &splits, &seeds, (self.selection.quick, &self.arguments())))
    }

    /// Command-line options other than machine, tested logs and seed.
    fn arguments(&self) -> String {
        let baseline = given("baseline", self.baseline.as_ref().map(|file| file.display()));
        given("data", Some(self.data.display())) + &baseline + &self.selection.arguments()
    }
}

/// Reason why the logs of a machine cannot be chosen.
fn without_test(machine: Machine) -> Option<&'static str> {
    match machine {
        Machine::Panda | Machine::MultiArm => {
            Some("of this machine one log is learned from and tested in parts")
        }
        Machine::Ur10e => Some("of the UR10e one log is learned from and all are tested"),
        Machine::Emps => Some("of the axis train.csv is learned from and test.csv tested"),
        Machine::DoublePendulum | Machine::Pendulum => None,
    }
}
