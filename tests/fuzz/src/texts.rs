//! Texts written by people.

#[cfg(feature = "learning")]
use leastaction_learning::config::Config;
#[cfg(feature = "arms")]
use leastaction_models::urdf::{self, Described, Followers, Inertias, Options};
#[cfg(feature = "learning")]
use std::path::Path;

/// Reads a configuration: a valid one must give the beginning of a model, and its text must read back as an equal configuration.
#[cfg(feature = "learning")]
pub fn toml(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let file = Path::new("train.toml");
    let Ok(config) = Config::parse(text, file) else { return };
    let again = Config::parse(&config.to_toml(), file)
        .expect("a configuration that was read can be written and read");
    assert_eq!(config, again);
    // No other files are read here.
    if !["from", "urdf"].iter().any(|key| text.contains(key)) {
        drop(config.beginning());
    }
}

/// Reads a robot description: a valid one must give torques, and words for every note.
#[cfg(feature = "arms")]
pub fn urdf(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    for inertias in [Inertias::Required, Inertias::Optional] {
        for followers in [Followers::Move, Followers::Held] {
            let options = Options { inertias, followers, ..Options::default() };
            let Ok(Described { tree, notes }) = urdf::parse_with(text, &options) else { continue };
            assert!(notes.iter().all(|note| !note.to_string().is_empty()));
            let n = tree.coordinates();
            let torques = tree.inverse_dynamics(&vec![0.1; n], &vec![0.2; n], &vec![0.3; n]);
            assert_eq!(torques.len(), n);
        }
    }
}
