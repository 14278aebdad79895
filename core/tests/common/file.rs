//! Writes model files, valid and not.

use super::graphs::edge;
use super::trees::network;
use leastaction_core::discrete::Order;
use leastaction_core::energy::graph::{
    self, Drag, EdgeShape, Kinetic, MessageShape, NodeShape, Potential, Separation,
};
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::energy::modular::{
    ELEMENT_PARAMETERS, Input, ModularShape, PairInput, PairShape, TransformShape, TypeShape,
};
use leastaction_core::forces::ControlKind;
use leastaction_core::model::{
    ActuatorBytes, CoordinateRange, FORMAT_VERSION, Family, GraphHeader, GraphLayout, Header,
    InertiaNetworkHeader, Interval, Law, LawNetwork, Laws, MAGIC, MAX_GRAPHS, MAX_TREES, ModelError,
    ModularHeader, Section, TrainedStep, TrainingRange, TreeHeader, checksum, parse,
};
use leastaction_core::network::Activation;
use leastaction_core::scalar::f16;
use std::path::PathBuf;

/// Bytes aligned to 16, like a model file placed in a linker section with that alignment.
#[derive(Clone)]
pub struct Aligned {
    block: Vec<u128>,
    length: usize,
}

impl Aligned {
    pub fn new(bytes: &[u8]) -> Self {
        Self::shifted(bytes, 0)
    }

    /// The bytes at an address that is `shift` bytes further on.
    pub fn shifted(bytes: &[u8], shift: usize) -> Self {
        let padded: Vec<u8> = [&vec![0; shift], bytes].concat();
        let block = padded
            .chunks(16)
            .map(|chunk| {
                let mut word = [0; 16];
                word[..chunk.len()].copy_from_slice(chunk);
                u128::from_ne_bytes(word)
            })
            .collect();
        Self { block, length: padded.len() }
    }

    pub fn bytes(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.block)[..self.length]
    }
}

/// The cart-pole of the golden file: 3 → 7 → 5 → 4, damped.
pub const CARTPOLE: InertiaNetworkHeader<'static> = InertiaNetworkHeader {
    coordinates: "ta",
    widths: [7, 5, 0, 0],
    activation: Activation::Tanh,
    inertia: Inertia::Cholesky { epsilon: 1e-3 },
};

pub const HEADER: Header<'static> = Header {
    laws: Laws::VISCOUS,
    trained_step: Some(STEP),
    provenance: "golden: weights are multiples of 1/64",
    ..Header::new(Family::InertiaNetwork(CARTPOLE))
};

pub const STEP: TrainedStep = TrainedStep { order: Order::Four, h: 0.05, control: ControlKind::Held };

/// Weights that any text represents exactly, damping last.
pub fn weights(header: &InertiaNetworkHeader) -> Vec<f32> {
    [exact(header.parameters().unwrap()), vec![0.125; header.n()]].concat()
}

/// c, c_load, τ_s and ε of both coordinates.
pub const FRICTION: [[f32; 4]; 2] = [[0.5, 0.25, 0.75, 0.0625], [0.015625, 0.0, 1.0, 0.125]];

/// The cart-pole of the golden file with dry friction of these numbers.
pub fn with_friction(friction: &[f32]) -> Vec<u8> {
    write(FRICTION_HEADER, &[&weights(&CARTPOLE), friction].concat())
}

pub const FRICTION_HEADER: Header<'static> = Header { laws: Laws::FRICTION, ..HEADER };

/// Dissipation of the angle, whose network sees both coordinates, and a potential of the angle: 2 + 2 → 3 → 3 and 2 → 4 → 1.
pub const DISSIPATION: LawNetwork<'static> =
    LawNetwork { coordinates: "ca", widths: [3, 0, 0, 0], activation: Activation::Isru };
pub const POTENTIAL: LawNetwork<'static> =
    LawNetwork { coordinates: "-a", widths: [4, 0, 0, 0], activation: Activation::Softplus };

/// The cart-pole of the golden file with laws of every kind.
pub const NETWORKS_HEADER: Header<'static> =
    Header { laws: Laws::FRICTION.with_dissipation(DISSIPATION).with_potential(POTENTIAL), ..HEADER };

