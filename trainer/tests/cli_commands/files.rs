//! `export` and `inspect`.

use crate::support::Bench;
use leastaction_core::constraints::Holonomic;
use leastaction_core::continuous::acceleration;
use leastaction_core::discrete::{Midpoint, Order};
use leastaction_core::energy::graph::{Edge, Graph};
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::forces::{ControlKind, Viscous};
use leastaction_core::model::{ArmModel, Laws, TrainedStep};
use leastaction_core::particles::Particles;
use leastaction_learning::config::Config;
use leastaction_models::file::{ConstantsError, decode, encode, encode_in, rust_constants, rust_source};
use leastaction_models::{Actuator, Architecture, Facts, InertiaNetworkArchitecture, Precision};

#[path = "../cli_golden/model.rs"]
mod golden;
#[path = "../cli_golden/arm_constants.rs"]
#[allow(dead_code, reason = "of an arm only the system is looked at")]
mod golden_arm_constants;
#[path = "../cli_golden/constants.rs"]
mod golden_constants;
#[path = "../cli_golden/graphs.rs"]
mod golden_graphs;
#[path = "../cli_golden/lagging.rs"]
mod golden_lagging;
#[path = "../cli_golden/lagging_constants.rs"]
mod golden_lagging_constants;
#[path = "../cli_golden/late.rs"]
mod golden_late;
#[path = "../cli_golden/late_constants.rs"]
mod golden_late_constants;
#[path = "../cli_golden/trees.rs"]
mod golden_trees;

fn trained() -> Bench {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 2");
    bench.run("train c.toml -o run -q").good();
    bench
}

#[test]
fn exported_files_agree() {
    let bench = trained();
    let report = bench.run("export run -o m.postcard --rust m.rs --json").good().json();
    let bytes = bench.read("m.postcard");
    assert_eq!(report["bytes"].as_u64(), Some(bytes.len() as u64));
    let model = decode(&bytes).unwrap();
    assert_eq!(
        model.facts.trained_step,
        Some(TrainedStep { order: Order::Two, h: 0.1, control: ControlKind::Held })
    );
    assert_eq!(report["parameters"].as_u64(), Some(model.weights.len() as u64));
    assert_eq!(report["provenance"].as_str(), Some(model.facts.provenance.as_str()));
    assert!(
        model.facts.provenance.contains("next-position by levenberg-marquardt, seed 0"),
        "{}",
        model.facts.provenance
    );
    assert_eq!(bench.text("m.rs"), rust_source(&bytes).unwrap());
}

#[test]
fn half_the_flash_has_a_price_that_is_told() {
    let bench = trained();
    let single = bench.run("export run -o m.postcard --json").good().json();
    assert!(single["accuracy"].is_null());
    let half = bench.run("export run -o half.postcard --rust half.rs --weights f16 --json").good().json();
    assert_eq!((single["weight_bits"].as_u64(), half["weight_bits"].as_u64()), (Some(32), Some(16)));
    let saved = single["bytes"].as_u64().unwrap() - half["bytes"].as_u64().unwrap();
    assert!(saved.abs_diff(2 * half["parameters"].as_u64().unwrap()) <= 4, "{saved}");
    let error = |of: &str| half["accuracy"][of]["one_step"].as_f64().unwrap();
    assert!(error("trained") > 0.0 && error("shipped") != error("trained"));
    let evaluated = |model: &str| {
        let report = bench.run(&format!("evaluate {model} --data data.npz --json")).good().json();
        report["one_step_mse"].as_f64().unwrap()
    };
    let found = evaluated("half.postcard").sqrt();
    assert!((found - error("shipped")).abs() <= 1e-12 * found, "{found} {}", error("shipped"));
    assert!(bench.text("half.rs").contains("InertiaNetworkModel<'static, N, H, L, f16>"));
    let text = bench.run("export run -o half.postcard --weights f16").good().stdout;
    assert!(text.contains("parameters of 16 bits") && text.contains("positions one step ahead"), "{text}");
    let text = bench.run("inspect half.postcard").good().stdout;
    assert!(text.contains("of 16 bits"), "{text}");
}

