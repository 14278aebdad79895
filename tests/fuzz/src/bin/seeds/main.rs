//! What fuzzing begins with: small inputs of every target, made by our own writers, in a folder a target: `seeds CORPUS`.

use leastaction_core::discrete::Order;
use leastaction_core::energy::modular::PairInput;
use leastaction_core::energy::rigid::Inertia;
use leastaction_core::model::Laws;
use leastaction_core::network::Activation;
use leastaction_data::{self as data, Dataset, Rows, Trajectory};
use leastaction_firmware_sim::control::{Gains, Law as ControlLaw, Target};
use leastaction_firmware_sim::devices::ActuatorConfig;
use leastaction_firmware_sim::link::{LoggedSamples, Request, Samples, VERSION};
use leastaction_firmware_sim::scenario::{SwingUpConfig, TrackConfig};
use leastaction_firmware_sim::{Program, Task};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

#[allow(dead_code, missing_docs, reason = "shared with tests, which use more of it")]
#[path = "../../../../../trainer/data/tests/bag/mod.rs"]
mod bag;
#[allow(dead_code, missing_docs, reason = "shared with tests, which use more of it")]
#[path = "../../../../../trainer/chip/tests/common/mod.rs"]
mod samples;

// What counts branches is in the fuzzer's library, which wants a target.
libfuzzer_sys::fuzz_target!(|_data: &[u8]| {});

type Done<T = ()> = Result<T, Box<dyn Error>>;

/// A folder of seeds, which are numbered.
struct Seeds {
    folder: PathBuf,
    count: usize,
}

impl Seeds {
    fn of(corpus: &Path, target: &str) -> Done<Self> {
        let folder = corpus.join(target);
        fs::create_dir_all(&folder)?;
        Ok(Self { folder, count: 0 })
    }

    fn add(&mut self, bytes: &[u8]) -> Done {
        self.count += 1;
        Ok(fs::write(self.folder.join(format!("seed-{}", self.count)), bytes)?)
    }
}

fn main() -> Done {
    let corpus = std::env::args_os().nth(1).ok_or("seeds CORPUS")?;
    let corpus = Path::new(&corpus);
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    models(corpus, &repository)?;
    documents(&mut Seeds::of(corpus, "link")?)?;
    logs(corpus)?;
    texts(corpus, &repository)?;
    #[cfg(feature = "learning")]
    learning::seeds(corpus)?;
    Ok(())
}

#[cfg(feature = "learning")]
mod learning;

/// Sections of model files: small ones of every family and every law, those of core's tests, and those of the images.
fn models(corpus: &Path, repository: &Path) -> Done {
    let (mut load, mut steps) = (Seeds::of(corpus, "load")?, Seeds::of(corpus, "steps")?);
    let mut files = small();
    for entry in fs::read_dir(repository.join("core/tests/golden"))? {
        let text = fs::read_to_string(entry?.path())?;
        let digits = text.lines().flat_map(|line| line.split('#').next().unwrap_or("").split_whitespace());
        files.push(digits.map(|byte| u8::from_str_radix(byte, 16)).collect::<Result<_, _>>()?);
    }
    for entry in fs::read_dir(repository.join("firmware-sim/chip/models"))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "postcard") {
            files.push(fs::read(path)?);
        }
    }
    for file in files {
        let sections = file.get(5..file.len() - 4).ok_or("a model file is longer")?;
        load.add(sections)?;
        steps.add(&[&[7, 100, 99], sections].concat())?;
    }
    Ok(())
}

fn small() -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    let network = samples::NETWORK;
    let all = Laws::FRICTION.with_dissipation(network).with_potential(network);
    let inertias =
        [Inertia::Diagonal, Inertia::Cholesky { epsilon: 0.1 }, Inertia::Factor { rows: 3, epsilon: 0.1 }];
    let activations = [
        Activation::Tanh,
        Activation::Softplus,
        Activation::Squareplus,
        Activation::Isru,
        Activation::Identity,
    ];
    for (seed, (activation, laws)) in (1..).zip(activations.into_iter().zip([
        Laws::NONE,
        Laws::VISCOUS,
        Laws::COULOMB,
        Laws::FRICTION,
        all,
    ])) {
        let coordinates = ["a", "ta", "at"][seed as usize % 3].to_owned();
        let inertia = if coordinates.len() == 1 { Inertia::Diagonal } else { inertias[seed as usize % 3] };
        let widths = [3, 2 * (seed as u16 % 2), 0, 0];
        let rigid = samples::RigidSample { coordinates, widths, activation, inertia, laws, seed };
        files.push(rigid.file(Order::Two));
        let pair = [PairInput::Distance, PairInput::Difference, PairInput::Concat][seed as usize % 3];
        files.push(samples::TreeSample::chain(2, 2, pair, laws, seed).file(Order::Four));
        files.push(samples::BodiesSample::chain(1 + seed as usize % 3, laws, seed).file(Order::Two));
    }
    for (dimension, nodes) in [(2, 2), (3, 3), (2, 4)] {
        files.push(samples::GraphSample::row(dimension, nodes, 2, 1).file(Order::Two));
    }
    files
}

