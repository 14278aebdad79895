//! Unwrapping of angles from sensors that measure within one turn.

use std::f64::consts::{PI, TAU};

use crate::note::Note;
use crate::{Dataset, Trajectory};

/// Tolerance for rounding and noise beyond one turn, rad.
const SLACK: f64 = 1e-3;

impl Dataset {
    /// Unwraps angles that are given within one turn; returns a note for each.
    ///
    /// `letters` has one letter per coordinate: `t` translation, `a` angle, `c` cyclic. A seam is an interval over
    /// which an angle moves by 2π, give or take a quarter turn, relative to the neighbouring intervals. From each seam
    /// on, a whole turn is added.
    ///
    /// A cyclic coordinate may be an angle or a length. It is taken as an angle if it has such jumps and the trajectory
    /// stays within [−π, π] or [0, 2π]: a length would hardly jump between the ends of exactly such a range. Velocities
    /// and accelerations are neither read nor changed.
    #[must_use]
    pub fn unwrap_angles(&mut self, letters: &str) -> Vec<Note> {
        let columns = letters.chars().take(self.n).enumerate();
        let turning = columns.filter(|(_, letter)| matches!(letter, 'a' | 'c'));
        turning.filter_map(|(i, letter)| self.unwrap_column(i, letter == 'c')).collect()
    }

    fn unwrap_column(&mut self, coordinate: usize, cyclic: bool) -> Option<Note> {
        let (mut seams, mut trajectories) = (0, Vec::new());
        for trajectory in &mut self.trajectories {
            if cyclic && !keeps_to_a_turn(trajectory, coordinate) {
                continue;
            }
            let found = unwrap(trajectory, coordinate);
            if found > 0 {
                seams += found;
                trajectories.push(trajectory.id);
            }
        }
        (seams > 0).then_some(Note::Seams { coordinate, cyclic, seams, trajectories })
    }
}

fn keeps_to_a_turn(trajectory: &Trajectory, coordinate: usize) -> bool {
    let ranges = [(-PI, PI), (0.0, TAU)];
    let within = |(least, most)| {
        let range = least - SLACK..=most + SLACK;
        trajectory.q.column(coordinate).all(|q| range.contains(&q))
    };
    ranges.into_iter().any(within)
}

/// Unwraps a column; returns the number of seams.
fn unwrap(trajectory: &mut Trajectory, coordinate: usize) -> usize {
    let angles: Vec<f64> = trajectory.q.column(coordinate).collect();
    let seams = seams(&angles, TAU);
    let mut turns = 0.0;
    for (q, seam) in trajectory.q.column_mut(coordinate).skip(1).zip(&seams) {
        turns -= f64::from(*seam);
        *q += turns * TAU;
    }
    seams.iter().filter(|seam| **seam != 0).count()
}

/// For every interval 1 or −1 if the values move by ±`turn`, give or take a quarter turn, relative to the neighbouring
/// intervals; otherwise 0.
pub(crate) fn seams(values: &[f64], turn: f64) -> Vec<i8> {
    let moves: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let seam = |k: usize| {
        let beyond = moves[k] - expected(&moves, k, turn);
        let far = moves[k].abs() > turn / 2.0 && moves[k] * beyond > 0.0;
        far && (beyond.abs() - turn).abs() <= turn / 4.0
    };
    (0..moves.len()).map(|k| if seam(k) { moves[k].signum() as i8 } else { 0 }).collect()
}

/// The mean of the moves before and after `k`, without those that merely jump back, as of a value that flickers about
/// the seam.
fn expected(moves: &[f64], k: usize, turn: f64) -> f64 {
    let back = |other: f64| other.abs() > turn / 2.0 && other * moves[k] < 0.0;
    let neighbours = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|k| moves.get(k));
    let steady: Vec<f64> = neighbours.copied().filter(|other| !back(*other)).collect();
    if steady.is_empty() { 0.0 } else { steady.iter().sum::<f64>() / steady.len() as f64 }
}
