//! Flips bits in the memory of a controller on an emulated chip, and prints what became of it: `firmware-sim/chip/faults.sh`.
//!
//! `faults IMAGE MODEL [--faults N] [--first I] [--seed S] [--guards none|state|weights|all] [--json]`

use leastaction_core::model::ModelError;
use leastaction_firmware_sim::trajectory::reference::SmallCartpole;
use leastaction_tests::faults::{
    Bench, Caught, Chip, Costs, Fault, Guard, Judged, Place, Silence, TICKS_BEFORE,
};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};
use std::{env, process, thread};

/// Number of ticks in which a bit may flip.
const WINDOW: u32 = 40;
/// Guards, by their bits.
const GUARDS: [&str; 4] = ["none", "state", "weights", "all"];
const ALL: u32 = 3;
/// Number of runs of one emulator, whose memory grows with every reset.
const RUNS: u32 = 100;

struct Settings {
    image: PathBuf,
    model: PathBuf,
    faults: u32,
    /// Index of the first fault.
    first: u32,
    seed: u64,
    guards: u32,
    json: bool,
}

fn settings() -> Option<Settings> {
    let mut arguments = env::args().skip(1);
    let (image, model) = (arguments.next()?.into(), arguments.next()?.into());
    let mut settings = Settings { image, model, faults: 10_000, seed: 0, guards: ALL, first: 0, json: false };
    while let Some(name) = arguments.next() {
        match name.as_str() {
            "--json" => settings.json = true,
            "--faults" => settings.faults = arguments.next()?.parse().ok()?,
            "--first" => settings.first = arguments.next()?.parse().ok()?,
            "--seed" => settings.seed = arguments.next()?.parse().ok()?,
            "--guards" => {
                let guards = arguments.next()?;
                settings.guards = GUARDS.iter().position(|name| *name == guards)? as u32;
            }
            _ => return None,
        }
    }
    Some(settings)
}

/// A stream of numbers of its own for every fault. Source: Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014.
struct Stream(u64);

impl Stream {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 32) as u32
    }

    /// A number below `end`.
    fn below(&mut self, end: u32) -> u32 {
        ((u64::from(self.next()) * u64::from(end)) >> 32) as u32
    }
}

/// The fault of an index: a third each in state, stack and weights, at any instruction of a tick.
fn fault(seed: u64, index: u32, costs: &Costs) -> Fault {
    let mut stream = Stream(seed << 32 | u64::from(index));
    let tick = TICKS_BEFORE + stream.below(WINDOW);
    let instructions = costs.instructions.get(tick as usize).copied().unwrap_or(1);
    Fault {
        place: Some(Place::ALL[index as usize % Place::ALL.len()]),
        tick,
        after: stream.below(instructions),
        byte: stream.next(),
        bit: stream.below(8),
    }
}

/// An emulator that is started anew when it is lost.
struct Workshop<'a> {
    settings: &'a Settings,
    name: String,
    chip: Option<Chip>,
    runs: u32,
}

impl Workshop<'_> {
    fn chip(&mut self) -> Result<&mut Chip, String> {
        if self.chip.is_none() {
            let folder = env::temp_dir().join(format!("leastaction-faults-{}-{}", process::id(), self.name));
            self.chip = Some(
                Chip::start(&self.settings.image, folder).map_err(|error| format!("no emulator: {error}"))?,
            );
        }
        self.chip.as_mut().ok_or_else(|| "no emulator".into())
    }
}

/// Costs of the guards, from a run with an interrupt without a flip, whose commands must be those of this machine.
fn costs(bench: &Bench, workshop: &mut Workshop, guards: u32) -> Result<Costs, String> {
    let nothing = Fault { place: None, tick: TICKS_BEFORE + WINDOW, after: 1000, byte: 0, bit: 0 };
    let run = bench.run(workshop.chip()?, guards, &nothing);
    let run = run.map_err(|Silence| "the image does not begin")?;
    let caught = bench.judge(&run);
    if caught.judged != Judged::Masked || caught.by.is_some() {
        return Err(format!("a run without a fault: {caught:?}, {:?}", run.stop));
    }
    Ok(Costs { instructions: run.instructions, memory: run.memory })
}

/// Effects of all faults.
fn effects(bench: &Bench, settings: &Settings, costs: &Costs) -> Result<Vec<Caught>, String> {
    let (next, effects) = (AtomicU32::new(0), Mutex::new(vec![None; settings.faults as usize]));
    let work = |name: usize| -> Result<(), String> {
        let mut workshop = Workshop { settings, name: name.to_string(), chip: None, runs: 0 };
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= settings.faults {
                return Ok(());
            }
            let fault = fault(settings.seed, settings.first + index, costs);
            let run = match bench.run(workshop.chip()?, settings.guards, &fault) {
                // The run before has left an image that does not begin any more.
                Err(Silence) => {
                    workshop.chip = None;
                    bench.run(workshop.chip()?, settings.guards, &fault)
                }
                run => run,
            };
            let run = run.map_err(|Silence| format!("no run of {fault:?}"))?;
            let caught = bench.judge(&run);
            // A processor that ran astray may have changed devices, which a reset of the emulated board does not repair.
            let kept = run.stop.is_none() && matches!(caught.judged, Judged::Masked | Judged::Detected);
            workshop.runs += 1;
            if !kept || workshop.runs.is_multiple_of(RUNS) {
                workshop.chip = None;
            }
            if caught.judged == Judged::Wrong && settings.guards == ALL {
                eprintln!("fault {}: {fault:?}: {caught:?}, {:?}", settings.first + index, run.stop);
            }
            effects.lock().map_err(|_| "a thread has failed")?[index as usize] = Some(caught);
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|name| scope.spawn(move || work(name))).collect();
        threads.into_iter().try_for_each(|thread| thread.join().map_err(|_| "a thread has failed")?)
    })?;
    let effects = effects.into_inner().map_err(|_| "a thread has failed")?;
    effects.into_iter().collect::<Option<_>>().ok_or("a fault is missing".into())
}

