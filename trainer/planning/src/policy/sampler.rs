use super::Setting;
use leastaction_core::control::Plant;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::array::from_fn;
use std::f64::consts::PI;

/// Random starts: half of them anywhere, half thrown from the goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Starts<const D: usize> {
    /// Seed.
    pub seed: u64,
    /// Largest deviations of positions from the goal, and largest velocities, of starts anywhere; angles of any turn are drawn from a whole
    /// turn.
    pub spread: [f64; D],
    /// Largest velocities of throws; the positions' numbers are not used.
    pub throw: [f64; D],
    /// Longest time after a throw, s.
    pub seconds: f64,
}

impl<const D: usize> Starts<D> {
    /// The start of a number.
    pub fn draw<P: Plant<f64, D, M>, const M: usize>(&self, setting: &Setting<P, D, M>, k: u64) -> [f64; D] {
        let mut random =
            Pcg64Mcg::seed_from_u64(self.seed.wrapping_add(k.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        let anywhere: [f64; D] = from_fn(|i| {
            let spread = if setting.aim.turns[i] { PI } else { self.spread[i] };
            setting.aim.goal[i] + spread * symmetric(&mut random)
        });
        let start = if k.is_multiple_of(2) { Some(anywhere) } else { self.thrown(setting, &mut random) };
        setting.aim.states.clamped(&start.unwrap_or(anywhere))
    }

    /// State some time after a throw from the goal, under a random command.
    fn thrown<P: Plant<f64, D, M>, const M: usize>(
        &self,
        setting: &Setting<P, D, M>,
        random: &mut impl Rng,
    ) -> Option<[f64; D]> {
        let n = D / 2;
        let mut x = setting.aim.goal;
        for (v, most) in x.iter_mut().zip(&self.throw).skip(n) {
            *v += most * symmetric(random);
        }
        let limits = &setting.aim.controls;
        let u: [f64; M] = from_fn(|j| {
            let (least, most) = (limits.least[j], limits.most[j]);
            0.5 * (least + most) + 0.5 * (most - least) * symmetric(random)
        });
        let count = (self.seconds * random.random::<f64>() / setting.h) as usize;
        let mut motion = setting.plant.begin(&x).ok()?;
        for _ in 0..count {
            x = setting.plant.advance(&mut motion, (1, &u), &mut [0.0; D]).ok()?;
        }
        Some(x)
    }
}

/// A number between −1 and 1.
fn symmetric(random: &mut impl Rng) -> f64 {
    2.0 * random.random::<f64>() - 1.0
}
