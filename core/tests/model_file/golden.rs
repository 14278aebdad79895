//! The model file has not changed, byte for byte; its bytes are named.

use crate::common::file::{self, CARTPOLE};
use crate::common::{crane, manipulator};
use leastaction_core::model::{ActuatorBytes, Header, Section};

/// Names of the parts before the weights, and of the parts of the weight block.
struct Parts {
    before: Vec<(usize, &'static str)>,
    weights: Vec<(usize, &'static str)>,
}

const HEAD: &str = "length of the section, 4 bytes, little-endian";

impl Parts {
    /// Text of all parts of a file in order. The parts of the sections for step, weights and provenance are named
    /// here.
    fn text(&self, bytes: &[u8]) -> String {
        let [start, _] = file::place(bytes, Section::Weights);
        let padding = usize::from(bytes[start]);
        let mut parts = vec![(4, "magic LACT"), (1, "format version")];
        parts.extend(&self.before);
        parts.extend([
            (1, "section 4: step"),
            (4, HEAD),
            (6, "order 4, h = 0.05 s, control 0: held"),
            (1, "section 5: weights"),
            (4, HEAD),
            (1 + padding, "padding: its length, zeros"),
        ]);
        parts.extend(&self.weights);
        parts.extend(behind_weights(bytes));
        parts.push((4, "CRC-32 of all bytes above, little-endian"));
        file::text(bytes, &parts)
    }
}

fn behind_weights(bytes: &[u8]) -> Vec<(usize, &'static str)> {
    let [_, end] = file::place(bytes, Section::Weights);
    let mut parts = Vec::new();
    if bytes[end] == Section::Units as u8 {
        parts.extend([(1, "section 128: units"), (4, HEAD), (5, "of x and of the angle: m,rad")]);
        parts.extend([(1, "section 129: range of the training data"), (4, HEAD)]);
        for _ in 0..2 {
            parts.extend([(8, "q: least and most"), (8, "v: the same"), (8, "u: the same"), (4, "period")]);
        }
    }
    parts.extend([(1, "section 130: provenance"), (4, HEAD), (37, "37 letters")]);
    parts
}

const DAMPED: [(usize, &str); 3] = [(1, "section 2: forces"), (4, HEAD), (1, "law 0: viscous")];

/// Text of a cart-pole with `each` bytes per weight.
fn cartpole_text(bytes: &[u8], each: usize) -> String {
    let mut before = vec![
        (1, "section 1: energies"),
        (4, HEAD),
        (1, "family 0: inertia-network"),
        (3, "coordinates, 2 letters: t, a"),
        (4, "hidden widths 7, 5, then none"),
        (1, "activation 0: tanh"),
        (5, "inertia 1: Cholesky, epsilon 1e-3"),
    ];
    before.extend(DAMPED);
    let [start, end] = file::place(bytes, Section::Forces);
    let axes = bytes[start..end] == [0, 5, 6, 7];
    let (dry, corrected) = (end - start > 1 && !axes, end - start > 2 && !axes);
    if dry {
        before.push((1, "law 1: coulomb"));
    }
    if axes {
        before.extend([(1, "law 5: directional"), (1, "law 6: sticking"), (1, "law 7: stops")]);
    }
    if corrected {
        before.extend([
            (1, "law 2: dissipation"),
            (3, "coordinates, 2 letters: c (x by its velocity alone), a"),
            (5, "hidden width 3, then none; activation 3: isru"),
            (1, "law 3: potential"),
            (3, "coordinates, 2 letters: - (not x), a"),
            (5, "hidden width 4, then none; activation 1: softplus"),
        ]);
    }
    if file::place(bytes, Section::Step)[0] != before.iter().map(|(length, _)| length).sum::<usize>() + 10 {
        before.extend([
            (1, "section 3: actuator"),
            (4, HEAD),
            (4, "delay, s"),
            (8, "of x: gain, offset"),
            (8, "of the angle: gain, offset"),
        ]);
        let [start, end] = file::place(bytes, Section::Actuator);
        before.extend((end - start > 20).then_some((4, "lag, s")));
    }
    let mut weights = vec![
        (each * 28, "layer 3 to 7: panel of 4, panels of 1, biases"),
        (each * 40, "layer 7 to 5: panel of 4, panel of 1, biases"),
        (each * 24, "layer 5 to 4: panel of 4, biases"),
        (each * 2, "viscous: c of each coordinate"),
    ];
    if dry {
        weights.extend([
            (each * 4, "coulomb, of x: c, c_load, tau_s, epsilon"),
            (each * 4, "coulomb, of the angle: the same"),
        ]);
    }
    if axes {
        weights.extend([
            (each * 5, "directional, of x: b, beta, c, delta, epsilon"),
            (each * 5, "directional, of the angle: the same"),
            (each * 6, "sticking, of x: c, delta, c_load, tau_s, s, epsilon"),
            (each * 6, "sticking, of the angle: the same"),
            (each * 3, "stops, of x: centre, half distance, e"),
            (each * 3, "stops, of the angle: the same"),
        ]);
    }
    if corrected {
        weights.extend([
            (each * 2, "dissipation: the scales of both velocities"),
            (each * 15, "layer 4 to 3: panels of 1, biases"),
            (each * 12, "layer 3 to 3: panels of 1, biases"),
            (each * 12, "potential: layer 2 to 4: panel of 4, biases"),
            (each * 5, "layer 4 to 1: panel of 1, bias"),
        ]);
    }
    Parts { before, weights }.text(bytes)
}

fn arm_text() -> String {
    let mut before = vec![
        (1, "section 1: energies"),
        (4, HEAD),
        (1, "family 1: modular"),
        (8, "network 0: present, 2 inputs, hidden widths 4, 3, then none, 2 outputs, activation 0: tanh"),
        (8, "network 1: present, 2 inputs, hidden width 5, then none, 1 output, activation 1: softplus"),
        (8, "network 2: present, 1 input, no hidden layer, 1 output, activation 4: identity"),
        (5, "networks 3 to 7: none"),
        (3, "type 0: present, transform 2: slide, no potential"),
        (
            7,
            "type 1: present, transform 0: network 0, no velocity network, input 1: angle, potential: network 1",
        ),
        (4, "type 2: present, transform 1: rod, potential: network 1"),
        (3, "types 3 to 5: none"),
        (3, "pair potential: present, network 2, input 2: distance"),
        (14, "names of the types, 13 letters: cart,link,rod"),
        (8, "tree 0: name, 4 letters: link; 2 bytes: type 1 on the ground"),
        (
            11,
            "tree 1: name, 3 letters: arm; 6 bytes: type 0 on the ground, type 1 on element 0, type 2 on element 1",
        ),
        (12, "trees 2 to 7: no name, no element"),
    ];
    before.extend(DAMPED);
    let weights = vec![
        (4 * 12, "network 0, layer 2 to 4: panel of 4, biases"),
        (4 * 15, "network 0, layer 4 to 3: panels of 1, biases"),
        (4 * 8, "network 0, layer 3 to 2: panels of 1, biases"),
        (4 * 15, "network 1, layer 2 to 5: panel of 4, panel of 1, biases"),
        (4 * 6, "network 1, layer 5 to 1: panel of 1, bias"),
        (4 * 2, "network 2, layer 1 to 1: panel of 1, bias"),
        (4 * 4, "cart: mass, moment of inertia, centre, length"),
        (4 * 4, "link: the same"),
        (4 * 4, "rod: the same"),
        (4 * 2, "c1, c2"),
        (4 * 3, "viscous: c of cart, link and rod"),
    ];
    Parts { before, weights }.text(&file::golden_arm())
}

fn web_text() -> String {
    let before = vec![
        (1, "section 1: energies"),
        (4, HEAD),
        (1, "family 2: graph"),
        (3, "2 dimensions, kinetic embedding of 1 number, embedding of 2"),
        (8, "network 0: present, 2 inputs, hidden width 3, then none, 1 output, activation 1: softplus"),
        (8, "network 1: present, 1 input, hidden width 4, then none, 1 output, activation 2: squareplus"),
        (8, "network 2: present, 1 input, no hidden layer, 2 outputs, activation 4: identity"),
        (8, "network 3: present, 4 inputs, hidden width 3, then none, 2 outputs, activation 0: tanh"),
        (8, "network 4: present, 2 inputs, no hidden layer, 2 outputs, activation 4: identity"),
        (8, "network 5: present, 2 inputs, hidden width 5, then none, 1 output, activation 0: tanh"),
        (6, "networks 6 to 11: none"),
        (4, "node type 0: present, kinetic 0: mass, potential 1: uniform, drag 1: viscous"),
        (5, "node type 1: present, kinetic 1: network 0, potential 0: none, drag 0: none"),
        (4, "node types 2 to 5: none"),
        (6, "edge type 0: present, separation 0: distance, potential: network 1, embedding: network 2"),
        (5, "edge types 1 to 5: none"),
        (6, "messages: present, message: network 3, update: network 4, of edges: network 5, of nodes: none"),
        (9, "names of the node types, 8 letters: bob,body"),
        (7, "names of the edge types, 6 letters: spring"),
        (
            5 + 3 + 6 + 1,
            "graph 0: name, 4 letters: pair; 2 nodes: types 0, 1; 5 bytes: edge of type 0, nodes 0 and 1; no rod",
        ),
        (5 + 4 + 16, "graph 1: name, 4 letters: ring; 3 nodes: types 0, 1, 1; 15 bytes: edges 0-1, 1-2, 2-0"),
        (17, "16 bytes: rods from the origin to node 0, 0.5 m, and from node 0 to node 2, 2 m"),
        (24, "graphs 2 to 7: no name, no node, no edge, no rod"),
    ];
    let weights = vec![
        (4 * (9 + 4), "network 0, layers 2 to 3 to 1"),
        (4 * (8 + 5), "network 1, layers 1 to 4 to 1"),
        (4 * 4, "network 2, layer 1 to 2"),
        (4 * (15 + 8), "network 3, layers 4 to 3 to 2"),
        (4 * 6, "network 4, layer 2 to 2"),
        (4 * (15 + 6), "network 5, layers 2 to 5 to 1"),
        (4 * 7, "bob: mass, drag, field in x and y, kinetic embedding, embedding"),
        (4 * 7, "body: the same"),
        (4 * 2, "spring: c1, c2"),
    ];
    Parts { before, weights }.text(&file::golden_web())
}

fn crane_text(bytes: &[u8]) -> String {
    let before = vec![
        (1, "section 1: energies"),
        (4, HEAD),
        (1, "family 3: bodies"),
        (1, "2 dimensions"),
        (7, "6 bytes: prismatic on the ground, revolute on body 0, prismatic on body 1"),
    ];
    let weights = vec![
        (4 * 2, "gravity in x and y"),
        (4 * 9, "cart: place in x and y, angle, mass, centre in x and y, moment of inertia, rotor, gear"),
        (4 * 9, "jib: the same"),
        (4 * 9, "trolley: the same"),
    ];
    let friction = [
        "coulomb, of the cart: c, c_load, tau_s, epsilon",
        "coulomb, of the jib: the same",
        "coulomb, of the trolley: the same",
    ];
    damped_text(bytes, Parts { before, weights }, friction)
}

/// Text of a file with three damped coordinates, and of the dry friction in the file.
fn damped_text(
    bytes: &[u8],
    Parts { mut before, mut weights }: Parts,
    friction: [&'static str; 3],
) -> String {
    before.extend(DAMPED);
    weights.push((4 * 3, "viscous: c of each coordinate"));
    let [start, end] = file::place(bytes, Section::Forces);
    if end - start > 1 {
        before.push((1, "law 1: coulomb"));
        weights.extend(friction.map(|of| (4 * 4, of)));
    }
    Parts { before, weights }.text(bytes)
}

fn manipulator_text(bytes: &[u8]) -> String {
    let before = vec![
        (1, "section 1: energies"),
        (4, HEAD),
        (1, "family 4: arm"),
        (7, "6 bytes: revolute on the ground, revolute on body 0, prismatic on body 1"),
    ];
    let mut weights = vec![(4 * 3, "gravity in x, y and z")];
    for of_body in [
        [
            "column: rotation of the joint's frame, row by row",
            "column: place in x, y and z, axis",
            "column: mass, first moments, inertia (xx, xy, yy, xz, yz, zz), rotor",
        ],
        ["upper arm: rotation", "upper arm: place, axis", "upper arm: mass, first moments, inertia, rotor"],
        ["forearm: rotation", "forearm: place, axis", "forearm: mass, first moments, inertia, rotor"],
    ] {
        weights.extend([4 * 9, 4 * 6, 4 * 11].into_iter().zip(of_body));
    }
    let friction = [
        "coulomb, of the column: c, c_load, tau_s, epsilon",
        "coulomb, of the upper arm: the same",
        "coulomb, of the forearm: the same",
    ];
    damped_text(bytes, Parts { before, weights }, friction)
}

#[test]
fn the_inertia_network_file_is_unchanged() {
    let file = file::golden();
    file::assert_golden("cartpole.hex", &file, &cartpole_text(&file, 4));
}

#[test]
fn the_inertia_network_file_in_half_precision_is_unchanged() {
    let file = file::write_half(file::HEADER, &file::weights(&CARTPOLE));
    file::assert_golden("cartpole-f16.hex", &file, &cartpole_text(&file, 2));
}

#[test]
fn the_file_with_dry_friction_is_unchanged() {
    let file = file::with_friction(file::FRICTION.as_flattened());
    file::assert_golden("cartpole-friction.hex", &file, &cartpole_text(&file, 4));
}

#[test]
fn the_file_with_laws_of_axes_is_unchanged() {
    let file = file::with_axes(&file::AXES);
    file::assert_golden("cartpole-axes.hex", &file, &cartpole_text(&file, 4));
}

#[test]
fn the_file_with_networks_in_its_laws_is_unchanged() {
    let file = file::with_networks(file::NETWORKS_HEADER, &file::of_networks());
    file::assert_golden("cartpole-networks.hex", &file, &cartpole_text(&file, 4));
}

#[test]
fn the_modular_file_is_unchanged() {
    file::assert_golden("arm.hex", &file::golden_arm(), &arm_text());
}

#[test]
fn the_graph_file_is_unchanged() {
    file::assert_golden("web.hex", &file::golden_web(), &web_text());
}

#[test]
fn the_file_of_bodies_is_unchanged() {
    let file = crane::golden();
    file::assert_golden("crane.hex", &file, &crane_text(&file));
}

#[test]
fn the_file_of_bodies_with_dry_friction_is_unchanged() {
    let file = crane::with_friction();
    file::assert_golden("crane-friction.hex", &file, &crane_text(&file));
}

#[test]
fn the_file_of_an_arm_is_unchanged() {
    let file = manipulator::golden();
    file::assert_golden("manipulator.hex", &file, &manipulator_text(&file));
}

#[test]
fn the_file_of_an_arm_with_dry_friction_is_unchanged() {
    let file = manipulator::with_friction();
    file::assert_golden("manipulator-friction.hex", &file, &manipulator_text(&file));
}

#[test]
fn the_file_with_every_section_is_unchanged() {
    let file = file::golden_whole();
    file::assert_golden("cartpole-whole.hex", &file, &cartpole_text(&file, 4));
}

#[test]
fn the_file_with_a_lag_is_unchanged() {
    let actuator = file::actuator(&[&file::ACTUATOR[..], &[0.008]].concat());
    let header = Header { actuator: Some(ActuatorBytes::new(&actuator).unwrap()), ..file::HEADER };
    let file = file::write(header, &file::weights(&CARTPOLE));
    file::assert_golden("cartpole-lag.hex", &file, &cartpole_text(&file, 4));
}