fn median(instructions: &[u32]) -> u32 {
    let mut sorted = instructions.get(TICKS_BEFORE as usize..).unwrap_or_default().to_vec();
    sorted.sort_unstable();
    sorted.get(sorted.len() / 2).copied().unwrap_or(0)
}

/// Counts of the faults of one place.
struct Row {
    place: Place,
    judged: [usize; Judged::ALL.len()],
    /// Faults that each guard found first, without those that are wrong all the same.
    caught: [usize; Guard::ALL.len()],
}

impl Row {
    fn of(place: Place, effects: &[Caught]) -> Self {
        let count = |which: &dyn Fn(&Caught) -> bool| effects.iter().filter(|effect| which(effect)).count();
        let judged = Judged::ALL.map(|judged| count(&|effect| effect.judged == judged));
        let caught = Guard::ALL
            .map(|guard| count(&|effect| effect.by == Some(guard) && effect.judged != Judged::Wrong));
        Self { place, judged, caught }
    }

    /// Names and counts.
    fn cells(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let names = Judged::ALL.map(Judged::name).into_iter().chain(Guard::ALL.map(Guard::name));
        names.zip(self.judged.into_iter().chain(self.caught))
    }

    fn json(&self) -> serde_json::Value {
        let counts = self.cells().map(|(name, count)| (name.to_string(), count.into()));
        let place = ("place".to_string(), self.place.name().into());
        serde_json::Value::Object([place].into_iter().chain(counts).collect())
    }
}

fn rows(settings: &Settings, effects: &[Caught]) -> [Row; Place::ALL.len()] {
    let places = || Place::ALL.into_iter().cycle().skip(settings.first as usize % Place::ALL.len());
    Place::ALL.map(|place| {
        let here = places().zip(effects).filter(|(at, _)| *at == place);
        Row::of(place, &here.map(|(_, effect)| *effect).collect::<Vec<_>>())
    })
}

fn print(settings: &Settings, costs: &Costs, rows: &[Row]) {
    let Settings { faults, seed, guards, json, .. } = settings;
    let (guards, instructions) = (GUARDS[*guards as usize], median(&costs.instructions));
    let memory = costs.memory;
    if *json {
        let rows: Vec<_> = rows.iter().map(Row::json).collect();
        let table = serde_json::json!({ "guards": guards, "faults": faults, "seed": seed,
            "tick_instructions": instructions, "state_bytes": memory, "rows": rows });
        println!("{table}");
        return;
    }
    println!(
        "guards {guards}, {faults} faults, seed {seed}: {instructions} instructions a tick, {memory} bytes of state"
    );
    let names = rows.iter().take(1).flat_map(Row::cells).map(|(name, _)| format!("{name:>13}"));
    println!("{:>9}{}", "", names.collect::<String>());
    for row in rows {
        let counts: String = row.cells().map(|(_, count)| format!("{count:>13}")).collect();
        println!("{:>9}{counts}", row.place.name());
    }
}

fn load(path: &Path) -> Result<Vec<u32>, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    // Whole words, so that the weights are aligned; the caller cuts the rest off again.
    Ok(bytes
        .chunks(4)
        .map(|chunk| {
            let mut word = [0; 4];
            word[..chunk.len()].copy_from_slice(chunk);
            u32::from_ne_bytes(word)
        })
        .collect())
}

fn run(settings: &Settings) -> Result<bool, String> {
    let words = load(&settings.model)?;
    let length = std::fs::metadata(&settings.model).map_err(|error| error.to_string())?.len() as usize;
    let file = &bytemuck::cast_slice(&words)[..length];
    let model = SmallCartpole::load(file).map_err(|error: ModelError| error.to_string())?;
    let bench = Bench::new(&model);
    let mut workshop = Workshop { settings, name: "costs".into(), chip: None, runs: 0 };
    let costs = costs(&bench, &mut workshop, settings.guards)?;
    drop(workshop);
    let effects = effects(&bench, settings, &costs)?;
    print(settings, &costs, &rows(settings, &effects));
    Ok(effects.iter().all(|effect| effect.judged != Judged::Wrong))
}

fn main() {
    let Some(settings) = settings() else {
        eprintln!(
            "usage: faults IMAGE MODEL [--faults N] [--first I] [--seed S] [--guards {}] [--json]",
            GUARDS.join("|")
        );
        process::exit(2)
    };
    match run(&settings) {
        Ok(true) => {}
        // Without guards some faults are wrong: that is no failure.
        Ok(false) => process::exit(i32::from(settings.guards == ALL)),
        Err(error) => {
            eprintln!("{error}");
            process::exit(1)
        }
    }
}