/// Numbers of both networks: the scales of two velocities, then multiples of 1/64.
pub fn of_networks() -> Vec<f32> {
    [vec![0.5, 2.0], exact(27), exact(17)].concat()
}

/// The file with laws of every kind, given the numbers of the two network laws.
pub fn with_networks(header: Header, networks: &[f32]) -> Vec<u8> {
    write(header, &[&weights(&CARTPOLE), FRICTION.as_flattened(), networks].concat())
}

/// Friction by direction (b, β, c, δ, ε), friction that sticks (c, δ, c_load, τ_s, s, ε) and end stops (centre, half distance, e) of both
/// coordinates.
pub const AXES: [f32; 28] = [
    0.5, 0.25, 0.375, -0.75, 0.0625, 0.125, -1.0, 1.5, 0.25, 0.03125, // friction by direction
    0.75, 0.375, 0.25, 0.5, 1.25, 0.0625, 0.0, -0.5, 0.5, 1.0, 1.0, 0.125, // friction that sticks
    0.5, 0.75, 0.5, -0.25, 2.0, 1.0, // end stops
];

pub const AXES_HEADER: Header<'static> =
    Header { laws: Laws::VISCOUS.with(Law::Directional).with(Law::Sticking).with(Law::Stops), ..HEADER };

/// The cart-pole of the golden file with laws of axes of these numbers.
pub fn with_axes(numbers: &[f32]) -> Vec<u8> {
    write(AXES_HEADER, &[&weights(&CARTPOLE), numbers].concat())
}

/// Multiples of 1/64 in ±1.
fn exact(count: usize) -> Vec<f32> {
    let mut random = super::Random(2022);
    (0..count).map(|_| (random.bits() % 129) as f32 / 64.0 - 1.0).collect()
}

/// A cart, a learned link and a rod, with a pair potential.
pub fn arm_shape() -> ModularShape {
    let networks = [
        network(2, &[4, 3], 2, Activation::Tanh),
        network(2, &[5], 1, Activation::Softplus),
        network(1, &[], 1, Activation::Identity),
    ];
    let learned = TransformShape::Network { position: 0, velocity: None, input: Input::Angle };
    let types = [
        TypeShape { transform: TransformShape::Slide, potential: None },
        TypeShape { transform: learned, potential: Some(1) },
        TypeShape { transform: TransformShape::Rod, potential: Some(1) },
    ];
    let pair = PairShape { network: 2, input: PairInput::Distance };
    ModularShape::new(&networks, &types, Some(pair)).expect("few parts")
}

/// The numbers of [`arm_shape`]'s types.
pub const ARM_NUMBERS: [[f32; ELEMENT_PARAMETERS]; 3] =
    [[2.0, 0.0, 1.0, 0.0], [1.0, 0.25, 0.5, 0.0], [0.75, 0.0, 1.0, 1.5]];
/// The damping of its types.
pub const ARM_DAMPING: [f32; 3] = [0.5, 0.125, 0.0];
/// c₁ and c₂.
pub const ARM_COEFFICIENTS: [f32; 2] = [9.5, 0.25];

/// Two trees of these types, of one and of three elements.
pub fn arm() -> ModularHeader<'static> {
    let mut trees = [TreeHeader::default(); MAX_TREES];
    trees[0] = TreeHeader { name: "link", elements: &[1, 0] };
    trees[1] = TreeHeader { name: "arm", elements: &[0, 0, 1, 1, 2, 2] };
    ModularHeader { shape: arm_shape(), names: "cart,link,rod", trees }
}

