//! The layout of the SyMo authors' data sets (Santos et al., L4DC 2022).
//!
//! One `.npz` file. `train_x`, `test_x`, `int_x`: \[trajectories, samples, 2n\], positions then velocities. `train_u`,
//! `test_u`, `int_u`: \[trajectories, samples\], the generalised force at the one actuated coordinate. The step is not
//! in the file. The authors take the control as linear between samples, (h/4)(u₋ + 2u + u₊) in their equation; in their
//! sets it is constant within a trajectory. Any real element type is read, float64 is written. Other arrays (the
//! authors add the start states `x0`, `int_x0`) are ignored and not written.

use std::fs;
use std::path::Path;

use leastaction_core::forces::ControlKind;

use crate::archive::{Archive, Array};
use crate::dataset::{expect, positive};
use crate::error::{DataError, Fault};
use crate::npz::Writer;
use crate::place::Place;
use crate::problem::Problem;
use crate::{Dataset, MIN_SAMPLES, Rows, Trajectory, located, store};

/// The three parts of a data set.
#[derive(Debug, Clone, PartialEq)]
pub struct SymoSet {
    /// Forced motions for training.
    pub train: Dataset,
    /// Forced motions for testing one step ahead.
    pub test: Dataset,
    /// Long free motions for testing the integration.
    pub integration: Dataset,
}

/// Keys of the states and controls of each part.
const PARTS: [(&str, &str); 3] = [("train_x", "train_u"), ("test_x", "test_u"), ("int_x", "int_u")];

/// Reads a data set of step `h` (s) whose control acts on coordinate `actuated` (from 0).
///
/// Every trajectory has `v` and `u` (zero at the other coordinates), starts at t = 0 and is numbered from 0 in its part.
///
/// # Errors
/// [`DataError`] with the file, key and row, for a part that is missing, of the wrong shape, or not finite, and for an `h` or `actuated`
/// out of range.
pub fn read(path: impl AsRef<Path>, h: f64, actuated: usize) -> Result<SymoSet, DataError> {
    let path = path.as_ref();
    located(path, || {
        positive(h).map_err(|problem| (Place::File, problem))?;
        let bytes = fs::read(path).map_err(|error| (Place::File, error.into()))?;
        let archive = Archive::open(&bytes)?;
        let [train, test, integration] = PARTS;
        let part = |keys| PlacedNetwork::find(&archive, keys)?.into_dataset(h, actuated);
        let set = SymoSet { train: part(train)?, test: part(test)?, integration: part(integration)? };
        for (key, part) in [("test_x", &set.test), ("int_x", &set.integration)] {
            same_width(key, part.n, set.train.n)?;
        }
        Ok(set)
    })
}

fn same_width(key: &str, found: usize, expected: usize) -> Result<(), Fault> {
    expect("q", "columns", found, expected).map_err(|problem| (Place::Key(key.to_owned()), problem))
}

/// Writes the layout; the control must be zero except at coordinate `actuated` (from 0).
///
/// The file is replaced atomically. Ids, start times and accelerations are not part of the layout and are lost.
///
/// # Errors
/// [`DataError`]; also for trajectories of unequal length within a part, without `v` or `u`, with a second control, or with a held control
/// that changes.
pub fn write(path: impl AsRef<Path>, set: &SymoSet, actuated: usize) -> Result<(), DataError> {
    let path = path.as_ref();
    located(path, || {
        let mut writer = Writer::new();
        for (keys, part) in PARTS.into_iter().zip([&set.train, &set.test, &set.integration]) {
            part.check()?;
            same_width(keys.0, part.n, set.train.n)?;
            if part.control == Some(ControlKind::Held) && part.control_changes() {
                return Err((Place::Key(keys.1.to_owned()), Problem::HeldControl));
            }
            add_part(&mut writer, keys, part, actuated)?;
        }
        store(path, &writer.finish()?)
    })
}

/// The arrays of a part, with checked shapes.
struct PlacedNetwork<'a> {
    states: Array<'a>,
    controls: Array<'a>,
    samples: usize,
    n: usize,
}

