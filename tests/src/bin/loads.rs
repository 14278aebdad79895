//! Lets a simulated Panda run for hours without a load, or take up one in motion for many seeds, with a firmware whose model follows, and prints
//! what the firmware announces: `loads FOLDER quiet HOURS` or `loads FOLDER seeds FIRST COUNT`. Runs on all cores.
//!
//! The folder is one of `tests/loads.py`: plant.postcard, model.postcard, follow.toml, and the settings of the adapter. World and firmware are those of
//! `leastaction simulate`, but the plant takes one Runge–Kutta step a tick, and sizes are compiled in, so that an hour takes minutes.

use leastaction_core::adapt::{Difference, Number, StoredSettings, Tunable};
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, INERTIAL_PARAMETERS};
use leastaction_core::model::{ArmHeader, Tuned, fingerprint, parse_as};
use leastaction_firmware_sim::control::{Gains, NoMpc, NoPump, Reference, TaskController, Trajectory};
use leastaction_firmware_sim::devices::EncoderConfig;
use leastaction_firmware_sim::observer::OtherStep;
use leastaction_firmware_sim::scenario::{Run, TrackConfig};
use leastaction_firmware_sim::trajectory::reference::Friction;
use leastaction_firmware_sim::{Adapting, Mechanism, Timeline};
use serde_json::json;
use std::error::Error;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

const N: usize = 7;
const P: usize = INERTIAL_PARAMETERS + 2 * N;
const PAIRS: usize = P * (P - 1) / 2;
type Arm<'f> = Tuned<'f, Friction<N>, ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, N, 256>;
type Firmware<'t, 'f> = Adapting<'t, Arm<'f>, TaskController<'static, NoPump, NoMpc, N>, N, P, PAIRS>;

/// Earliest time at which a load is taken up, and the period of the motion, anywhere within which it is, s.
const EARLIEST: f32 = 4.0;
const PERIOD: f32 = 10.0;
/// Time with a load, s.
const WITH_LOAD: f32 = 3.0;
/// Length of a run without a load, s.
const QUIET: f32 = 900.0;
/// Largest distance of a load from the middle of the flange along every axis, m.
const AWAY: f32 = 0.1;

/// Files of the folder.
struct Files {
    plant: Vec<u32>,
    model: Vec<u32>,
    settings: Vec<u8>,
    reference: Reference<N>,
}

/// Findings of a firmware.
struct Said {
    announced: Option<(f32, Difference<f32>)>,
    last: Difference<f32>,
    changes: u32,
    unlike: bool,
}

fn words(path: &Path) -> Result<Vec<u32>, std::io::Error> {
    let bytes = std::fs::read(path)?;
    let word = |four: &[u8]| u32::from_le_bytes(std::array::from_fn(|i| *four.get(i).unwrap_or(&0)));
    Ok(std::iter::once(bytes.len() as u32).chain(bytes.chunks(4).map(word)).collect())
}

/// Bytes of a file whose length is the first word.
fn bytes(words: &[u32]) -> &[u8] {
    &bytemuck::cast_slice(&words[1..])[..words[0] as usize]
}

fn arm(file: &[u8]) -> Result<Arm<'_>, Box<dyn Error>> {
    let parsed = parse_as::<ArmHeader, f32>(file)?;
    Ok(Tuned::new(&parsed, parsed.shape.tree()?)?)
}

/// The motion of a file of `leastaction excite`.
fn motion(path: &Path) -> Result<Reference<N>, Box<dyn Error>> {
    let file: toml::Table = std::fs::read_to_string(path)?.parse()?;
    let number = |value: &toml::Value| value.as_float().unwrap_or(f64::NAN) as f32;
    let list = |value: &toml::Value, k: usize| value.get(k).map_or(f32::NAN, number);
    let (cosine, sine) = (&file["cosine"], &file["sine"]);
    let of = |rows: &toml::Value, i: usize, k: usize| rows.get(i).map_or(f32::NAN, |row| list(row, k));
    let waves = std::array::from_fn(|i| std::array::from_fn(|k| [of(cosine, i, k), of(sine, i, k)]));
    let (ramp, frequency) = (number(&file["ramp"]), [number(&file["frequency"]); N]);
    let reference = Reference {
        begin: 0.1,
        ramp,
        centre: std::array::from_fn(|i| list(&file["centre"], i)),
        frequency,
        waves,
    };
    reference.validate()?;
    Ok(reference)
}

