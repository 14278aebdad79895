use crate::data::modlanet::ModlanetRows;
use crate::data::{Dataset, Rows, Trajectory};
use leastaction_core::forces::ControlKind;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use std::ops::Range;
use thiserror::Error;

/// Data that lacks what a loss needs.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SampleError {
    /// A quantity is missing.
    #[error("this loss needs {0}, which the data does not have")]
    Missing(&'static str),
}

/// Samples of a loss: three consecutive positions with their controls, or one state with its acceleration or with the
/// next state.
///
/// All numbers are \[samples\]\[n\], flat.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// Number of coordinates.
    pub n: usize,
    /// Step, s.
    pub h: f64,
    /// (q₋, q, q₊) for the discrete losses; (q, v, v̇) for acceleration and torque losses; (q, v, q₊) for the next-state loss.
    pub states: [Vec<f64>; 3],
    /// Velocities v₊ after a step for the next-state loss; otherwise empty.
    pub next_velocities: Vec<f64>,
    /// Controls at the same times. For acceleration and torque losses only the first entry, u, is used; for the
    /// next-state loss the first two, u and u₊.
    pub controls: [Vec<f64>; 3],
    /// Behaviour of the controls between these times.
    pub control: ControlKind,
}

impl Samples {
    /// An empty set for data with this step and control kind.
    fn of(data: &Dataset) -> Self {
        Self { n: data.n, h: data.h, control: data.control_kind(), ..Self::default() }
    }

    /// All triples of consecutive positions of every trajectory. Velocities are not read.
    pub fn triples(data: &Dataset) -> Self {
        let mut samples = Self::of(data);
        for trajectory in &data.trajectories {
            let count = trajectory.samples().saturating_sub(2);
            for k in 0..3 {
                samples.states[k].extend(rows(&trajectory.q, k, count));
                samples.controls[k].extend(control(trajectory, data.n, k, count));
            }
        }
        samples
    }

    /// All rows of a data set in ModLaNet's layout: states with accelerations, without control.
    pub fn modlanet(rows: &ModlanetRows) -> Self {
        let states = [&rows.q, &rows.v, &rows.a].map(|rows| rows.as_flat().to_vec());
        let control = vec![0.0; states[0].len()];
        Self {
            n: rows.q.width(),
            h: 0.0,
            controls: [control.clone(), control.clone(), control],
            states,
            ..Self::default()
        }
    }

    /// All states with their accelerations.
    ///
    /// # Errors
    /// [`SampleError`] if velocities or accelerations are missing.
    pub fn accelerations(data: &Dataset) -> Result<Self, SampleError> {
        let mut samples = Self::of(data);
        for trajectory in &data.trajectories {
            let count = trajectory.samples();
            let v = trajectory.v.as_ref().ok_or(SampleError::Missing("velocities (v)"))?;
            let a = trajectory.a.as_ref().ok_or(SampleError::Missing("accelerations (a)"))?;
            for (states, source) in samples.states.iter_mut().zip([&trajectory.q, v, a]) {
                states.extend(rows(source, 0, count));
            }
            for controls in &mut samples.controls {
                controls.extend(control(trajectory, data.n, 0, count));
            }
        }
        Ok(samples)
    }

    /// Filtered states with their torques, from a log of step h (s).
    pub fn of_torques(filtered: &crate::torque::Samples, h: f64) -> Self {
        let crate::torque::Samples { q, v, a, tau, .. } = filtered;
        let flat = |rows: &Rows| rows.as_flat().to_vec();
        let control = flat(tau);
        let controls = [control.clone(), control.clone(), control];
        Self { n: q.width(), h, states: [q, v, a].map(flat), controls, ..Self::default() }
    }

    /// All pairs of consecutive states, with the controls at both.
    ///
    /// # Errors
    /// [`SampleError`] if velocities are missing.
    pub fn next_states(data: &Dataset) -> Result<Self, SampleError> {
        let mut samples = Self::of(data);
        for trajectory in &data.trajectories {
            let v = trajectory.v.as_ref().ok_or(SampleError::Missing("velocities (v)"))?;
            let count = trajectory.samples().saturating_sub(1);
            for (states, (source, start)) in
                samples.states.iter_mut().zip([(&trajectory.q, 0), (v, 0), (&trajectory.q, 1)])
            {
                states.extend(rows(source, start, count));
            }
            samples.next_velocities.extend(rows(v, 1, count));
            for (controls, start) in samples.controls.iter_mut().zip([0, 1, 1]) {
                controls.extend(control(trajectory, data.n, start, count));
            }
        }
        Ok(samples)
    }

