//! Division of logs into folds, for cross-validation.

use crate::data::{Dataset, Trajectory};

/// Largest number of folds.
const FOLDS: usize = 4;
/// Amount of data that suffices to compare configurations, in windows of the longest length; of more data only a part
/// is used.
const ENOUGH: usize = 60;
/// Largest length of a piece of a log, in windows of the longest length.
const PIECE: usize = 4;
/// Least number of pieces that a few logs are cut into.
const PIECES: usize = 2 * FOLDS;

/// Trajectories to learn from, followed by held-back ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Fold {
    /// All trajectories, training trajectories first.
    pub data: Dataset,
    /// Number of training trajectories.
    pub training: usize,
}

/// Divides trajectories into four folds, or fewer if there are fewer trajectories. Fold k holds back every fourth
/// trajectory, starting with the k-th, so that each trajectory is held back exactly once. A single trajectory gives no
/// folds.
pub fn folds(data: &Dataset) -> Vec<Fold> {
    let count = data.trajectories.len();
    let parts = if count < 2 { 0 } else { FOLDS.min(count) };
    let fold = |part: usize| {
        let (held_back, own): (Vec<usize>, Vec<usize>) = (0..count).partition(|k| k % parts == part);
        let training = own.len();
        let trajectories = own.into_iter().chain(held_back).map(|k| data.trajectories[k].clone()).collect();
        Fold { data: Dataset { trajectories, ..*data }, training }
    };
    (0..parts).map(fold).collect()
}

/// An excerpt of the data that suffices to compare configurations, with at least as many trajectories as there are
/// folds. If there are few trajectories, or much data, the trajectories are cut into pieces, and pieces from all parts
/// of them are taken. `longest` is the largest number of samples in a window.
pub(super) fn excerpt(data: &Dataset, longest: usize) -> Dataset {
    let samples: usize = data.trajectories.iter().map(Trajectory::samples).sum();
    if data.trajectories.len() >= FOLDS && samples <= ENOUGH * longest {
        return data.clone();
    }
    let piece = (PIECE * longest).min(samples / PIECES).max(1);
    let pieces: Vec<Trajectory> = data.trajectories.iter().flat_map(|log| cut(log, piece, data.h)).collect();
    let enough = (ENOUGH * longest / piece).max(PIECES);
    let every = pieces.len().div_ceil(enough).max(1);
    let of = |(k, piece): (usize, Trajectory)| Trajectory { id: k as i64, ..piece };
    let trajectories = pieces.into_iter().step_by(every).enumerate().map(of).collect();
    Dataset { trajectories, ..*data }
}

/// Cuts a trajectory into pieces of about `piece` samples.
fn cut(trajectory: &Trajectory, piece: usize, h: f64) -> Vec<Trajectory> {
    let samples = trajectory.samples();
    let count = (samples / piece).max(1);
    let at = |k: usize| k * samples / count;
    (0..count).map(|k| trajectory.part(at(k)..at(k + 1), h)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Rows;

    fn data(samples: &[usize]) -> Dataset {
        let trajectory = |(k, samples): (usize, &usize)| {
            let q: Vec<[f64; 1]> = (0..*samples).map(|sample| [(1000 * k + sample) as f64]).collect();
            Trajectory { id: k as i64, t0: 1.0, q: Rows::from_arrays(&q), v: None, a: None, u: None }
        };
        let trajectories = samples.iter().enumerate().map(trajectory).collect();
        Dataset { n: 1, h: 0.5, control: None, trajectories }
    }

    #[test]
    fn every_trajectory_is_held_back_once() {
        for count in [2, 4, 7] {
            let all = data(&vec![3; count]);
            let folds = folds(&all);
            assert_eq!(folds.len(), count.min(FOLDS));
            let mut held_back = Vec::new();
            for Fold { data, training } in &folds {
                assert_eq!(data.trajectories.len(), count);
                assert!(*training > 0);
                held_back.extend(data.trajectories[*training..].iter().map(|own| own.id));
            }
            held_back.sort_unstable();
            assert!(held_back.into_iter().eq(0..count as i64));
        }
        assert_eq!(folds(&data(&[3])), []);
    }

    #[test]
    fn few_or_long_logs_are_tried_in_pieces_from_all_over_them() {
        let short = data(&[50; 6]);
        assert_eq!(excerpt(&short, 10), short);
        let one = excerpt(&data(&[160]), 10);
        let starts: Vec<[f64; 2]> = one.trajectories.iter().map(|own| [own.t0, own.q[0][0]]).collect();
        assert_eq!((starts.len(), starts[3]), (PIECES, [1.0 + 0.5 * 60.0, 60.0]));
        let long = excerpt(&data(&[100_000, 50_000]), 10);
        let samples: usize = long.trajectories.iter().map(Trajectory::samples).sum();
        assert!((500..=700).contains(&samples), "{samples}");
        let last = long.trajectories.last().unwrap();
        assert!(last.q[0][0] >= 1000.0 + 40_000.0 && last.samples() >= 40);
    }
}