fn config(reference: Reference<N>, seed: u64, seconds: f32) -> TrackConfig<N> {
    let encoder = EncoderConfig { noise: 0.0, ..EncoderConfig::rotary() };
    let limit = [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0];
    let mut config = TrackConfig::new([encoder; N], limit, (reference.at(0.0).q, reference));
    (config.setup.seed, config.setup.seconds, config.setup.tick, config.setup.substeps) =
        (seed, seconds, 1e-3, 1);
    (config.setup.observer.delay, config.setup.observer.memory) = (1.0, 50);
    config.setup.observer.other_step = OtherStep::Accepted;
    config.gains = Gains { frequency: 60.0, ..config.gains };
    config
}

/// A load.
#[derive(Clone, Copy)]
struct Load {
    mass: f32,
    place: [f32; 3],
    taken_up: f32,
}

impl Load {
    /// The load of a seed: .5 to 3 kg.
    fn of(seed: u64) -> Self {
        // Fractional parts of multiples of irrational numbers fill an interval evenly.
        let even = |irrational: f64| ((seed + 1) as f64 * irrational).fract() as f32;
        let [x, y, z] =
            [2.0_f64.sqrt(), 3.0_f64.sqrt(), 5.0_f64.sqrt()].map(|root| AWAY * (2.0 * even(root) - 1.0));
        let mass = 0.5 + 2.5 * even(0.618_033_988_749_895);
        Self { mass, place: [x, y, z + AWAY], taken_up: EARLIEST + PERIOD * even(7.0_f64.sqrt()) }
    }

    /// Inertial numbers of a point with this mass.
    fn numbers(&self) -> [f32; INERTIAL_PARAMETERS] {
        let (m, [x, y, z]) = (self.mass, self.place);
        let about = [y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y];
        let [xx, xy, yy, xz, yz, zz] = about.map(|square| m * square);
        [m, m * x, m * y, m * z, xx, xy, yy, xz, yz, zz]
    }
}

impl Files {
    fn read(folder: &Path) -> Result<Self, Box<dyn Error>> {
        Ok(Self {
            plant: words(&folder.join("plant.postcard"))?,
            model: words(&folder.join("model.postcard"))?,
            settings: std::fs::read(folder.join("adapter.settings"))?,
            reference: motion(&folder.join("follow.toml"))?,
        })
    }

    /// Runs the arm for some time, and lets it take up a load, if there is one.
    fn run(&self, seed: u64, seconds: f32, load: Option<Load>) -> Result<Said, Box<dyn Error>> {
        let (file, config) = (bytes(&self.model), config(self.reference, seed, seconds));
        let settings = StoredSettings::<N, P>::read(&self.settings, fingerprint(file)?)?;
        settings.check_tick(config.setup.tick)?;
        let tuning = settings.settings.tuning()?;
        let model = arm(file)?;
        let firmware = config.program().follow(model.of_file())?;
        let blocks = settings.settings.blocks(settings.block);
        let firmware = Firmware::new(model, firmware, (blocks, &tuning))?;
        let mut carrying = arm(bytes(&self.plant))?;
        let numbers: [Number; INERTIAL_PARAMETERS] =
            std::array::from_fn(|j| Number::Inertia { body: N as u8 - 1, index: j as u8 });
        carrying.set(&numbers, &load.map_or([0.0; INERTIAL_PARAMETERS], |load| load.numbers()));
        let (alone, loaded) = (*carrying.of_file().system(), carrying.in_use());
        let later: Vec<_> = load.iter().map(|load| (load.taken_up, &loaded)).collect();
        let plant = Timeline::new(&alone, &later);
        let mut run = Run::new(plant, firmware, &config.setup, config.reference)?;
        let announcement = settings.announcement.ok_or("no announcement")?;
        let (mut announced, mut changes) = (None, 0);
        for _ in 0..config.setup.ticks() {
            let Ok(tick) = run.tick();
            let Some(agreement) = run.processor().agreement() else { continue };
            changes += u32::from(agreement.changed);
            let of = announcement.of(run.processor().adapter().filter());
            announced = announced.or(of.map(|of| (tick.time, of)));
        }
        let (filter, j) = (run.processor().adapter().filter(), usize::from(announcement.number));
        let last = Difference { estimate: filter.estimate()[j], error: filter.variance(j).sqrt() };
        Ok(Said { announced, last, changes, unlike: run.processor().adapter().unlike() })
    }
}

