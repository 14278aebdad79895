use super::{ImportError, Imported, lgnn, modlanet, symo};
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::lagrangian::Energies;
use leastaction_ground_truth::ManyBody;
use leastaction_programs::{Row, System};
use safetensors::tensor::{Dtype, TensorView};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Tensors by name, with shape and entries.
type File = BTreeMap<String, (Vec<usize>, Vec<f64>)>;

fn bytes(file: &File) -> Vec<u8> {
    let raw: Vec<(&String, &Vec<usize>, Vec<u8>)> = file
        .iter()
        .map(|(name, (shape, values))| (name, shape, values.iter().flat_map(|x| x.to_le_bytes()).collect()))
        .collect();
    let views = raw
        .iter()
        .map(|(name, shape, raw)| (name, TensorView::new(Dtype::F64, (*shape).clone(), raw).unwrap()));
    safetensors::serialize(views, None).unwrap()
}

/// Adds a tensor with distinct entries.
fn put(file: &mut File, name: &str, shape: &[usize]) {
    let seed = file.len() as f64;
    let values = (0..shape.iter().product()).map(|k| (1.7 * seed + 0.9 * k as f64).sin()).collect();
    file.insert(name.to_owned(), (shape.to_vec(), values));
}

/// Hidden widths of the small networks.
const WIDTHS: [usize; 2] = [9, 5];

fn small(transform_inputs: usize) -> File {
    let mut file = File::new();
    let shapes = [
        ("Global4x", transform_inputs, 2),
        ("Global4v", transform_inputs, 2),
        ("Potential1", 2, 1),
        ("Potential2", 4, 1),
    ];
    for (name, inputs, outputs) in shapes {
        let mut part = |part: &str, shape: &[usize]| put(&mut file, &format!("{name}.mlp.{part}"), shape);
        part("linear1.weight", &[WIDTHS[0], inputs]);
        part("linear1.bias", &[WIDTHS[0]]);
        part("linear2.weight", &[WIDTHS[1], WIDTHS[0]]);
        part("linear2.bias", &[WIDTHS[1]]);
        part("linear3.weight", &[outputs, WIDTHS[1]]);
    }
    for (name, shape, value) in
        [("mass.weight", vec![1, 1], 0.7), ("co1", vec![1], 1.3), ("co2", vec![1], -0.6)]
    {
        file.insert(name.to_owned(), (shape, vec![value]));
    }
    file
}

/// Output of a network in the file, written out.
fn network(file: &File, name: &str, activation: fn(f64) -> f64, x: &[f64]) -> Vec<f64> {
    let tensor = |part: &str| file.get(&format!("{name}.mlp.{part}")).map(|(_, values)| values.as_slice());
    (1..=3).fold(x.to_vec(), |x, k| {
        let rows = tensor(&format!("linear{k}.weight")).unwrap().chunks(x.len());
        let sums = rows.map(|row| row.iter().zip(&x).map(|(w, x)| w * x).sum::<f64>());
        match tensor(&format!("linear{k}.bias")) {
            Some(bias) => sums.zip(bias).map(|(sum, bias)| activation(sum + bias)).collect(),
            None => sums.collect(),
        }
    })
}

/// The authors' T and U of elements at `x` that move at `velocity`.
fn theirs(file: &File, activation: fn(f64) -> f64, x: &[[f64; 2]], velocity: &[[f64; 2]]) -> Energies<f64> {
    let number = |name: &str| file[name].1[0];
    let u = |name: &str, x: &[f64]| network(file, name, activation, x)[0];
    let (mut own, mut pairs) = (0.0, 0.0);
    for (i, a) in x.iter().enumerate() {
        own += u("Potential1", a);
        for b in &x[..i] {
            pairs += 0.5 * (u("Potential2", &[*a, *b].concat()) + u("Potential2", &[*b, *a].concat()));
        }
    }
    let m = number("mass.weight");
    let kinetic = 0.5 * m * velocity.as_flattened().iter().map(|v| v * v).sum::<f64>();
    Energies { kinetic, potential: m * (number("co1") * own + number("co2") * pairs) }
}

fn ours(imported: &Imported, q: &[f64], v: &[f64]) -> Energies<f64> {
    let program = System::new(&*imported.architecture.energies().unwrap()).energies();
    let rows = |x: &[f64]| x.iter().copied().map(Row::splat).collect::<Vec<_>>();
    let mut workspace = program.workspace();
    program.run(&imported.weights, &[&rows(q), &rows(v)], &mut workspace, &mut []);
    let [kinetic, potential] = [0, 1].map(|output| workspace.output(output)[0].0[0]);
    Energies { kinetic, potential }
}

