//! Plans that the tests compute, and plans with given numbers.

use core::array::from_fn;
use core::f64::consts::PI;
use leastaction_core::control::riccati::{Weights, back, stationary};
use leastaction_core::control::{Cost, Ilqr, Limits, Node, Options, Penalty, Plant, Problem, Stepped};
use leastaction_core::discrete::{Del, Midpoint};
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{Actuator, System};
use leastaction_core::plan::{Plan, PlanFile, PlanHeader, write};
use leastaction_firmware_sim::devices::Drive;

/// Tick of the plans, s.
pub const H: f32 = 0.01;
/// Fingerprint of a model that has no file.
pub const MODEL: u32 = 0x1234_5678;

/// A plan in memory.
pub struct Written(Vec<u32>);

impl Written {
    /// Numbers of every record, one after the other.
    pub fn new(header: &PlanHeader, records: &[f32]) -> Self {
        let mut words = vec![0; 64 + records.len()];
        let length = write(header, records, bytemuck::cast_slice_mut(&mut words)).unwrap().len();
        words.truncate(length / 4);
        Self(words)
    }

    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.0)
    }

    pub fn plan<const N: usize>(&self) -> Plan<'_, N, N> {
        Plan::at_most(PlanFile::parse(self.bytes()).unwrap()).unwrap()
    }
}

/// A swing-up by the force on the first coordinate, whose nodes last two ticks.
pub struct SwingUp<const N: usize> {
    pub mechanism: Trigonometric<'static, N>,
    pub limit: f64,
    pub seconds: f64,
    /// Conversion between the plan's commands and forces.
    pub drive: Drive<N>,
}

/// A pendulum by a joint that is too weak to lift it.
pub const PENDULUM_UP: SwingUp<1> =
    SwingUp { mechanism: PENDULUM, limit: 2.25, seconds: 3.0, drive: Drive::ideal() };
/// A pole by its cart.
pub const CARTPOLE_UP: SwingUp<2> =
    SwingUp { mechanism: CARTPOLE, limit: 12.0, seconds: 2.0, drive: Drive::ideal() };

impl<const N: usize> SwingUp<N> {
    /// The plan, which leaves a fifth of the limit to the feedback.
    pub fn plan<const D: usize>(&self) -> Written {
        let system = System::conservative(self.mechanism);
        let actuator = Actuator {
            gain: self.drive.gain.map(f64::from),
            offset: self.drive.offset.map(f64::from),
            delay: 0.0,
        };
        let del = Del::<f64, Midpoint>::new(f64::from(H));
        let plant = Stepped { system: &system, del, actuator, inputs: [0], stride: 1 };
        let start: [f64; D] = from_fn(|i| if i == N - 1 { PI } else { 0.0 });
        let (goal, most) = ([0.0; D], [0.8 * self.limit]);
        let problem = Problem {
            plant: &plant,
            cost: Cost { goal, turns: [false; D], x: goal, u: [0.01], end: [[0.0; D]; D] },
            controls: Limits { least: most.map(|u| -u), most },
            hard: Penalty::none(),
            soft: Penalty::none(),
            goal: Penalty { limits: Limits { least: goal, most: goal }, weights: [1.0; D] },
            energy: Penalty::none(),
        };
        let count = (self.seconds / (2.0 * f64::from(H))).round() as u32;
        let mut nodes: Vec<Node<f64, D, 1>> =
            (0..count).map(|k| Node::new(2, [0.01 * (0.1 * f64::from(k)).sin()])).collect();
        let options =
            Options { iterations: 1000, tolerance: 1e-6, violation: 1e-5, penalty: 1.0, growth: 10.0 };
        let mut search = Ilqr::new(problem, options, start, &mut nodes).unwrap();
        search.solve(|_| true).unwrap();
        assert!(search.violation() < 1e-5, "the plan ends upright");
        self.write(&plant, &nodes)
    }

    /// The plan of a motion, with the gains of a time-varying regulator.
    fn write<const D: usize>(&self, plant: &impl Plant<f64, D, 1>, nodes: &[Node<f64, D, 1>]) -> Written {
        let weights =
            Weights { x: from_fn(|i| if i < N { 100.0 } else { 10.0 }), u: [30.0 / self.limit.powi(2)] };
        let hold = [-f64::from(self.drive.offset[0]) / f64::from(self.drive.gain[0])];
        let end = stationary(&plant.linearise_at(&[0.0; D], (2, &hold)).unwrap(), &weights).unwrap();
        let mut cost = end.cost;
        let mut records = vec![[&[0.0; D][..], &hold, &end.gain[0]].concat()];
        for node in nodes.iter().rev() {
            let regulator = back(&node.transition, &weights, &cost).unwrap();
            cost = regulator.cost;
            records.push([&node.x[..], &node.u, &regulator.gain[0]].concat());
        }
        let records: Vec<f32> = records.into_iter().rev().flatten().map(|x| x as f32).collect();
        let angles: [u8; N] = from_fn(|i| u8::from(i == N - 1));
        let limit = self.limit as f32;
        let header = PlanHeader {
            model: MODEL,
            driven: &[0],
            angles: &angles,
            h: H,
            ticks_per_node: 2,
            nodes: nodes.len() as u32,
            limits: &[[-limit, limit]],
        };
        Written::new(&header, &records)
    }
}

/// A plan of one node of two ticks in which every driven coordinate holds to its start with the same gains.
pub fn resting<const N: usize>(
    (model, h): (u32, f32),
    (q, angle): ([f32; N], bool),
    driven: &[u8],
    [u, gain_q, gain_v]: [f32; 3],
) -> Written {
    let own = |i: usize, coordinate: u8, gain: f32| if i == usize::from(coordinate) { gain } else { 0.0 };
    let mut record = [q, [0.0; N]].concat();
    record.extend(driven.iter().map(|_| u));
    for coordinate in driven {
        record.extend(
            [gain_q, gain_v].into_iter().flat_map(|gain| (0..N).map(move |i| own(i, *coordinate, gain))),
        );
    }
    let (angles, limits) = ([u8::from(angle); N], vec![[-50.0, 50.0]; driven.len()]);
    let header =
        PlanHeader { model, driven, angles: &angles, h, ticks_per_node: 2, nodes: 1, limits: &limits };
    Written::new(&header, &record.repeat(2))
}
