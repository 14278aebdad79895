//! Every damaged model file is refused; the boards count the same (`firmware-sim/chip/hil.sh`).

use leastaction_firmware_sim::damage::Damage;
use leastaction_tests::all_refusals;

/// Sizes of the models, in bytes.
const BYTES: [(&str, u32); 2] = [("double", 586), ("pendulums", 462)];

#[test]
fn every_changed_bit_and_every_truncation_is_refused() {
    for (model, damage, refusals) in all_refusals() {
        let (_, bytes) = BYTES.into_iter().find(|(name, _)| *name == model).unwrap();
        let of = |name: &str| refusals.of(name);
        let total = refusals.accepted + refusals.occurred().map(|(_, count)| count).sum::<u32>();
        match damage {
            Damage::Bit => {
                assert_eq!((refusals.accepted, total), (0, 8 * bytes), "{model}");
                // Bits of the magic letters (32), of the version (8), and all others.
                let kinds = ["not_a_model", "version", "checksum"].map(of);
                assert_eq!(kinds, [32, 8, 8 * bytes - 40], "{model}");
            }
            Damage::Truncation => {
                assert_eq!((refusals.accepted, total), (0, bytes), "{model}");
                assert_eq!(of("too_short") + of("checksum"), bytes, "{model}");
            }
            // A weight changed under a checksum that fits gives another model, and no error.
            Damage::BitUnderChecksum => {
                assert_eq!(total, 8 * (bytes - 4), "{model}");
                assert!(of("malformed") > 0 && of("checksum") == 0, "{model}");
            }
        }
    }
}