fn assert_equal(a: Energies<f64>, b: Energies<f64>) {
    assert!((a.kinetic - b.kinetic).abs() < 1e-13 * b.kinetic.abs(), "{a:?} {b:?}");
    assert!((a.potential - b.potential).abs() < 1e-13 * (1.0 + b.potential.abs()), "{a:?} {b:?}");
}

#[test]
fn modlanet_pendulums_are_the_written_out_network() {
    let file = small(1);
    for count in [1, 2, 3] {
        let imported = modlanet(&bytes(&file), ManyBody::Pendulum(count), None).unwrap();
        let q: Vec<f64> = (0..count).map(|i| 7.5 - 5.0 * i as f64).collect();
        let v: Vec<f64> = (0..count).map(|i| 0.4 - 0.9 * i as f64).collect();
        let (mut at, mut moving) = ([0.0; 2], [0.0; 2]);
        let (mut x, mut velocity) = (Vec::new(), Vec::new());
        for (q, v) in q.iter().zip(&v) {
            let own = |name| network(&file, name, f64::tanh, &[q.rem_euclid(TAU)]);
            let (s, g) = (own("Global4x"), own("Global4v"));
            at = [0, 1].map(|i| at[i] + s[i]);
            moving = [0, 1].map(|i| moving[i] + g[i] * v);
            x.push(at);
            velocity.push(moving);
        }
        assert_equal(ours(&imported, &q, &v), theirs(&file, |z| z, &x, &velocity));
    }
}

#[test]
fn modlanet_bodies_are_the_written_out_network() {
    // The authors' files carry transforms of two inputs that nothing uses.
    let file = small(2);
    for count in [2, 3] {
        let imported = modlanet(&bytes(&file), ManyBody::Bodies(count), None).unwrap();
        let x: Vec<[f64; 2]> = (0..count).map(|i| [1.5 - i as f64, 0.3 * i as f64]).collect();
        let v: Vec<[f64; 2]> = (0..count).map(|i| [0.2 * i as f64, 0.7]).collect();
        assert_equal(ours(&imported, x.as_flattened(), v.as_flattened()), theirs(&file, f64::tanh, &x, &v));
    }
}

#[test]
fn modlanet_mass_scales_all_energies() {
    let mut file = small(1);
    file.get_mut("mass.weight").unwrap().1[0] = -0.01;
    let error = modlanet(&bytes(&file), ManyBody::Pendulum(2), None).unwrap_err().to_string();
    assert!(error.contains("mass.weight is -0.01") && error.contains("--mass 1"), "{error}");
    let (q, v) = ([1.0, 2.0], [3.0, 4.0]);
    let with = |mass| ours(&modlanet(&bytes(&file), ManyBody::Pendulum(2), Some(mass)).unwrap(), &q, &v);
    let (one, three) = (with(1.0), with(3.0));
    assert_equal(three, Energies { kinetic: 3.0 * one.kinetic, potential: 3.0 * one.potential });
}

/// The error of a pendulum's file after a change.
fn refused(change: impl FnOnce(&mut File)) -> ImportError {
    let mut file = small(1);
    change(&mut file);
    modlanet(&bytes(&file), ManyBody::Pendulum(2), None).unwrap_err()
}

#[test]
fn modlanet_errors_name_the_tensor() {
    let missing = |name: &'static str| refused(|file| drop(file.remove(name)));
    for name in ["Global4v.mlp.linear2.weight", "Potential1.mlp.linear1.bias", "co2", "mass.weight"] {
        assert!(matches!(missing(name), ImportError::Missing(found) if found == name), "{name}");
    }
    let error = refused(|file| put(file, "Global4x.mlp.linear3.bias", &[2]));
    assert!(matches!(error, ImportError::Unexpected { name, .. } if name == "Global4x.mlp.linear3.bias"));
    let error = refused(|file| put(file, "Potential2.mlp.linear2.weight", &[5, 8]));
    assert!(matches!(error, ImportError::Shape { name, .. } if name == "Potential2.mlp.linear2.weight"));
    let error = refused(|file| file.get_mut("co1").unwrap().1[0] = f64::NAN);
    assert!(matches!(error, ImportError::NotFinite { name, index: 0 } if name == "co1"));
    let error = refused(File::clear);
    assert!(matches!(error, ImportError::Unknown { .. }));
    let bodies = modlanet(&bytes(&small(2)), ManyBody::Pendulum(2), None).unwrap_err().to_string();
    assert!(bodies.contains("Global4x.mlp.linear1.weight") && bodies.contains("--system"), "{bodies}");
    for found in [0, 33, 1000] {
        let error = modlanet(&bytes(&small(1)), ManyBody::Pendulum(found), None).unwrap_err();
        assert!(matches!(error, ImportError::Count { found: count } if count == found));
    }
}