    /// Accelerations for logs without them. From every five consecutive states it takes the middle state, with the
    /// acceleration of the polynomial of degree 9 through their positions and velocities; the error is O(h⁸).
    ///
    /// v̇₀ = \[−5q₀ + 64/27 (q₁ + q₋₁) + 7/54 (q₂ + q₋₂)\]/h² − \[8/9 (v₁ − v₋₁) + 1/36 (v₂ − v₋₂)\]/h. Noise of σ on positions
    /// becomes 6σ/h² on accelerations.
    ///
    /// # Errors
    /// [`SampleError`] if velocities are missing.
    pub fn interpolated(data: &Dataset) -> Result<Self, SampleError> {
        let mut samples = Self::of(data);
        for trajectory in &data.trajectories {
            let v = trajectory.v.as_ref().ok_or(SampleError::Missing("velocities (v)"))?;
            let count = trajectory.samples().saturating_sub(4);
            let a = interpolated(&trajectory.q, v, data.h, count);
            samples.states[0].extend(rows(&trajectory.q, 2, count));
            samples.states[1].extend(rows(v, 2, count));
            samples.states[2].extend(a);
            for controls in &mut samples.controls {
                controls.extend(control(trajectory, data.n, 2, count));
            }
        }
        Ok(samples)
    }

    /// The samples in an order drawn from the seed, so that every batch is a mixture.
    #[must_use]
    pub fn shuffled(&self, seed: u64) -> Self {
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.shuffle(&mut Pcg64::seed_from_u64(seed));
        let n = self.n;
        let permute = |x: &Vec<f64>| order.iter().flat_map(|k| &x[k * n..(k + 1) * n]).copied().collect();
        Self {
            n,
            h: self.h,
            states: self.states.each_ref().map(permute),
            next_velocities: of_some(&self.next_velocities, permute),
            controls: self.controls.each_ref().map(permute),
            control: self.control,
        }
    }

    /// Splits the samples into two sets: all but the last `held_back`, and the last `held_back`.
    #[must_use]
    pub fn split(&self, held_back: usize) -> [Self; 2] {
        let first = self.len().saturating_sub(held_back);
        [self.range(0..first), self.range(first..self.len())]
    }

    /// The samples in a range, clipped to the existing samples.
    #[must_use]
    pub fn range(&self, range: Range<usize>) -> Self {
        let end = range.end.min(self.len());
        let of = |x: &Vec<f64>| x[range.start.min(end) * self.n..end * self.n].to_vec();
        let (states, controls) = (self.states.each_ref().map(of), self.controls.each_ref().map(of));
        Self { states, controls, next_velocities: of_some(&self.next_velocities, of), ..*self }
    }

    /// Mean square of the third state; for the acceleration loss these are the accelerations.
    pub fn mean_square(&self) -> f64 {
        let [.., last] = &self.states;
        last.iter().map(|x| x * x).sum::<f64>() / last.len() as f64
    }

    /// Standard deviation of every coordinate's control, N m or N; 1 if it is constant.
    pub fn torque_deviations(&self) -> Vec<f64> {
        let count = self.len() as f64;
        let of = |i: usize| self.controls[0].iter().skip(i).step_by(self.n.max(1));
        let deviation = |i: usize| {
            let mean = of(i).sum::<f64>() / count;
            (of(i).map(|u| (u - mean) * (u - mean)).sum::<f64>() / count).sqrt()
        };
        (0..self.n).map(deviation).map(|deviation| if deviation > 0.0 { deviation } else { 1.0 }).collect()
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.states[0].len() / self.n.max(1)
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Applies `change` to numbers that only some losses have; an empty list stays empty.
fn of_some(x: &Vec<f64>, change: impl Fn(&Vec<f64>) -> Vec<f64>) -> Vec<f64> {
    if x.is_empty() { Vec::new() } else { change(x) }
}

/// The accelerations of `count` states, starting with the third; see [`Samples::interpolated`].
fn interpolated(q: &Rows, v: &Rows, h: f64, count: usize) -> Vec<f64> {
    let (q, v) = (q.as_flat(), v.as_flat());
    let n = q.len() / (count + 4).max(1);
    let one = |at: usize| {
        let pair = |x: &[f64], k: usize, sign: f64| x[at + k * n] + sign * x[at - k * n];
        let positions = -5.0 * q[at] + 64.0 / 27.0 * pair(q, 1, 1.0) + 7.0 / 54.0 * pair(q, 2, 1.0);
        let velocities = 8.0 / 9.0 * pair(v, 1, -1.0) + 1.0 / 36.0 * pair(v, 2, -1.0);
        positions / (h * h) - velocities / h
    };
    (2 * n..(2 + count) * n).map(one).collect()
}

/// `count` samples from `start` on.
fn rows(source: &Rows, start: usize, count: usize) -> impl Iterator<Item = f64> {
    source.iter().skip(start).take(count).flatten().copied()
}

/// The controls; zero if the log has none.
fn control(trajectory: &Trajectory, n: usize, start: usize, count: usize) -> Vec<f64> {
    match &trajectory.u {
        Some(u) => rows(u, start, count).collect(),
        None => vec![0.0; n * count],
    }
}
