use super::ERROR;
use crate::FmuError;
use std::ffi::{CStr, CString, c_char, c_int, c_void};

/// Function of an importer of FMI 3.0 that takes messages.
pub(super) type Logger3 = unsafe extern "C" fn(
    environment: *mut c_void,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
);

/// Function of an importer of FMI 2.0 that takes messages, as `printf` does.
pub(super) type Logger2 = unsafe extern "C" fn(
    environment: *mut c_void,
    name: *const c_char,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
    ...
);

/// The way to the importer's messages.
pub(super) enum Log {
    /// FMI 2.0.
    Two { logger: Option<Logger2>, environment: *mut c_void, name: CString },
    /// FMI 3.0.
    Three { logger: Option<Logger3>, environment: *mut c_void },
}

/// Category of all messages, as in the description.
const CATEGORY: &CStr = c"logStatusError";

impl Log {
    /// Tells the importer of an error, whether or not it wants messages for debugging.
    pub fn error(&self, error: &FmuError) {
        let message = error.to_string().replace('\0', "");
        match self {
            Self::Two { logger: Some(logger), environment, name } => {
                // The message is a format, in which a percent sign begins an argument.
                let message = CString::new(message.replace('%', "%%")).unwrap_or_default();
                let [name, category, message] = [name.as_c_str(), CATEGORY, &message].map(CStr::as_ptr);
                // SAFETY: the importer's function, with strings that outlive the call.
                unsafe { logger(*environment, name, ERROR, category, message) };
            }
            Self::Three { logger: Some(logger), environment } => {
                let message = CString::new(message).unwrap_or_default();
                // SAFETY: the importer's function, with strings that outlive the call.
                unsafe { logger(*environment, ERROR, CATEGORY.as_ptr(), message.as_ptr()) };
            }
            Self::Two { .. } | Self::Three { .. } => {}
        }
    }
}
