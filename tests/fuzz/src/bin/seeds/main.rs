//! Writes the seeds of the fuzzing corpus: small inputs for every target, made by our own writers, in one folder per target: `seeds
//! CORPUS`.

use leastaction_core::discrete::Order;
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::energy::modular::PairInput;
use leastaction_core::model::{Law, Laws, MAGIC};
use leastaction_core::network::Activation;
use leastaction_core::plan;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

#[allow(dead_code, missing_docs, reason = "shared with tests, which use more of it")]
#[path = "../../../../../trainer/replica/tests/common/mod.rs"]
mod samples;

// The counter of branches is in the fuzzer's library, which needs a target.
libfuzzer_sys::fuzz_target!(|_data: &[u8]| {});

type Done<T = ()> = Result<T, Box<dyn Error>>;

/// A folder of numbered seeds.
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
    plans(corpus, &repository)?;
    #[cfg(feature = "link")]
    link::documents(&mut Seeds::of(corpus, "link")?)?;
    #[cfg(feature = "logs")]
    logs::logs(corpus)?;
    texts(corpus, &repository)?;
    #[cfg(feature = "learning")]
    learning::seeds(corpus)?;
    Ok(())
}

#[cfg(feature = "learning")]
mod learning;
#[cfg(feature = "link")]
mod link;
#[cfg(feature = "logs")]
mod logs;

/// Writes sections of model files: small ones of every family and every law, those of core's tests, and those of the images.
fn models(corpus: &Path, repository: &Path) -> Done {
    let (mut load, mut steps) = (Seeds::of(corpus, "load")?, Seeds::of(corpus, "steps")?);
    let mut files = small();
    files.extend(golden(repository)?.into_iter().filter(|file| file.starts_with(&MAGIC)));
    for entry in fs::read_dir(repository.join("firmware-sim/chip/models"))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "postcard") {
            files.extend(Some(fs::read(path)?).filter(|file| file.starts_with(&MAGIC)));
        }
    }
    for file in files {
        let sections = file.get(5..file.len() - 4).ok_or("a model file is longer")?;
        load.add(sections)?;
        steps.add(&[&[7, 100, 99], sections].concat())?;
    }
    Ok(())
}

/// Writes contents of the plan of core's tests, and sizes of plans with numbers.
fn plans(corpus: &Path, repository: &Path) -> Done {
    let mut plan = Seeds::of(corpus, "plan")?;
    let swing_up = fs::read(repository.join("firmware-sim/chip/models/swing-up.postcard"))?;
    let golden = golden(repository)?.into_iter().filter(|file| file.starts_with(&plan::MAGIC));
    for file in golden.chain([swing_up]) {
        plan.add(&[&[0], &file[5..file.len() - 4]].concat())?;
    }
    let numbers: Vec<u8> = (0..40).flat_map(|i| (i as f32 / 8.0 - 1.0).to_le_bytes()).collect();
    for [n, driven, angles] in [[1, 1, 1], [2, 2, 1], [2, 3, 0], [3, 5, 6], [5, 8, 3]] {
        let head = [&[1, n, driven, angles, 3, 2][..], &0.05_f32.to_le_bytes()].concat();
        plan.add(&[head, numbers.clone()].concat())?;
    }
    Ok(())
}

/// Files of core's tests: models and a plan.
fn golden(repository: &Path) -> Done<Vec<Vec<u8>>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(repository.join("core/tests/golden"))? {
        let text = fs::read_to_string(entry?.path())?;
        let digits = text.lines().flat_map(|line| line.split('#').next().unwrap_or("").split_whitespace());
        files.push(digits.map(|byte| u8::from_str_radix(byte, 16)).collect::<Result<_, _>>()?);
    }
    Ok(files)
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
        let inertia_network =
            samples::InertiaNetworkSample { coordinates, widths, activation, inertia, laws, seed };
        files.push(inertia_network.file(Order::Two));
        let pair = [PairInput::Distance, PairInput::Difference, PairInput::Concat][seed as usize % 3];
        files.push(samples::TreeSample::chain(2, 2, pair, laws, seed).file(Order::Four));
        files.push(samples::BodiesSample::chain(1 + seed as usize % 3, laws, seed).file(Order::Two));
    }
    let axes = Laws::VISCOUS.with(Law::Directional).with(Law::Sticking).with(Law::Stops);
    files.push(samples::BodiesSample::chain(2, axes, 6).file(Order::Two));
    for (dimension, nodes) in [(2, 2), (3, 3), (2, 4)] {
        files.push(samples::GraphSample::row(dimension, nodes, 2, 1).file(Order::Two));
    }
    files
}

/// Writes configurations of the documentation and of the images, and robot descriptions.
fn texts(corpus: &Path, repository: &Path) -> Done {
    let mut toml = Seeds::of(corpus, "toml")?;
    for family in ["bodies/plane", "bodies/space", "graph", "inertia_network", "modular"] {
        toml.add(&fs::read(repository.join("trainer/models/src").join(family).join("config.toml"))?)?;
    }
    let book = repository.join("docs/book/src");
    for entry in fs::read_dir(&book)?.chain(fs::read_dir(book.join("reference"))?) {
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
    urdf.add(
        b"<mujoco><compiler angle='radian'/><default><joint armature='0.1' range='-1 1'/></default><worldbody><body name='a' pos='0 0 1'>\
          <inertial pos='0.1 0 0' mass='2' diaginertia='0.03 0.04 0.05'/><joint name='j' axis='0 1 0' ref='0.1'/><body name='b'>\
          <joint name='k' type='slide'/><geom type='capsule' size='0.1' fromto='0 0 0 0 0 1'/></body></body></worldbody>\
          <equality><joint joint1='k' joint2='j' polycoef='0 2'/></equality></mujoco>",
    )?;
    urdf.add(&fs::read(repository.join("trainer/src/commands/demo/arm.urdf"))?)?;
    urdf.add(
        b"<robot name='r'><link name='base'/><link name='a'><inertial><origin xyz='0.1 0.2 0.3' rpy='0.3 0.2 0.1'/>\
          <mass value='2'/><inertia ixx='0.03' ixy='0.001' ixz='0.002' iyy='0.04' iyz='0.003' izz='0.05'/></inertial></link>\
          <link name='tip'/><joint name='j' type='revolute'><parent link='base'/><child link='a'/><axis xyz='0 0 2'/>\
          <limit lower='-1' upper='2' velocity='3' effort='4'/><dynamics damping='0.1'/></joint>\
          <joint name='k' type='fixed'><parent link='a'/><child link='tip'/><origin xyz='0.4 -0.1 0.2' rpy='1 -2 0.5'/></joint></robot>",
    )
}
