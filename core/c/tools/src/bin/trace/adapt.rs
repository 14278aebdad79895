//! Counterpart of `example/adapt.c`: writes the settings of its adapter and the machine that it moves, and does the same in Rust.

use super::config::{BLOCK, LEASTACTION_NUMBERS as P};
use super::{Hash, Laws, Mechanism, N, Step, Vector, aligned, in_place, words};
use leastaction_core::adapt::{
    Adapter, Announcement, Blocks, Following, Number, Patch, Reading, Settings, SettingsFile, StoredSettings,
    Tunable, Tuning,
};
use leastaction_core::discrete::Order;
#[cfg(feature = "arm")]
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS as D, ARM_PARAMETERS as B};
#[cfg(feature = "bodies")]
use leastaction_core::energy::bodies::{BODY_PARAMETERS as B, GRAVITY_PARAMETERS as D};
use leastaction_core::forces::Coefficient;
use leastaction_core::model::{self, Law, Layout, Tuned, fingerprint, parse_as};
#[cfg(feature = "arm")]
use leastaction_core::model::{ArmHeader as Shape, ArmModel as Model};
#[cfg(feature = "bodies")]
use leastaction_core::model::{BodiesHeader as Shape, BodiesModel as Model};
use leastaction_core::scalar::{Scalar, Weights};

/// Ticks of the loop, and of a block of them.
const TICKS: u32 = 960;
const TICKS_PER_BLOCK: u16 = 2;
/// Load of the machine: a point mass, kg, and its place on the last body, m.
const LOAD: f32 = 0.5;
const PLACE: [f32; 3] = [0.25, -0.125, 0.125];
/// Friction that the machine has beside the model's, in the first coordinate.
const MORE_FRICTION: f32 = 0.125;

const T: usize = P * (P - 1) / 2;
type Own<'f> = Tuned<'f, Laws, D, B, N, BLOCK>;

fn own(file: &[u8]) -> Result<Own<'_>, String> {
    let parsed = parse_as::<Shape, f32>(file).map_err(words)?;
    Tuned::new(&parsed, parsed.shape.tree().map_err(words)?).map_err(words)
}

/// Inertial numbers of a point mass m at the place.
fn point(m: f32) -> Vec<f32> {
    let [x, y, z] = PLACE.map(f64::from);
    let of = |number: f64| number as f32 * m;
    if cfg!(feature = "bodies") {
        return vec![m, of(x), of(y), of(x * x + y * y)];
    }
    let inertia = [y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y];
    [1.0, x, y, z].into_iter().chain(inertia).map(of).collect()
}

fn of_last_body() -> impl Iterator<Item = Number> {
    (0..point(1.0).len()).map(|index| Number::Inertia { body: (N - 1) as u8, index: index as u8 })
}

fn friction(coefficient: Coefficient) -> impl Iterator<Item = Number> {
    (0..N).map(move |i| Number::Friction(coefficient, i as u8))
}

/// The model's file with what the machine carries, and with its friction.
pub fn machine(file: &[u8]) -> Result<Vec<u8>, String> {
    let parsed = model::parse(file).map_err(words)?;
    let Weights::Single(weights) = parsed.weights else { return Err("half precision".into()) };
    let layout = Layout::of(&parsed.header.family, parsed.header.laws).map_err(words)?;
    let numbers: Vec<Number> = of_last_body().chain(friction(Coefficient::Viscous).take(1)).collect();
    let distances: Vec<f32> = point(LOAD).into_iter().chain([MORE_FRICTION]).collect();
    let mut block = weights.to_vec();
    layout.write(weights, (&numbers, &distances), &mut block);
    let bytes: Vec<u8> = block.iter().flat_map(|weight| weight.to_le_bytes()).collect();
    let mut memory = vec![0; file.len() + 64];
    Ok(model::write(&parsed.header, &bytes, &mut memory).map_err(words)?.to_vec())
}

/// Settings of the inertia of the last body and all frictions, for a loop with ticks of h seconds.
pub fn settings(file: &[u8], h: f32) -> Result<Vec<u8>, String> {
    let (own, parsed) = (own(file)?, parse_as::<Shape, f32>(file).map_err(words)?);
    let value = |number| own.value(number).ok_or(format!("no {number:?}"));
    let dry = parsed.laws.contains(Law::Coulomb);
    let frictions = [(Coefficient::Viscous, true), (Coefficient::Coulomb, dry)];
    let frictions = frictions.into_iter().filter(|(_, is)| *is).flat_map(|(of, _)| friction(of));
    let following = |number| {
        let model = value(number)?;
        let inertial = matches!(number, Number::Inertia { .. });
        let prior = if inertial { 0.5 } else { 0.25 };
        let positive = !matches!(number, Number::Inertia { index: 1.., .. });
        let limits = [if positive { -model } else { -2.0 }, 2.0];
        Ok(Following { number, model, prior, walk: if inertial { 0.0 } else { 1e-5 }, limits })
    };
    let numbers: Vec<Following> =
        of_last_body().chain(frictions).map(following).collect::<Result<_, String>>()?;
    let levels: Vec<f32> =
        friction(Coefficient::Coulomb).map(|number| value(number).unwrap_or(0.0)).collect();
    let settings = Settings {
        half: 6,
        h: h * f32::from(TICKS_PER_BLOCK),
        deviation: vec![0.0625; N],
        forgotten: 0.0078125,
        change: 50.0,
        dry: dry.then_some((Coefficient::Coulomb, levels)),
        kept: 0.125,
        numbers,
    };
    let announcement = Some(Announcement { number: 0, threshold: 14.0, least: 0.0625, prior: 0.25 });
    let model = fingerprint(file).map_err(words)?;
    let file = SettingsFile { model, block: TICKS_PER_BLOCK, settings, announcement };
    Ok(file.write(&mut vec![0; 8192]).map_err(words)?.to_vec())
}

