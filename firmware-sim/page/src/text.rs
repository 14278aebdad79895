use core::fmt;

/// Text of at most 400 bytes; more is cut off.
pub struct Text {
    bytes: [u8; 400],
    length: usize,
}

impl Text {
    /// Creates an empty text.
    pub const fn new() -> Self {
        Self { bytes: [0; 400], length: 0 }
    }

    /// Replaces the text by a message.
    pub fn set(&mut self, message: impl fmt::Display) {
        self.length = 0;
        // A text that is cut off is still one.
        let _ = fmt::write(self, format_args!("{message}"));
    }

    /// The bytes so far.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

impl fmt::Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let room = self.bytes.get_mut(self.length..).unwrap_or_default();
        for (byte, next) in room.iter_mut().zip(text.bytes()) {
            *byte = next;
            self.length += 1;
        }
        Ok(())
    }
}