impl<'a> PlacedNetwork<'a> {
    fn find(archive: &'a Archive, (states, controls): (&'static str, &'static str)) -> Result<Self, Fault> {
        let (states, controls) = (archive.require(states)?, archive.require(controls)?);
        let [trajectories, samples, width] = *states.shape() else {
            return Err(states.wrong_shape("[trajectories, samples, 2n]".to_owned()));
        };
        if trajectories == 0 || samples < MIN_SAMPLES || width == 0 || width % 2 != 0 {
            let expected = format!("[trajectories, samples, 2n] with at least {MIN_SAMPLES} samples");
            return Err(states.wrong_shape(expected));
        }
        if controls.shape() != [trajectories, samples] && controls.shape() != [trajectories, samples, 1] {
            return Err(controls.wrong_shape(format!("[{trajectories}, {samples}]")));
        }
        Ok(Self { states, controls, samples, n: width / 2 })
    }

    fn into_dataset(self, h: f64, actuated: usize) -> Result<Dataset, Fault> {
        let n = self.n;
        if actuated >= n {
            return Err(self.controls.fault(Problem::BadActuated { index: actuated, n }));
        }
        let (x, u) =
            (self.states.finite_reals(self.samples * 2 * n)?, self.controls.finite_reals(self.samples)?);
        let states = x.chunks_exact(self.samples * 2 * n);
        let trajectories = (0..).zip(states.zip(u.chunks_exact(self.samples)));
        let trajectories = trajectories.map(|(id, (x, u))| trajectory(id, n, x, u, actuated));
        let trajectories = trajectories.collect::<Option<_>>().ok_or((Place::File, Problem::Empty))?;
        Ok(Dataset { n, h, control: Some(ControlKind::Linear), trajectories })
    }
}

fn trajectory(id: i64, n: usize, x: &[f64], u: &[f64], actuated: usize) -> Option<Trajectory> {
    let states = || x.chunks_exact(2 * n);
    let u = u.iter().flat_map(|&u| (0..n).map(move |i| if i == actuated { u } else { 0.0 }));
    Some(Trajectory {
        id,
        t0: 0.0,
        q: Rows::from_rows(n, states().filter_map(|x| x.get(..n)))?,
        v: Some(Rows::from_rows(n, states().filter_map(|x| x.get(n..)))?),
        a: None,
        u: Some(Rows::from_flat(n, u.collect())?),
    })
}

fn add_part(writer: &mut Writer, keys: (&str, &str), part: &Dataset, actuated: usize) -> Result<(), Fault> {
    let (n, samples) = (part.n, part.trajectories.first().map_or(0, Trajectory::samples));
    let (mut x, mut u) = (Vec::new(), Vec::new());
    for trajectory in &part.trajectories {
        append(trajectory, n, samples, actuated, &mut x, &mut u)
            .map_err(|problem| (Place::Trajectory(trajectory.id), problem))?;
    }
    let trajectories = part.trajectories.len();
    writer.add(keys.0, &[trajectories, samples, 2 * n], &x)?;
    writer.add(keys.1, &[trajectories, samples], &u)
}

fn append(
    trajectory: &Trajectory,
    n: usize,
    samples: usize,
    actuated: usize,
    x: &mut Vec<f64>,
    u: &mut Vec<f64>,
) -> Result<(), Problem> {
    expect("q", "samples", trajectory.samples(), samples)?;
    let v = trajectory.v.as_ref().ok_or(Problem::MissingKey("v"))?;
    for (q, v) in trajectory.q.iter().zip(v) {
        x.extend_from_slice(q);
        x.extend_from_slice(v);
    }
    for row in trajectory.u.as_ref().ok_or(Problem::MissingKey("u"))? {
        u.push(row.get(actuated).copied().ok_or(Problem::BadActuated { index: actuated, n })?);
        let other = row.iter().zip(0..).find(|&(&u, i)| i != actuated && u != 0.0);
        other.map_or(Ok(()), |(_, i)| Err(Problem::SecondControl(i)))?;
    }
    Ok(())
}