#[test]
fn without_the_log_the_price_is_not_known() {
    let bench = trained();
    std::fs::rename(bench.at("data.npz"), bench.at("moved.npz")).unwrap();
    let said = bench.run("export run -o half.postcard --weights f16").good();
    assert!(
        said.stderr.contains("data.npz") && said.stderr.contains("name the log with --data"),
        "{}",
        said.stderr
    );
    let said = bench.run("export run -o half.postcard --weights f16 --data moved.npz").good();
    assert!(said.stdout.contains("moved.npz"), "{}", said.stdout);
    std::fs::remove_file(bench.at("half.postcard")).unwrap();
    bench.run("export run -o half.postcard --weights f16 --data none.npz").bad(2, &["none.npz"]);
    assert!(!bench.at("half.postcard").exists());
}

#[test]
fn export_needs_a_run() {
    let bench = Bench::new();
    bench.run("export nothing -o m.postcard").bad(2, &["nothing/checkpoint.postcard", "training run"]);
    assert!(!bench.at("m.postcard").exists());
    let bench = trained();
    bench.run("export run -o no/such/m.postcard").bad(1, &["no/such/m.postcard"]);
}

#[test]
fn inspect_counts_and_measures() {
    let bench = trained();
    bench.model("run");
    let report = bench.run("inspect run.postcard --json").good().json();
    assert_eq!(report["layers"], serde_json::json!([[2, 6], [6, 2]]));
    assert_eq!((report["coordinates"][0].as_str(), report["order"].as_u64()), (Some("angle"), Some(2)));
    assert_eq!(report["h"].as_f64(), Some(0.1));
    assert_eq!(report["parameters"].as_u64(), Some(2 * 6 + 6 + 6 * 2 + 2));
    assert_eq!(report["flash_bytes"].as_u64(), Some(bench.read("run.postcard").len() as u64));
    assert_eq!(report["cost"]["acceleration"]["multiply_adds"].as_u64(), Some(2 * 24));
    let text = bench.run("inspect run.postcard").good().stdout;
    assert!(text.contains("order 2, step 0.1 s") && text.contains("Newton iteration, order 4"), "{text}");
}

#[test]
fn inspect_predicts_what_an_image_takes() {
    let bench = trained();
    bench.model("run");
    let report = bench.run("inspect run.postcard --target cortex-m4f --json").good().json();
    let target = &report["target"];
    let instructions = |of: &str| target[of]["instructions"].as_u64().unwrap();
    assert!(instructions("acceleration") < instructions("step_order_2"), "{target}");
    assert!(instructions("step_order_2") < instructions("step_order_4"), "{target}");
    assert_eq!(target["model_bytes"], report["flash_bytes"]);
    let text = bench.run("inspect run.postcard --target cortex-m7").good().stdout;
    assert!(text.contains("predicted for a cortex-m7") && text.contains("code bytes"), "{text}");
    bench.run("export run -o half.postcard --weights f16").good();
    bench.run("inspect half.postcard --target cortex-m4f").bad(2, &["half.postcard", "half precision"]);
    bench.run("inspect run.postcard --target z80").bad(2, &["cortex-m4f"]);
}

#[test]
fn inspect_refuses_what_is_no_model() {
    let bench = trained();
    let good = bench.model("run");
    let refused = |bytes: &[u8], words: &[&str]| {
        std::fs::write(bench.at("bad.postcard"), bytes).unwrap();
        bench.run("inspect bad.postcard").bad(2, words);
    };
    bench.run("inspect missing.postcard").bad(2, &["missing.postcard"]);
    refused(b"", &["bad.postcard", "0 bytes"]);
    refused(b"PK\x03\x04 something else", &["does not begin with LACT"]);
    refused(&good[..good.len() - 1], &["damaged"]);
    let mut changed = good.clone();
    changed[good.len() / 2] ^= 4;
    refused(&changed, &["damaged", "checksum"]);
    changed[4] = 9;
    refused(&changed, &["format version 9"]);
}

fn shape() -> InertiaNetworkArchitecture {
    InertiaNetworkArchitecture { damped: true, ..InertiaNetworkArchitecture::new(&[Coordinate::Angle], 3) }
}

/// A model file whose bytes depend only on the format and the seeded initial weights.
fn example() -> Vec<u8> {
    let architecture = Architecture::from(shape());
    let weights = architecture.initial_weights(1);
    encode(
        &architecture,
        &weights,
        Some(TrainedStep { order: Order::Four, h: 0.05, control: ControlKind::Linear }),
        "an example\nin two lines",
    )
    .unwrap()
}

