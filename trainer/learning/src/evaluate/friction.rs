//! The forces of a model beside its energies: friction by formulas and by networks.

use super::systems::system;
use crate::architecture::Architecture;
use leastaction_core::model::ModelError;
use leastaction_programs::{Row, WIDTH};

/// A state under a control force.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven {
    /// m or rad.
    pub q: Vec<f64>,
    /// m/s or rad/s.
    pub v: Vec<f64>,
    /// N or N m.
    pub tau: Vec<f64>,
}

/// Q(q, v, τ) beside the control, N or N m, at every one of these states.
///
/// # Errors
/// Where the shape does not fit in itself or the weights.
pub fn forces_at(
    architecture: &Architecture,
    weights: &[f64],
    states: &[Driven],
) -> Result<Vec<Vec<f64>>, ModelError> {
    let system = system(architecture, weights)?;
    let (n, program) = (system.n(), system.force());
    let (mut workspace, mut all) = (program.workspace(), Vec::new());
    for block in states.chunks(WIDTH) {
        let rows = |of: &dyn Fn(&Driven) -> &[f64]| -> Vec<Row> {
            let at =
                |lane: usize, i: usize| block.get(lane).or(block.last()).map_or(0.0, |state| of(state)[i]);
            (0..n).map(|i| Row(std::array::from_fn(|lane| at(lane, i)))).collect()
        };
        let [q, v, tau] = [rows(&|of| &of.q), rows(&|of| &of.v), rows(&|of| &of.tau)];
        program.run_outputs(weights, &[&q, &v, &tau], &mut workspace);
        let force = workspace.output(0);
        all.extend((0..block.len()).map(|lane| force.iter().map(|row| row.0[lane]).collect()));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use leastaction_core::forces::{Coulomb, DryFriction, Forces};
    use std::path::Path;

    /// More states than run side by side, the last block not full.
    const STATES: usize = WIDTH + 3;

    #[test]
    fn forces_are_those_of_the_law() {
        let text = "[data]\nfile = \"a.csv\"\n[model]\nfamily = \"bodies\"\nchain = 2\n\
                    friction = { viscous = [0.3, 0.0], coulomb = [0.5, 0.2], load = [0.1, 0.4], width = 0.2, smoothing = 0.1 }\n";
        let (architecture, weights) = Config::parse(text, Path::new("c.toml")).unwrap().beginning().unwrap();
        let state = |k: usize| {
            let x = k as f64;
            Driven { q: vec![x, -x], v: vec![x.sin(), 0.1 * x], tau: vec![-x, 0.3 * x] }
        };
        let states: Vec<Driven> = (0..STATES).map(state).collect();
        let dry = |constant: f64, load: f64| DryFriction { constant, load, smoothing: 0.1, width: 0.2 };
        let law = Coulomb { coordinates: [dry(0.5, 0.1), dry(0.2, 0.4)] };
        for (state, force) in states.iter().zip(forces_at(&architecture, &weights, &states).unwrap()) {
            let [q, v, tau]: [[f64; 2]; 3] =
                [&state.q, &state.v, &state.tau].map(|x| x.as_slice().try_into().unwrap());
            let [first, second] = law.force(&q, &v, &tau);
            let expected = [first - 0.3 * v[0], second];
            assert!((0..2).all(|i| (force[i] - expected[i]).abs() < 1e-14), "{force:?} {expected:?}");
        }
    }
}