pub fn arm_header(arm: ModularHeader<'static>) -> Header<'static> {
    Header { family: Family::Modular(arm), ..HEADER }
}

pub fn arm_weights(numbers: [[f32; ELEMENT_PARAMETERS]; 3]) -> Vec<f32> {
    let ends = ELEMENT_PARAMETERS * numbers.len() + ARM_COEFFICIENTS.len();
    let networks = exact(arm().parameters().unwrap() - ends);
    [networks, numbers.concat(), ARM_COEFFICIENTS.to_vec(), ARM_DAMPING.to_vec()].concat()
}

/// The valid modular file that the tests damage.
pub fn golden_arm() -> Vec<u8> {
    write(arm_header(arm()), &arm_weights(ARM_NUMBERS))
}

/// Bobs and a free body, springs between them, with messages.
pub fn web_shape() -> graph::GraphShape {
    let networks = [
        network(2, &[3], 1, Activation::Softplus),
        network(1, &[4], 1, Activation::Squareplus),
        network(1, &[], 2, Activation::Identity),
        network(4, &[3], 2, Activation::Tanh),
        network(2, &[], 2, Activation::Identity),
        network(2, &[5], 1, Activation::Tanh),
    ];
    let nodes = [
        NodeShape { kinetic: Kinetic::Mass, potential: Potential::Uniform, drag: Drag::Viscous },
        NodeShape { kinetic: Kinetic::Network(0), potential: Potential::None, drag: Drag::None },
    ];
    let edges = [EdgeShape { separation: Separation::Distance, potential: Some(1), embedding: Some(2) }];
    let messages = MessageShape { message: 3, update: 4, edge_potential: Some(5), node_potential: None };
    let shape = graph::GraphShape::new(2, &networks, &nodes, &edges).expect("few parts");
    graph::GraphShape { kinetic_embedding: 1, embedding: 2, messages: Some(messages), ..shape }
}

/// The numbers of [`web_shape`]'s types: mass, drag, field, kinetic embedding, embedding.
pub const WEB_NUMBERS: [[f32; 7]; 2] =
    [[1.5, 0.25, 0.0, 9.5, 0.0, 0.5, -0.5], [0.0, 0.0, 0.0, 0.0, 0.75, -1.0, 0.25]];

/// The law of its edge type.
pub const WEB_LAW: [f32; 2] = [-0.75, 0.125];

/// The edges of the graph `ring`.
pub const RING: [[u8; 5]; 3] = [edge(0, 0, 1).to_bytes(), edge(0, 1, 2).to_bytes(), edge(0, 2, 0).to_bytes()];

/// A rod of 0.5 m from the origin to node 0, and one of 2 m from node 0 to node 2.
pub const RODS: [[u8; 8]; 2] = [[255, 255, 0, 0, 0, 0, 0, 63], [0, 0, 2, 0, 0, 0, 0, 64]];

/// Two graphs of these types, of one edge, and of three edges and two rods.
pub fn web() -> GraphHeader<'static> {
    let mut graphs = [GraphLayout::default(); MAX_GRAPHS];
    graphs[0] = GraphLayout { name: "pair", nodes: &[0, 1], edges: RING[0].as_slice(), rods: &[] };
    let (nodes, edges, rods) = (&[0, 1, 1], RING.as_flattened(), RODS.as_flattened());
    graphs[1] = GraphLayout { name: "ring", nodes, edges, rods };
    GraphHeader { shape: web_shape(), node_names: "bob,body", edge_names: "spring", graphs }
}

pub fn web_header(web: GraphHeader) -> Header {
    Header { family: Family::Graph(web), laws: Laws::NONE, ..HEADER }
}

pub fn web_weights(numbers: [[f32; 7]; 2]) -> Vec<f32> {
    let numbers = [numbers.concat(), WEB_LAW.to_vec()].concat();
    [exact(web().parameters().unwrap() - numbers.len()), numbers].concat()
}

/// The valid graph file that the tests damage.
pub fn golden_web() -> Vec<u8> {
    write(web_header(web()), &web_weights(WEB_NUMBERS))
}

/// The file of a header and a weight block given as bytes, closed with a valid checksum. It is written here without
/// core's own writer, which must give the same bytes.
pub fn write_raw(header: Header, padding: Option<&[u8]>, weights: &[u8]) -> Vec<u8> {
    let mut file = [&MAGIC[..], &[FORMAT_VERSION]].concat();
    for (section, content) in before_weights(&header) {
        file.extend(section_of(section, &content));
    }
    let aligned = [0; 3].get(..(4 - (file.len() + 6) % 4) % 4).unwrap();
    let padding = padding.unwrap_or(aligned);
    file.extend(section_of(Section::Weights, &[&[padding.len() as u8], padding, weights].concat()));
    for (section, content) in after_weights(&header) {
        file.extend(section_of(section, &content));
    }
    with_checksum(&file)
}