/// The model with held commands and a delay of 2.3 steps.
fn example_of_delay() -> Vec<u8> {
    let architecture = Architecture::from(shape());
    let weights = architecture.initial_weights(2);
    let actuator = Actuator { gain: vec![0.8], offset: vec![-0.05], delay: 0.115, lag: 0.0 };
    let trained_step = Some(TrainedStep { order: Order::Two, h: 0.05, control: ControlKind::Held });
    let facts = Facts { trained_step, actuator, ..Facts::default() };
    encode_in(Precision::Single, &architecture, &weights, &facts).unwrap()
}

/// The model with a lag behind a part of the delay.
fn example_of_lag() -> Vec<u8> {
    let architecture = Architecture::from(shape());
    let actuator = Actuator { gain: vec![0.8], offset: vec![-0.05], delay: 0.02, lag: 0.07 };
    let trained_step = Some(TrainedStep { order: Order::Two, h: 0.05, control: ControlKind::Held });
    let facts = Facts { trained_step, actuator, ..Facts::default() };
    encode_in(Precision::Single, &architecture, &architecture.initial_weights(2), &facts).unwrap()
}

/// Trees of two sizes over the same types.
fn example_of_trees() -> (Architecture, Vec<u8>) {
    let text = "[data]\nfile = \"none\"\n[model]\nfamily = \"modular\"\ntree = \"double\"\n\
                [[model.types]]\nname = \"bob\"\ntransform = \"angle\"\nposition = []\npotential = [3]\nmass = 2.0\n\
                [[model.types]]\nname = \"cart\"\ntransform = \"slide\"\ndamping = 0.5\n\
                [model.trees]\ndouble = [\"bob\", \"bob\"]\ncrane = [\"cart\", \"bob\", \"bob\"]\n";
    let (architecture, weights) = Config::parse(text, "c.toml".as_ref()).unwrap().beginning().unwrap();
    let bytes = encode(&architecture, &weights, None, "an example").unwrap();
    (architecture, bytes)
}

/// Graphs of two sizes over the same types.
fn example_of_graphs() -> (Architecture, Vec<u8>) {
    let text = "[data]\nfile = \"none\"\n[model]\nfamily = \"graph\"\ngraph = \"pair\"\n\
                [[model.node_types]]\nname = \"bob\"\nmass = 2.0\nfield = [0.0, 9.5]\npotential = [3]\n\
                [[model.edge_types]]\nname = \"spring\"\nlaw = [-2.0, 1.0]\npotential = [2]\n\
                [model.graphs.pair]\nnodes = [\"bob\", \"bob\"]\nedges = [[0, 1]]\n\
                [model.graphs.three]\nnodes = [\"bob\", \"bob\", \"bob\"]\nedges = [[0, 1], [1, 2]]\n\
                rods = [{ from = \"origin\", to = 0, length = 0.5 }]\n";
    let (architecture, weights) = Config::parse(text, "c.toml".as_ref()).unwrap().beginning().unwrap();
    let bytes = encode(&architecture, &weights, None, "an example").unwrap();
    (architecture, bytes)
}

/// Compares with a golden file; UPDATE_GOLDEN writes the file anew after a deliberate change.
fn is_golden(source: &str, name: &str) {
    let file = format!("{}/tests/cli_golden/{name}", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&file, source).unwrap();
    }
    assert_eq!(source, std::fs::read_to_string(&file).unwrap());
}

#[test]
fn rust_source_is_the_golden_file() {
    is_golden(&rust_source(&example()).unwrap(), "model.rs");
    is_golden(&rust_source(&example_of_trees().1).unwrap(), "trees.rs");
    is_golden(&rust_source(&example_of_graphs().1).unwrap(), "graphs.rs");
    is_golden(&rust_constants(&example()).unwrap(), "constants.rs");
    is_golden(&rust_constants(&ARM.0).unwrap(), "arm_constants.rs");
    is_golden(&rust_source(&example_of_delay()).unwrap(), "late.rs");
    is_golden(&rust_constants(&example_of_delay()).unwrap(), "late_constants.rs");
    is_golden(&rust_source(&example_of_lag()).unwrap(), "lagging.rs");
    is_golden(&rust_constants(&example_of_lag()).unwrap(), "lagging_constants.rs");
    let of_firmware = include_bytes!("../../../firmware-sim/examples/cartpole.postcard");
    is_golden(&rust_source(of_firmware).unwrap(), "../../../firmware-sim/examples/cartpole.rs");
}