/// Sessions of a processor: documents behind their lengths.
fn documents(seeds: &mut Seeds) -> Done {
    let measured = [Some(-0.25), None];
    let target = Target::of(&TrackConfig::<2>::cartpole().reference, 0.5, 0.0125);
    let tick = Request::Tick(Samples { sequence: 258, elapsed: 1, measured, target });
    let logged = Request::Log(LoggedSamples { sequence: 1, elapsed: 1, measured, command: [0.5, 0.0] });
    let swing_up = SwingUpConfig::cartpole().program();
    let float = Program { task: Task::Float { begin: [0.0, 0.1], drag: 1.0 }, ..swing_up };
    let begun =
        [swing_up, TrackConfig::<2>::cartpole().program(), float, Program { task: Task::Listen, ..swing_up }];
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

/// A pendulum that is pushed, twice.
fn motions(samples: usize) -> Done<Dataset> {
    let rows = |f: &dyn Fn(f64) -> f64| {
        Rows::from_flat(1, (0..samples).map(|k| f(0.05 * k as f64)).collect()).ok_or("one column")
    };
    let mut trajectories = Vec::new();
    for id in 0..2_i32 {
        let phase = f64::from(id);
        let (q, u) = (rows(&|t| (3.0 * t + phase).cos())?, rows(&|_| 0.5)?);
        trajectories.push(Trajectory { id: id.into(), t0: 0.0, q, v: None, a: None, u: Some(u) });
    }
    Ok(Dataset { n: 1, h: 0.05, control: None, trajectories })
}

/// Logs of a pendulum in every format.
fn logs(corpus: &Path) -> Done {
    let folder = tempfile::tempdir()?;
    let (mut csv, mut npz, mut mcap) =
        (Seeds::of(corpus, "csv")?, Seeds::of(corpus, "npz")?, Seeds::of(corpus, "mcap")?);
    let motions = motions(4)?;
    for extension in ["csv", "npz"] {
        let path = folder.path().join("log").with_extension(extension);
        data::write(&path, &motions)?;
        let bytes = fs::read(path)?;
        if extension == "csv" { csv.add(&bytes)? } else { npz.add(&[&[0], &bytes[..]].concat())? }
    }
    for text in [
        "time;enc;tau;mode\n0.00;100;0.5;on\n0.01;101;0.5;on\n0.021;103;-1;on\n0.03;104;-1;on\n0.041;106;2;on\n0.08;107;2;on\n",
        "# h = 0.05\n# control = held\nq0,u0,trajectory\n1,0,1\n2,0.5,1\n3,1e-3,1\n4,0,2\n5,0,2\n6,0,2\n",
        "t\tq\tv\n0\t0,5\t1\n0,1\t0,6\t1\n0,2\t0,7\t1\n",
        "time,enc,tau\n0,1,2\n1,2,3\n2,3,4\n9,9,9\n10,9,9\n11,9,9\n",
    ] {
        csv.add(text.as_bytes())?;
        let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        csv.add(&[&[0xff, 0xfe], &wide[..]].concat())?;
    }
    for arrays in arrays() {
        npz.add(&[&[1], &arrays[..]].concat())?;
    }
    for chunks in [bag::Chunks::No, bag::Chunks::Plain, bag::Chunks::Zstd, bag::Chunks::Lz4] {
        let (stamps, names) = ([0_i64, 10_000_000, 20_000_000, 31_000_000, 90_000_000], ["a"]);
        let values: Vec<[f64; 3]> = (0..stamps.len()).map(|k| [0.1 * k as f64, 0.5, -1.0]).collect();
        let messages: Vec<_> = (stamps.iter().zip(&values))
            .map(|(stamp, [q, v, u])| {
                let fields = [q, v, u].map(std::slice::from_ref);
                bag::Joints { topic: "/joints", stamp: *stamp, names: &names, fields }
            })
            .collect();
        mcap.add(&without_checksums(bag::bag(&messages, chunks)))?;
    }
    Ok(())
}

/// The same bag with checksums 0, which says that there are none, so that what the fuzzer changes is read.
fn without_checksums(mut bag: Vec<u8>) -> Vec<u8> {
    let mut at = 8;
    while let Some(head) = bag.get(at..at + 9) {
        let (opcode, length) =
            (head[0], head[1..].iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte)));
        let body = at + 9;
        let zeroed = match opcode {
            // Of a chunk, behind two times and a size.
            6 => Some(body + 24),
            // Of the end of the data, and of the footer.
            15 => Some(body),
            2 => Some(body + 16),
            _ => None,
        };
        if let Some(sum) = zeroed.and_then(|start| bag.get_mut(start..start + 4)) {
            sum.fill(0);
        }
        at = body + length;
    }
    bag
}

