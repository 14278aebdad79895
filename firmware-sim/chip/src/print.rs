//! Lines of a name and a value, without the formatting code of `core`.

use semihosting::sys::arm_compat::sys_writec;

fn bytes(text: &[u8]) {
    text.iter().for_each(|byte| sys_writec(*byte));
}

/// Prints a name and a text.
pub fn line(name: &[u8], value: &[u8]) {
    bytes(name);
    bytes(b" ");
    bytes(value);
    bytes(b"\n");
}

/// Prints a name and a whole number.
#[inline(never)]
pub fn number(name: &[u8], mut value: u32) {
    let mut digits = [b'0'; 10];
    let mut length = 0;
    for digit in digits.iter_mut().rev() {
        *digit = b'0' + (value % 10) as u8;
        value /= 10;
        length += 1;
        if value == 0 {
            break;
        }
    }
    line(name, digits.get(10 - length..).unwrap_or(&digits));
}

/// Prints a name and 16 hexadecimal digits.
#[inline(never)]
pub fn hash(name: &[u8], value: u64) {
    let mut digits = [0; 16];
    for (digit, shift) in digits.iter_mut().rev().zip((0..64).step_by(4)) {
        let nibble = (value >> shift) as u8 & 15;
        *digit = if nibble < 10 { b'0' + nibble } else { b'a' - 10 + nibble };
    }
    line(name, &digits);
}
