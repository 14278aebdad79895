//! Inputs of the targets that read training's inputs and outputs.

use super::logs::motions;
use super::{Done, Seeds};
use leastaction_fuzz::CHECKPOINT;
use leastaction_learning::config::Config;
use leastaction_learning::run::{Monitor, Plan, Row, Run};
use safetensors::tensor::{Dtype, TensorView};
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Writes the seeds of all these targets.
pub fn seeds(corpus: &Path) -> Done {
    weights(&mut Seeds::of(corpus, "safetensors")?)?;
    checkpoints(&mut Seeds::of(corpus, "checkpoint")?)
}

/// Writes tiny tensors of each of the three programs.
fn weights(seeds: &mut Seeds) -> Done {
    let layers = |names: &[(&str, usize, usize)]| -> Vec<(String, Vec<usize>)> {
        names
            .iter()
            .flat_map(|(name, inputs, outputs)| {
                [
                    (format!("{name}.weight"), vec![*outputs, *inputs]),
                    (format!("{name}.bias"), vec![*outputs]),
                ]
            })
            .collect()
    };
    let symo =
        layers(&[("nn.MLP.MLP.0", 2, 2), ("nn.MLP.MLP.2", 2, 2), ("nn.fc_ld", 2, 1), ("nn.fc_g", 2, 1)]);
    seeds.add(&[&[0], &tensors(&symo)?[..]].concat())?;
    let mut modlanet = Vec::new();
    for (name, inputs, outputs) in
        [("Global4x", 1, 2), ("Global4v", 1, 2), ("Potential1", 2, 1), ("Potential2", 4, 1)]
    {
        let at = |part: &str| format!("{name}.mlp.{part}");
        modlanet.extend([
            (at("linear1.weight"), vec![2, inputs]),
            (at("linear1.bias"), vec![2]),
            (at("linear2.weight"), vec![2, 2]),
            (at("linear2.bias"), vec![2]),
            (at("linear3.weight"), vec![outputs, 2]),
        ]);
    }
    modlanet.extend([
        ("mass.weight".to_owned(), vec![1, 1]),
        ("co1".to_owned(), vec![1]),
        ("co2".to_owned(), vec![1]),
    ]);
    let modlanet = tensors(&modlanet)?;
    seeds.add(&[&[1], &modlanet[..]].concat())?;
    seeds.add(&[&[2], &modlanet[..]].concat())?;
    let mut lgnn = Vec::new();
    let networks = [
        ("L.ke", 3, 1),
        ("L.ff3", 6, 1),
        ("drag", 1, 1),
        ("L.fb", 1, 2),
        ("L.fv", 6, 4),
        ("L.fe", 4, 2),
        ("L.ff1", 2, 1),
        ("L.ff2", 4, 1),
    ];
    for (name, inputs, outputs) in networks {
        let (first, second) = (format!("{name}.0"), format!("{name}.1"));
        lgnn.extend(layers(&[(&first, inputs, 2), (&second, 2, outputs)]));
    }
    lgnn.extend(layers(&[("L.fneke.0", 1, 2), ("L.fne.0", 1, 4)]));
    seeds.add(&[&[3], &tensors(&lgnn)?[..]].concat())
}

fn tensors(shapes: &[(String, Vec<usize>)]) -> Done<Vec<u8>> {
    let values = |shape: &[usize]| {
        (0..shape.iter().product::<usize>())
            .flat_map(|k| (0.3 + 0.1 * k as f32).to_le_bytes())
            .collect::<Vec<_>>()
    };
    let raw: Vec<_> = shapes.iter().map(|(name, shape)| (name, shape, values(shape))).collect();
    let views: Result<Vec<_>, _> = raw
        .iter()
        .map(|(name, shape, raw)| {
            Ok::<_, safetensors::SafeTensorError>((name, TensorView::new(Dtype::F32, (*shape).clone(), raw)?))
        })
        .collect();
    Ok(safetensors::serialize(views?, None)?)
}

/// A monitor without output.
struct Silent;

impl Monitor for Silent {
    fn row(&mut self, _: &Row) {}
    fn warning(&mut self, _: &str) {}
}

/// Writes checkpoints of short runs of several families, losses and optimisers, without the parts that the target adds.
fn checkpoints(seeds: &mut Seeds) -> Done {
    let motions = motions(9)?;
    for (model, training) in [
        ("coordinates = \"a\"\nhidden = [2]", "iterations = 3"),
        (
            "coordinates = \"a\"\nhidden = [2]\n[model.friction]\nviscous = \"learned\"\ncoulomb = \"learned\"",
            "iterations = 2",
        ),
        ("coordinates = \"a\"\nhidden = [2]", "optimiser = \"adam\"\niterations = 2"),
        ("family = \"bodies\"\nchain = 1", "loss = \"next-position\"\niterations = 2"),
        ("coordinates = \"a\"\nhidden = [2]", "loss = \"windows\"\niterations = 2"),
    ] {
        let text = format!("[data]\nfile = \"x.npz\"\n[model]\n{model}\n[training]\n{training}\n");
        let config = Config::parse(&text, Path::new("seed.toml"))?;
        let folder = tempfile::tempdir()?;
        let mut run = Run::begin(Plan::new(config, &motions)?, &folder.path().join("run"), false)?;
        run.train(&mut Silent, &AtomicBool::new(false))?;
        let bytes = fs::read(folder.path().join("run/checkpoint.postcard"))?;
        seeds.add(&bytes[CHECKPOINT.len()..bytes.len() - 8])?;
    }
    Ok(())
}