/// A section: its number, its length, its content.
pub fn section_of(section: Section, content: &[u8]) -> Vec<u8> {
    [&[section as u8], &(content.len() as u32).to_le_bytes()[..], content].concat()
}

/// Start and end of the content of a section in a file.
pub fn place(file: &[u8], section: Section) -> [usize; 2] {
    let mut start = 5;
    loop {
        let length = u32::from_le_bytes(file[start + 1..start + 5].try_into().unwrap()) as usize;
        if file[start] == section as u8 {
            return [start + 5, start + 5 + length];
        }
        start += 5 + length;
    }
}

/// The file with the content of a section replaced, and a new checksum.
pub fn with_section(file: &[u8], section: Section, content: &[u8]) -> Vec<u8> {
    let [start, end] = place(file, section);
    let rest = &file[end..file.len() - 4];
    with_checksum(&[&file[..start - 5], &section_of(section, content), rest].concat())
}

fn before_weights(header: &Header) -> Vec<(Section, Vec<u8>)> {
    let actuator = header.actuator.map(|actuator| (Section::Actuator, actuator.bytes().to_vec()));
    let step = header.trained_step.map(|step| (Section::Step, step.to_bytes().to_vec()));
    let laws = Some((Section::Forces, laws(&header.laws))).filter(|(_, laws)| !laws.is_empty());
    let energies = Some((Section::Energies, energies(&header.family)));
    [energies, laws, actuator, step].into_iter().flatten().collect()
}

fn after_weights(header: &Header) -> Vec<(Section, Vec<u8>)> {
    let range = header.range.map_or(Vec::new(), |range| range.bytes().to_vec());
    let all = [
        (Section::Units, header.units.as_bytes().to_vec()),
        (Section::Range, range),
        (Section::Provenance, header.provenance.as_bytes().to_vec()),
    ];
    all.into_iter().filter(|(_, content)| !content.is_empty()).collect()
}

/// The number of every law, and the shape of its network if it has one.
pub fn laws(laws: &Laws) -> Vec<u8> {
    let network = |law| laws.network(law).map(|network| document(&network)).unwrap_or_default();
    laws.iter().flat_map(|law| [vec![law as u8], network(law)].concat()).collect()
}

fn document(of: &impl serde::Serialize) -> Vec<u8> {
    postcard::to_slice(of, &mut [0; 64]).unwrap().to_vec()
}

/// The number of the family and its shape.
pub fn energies(family: &Family) -> Vec<u8> {
    let mut buffer = vec![0; 8192];
    let written = match family {
        Family::InertiaNetwork(shape) => postcard::to_slice(&(0_u8, shape), &mut buffer),
        Family::Modular(shape) => postcard::to_slice(&(1_u8, shape), &mut buffer),
        Family::Graph(shape) => postcard::to_slice(&(2_u8, shape), &mut buffer),
        Family::Bodies(shape) => postcard::to_slice(&(3_u8, shape), &mut buffer),
        Family::Arm(shape) => postcard::to_slice(&(4_u8, shape), &mut buffer),
        _ => unreachable!("a family without tests"),
    };
    written.unwrap().to_vec()
}

/// A file body closed with its checksum.
pub fn with_checksum(body: &[u8]) -> Vec<u8> {
    [body, &checksum(body).to_le_bytes()].concat()
}

pub fn write(header: Header, weights: &[f32]) -> Vec<u8> {
    write_raw(header, None, bytemuck::cast_slice(weights))
}

/// A file with weights in half precision.
pub fn write_half(header: Header, weights: &[f32]) -> Vec<u8> {
    let halves: Vec<f16> = weights.iter().map(|w| f16::from_f32(*w)).collect();
    write_raw(header, None, bytemuck::cast_slice(&halves))
}

/// The valid file that the tests damage.
pub fn golden() -> Vec<u8> {
    write(HEADER, &weights(&CARTPOLE))
}