/// A pendulum of the SyMo authors' program.
fn symo_pendulum(prefix: &str) -> File {
    let mut file = File::new();
    let layers = [("MLP.MLP.0", 2, 9), ("MLP.MLP.2", 9, 5), ("fc_ld", 5, 1), ("fc_g", 5, 1)];
    for (name, inputs, outputs) in layers {
        put(&mut file, &format!("{prefix}{name}.weight"), &[outputs, inputs]);
        put(&mut file, &format!("{prefix}{name}.bias"), &[outputs]);
    }
    file
}

#[test]
fn symo_pendulums_are_the_written_out_network() {
    for (prefix, discrete) in [("nn.", true), ("Rigid_Body.", false)] {
        let file = symo_pendulum(prefix);
        let imported = symo(&bytes(&file), &[Coordinate::Angle]).unwrap();
        assert!(imported.discrete == discrete && imported.architecture.family.inertia_network().is_some());
        let (q, v) = (0.8_f64, 1.5);
        let layer = |name: &str, x: &[f64]| -> Vec<f64> {
            let get = |part| file[&format!("{prefix}{name}.{part}")].1.as_slice();
            let rows = get("weight").chunks(x.len()).zip(get("bias"));
            rows.map(|(row, bias)| bias + row.iter().zip(x).map(|(w, x)| w * x).sum::<f64>()).collect()
        };
        let tanh = |x: Vec<f64>| -> Vec<f64> { x.into_iter().map(f64::tanh).collect() };
        let units = tanh(layer("MLP.MLP.2", &tanh(layer("MLP.MLP.0", &[q.cos(), q.sin()]))));
        let inertia = layer("fc_ld", &units)[0].exp().ln_1p();
        let expected = Energies { kinetic: 0.5 * inertia * v * v, potential: layer("fc_g", &units)[0] };
        assert_equal(ours(&imported, &[q], &[v]), expected);
    }
}

#[test]
fn symo_errors_name_the_tensor() {
    let refused = |change: fn(&mut File)| {
        let mut file = symo_pendulum("nn.");
        change(&mut file);
        symo(&bytes(&file), &[Coordinate::Angle]).unwrap_err().to_string()
    };
    assert!(refused(|file| drop(file.remove("nn.fc_g.weight"))).contains("nn.fc_g.weight is missing"));
    let shape = refused(|file| put(file, "nn.MLP.MLP.0.weight", &[9, 3]));
    assert!(
        shape.contains("nn.MLP.MLP.0.weight has shape [9, 3]") && shape.contains("--coordinates"),
        "{shape}"
    );
    assert!(refused(|file| put(file, "nn.fc_lo.weight", &[1, 5])).contains("nn.fc_lo.weight has no place"));
    assert!(refused(File::clear).contains("no tensor of SyMo"));
}

/// Names, inputs and outputs of the LGNN authors' networks in the plane, with embeddings of 2 and 4 numbers for nodes
/// and 5 for edges.
const LGNN: [(&str, usize, usize); 8] = [
    ("L.ke", 3, 1),
    ("L.ff3", 6, 1),
    ("drag", 1, 1),
    ("L.fb", 1, 5),
    ("L.fv", 9, 4),
    ("L.fe", 4, 5),
    ("L.ff1", 5, 1),
    ("L.ff2", 4, 1),
];

fn lgnn_pendulums() -> File {
    let mut file = File::new();
    let mut layer = |name: String, inputs: usize, outputs: usize| {
        put(&mut file, &format!("{name}.weight"), &[outputs, inputs]);
        put(&mut file, &format!("{name}.bias"), &[outputs]);
    };
    for (name, inputs, outputs) in LGNN {
        layer(format!("{name}.0"), inputs, 3);
        layer(format!("{name}.1"), 3, 7);
        layer(format!("{name}.2"), 7, outputs);
    }
    layer("L.fneke.0".to_owned(), 1, 2);
    layer("L.fne.0".to_owned(), 1, 4);
    file
}