#[repr(align(4))]
struct Aligned<T: ?Sized>(T);

static ARM: &Aligned<[u8]> = &Aligned(*include_bytes!("../../../firmware-sim/chip/models/arm.postcard"));

#[test]
fn constants_compile_and_are_the_same_model() {
    let (q, v, u) = ([0.3], [-1.2], [0.5]);
    let found = acceleration(&golden_constants::load().unwrap().system, &q, &v, &u).unwrap();
    assert_eq!(found, acceleration(&golden::load().unwrap().system, &q, &v, &u).unwrap());
    assert_eq!((golden_constants::STEP, golden_constants::stepper().unwrap().h()), (0.05, 0.05));
    assert_eq!((golden_constants::N, golden_constants::H, golden_constants::L), (1, 3, 2));

    let arm = ArmModel::<{ golden_arm_constants::N }>::load(&ARM.0).unwrap();
    let (q, v, u) = ([0.3; 7], [-0.7; 7], [1.5; 7]);
    let found = acceleration(&golden_arm_constants::load().unwrap().system, &q, &v, &u).unwrap();
    assert_eq!(found, acceleration(&arm.system, &q, &v, &u).unwrap());
    let mut stepper = golden_arm_constants::stepper(0.001).unwrap();
    stepper.start(q, v).unwrap();
    stepper.step(u).unwrap();
    assert!(golden_arm_constants::stepper(0.0).is_err());
}

/// The steppers of the file and of the constants agree, under commands delayed by 2.3 steps.
#[test]
fn steppers_of_an_actuator_agree() {
    let (mut file, mut constants) =
        (golden_late::stepper().unwrap(), golden_late_constants::stepper().unwrap());
    file.start([0.3], [-1.2]).unwrap();
    constants.start([0.3], [-1.2]).unwrap();
    let mut state = *file.state();
    let model = golden_late::load().unwrap();
    let (whole, actuator) = model.actuator().unwrap().unwrap().at_step::<1>(golden_late::STEP).unwrap();
    assert_eq!(whole, 2);
    let u = |k: usize| [if k < 3 { 0.0 } else { (k as f32 - 7.0) * 0.25 }];
    for k in 3..20 {
        let report = file.step(u(k)).unwrap();
        assert_eq!(
            (report, file.q(), file.p()),
            (constants.step(u(k)).unwrap(), constants.q(), constants.p())
        );
        let force = actuator.held(&u(k - 3), &u(k - 2));
        model.del::<f32, Midpoint>().unwrap().step(&model.system, &mut state, &force).unwrap();
        assert_eq!(file.state(), &state);
    }
}

/// The steppers of the file and of the constants agree behind a lag, and y begins at rest.
#[test]
fn steppers_of_a_lag_agree() {
    let (mut file, mut constants) =
        (golden_lagging::stepper().unwrap(), golden_lagging_constants::stepper().unwrap());
    file.start([0.3], [-1.2]).unwrap();
    constants.start([0.3], [-1.2]).unwrap();
    let mut state = *file.state();
    let model = golden_lagging::load().unwrap();
    let actuator = model.actuator().unwrap().unwrap();
    let (_, actuator, lag) = actuator.at_step_with_lag::<1>(golden_lagging::STEP).unwrap();
    let (mut y, mut before) = ([0.0], [0.0]);
    for k in 0..20 {
        let u = [(k as f32 - 7.0) * 0.25];
        let report = file.step(u).unwrap();
        assert_eq!((report, file.q(), file.p()), (constants.step(u).unwrap(), constants.q(), constants.p()));
        let (force, end) = actuator.lagging(|i| lag.held(y[i], before[i], u[i]));
        model.del::<f32, Midpoint>().unwrap().step(&model.system, &mut state, &force).unwrap();
        assert_eq!(file.state(), &state);
        (y, before) = (end, u);
    }
}

#[test]
fn trees_and_graphs_are_read_from_their_files() {
    for (bytes, what) in [(example_of_trees().1, "a tree of elements"), (example_of_graphs().1, "a graph")] {
        assert_eq!(rust_constants(&bytes), Err(ConstantsError::Unsupported { what }));
    }
    let bench = trained();
    bench.run("export run -o m.postcard --constants").bad(2, &["--rust"]);
    bench.run("export run -o m.postcard --rust m.rs --constants").good();
    assert_eq!(bench.text("m.rs"), rust_constants(&bench.read("m.postcard")).unwrap());
}