/// The golden file with every section that a file can have.
pub fn golden_whole() -> Vec<u8> {
    let (actuator, range) = (actuator(&ACTUATOR), range(&RANGE));
    let header = Header {
        actuator: Some(ActuatorBytes::new(&actuator).unwrap()),
        units: "m,rad",
        range: Some(TrainingRange::new(&range).unwrap()),
        ..HEADER
    };
    write(header, &weights(&CARTPOLE))
}

/// Delay, then gain and offset of both coordinates.
pub const ACTUATOR: [f32; 5] = [0.125, 2.0, -0.5, 0.25, 0.0];

/// Range of a rail of ±2 m and of an angle that was never upright.
pub const RANGE: [CoordinateRange; 2] = {
    const fn interval(least: f32, most: f32) -> Interval {
        Interval { least, most }
    }
    [
        CoordinateRange {
            q: interval(-2.0, 2.0),
            v: interval(-4.0, 3.5),
            u: interval(-10.0, 10.0),
            period: 0.0,
        },
        CoordinateRange {
            q: interval(-2.5, 3.0),
            v: interval(-8.0, 8.0),
            u: interval(0.0, 0.0),
            period: std::f32::consts::TAU,
        },
    ]
};

/// Section of an actuator.
pub fn actuator(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Section of a range.
pub fn range(coordinates: &[CoordinateRange]) -> Vec<u8> {
    coordinates.iter().flat_map(|coordinate| coordinate.to_bytes()).collect()
}

/// Every part of the file, cut off anywhere, must be refused.
pub fn assert_truncations_are_refused(file: &[u8]) {
    for length in 0..file.len() {
        let error = parse(Aligned::new(&file[..length]).bytes()).expect_err("a part of a file");
        let expected = matches!(error, ModelError::TooShort { .. } | ModelError::Checksum { .. });
        assert!(expected, "{length} bytes: {error:?}");
    }
}

/// Every other value of every byte must be refused.
pub fn assert_changes_are_refused(file: &[u8]) {
    for position in 0..file.len() {
        for change in 1..=255 {
            let mut bytes = file.to_vec();
            bytes[position] ^= change;
            let error = parse(Aligned::new(&bytes).bytes()).expect_err("a damaged file must be refused");
            match position {
                0..4 => assert_eq!(error, ModelError::Magic),
                4 => assert_eq!(error, ModelError::Version { found: FORMAT_VERSION ^ change }),
                _ => assert!(matches!(error, ModelError::Checksum { .. }), "byte {position}: {error:?}"),
            }
        }
    }
}

/// A file as text: hexadecimal bytes in parts of the given lengths, each part after its name.
pub fn text(file: &[u8], parts: &[(usize, &str)]) -> String {
    text_of("model file", file, parts)
}

/// [`text`] of a file of this kind.
pub fn text_of(kind: &str, file: &[u8], parts: &[(usize, &str)]) -> String {
    let mut text = format!("# A {kind}, written by core/tests; see core/FORMAT.md.\n");
    let mut rest = file;
    for (length, what) in parts {
        let (part, after) = rest.split_at(*length);
        text.push_str(&format!("# {what}\n"));
        for row in part.chunks(16) {
            let row: Vec<String> = row.iter().map(|byte| format!("{byte:02x}")).collect();
            text.push_str(&format!("{}\n", row.join(" ")));
        }
        rest = after;
    }
    assert!(rest.is_empty(), "{} bytes without a name", rest.len());
    text
}

/// Asserts that the golden file of this name has the text `text` and the bytes `file`. The format must not change: rewrite a golden file
/// with `LEASTACTION_REGENERATE=1` only together with a new format version.
pub fn assert_golden(name: &str, file: &[u8], text: &str) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    if std::env::var_os("LEASTACTION_REGENERATE").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
    }
    let stored = std::fs::read_to_string(&path).unwrap();
    let lines = stored.lines().filter(|line| !line.starts_with('#'));
    let bytes: Vec<u8> =
        lines.flat_map(str::split_whitespace).map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect();
    assert_eq!(bytes, file);
    assert_eq!(stored, text);
}