/// The layers of this name; all but the last have squareplus activations.
fn lgnn_network(file: &File, name: &str, x: &[f64]) -> Vec<f64> {
    let layers: Vec<_> = (0..)
        .map_while(|k| Some((file.get(&format!("{name}.{k}.weight"))?, &file[&format!("{name}.{k}.bias")])))
        .collect();
    layers.iter().enumerate().fold(x.to_vec(), |x, (k, ((_, rows), (_, bias)))| {
        let sums = rows
            .chunks(x.len())
            .zip(bias)
            .map(|(row, bias)| bias + row.iter().zip(&x).map(|(w, x)| w * x).sum::<f64>());
        let hidden = k + 1 < layers.len();
        sums.map(|y| if hidden { 0.5 * (y + (y * y + 4.0).sqrt()) } else { y }).collect()
    })
}

/// The authors' T and V of a chain, with an edge in each direction between neighbours.
fn lgnn_theirs(file: &File, x: &[[f64; 2]], v: &[[f64; 2]]) -> Energies<f64> {
    let net = |name: &str, x: &[&[f64]]| lgnn_network(file, name, &x.concat());
    let number = |name: &str, x: &[&[f64]]| net(name, x)[0];
    let [kinetic, own] = ["L.fneke", "L.fne"].map(|name| net(name, &[&[1.0]]));
    let kinetic = v.iter().map(|v| number("L.ke", &[&kinetic, &[v[0] * v[0] + v[1] * v[1]]])).sum();
    let edge = |a: usize, b: usize| net("L.fb", &[&[(x[a][0] - x[b][0]).hypot(x[a][1] - x[b][1])]]);
    let neighbours = |i: usize| (0..x.len()).filter(move |j| i.abs_diff(*j) == 1);
    let node = |i: usize| -> Vec<f64> {
        let messages = neighbours(i).map(|j| net("L.fv", &[&own, &edge(i, j)]));
        messages.fold(own.clone(), |sum, message| sum.iter().zip(message).map(|(a, b)| a + b).collect())
    };
    let mut potential = 0.0;
    for (i, x) in x.iter().enumerate() {
        potential += number("L.ff3", &[&own, x]) + number("L.ff2", &[&node(i)]);
        for j in neighbours(i) {
            let product: Vec<f64> = node(i).iter().zip(node(j)).map(|(a, b)| a * b).collect();
            let update = net("L.fe", &[&product]);
            let sum: Vec<f64> = edge(i, j).iter().zip(update).map(|(a, b)| a + b).collect();
            potential += number("L.ff1", &[&sum]);
        }
    }
    Energies { kinetic, potential }
}

#[test]
fn lgnn_pendulums_are_the_written_out_network() {
    let file = lgnn_pendulums();
    for count in [1, 2, 3] {
        let imported = lgnn(&bytes(&file), count, false).unwrap();
        assert!(!imported.discrete);
        let x: Vec<[f64; 2]> = (0..count).map(|i| [0.6 - i as f64, -0.7 * i as f64 - 0.4]).collect();
        let v: Vec<[f64; 2]> = (0..count).map(|i| [0.2 * i as f64, 0.7]).collect();
        let found = ours(&imported, x.as_flattened(), v.as_flattened());
        assert_equal(found, lgnn_theirs(&file, &x, &v));
    }
}

#[test]
fn lgnn_errors_name_the_tensor() {
    let refused = |change: fn(&mut File)| {
        let mut file = lgnn_pendulums();
        change(&mut file);
        lgnn(&bytes(&file), 2, true).unwrap_err().to_string()
    };
    assert!(refused(|file| drop(file.remove("L.fe.1.weight"))).contains("L.fe.1.weight is missing"));
    assert!(refused(|file| drop(file.remove("L.fne.0.bias"))).contains("L.fne.0.bias is missing"));
    assert!(refused(|file| put(file, "L.fne.0.weight", &[4, 2])).contains("L.fne.0.weight has shape [4, 2]"));
    assert!(refused(|file| put(file, "L.fne.1.bias", &[4])).contains("L.fne.1.bias has no place"));
    assert!(refused(|file| file.get_mut("drag.0.bias").unwrap().1[2] = f64::NAN).contains("drag.0.bias"));
    assert!(refused(File::clear).contains("no tensor of LGNN"));
    let wrong = refused(|file| put(file, "L.ff3.0.weight", &[3, 9]));
    assert!(wrong.contains("number of dimensions"), "{wrong}");
}
