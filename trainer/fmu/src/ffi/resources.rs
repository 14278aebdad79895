use crate::FmuError;
use std::path::PathBuf;

/// Folder of resources that an importer of FMI 3.0 names by its path.
pub(super) fn of_path(path: &str) -> Result<PathBuf, FmuError> {
    // Some importers still pass an URI, as FMI 2.0 demands.
    if path.starts_with("file:") { of_uri(path) } else { Ok(PathBuf::from(path)) }
}

/// Folder of resources that an importer of FMI 2.0 names by an URI: file:///path, file://localhost/path or file:/path.
pub(super) fn of_uri(uri: &str) -> Result<PathBuf, FmuError> {
    let refused = || FmuError::Resources(uri.to_owned());
    let rest = uri.strip_prefix("file:").ok_or_else(refused)?;
    let path = match rest.strip_prefix("//") {
        Some(host) => host.strip_prefix("localhost").unwrap_or(host),
        None => rest,
    };
    let decoded = decoded(path).filter(|path| path.starts_with('/')).ok_or_else(refused)?;
    // A drive of Windows, /C:/…, has no slash before its letter.
    let has_drive = decoded.as_bytes().get(2) == Some(&b':');
    Ok(PathBuf::from(if has_drive { &decoded[1..] } else { &decoded }))
}

/// Text with its %-sequences replaced; `None` if one is damaged.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = text.bytes();
    let mut to = Vec::new();
    while let Some(byte) = bytes.next() {
        to.push(if byte == b'%' { digit(bytes.next()?)? << 4 | digit(bytes.next()?)? } else { byte });
    }
    String::from_utf8(to).ok()
}

fn digit(character: u8) -> Option<u8> {
    char::from(character).to_digit(16).map(|digit| digit as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_paths() {
        for (uri, path) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources"),
            ("file://localhost/tmp/r", "/tmp/r"),
            ("file:/tmp/%C3%BC/", "/tmp/ü/"),
            ("file:///C:/units/resources", "C:/units/resources"),
        ] {
            assert_eq!(of_uri(uri).unwrap(), PathBuf::from(path), "{uri}");
        }
        assert_eq!(of_path("/tmp/100%/r/").unwrap(), PathBuf::from("/tmp/100%/r/"));
    }

    #[test]
    fn other_texts_are_refused() {
        for uri in [
            "",
            "/tmp/r",
            "http://host/r",
            "file://host/r",
            "file:///%",
            "file:///%4",
            "file:///%zz",
            "file:///%ff",
        ] {
            assert!(of_uri(uri).unwrap_err().to_string().contains("folder of resources"), "{uri}");
        }
    }
}
