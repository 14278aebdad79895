//! The model file is what it was, byte for byte, and what its bytes are.

mod common;

use common::file::{self, CARTPOLE};

fn cartpole_text() -> String {
    let bytes = file::golden();
    let padding = bytes.len() - 4 - 4 * file::weights(&CARTPOLE).len() - 2 - 1 - 64;
    let parts = [
        (4, "magic LACT"),
        (1, "format version"),
        (1, "family 0: rigid"),
        (3, "coordinates, 2 letters: t, a"),
        (4, "hidden widths 7, 5, then none"),
        (1, "activation 0: tanh"),
        (5, "inertia 1: Cholesky, epsilon 1e-3"),
        (1, "damped"),
        (6, "discretisation: present, order 4, h = 0.05 s"),
        (38, "provenance, 37 letters"),
        (1 + padding, "padding: its length, zeros"),
        (2, "bytes of weights, 376 as a varint"),
        (4 * 28, "layer 3 to 7: panel of 4, panels of 1, biases"),
        (4 * 40, "layer 7 to 5: panel of 4, panel of 1, biases"),
        (4 * 24, "layer 5 to 4: panel of 4, biases"),
        (4 * 2, "damping coefficients"),
        (4, "CRC-32 of all bytes above, little-endian"),
    ];
    file::text(&bytes, &parts)
}

fn arm_text() -> String {
    let bytes = file::golden_arm();
    let parts = |padding| {
        [
            (4, "magic LACT"),
            (1, "format version"),
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
            (6, "discretisation: present, order 4, h = 0.05 s"),
            (38, "provenance, 37 letters"),
            (1 + padding, "padding: its length, zeros"),
            (2, "bytes of weights, as a varint"),
            (4 * 12, "network 0, layer 2 to 4: panel of 4, biases"),
            (4 * 15, "network 0, layer 4 to 3: panels of 1, biases"),
            (4 * 8, "network 0, layer 3 to 2: panels of 1, biases"),
            (4 * 15, "network 1, layer 2 to 5: panel of 4, panel of 1, biases"),
            (4 * 6, "network 1, layer 5 to 1: panel of 1, bias"),
            (4 * 2, "network 2, layer 1 to 1: panel of 1, bias"),
            (4 * 5, "cart: mass, moment of inertia, centre, length, damping"),
            (4 * 5, "link: the same"),
            (4 * 5, "rod: the same"),
            (4 * 2, "c1, c2"),
            (4, "CRC-32 of all bytes above, little-endian"),
        ]
    };
    let padding = bytes.len() - parts(0).iter().map(|(length, _)| length).sum::<usize>();
    file::text(&bytes, &parts(padding))
}

#[test]
fn the_rigid_file_is_unchanged() {
    file::assert_golden("cartpole.hex", &file::golden(), &cartpole_text());
}

#[test]
fn the_modular_file_is_unchanged() {
    file::assert_golden("arm.hex", &file::golden_arm(), &arm_text());
}
