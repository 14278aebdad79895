//! The file of a plan has not changed, byte for byte; its bytes are named.

use crate::common::file::{assert_golden, text_of};
use crate::sample::Sample;

#[test]
fn the_file_is_unchanged() {
    let mut parts = vec![
        (4, "magic LAPN"),
        (1, "format version"),
        (4, "fingerprint of the model, little-endian"),
        (2, "driven coordinates, 1 byte: 1"),
        (3, "angles, 2 bytes: coordinate 0 is one, coordinate 1 is not"),
        (4, "h = 0.05 s"),
        (1, "3 ticks per node"),
        (1, "2 nodes"),
        (4, "padding: its length, zeros"),
        (8, "limits of the command: least and most"),
    ];
    for of in ["positions of node 0", "positions of node 1", "positions of the goal"] {
        parts.extend([
            (8, of),
            (8, "velocities"),
            (4, "command"),
            (16, "gains: of the positions, of the velocities"),
        ]);
    }
    parts.push((4, "CRC-32 of all bytes above, little-endian"));
    let bytes = Sample::golden().bytes();
    assert_golden("plan.hex", &bytes, &text_of("plan", &bytes, &parts));
}
