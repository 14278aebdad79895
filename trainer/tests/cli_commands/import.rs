//! `import`.

use crate::support::Bench;
use safetensors::tensor::{Dtype, TensorView};
use std::fs;

/// A file with these tensors of single precision, all entries 0.5.
fn tensors(bench: &Bench, name: &str, tensors: &[(&str, &[usize])]) {
    let raw: Vec<Vec<u8>> = tensors
        .iter()
        .map(|(_, shape)| (0..shape.iter().product()).flat_map(|_| 0.5_f32.to_le_bytes()).collect())
        .collect();
    let views = tensors
        .iter()
        .zip(&raw)
        .map(|((name, shape), raw)| (*name, TensorView::new(Dtype::F32, shape.to_vec(), raw).unwrap()));
    fs::write(bench.at(name), safetensors::serialize(views, None).unwrap()).unwrap();
}

/// A network of two hidden layers of 3 units as the ModLaNet authors name it, for elements of one coordinate or two.
fn modlanet(bench: &Bench, coordinates: usize) {
    let mut shapes: Vec<(String, Vec<usize>)> = Vec::new();
    let networks = [
        ("Global4x", coordinates, 2),
        ("Global4v", coordinates, 2),
        ("Potential1", 2, 1),
        ("Potential2", 4, 1),
    ];
    for (network, inputs, outputs) in networks {
        for (part, shape) in [
            ("linear1.weight", vec![3, inputs]),
            ("linear1.bias", vec![3]),
            ("linear2.weight", vec![3, 3]),
            ("linear2.bias", vec![3]),
            ("linear3.weight", vec![outputs, 3]),
        ] {
            shapes.push((format!("{network}.mlp.{part}"), shape));
        }
    }
    for (name, shape) in [("mass.weight", vec![1, 1]), ("co1", vec![1]), ("co2", vec![1])] {
        shapes.push((name.to_owned(), shape));
    }
    let named: Vec<_> = shapes.iter().map(|(name, shape)| (name.as_str(), shape.as_slice())).collect();
    tensors(bench, "n.safetensors", &named);
}

#[test]
fn modlanet_pendulums_become_a_model() {
    let bench = Bench::new();
    modlanet(&bench, 1);
    let report = bench.run("import modlanet n.safetensors -o m.postcard --json").good().json();
    assert_eq!(report["coordinates"].as_str(), Some("aa"));
    assert_eq!(report["bytes"].as_u64(), Some(bench.read("m.postcard").len() as u64));
    let network = |inputs: u64, outputs: u64| 3 * inputs + 3 + 9 + 3 + 3 * outputs + outputs;
    let parameters = 2 * network(1, 2) + network(2, 1) + network(4, 1) + 5 + 2;
    assert_eq!(report["parameters"].as_u64(), Some(parameters));
    let inspected = bench.run("inspect m.postcard --json").good().json();
    assert_eq!(inspected["types"][0]["mass"].as_f64(), Some(0.5));
    assert_eq!(inspected["trees"][0]["elements"], serde_json::json!(["0 bob", "1 bob on 0"]));
    assert_eq!(inspected["provenance"].as_str(), Some("imported from n.safetensors (ModLaNet)"));
    let longer = bench.run("import modlanet n.safetensors --count 4 -o m.postcard").good().stdout;
    assert!(longer.contains("coordinates aaaa, no step"), "{longer}");
}

#[test]
fn modlanet_bodies_become_a_model() {
    let bench = Bench::new();
    modlanet(&bench, 2);
    bench
        .run("import modlanet n.safetensors -o m.postcard")
        .bad(2, &["n.safetensors", "Global4x.mlp.linear1.weight", "[3, 2]", "--system"]);
    assert!(!bench.at("m.postcard").exists());
    bench.run("import modlanet n.safetensors --system body --mass 2 -o m.postcard").good();
    let inspected = bench.run("inspect m.postcard --json").good().json();
    assert_eq!(inspected["types"][0]["mass"].as_f64(), Some(2.0));
    assert_eq!(inspected["trees"][0]["elements"], serde_json::json!(["0 body", "1 body", "2 body"]));
}

#[test]
fn modlanet_refuses_what_it_cannot_use() {
    let bench = Bench::new();
    modlanet(&bench, 1);
    bench.run("import modlanet n.safetensors --count 33 -o m.postcard").bad(2, &["33 elements", "--count"]);
    bench.run("import modlanet n.safetensors --mass 0 -o m.postcard").bad(2, &["--mass", "above 0"]);
    bench.run("import modlanet no.safetensors -o m.postcard").bad(2, &["no.safetensors"]);
    bench.run("import modlanet n.safetensors -o no/such/m.postcard").bad(1, &["no/such/m.postcard"]);
    bench.write("n.safetensors", "not tensors");
    bench.run("import modlanet n.safetensors -o m.postcard").bad(2, &["not a safetensors file"]);
}