/// Calls a function with all numbers up to `count` on all cores, and returns the results in order.
fn on_all_cores<T: Send>(count: u64, of: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let (next, done) = (AtomicU64::new(0), Mutex::new(Vec::new()));
    let work = || loop {
        let k = next.fetch_add(1, Ordering::Relaxed);
        if k >= count {
            return;
        }
        let result = of(k);
        done.lock().expect("no thread panics").push((k, result));
    };
    std::thread::scope(|scope| {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        (0..cores).for_each(|_| drop(scope.spawn(work)));
    });
    let mut done = done.into_inner().expect("no thread panics");
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Quarters of an hour in which nothing happens.
fn quiet(files: &Files, hours: f64) -> Result<(), Box<dyn Error>> {
    let quarters = (3600.0 * hours / f64::from(QUIET)).ceil() as u64;
    let said = on_all_cores(quarters, |k| {
        let said = files.run(k, QUIET, None).map_err(|error| error.to_string());
        if let Ok(Said { announced: Some((t, of)), .. }) = &said {
            println!("quarter {k}: {} ± {} kg announced at {t} s", of.estimate, of.error);
        }
        said
    });
    let said = said.into_iter().collect::<Result<Vec<_>, _>>()?;
    let announced = said.iter().filter(|said| said.announced.is_some()).count();
    let changes: u32 = said.iter().map(|said| said.changes).sum();
    let unlike = said.iter().filter(|said| said.unlike).count();
    let largest = said.iter().map(|said| said.last.estimate.abs()).fold(0.0, f32::max);
    println!(
        "{}",
        json!({"hours": quarters as f64 / 4.0, "announced": announced, "changes": changes, "unlike": unlike, "largest_mass": largest})
    );
    Ok(())
}

/// Loads, one for each seed.
fn seeds(files: &Files, first: u64, count: u64) -> Result<(), Box<dyn Error>> {
    let run = |k| {
        let load = Load::of(first + k);
        let said = files.run(first + k, load.taken_up + WITH_LOAD, Some(load));
        said.map(|said| (load, said)).map_err(|error| error.to_string())
    };
    let all = on_all_cores(count, run).into_iter().collect::<Result<Vec<_>, _>>()?;
    let off = |(load, said): &(Load, Said)| said.last.estimate - load.mass;
    let z = |of: &(Load, Said)| off(of) / of.1.last.error;
    let after =
        |(load, said): &(Load, Said)| said.announced.map_or(f32::INFINITY, |(t, _)| t - load.taken_up);
    let held = all.iter().filter(|of| z(of).abs() <= 1.96).count();
    let mean: f32 = all.iter().map(z).sum::<f32>() / count as f32;
    let square: f32 = all.iter().map(|of| z(of) * z(of)).sum::<f32>() / count as f32;
    let worst = all.iter().map(|of| (off(of) / of.0.mass).abs()).fold(0.0, f32::max);
    let within = all.iter().filter(|of| (off(of) / of.0.mass).abs() <= 0.03).count();
    let early = all.iter().filter(|of| after(of) < 0.0).count();
    println!(
        "{}",
        json!({"seeds": count, "held": held, "mean_z": mean, "rms_z": square.sqrt(), "worst_share": worst, "within_3_percent": within,
               "announced_before": early, "announced_after": all.iter().map(after).fold(0.0, f32::max)})
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words[..] {
        [folder, "quiet", hours] => quiet(&Files::read(folder.as_ref())?, hours.parse()?),
        [folder, "seeds", first, count] => {
            seeds(&Files::read(folder.as_ref())?, first.parse()?, count.parse()?)
        }
        _ => Err("usage: loads FOLDER quiet HOURS | loads FOLDER seeds FIRST COUNT".into()),
    }
}
