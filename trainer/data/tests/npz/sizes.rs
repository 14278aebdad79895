//! Actual and stated unpacked sizes of archives.

use zip::CompressionMethod;

use crate::{accept, h, npy, pack, q3, read_bytes};

/// An array of zeros, written in pieces.
fn zeros(descr: &str, count: usize, size: usize) -> Vec<u8> {
    let mut array = npy(descr, false, &format!("({count},)"), &[]);
    array.resize(array.len() + count * size, 0);
    array
}

#[test]
fn small_files_do_not_unpack_to_large_ones() {
    for (descr, size) in [("'<f8'", 8), ("'|u1'", 1)] {
        let packed = pack(&[("q", zeros(descr, 10_000_000, size)), h()], CompressionMethod::Deflated);
        assert!(packed.len() < 200_000);
        let error = read_bytes(&packed).unwrap_err().to_string();
        assert!(error.contains("log.npz, key q: with this array the file holds more than the "), "{error}");
        assert!(
            error.ends_with("write it with numpy.savez, which does not compress, or leave samples out"),
            "{error}"
        );
        // Ignored arrays are not unpacked.
        let ignored = pack(&[q3(), ("_q", zeros(descr, 10_000_000, size)), h()], CompressionMethod::Deflated);
        assert_eq!(read_bytes(&ignored).unwrap().0, accept(&[q3(), h()]));
    }
    // Together the arrays are too large; each alone is not.
    let half = || zeros("'<f8'", 5_000_000, 8);
    let packed = pack(&[("q", half()), ("u", half()), h()], CompressionMethod::Deflated);
    let error = read_bytes(&packed).unwrap_err().to_string();
    assert!(error.contains("log.npz, key u: with this array"), "{error}");
}

#[test]
fn honest_files_of_that_size_are_read() {
    let stored = pack(&[("q", zeros("'|u1'", 10_000_000, 1)), h()], CompressionMethod::Stored);
    assert_eq!(read_bytes(&stored).unwrap().0.samples(), 10_000_000);
}

/// The error message if the archive's directory states another unpacked size for its first array.
fn forged(mut bytes: Vec<u8>, size: impl Fn(u32) -> u32) -> String {
    let directory = (0..bytes.len()).find(|&i| bytes[i..].starts_with(b"PK\x01\x02")).unwrap();
    let stated = bytes[directory + 24..].first_chunk_mut().unwrap();
    *stated = size(u32::from_le_bytes(*stated)).to_le_bytes();
    read_bytes(&bytes).unwrap_err().to_string()
}

#[test]
fn a_forged_size_is_refused() {
    let sound = pack(&[q3(), h()], CompressionMethod::Deflated);
    for change in [-176, -8, -1, 1, 8, 1 << 30] {
        let error = forged(sound.clone(), |size| size.wrapping_add_signed(change));
        assert!(error.contains("log.npz, key q: not a readable"), "{change}: {error}");
    }
    // An array and a directory that agree on more data than there is.
    let cut = pack(&[("q", npy("'<f8'", false, "(900,)", &[0; 48])), h()], CompressionMethod::Deflated);
    let error = forged(cut, |_| 900 * 8 + 128);
    assert!(error.contains("log.npz, key q: not a readable"), "{error}");
}
