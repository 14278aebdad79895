use crate::config::Config;
use leastaction_core::forces::{Coulomb, DryFriction, Forces};
use leastaction_models::Model;
use leastaction_models::forces::Driven;
use leastaction_programs::WIDTH;
use std::path::Path;

/// Number of states: more than one block, with the last block incomplete.
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
    for (state, force) in states.iter().zip(Model::new(architecture, weights).forces_at(&states).unwrap()) {
        let [q, v, tau]: [[f64; 2]; 3] =
            [&state.q, &state.v, &state.tau].map(|x| x.as_slice().try_into().unwrap());
        let [first, second] = law.force(&q, &v, &tau);
        let expected = [first - 0.3 * v[0], second];
        assert!((0..2).all(|i| (force[i] - expected[i]).abs() < 1e-14), "{force:?} {expected:?}");
    }
}