/// Adapter of a loop.
struct Loop<'f> {
    tuned: Own<'f>,
    tuning: Tuning<f32, N, P>,
    blocks: Blocks<f32, N>,
    adapter: Adapter<f32, N, P, T>,
}

impl Loop<'_> {
    fn tick(&mut self, reading: Option<&Reading<f32, N>>, frozen: bool) {
        let Self { tuned, tuning, blocks, adapter } = self;
        // The golden models have no actuator: a force is its command.
        adapter.follow(tuning, tuned, blocks, reading, frozen, |force| *force);
    }

    fn add(&self, count: usize, hash: &mut Hash) {
        let (filter, limits) = (self.adapter.filter(), &self.tuning.limits);
        for j in 0..count {
            let found = [filter.estimate()[j], Scalar::sqrt(filter.variance(j)), self.adapter.applied()[j]];
            hash.add(&[limits.model[j]]);
            hash.add(&found);
            hash.add(&[limits.lower[j], limits.upper[j]]);
        }
    }

    /// Begins anew with what was found, as after the power was off.
    fn restart(&mut self, model: u32, blocks: Blocks<f32, N>, hash: &mut Hash) -> Result<(), String> {
        let mut memory = [0; Patch::<P>::MAX_BYTES];
        let patch = self.adapter.patch(&self.tuning, model);
        let bytes = patch.write(&mut memory).map_err(words)?;
        bytes.iter().for_each(|byte| hash.add(&[f32::from(*byte)]));
        let patch = Patch::read(bytes, model).map_err(words)?;
        (self.adapter, self.blocks) = (Adapter::new(&self.tuning).map_err(words)?, blocks);
        self.adapter.begin_with(&self.tuning, &patch);
        self.tuned.set(&self.tuning.numbers, self.adapter.applied());
        Ok(())
    }
}

/// A motion to and fro, whose acceleration is constant but for its sign.
struct Reference {
    q: Vector,
    v: Vector,
}

impl Reference {
    fn go_on(&mut self, tick: u32, h: f32) -> Vector {
        let a = core::array::from_fn(|i| {
            let quarter = 32 + 8 * i as u32;
            if matches!(tick / quarter % 4, 0 | 3) { 4.0 } else { -4.0 }
        });
        for ((q, v), a) in self.q.iter_mut().zip(&mut self.v).zip(a) {
            *q += h * *v;
            *v += h * a;
        }
        a
    }
}

/// Moves the machine with the model in use, and lets the model follow.
pub fn adapt(file: &[u8], machine: &[u8], settings: &[u8], h: f32, q: &Vector) -> Result<u64, String> {
    let words_of_machine = aligned(machine);
    let machine =
        Model::<N, f32, Laws>::load(in_place(&words_of_machine, machine.len())).map_err(words)?.system;
    let model = fingerprint(file).map_err(words)?;
    let stored = StoredSettings::<N, P>::read(settings, model).map_err(words)?;
    let tuning = stored.settings.tuning().map_err(words)?;
    let adapter = Adapter::new(&tuning).map_err(words)?;
    let mut own = Loop { tuned: own(file)?, tuning, blocks: Blocks::new(stored.block, h), adapter };
    let (mut hash, mut reference) = (Hash::new(), Reference { q: *q, v: [0.0; N] });
    let mut state = machine.start(*q, [0.0; N])?;
    let step = Step { h, order: Order::Four, newton: machine.default_newton() };
    let (mut before, count) = ([0.0; N], stored.settings.numbers.len());
    for tick in 0..TICKS {
        let (q, v) = (state.q(), state.last_increment());
        let a = reference.go_on(tick, h);
        let wanted =
            core::array::from_fn(|i| a[i] + 16.0 * (reference.v[i] - v[i]) + 64.0 * (reference.q[i] - q[i]));
        let u = own.tuned.in_use().inverse_dynamics([&q, &v, &wanted])?;
        let force = core::array::from_fn(|i| 0.5 * (before[i] + u[i]));
        let missing = (100..103).contains(&tick);
        own.tick((!missing).then_some(&Reading { q, force }), (400..440).contains(&tick));
        [&q, &v, &u].iter().for_each(|x| hash.add(*x));
        if tick % 16 == 0 {
            own.add(count, &mut hash);
        }
        if tick == 640 {
            own.restart(model, Blocks::new(stored.block, h), &mut hash)?;
        }
        machine.step(&mut state, &step, u)?;
        before = u;
    }
    let found =
        stored.announcement.and_then(|test| test.of(own.adapter.filter())).ok_or("nothing is announced")?;
    hash.add(&[found.estimate, found.error]);
    eprintln!("attached: {} ± {} kg", found.estimate, found.error);
    if (found.estimate - LOAD).abs() < 0.0625 { Ok(hash.0) } else { Err(format!("{found:?} attached")) }
}
