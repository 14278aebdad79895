//! Files of lines `name: number`, the subset of YAML in which identified parameters are published.

use super::error::HardwareError;
use std::path::{Path, PathBuf};

/// Maximum size of such a file in bytes: it has a line for each number.
const LARGEST: u64 = 1 << 16;

/// Named numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parameters {
    file: PathBuf,
    numbers: Vec<(String, f64)>,
}

impl Parameters {
    /// Reads a file. Empty lines, comments (`# …`) and document marks (`---`) are ignored.
    ///
    /// # Errors
    /// [`HardwareError::Io`]; [`HardwareError::Line`] for a line of another form, a repeated name, or an invalid number.
    pub fn read(file: &Path) -> Result<Self, HardwareError> {
        let failed = |error| HardwareError::Io { path: file.to_owned(), error };
        if std::fs::metadata(file).map_err(failed)?.len() > LARGEST {
            let what = "not a file of parameters: it is too large".to_owned();
            return Err(HardwareError::unusable(file, &what));
        }
        let text = std::fs::read_to_string(file).map_err(failed)?;
        let mut all = Self { file: file.to_owned(), numbers: Vec::new() };
        for (line, text) in (1..).zip(text.lines()) {
            all.take(text).map_err(|what| HardwareError::Line { file: file.to_owned(), line, what })?;
        }
        Ok(all)
    }

    fn take(&mut self, line: &str) -> Result<(), String> {
        let text = line.split('#').next().unwrap_or_default().trim();
        if text.is_empty() || text == "---" {
            return Ok(());
        }
        let (name, value) =
            text.split_once(':').ok_or_else(|| format!("{text:?} is not of the form name: number"))?;
        let (name, value) = (name.trim(), value.trim());
        let number: f64 = value.parse().map_err(|_| format!("{name}: {value:?} is not a number"))?;
        if !number.is_finite() {
            return Err(format!("{name}: {value} is not finite"));
        }
        if self.number(name).is_some() {
            return Err(format!("{name} stands twice; remove one"));
        }
        self.numbers.push((name.to_owned(), number));
        Ok(())
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.numbers.iter().find(|(known, _)| known == name).map(|(_, number)| *number)
    }

    /// Returns the numbers with these names; others are ignored; an error if one is missing.
    pub fn get<const K: usize>(&self, names: [&str; K]) -> Result<[f64; K], HardwareError> {
        let missing: Vec<&str> = names.into_iter().filter(|name| self.number(name).is_none()).collect();
        if !missing.is_empty() {
            let what = format!("{} missing; needed are {}", missing.join(", "), names.join(", "));
            return Err(HardwareError::unusable(&self.file, &what));
        }
        Ok(names.map(|name| self.number(name).unwrap_or_default()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Parameters, HardwareError> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("model.yml");
        std::fs::write(&file, text).unwrap();
        Parameters::read(&file)
    }

    #[test]
    fn numbers_are_read_by_name() {
        let all = read("---\n# of the gear\ngr: 6.0\n\nIr: 6.287e-05 # kg m²\ntl1: 10\n").unwrap();
        assert_eq!(all.get(["Ir", "gr"]).unwrap(), [6.287e-5, 6.0]);
        let error = all.get(["Ir", "l1", "m1"]).unwrap_err().to_string();
        assert!(error.contains("model.yml: l1, m1 missing"), "{error}");
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let error = |text: &str| read(text).unwrap_err().to_string();
        assert!(error("a: 1\nb 2\n").contains("line 2: \"b 2\""));
        assert!(error("a: 1\na: 2\n").contains("line 2: a stands twice"));
        assert!(error("a: [1, 2]\n").contains("line 1: a: \"[1, 2]\" is not a number"));
        assert!(error("\na: nan\n").contains("line 2: a: nan is not finite"));
    }
}