#[test]
fn rust_source_of_graphs_compiles_and_is_the_same_model() {
    use golden_graphs::{DIMENSION, EDGES, GRAPH, GRAPHS, H, K, L, N, RODS, load};
    let (architecture, bytes) = example_of_graphs();
    let host = decode(&bytes).unwrap();
    assert_eq!(&host.architecture, &architecture);
    let weights = host.weights_f32();
    let named = architecture.family.graph().unwrap().graph().unwrap();
    let types = architecture
        .family
        .graph()
        .unwrap()
        .with_header(|header| header.types::<f32, DIMENSION, K, H, L>(&weights));
    let here = Graph::new(types.unwrap(), &named.nodes, &named.edges).unwrap();
    let mut edges = [Edge::default(); EDGES];
    let mut rods = [Holonomic::default(); RODS];
    let there = load(&mut edges, &mut rods).unwrap();
    let (q, v) = ([[0.3, -0.4], [0.9, 0.1]], [[-1.2, 0.2], [0.5, 0.7]]);
    let energies = |graph: &dyn Particles<f32, DIMENSION>| graph.energies(&q, &v, &mut []);
    assert_eq!(energies(&there.system.graph), energies(&here));
    assert!(energies(&here).potential != 0.0);
    assert_eq!((N, H, L, K, EDGES, RODS, GRAPH), (4, 3, 1, 2, 1, 0, "pair"));
    assert_eq!(GRAPHS, [("pair", 2, 1), ("three", 3, 2)]);

    let mut memory = golden_graphs::Memory::new();
    let mut stepper = golden_graphs::stepper(&mut memory, 0.01).unwrap();
    let [q, v] = [q, v].map(|x| [x[0][0], x[0][1], x[1][0], x[1][1]]);
    stepper.start(q, v).unwrap();
    stepper.step([0.5, 0.0, -0.5, 0.0]).unwrap();
    assert!(stepper.q() != q);
}

#[test]
fn rust_source_of_trees_compiles_and_is_the_same_model() {
    let (architecture, bytes) = example_of_trees();
    let host = decode(&bytes).unwrap();
    assert_eq!(&host.architecture, &architecture);
    let weights = host.weights_f32();
    let modular = architecture.family.modular().unwrap();
    let (q, v, u) = ([0.3, -0.4], [-1.2, 0.2], [0.5, 0.0]);
    let tree = modular.tree_header();
    let here = modular
        .header()
        .system::<_, f32, Viscous<f32, 2>, 2, 2, 3, 1>(&tree, Laws::VISCOUS, &weights)
        .unwrap();
    let there = golden_trees::load().unwrap();
    assert_eq!(acceleration(&there.system, &q, &v, &u).unwrap(), acceleration(&here, &q, &v, &u).unwrap());
    assert_eq!(golden_trees::TREES, [("double", 2), ("crane", 3)]);
    let crane = golden_trees::load_tree::<3>("crane").unwrap();
    assert_eq!(crane.system.forces.coefficients, [0.5, 0.0, 0.0]);
    assert!(
        golden_trees::load_tree::<2>("crane").is_err() && golden_trees::load_tree::<3>("cranes").is_err()
    );
    assert_eq!((golden_trees::N, golden_trees::H, golden_trees::L, golden_trees::E), (2, 3, 1, 2));
    assert_eq!(golden_trees::TREE, "double");
    let mut stepper = golden_trees::stepper(0.01).unwrap();
    stepper.start(q, v).unwrap();
    stepper.step(u).unwrap();
    assert!(stepper.q() != q);
}

#[test]
fn rust_source_compiles_and_is_the_same_model() {
    let model = golden::load().unwrap();
    let host = decode(&example()).unwrap();
    let weights = host.weights_f32();
    let system = shape().system::<f32, 1, 32>(&weights).unwrap();
    let (q, v, u) = ([0.3], [-1.2], [0.5]);
    let there = acceleration(&model.system, &q, &v, &u).unwrap();
    assert_eq!(there, acceleration(&system, &q, &v, &u).unwrap());
    assert_eq!((golden::N, golden::H, golden::L, golden::STEP), (1, 3, 2, 0.05));
    assert_eq!(golden::stepper().unwrap().h(), 0.05);
}