/// Arrays behind number of name and length: positions, stamps, forces of several element types and orders.
fn arrays() -> Vec<Vec<u8>> {
    let npy = |header: &str, content: &[u8]| {
        let padded = format!("{header:<117}\n");
        [b"\x93NUMPY\x01\x00", &(padded.len() as u16).to_le_bytes()[..], padded.as_bytes(), content].concat()
    };
    let doubles = |x: &[f64]| x.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
    let singles = |x: &[f32]| x.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>();
    let one = |kind: &str, shape: &str, fortran: &str| {
        format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}")
    };
    let (t, q) = ([0.0, 0.1, 0.2, 0.3], [1.0, 2.0, 3.0, 4.0]);
    let t = npy(&one("<f8", "(4,)", "False"), &doubles(&t));
    let q1 = npy(&one("<f8", "(4, 1)", "False"), &doubles(&q));
    let q2 = npy(&one(">f4", "(4, 2)", "True"), &singles(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]));
    let ids = npy(&one("|i1", "(4,)", "False"), &[0, 0, 0, 0]);
    let h = npy(&one("<f8", "()", "False"), &doubles(&[0.1]));
    let control = npy(&one("<U4", "()", "False"), b"h\0\0\0e\0\0\0l\0\0\0d\0\0\0");
    let put = |parts: &[(u8, &Vec<u8>)]| {
        let mut all = Vec::new();
        for (name, array) in parts {
            all.push(*name);
            all.extend((array.len() as u16).to_le_bytes());
            all.extend(*array);
        }
        all
    };
    vec![
        put(&[(0, &q1), (1, &t), (2, &q1)]),
        put(&[(0, &q2), (5, &h), (3, &q2), (6, &ids)]),
        put(&[(0, &q1), (5, &h), (7, &control)]),
    ]
}

/// Configurations of the documentation and of the images, and descriptions of robots.
fn texts(corpus: &Path, repository: &Path) -> Done {
    let mut toml = Seeds::of(corpus, "toml")?;
    toml.add(&fs::read(repository.join("trainer/learning/src/config/defaults.toml"))?)?;
    for entry in fs::read_dir(repository.join("docs"))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "md") {
            let text = fs::read_to_string(path)?;
            for block in text.split("```toml\n").skip(1) {
                toml.add(block.split("```").next().unwrap_or_default().as_bytes())?;
            }
        }
    }
    for entry in fs::read_dir(repository.join("firmware-sim/chip/models"))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            toml.add(&fs::read(path)?)?;
        }
    }
    let mut urdf = Seeds::of(corpus, "urdf")?;
    urdf.add(&fs::read(repository.join("trainer/src/commands/demo/arm.urdf"))?)?;
    urdf.add(
        b"<robot name='r'><link name='base'/><link name='a'><inertial><origin xyz='0.1 0.2 0.3' rpy='0.3 0.2 0.1'/>\
          <mass value='2'/><inertia ixx='0.03' ixy='0.001' ixz='0.002' iyy='0.04' iyz='0.003' izz='0.05'/></inertial></link>\
          <link name='tip'/><joint name='j' type='revolute'><parent link='base'/><child link='a'/><axis xyz='0 0 2'/>\
          <limit lower='-1' upper='2' velocity='3' effort='4'/><dynamics damping='0.1'/></joint>\
          <joint name='k' type='fixed'><parent link='a'/><child link='tip'/><origin xyz='0.4 -0.1 0.2' rpy='1 -2 0.5'/></joint></robot>",
    )
}