/// A network of the LGNN authors': hidden layers of 3 units, embeddings of 2 and 4 numbers, in the plane.
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

fn lgnn(bench: &Bench, networks: &[(&str, usize, usize)]) {
    let mut shapes: Vec<(String, Vec<usize>)> = Vec::new();
    let mut layer = |name: String, inputs: usize, outputs: usize| {
        shapes.push((format!("{name}.weight"), vec![outputs, inputs]));
        shapes.push((format!("{name}.bias"), vec![outputs]));
    };
    for (name, inputs, outputs) in networks {
        layer(format!("{name}.0"), *inputs, 3);
        layer(format!("{name}.1"), 3, *outputs);
    }
    layer("L.fneke.0".to_owned(), 1, 2);
    layer("L.fne.0".to_owned(), 1, 4);
    let named: Vec<_> = shapes.iter().map(|(name, shape)| (name.as_str(), shape.as_slice())).collect();
    tensors(bench, "n.safetensors", &named);
}

#[test]
fn lgnn_pendulums_become_a_model() {
    let bench = Bench::new();
    lgnn(&bench, &LGNN);
    let report = bench.run("import lgnn n.safetensors --count 2 -o m.postcard --json").good().json();
    let networks: usize =
        LGNN.iter().map(|(_, inputs, outputs)| 3 * inputs + 3 + 3 * outputs + outputs).sum();
    assert_eq!(report["parameters"].as_u64(), Some(networks as u64 + 2 + 2 + 2 + 4 + 2));
    assert_eq!(report["coordinates"].as_str(), Some("tttt"));
    let inspected = bench.run("inspect m.postcard --json").good().json();
    assert_eq!(inspected["provenance"].as_str(), Some("imported from n.safetensors (LGNN)"));
    assert_eq!(inspected["graphs"][0]["rods"].as_u64(), Some(2));
    assert_eq!(inspected["graphs"][0]["edges"].as_u64(), Some(1));
    assert!(!inspected["nodes"][0].as_str().unwrap().contains("drag"), "{inspected}");
    bench.run("import lgnn n.safetensors --drag -o m.postcard").good();
    let inspected = bench.run("inspect m.postcard --json").good().json();
    assert!(inspected["nodes"][0].as_str().unwrap().contains("drag 1-3-1"), "{inspected}");
}

#[test]
fn lgnn_refuses_what_it_cannot_use() {
    let bench = Bench::new();
    bench.write("n.safetensors", "not tensors");
    bench.run("import lgnn n.safetensors -o m.postcard").bad(2, &["not a safetensors file"]);
    lgnn(&bench, &LGNN[..7]);
    bench.run("import lgnn n.safetensors -o m.postcard").bad(2, &["L.ff2.0.bias is missing"]);
    bench.run("import lgnn n.safetensors --count 33 -o m.postcard").bad(2, &["33 elements", "--count"]);
    let mut other = LGNN;
    other[4].1 = 8;
    lgnn(&bench, &other);
    bench.run("import lgnn n.safetensors -o m.postcard").bad(2, &["network of the messages"]);
    lgnn(&bench, &[&LGNN[..], &[("L.ff4", 1, 1)]].concat());
    bench.run("import lgnn n.safetensors -o m.postcard").bad(2, &["L.ff4.", "no place"]);
    assert!(!bench.at("m.postcard").exists());
}

#[test]
fn symo_becomes_a_model() {
    let bench = Bench::new();
    let layers: [(&str, &[usize]); 6] = [
        ("nn.MLP.MLP.0.weight", &[4, 2]),
        ("nn.MLP.MLP.0.bias", &[4]),
        ("nn.fc_ld.weight", &[1, 4]),
        ("nn.fc_ld.bias", &[1]),
        ("nn.fc_g.weight", &[1, 4]),
        ("nn.fc_g.bias", &[1]),
    ];
    tensors(&bench, "n.safetensors", &layers);
    let report = bench.run("import symo n.safetensors --system pendulum -o m.postcard --json").good().json();
    assert_eq!((report["coordinates"].as_str(), report["parameters"].as_u64()), (Some("a"), Some(22)));
    let inspected = bench.run("inspect m.postcard --json").good().json();
    assert_eq!(inspected["layers"], serde_json::json!([[2, 4], [4, 2]]));
    tensors(&bench, "n.safetensors", &layers[..5]);
    bench
        .run("import symo n.safetensors --system pendulum -o m.postcard")
        .bad(2, &["n.safetensors", "nn.fc_g.bias is missing"]);
}
