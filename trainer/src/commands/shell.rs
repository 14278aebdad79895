//! `leastaction completions` and `leastaction man`: completions and manual pages.

use super::Cli;
use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;
use leastaction::cli::{Done, Failure, Output, folder};
use leastaction_learning::atomic;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Print the script with which a shell completes this command's options and their values.
///
/// bash: leastaction completions bash > ~/.local/share/bash-completion/completions/leastaction
///
/// zsh: leastaction completions zsh > a folder of $fpath, as _leastaction
///
/// fish: leastaction completions fish > ~/.config/fish/completions/leastaction.fish
///
/// Example: leastaction completions bash
#[derive(Args)]
pub struct Completions {
    /// The shell.
    shell: Shell,
}

/// The completion script of a shell.
#[derive(Serialize)]
struct Script {
    shell: String,
    script: String,
}

impl fmt::Display for Script {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.script)
    }
}

impl Completions {
    /// Prints the script.
    pub fn run(self, output: Output) -> Done {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "leastaction", &mut script);
        let script = String::from_utf8(script).map_err(|error| Failure::Work(error.to_string()))?;
        output.report(&Script { shell: self.shell.to_string(), script })
    }
}

/// Write the manual pages of this command, leastaction.1 and one for each of its commands.
///
/// Example: leastaction man ~/.local/share/man/man1
#[derive(Args)]
pub struct Manual {
    /// The folder to write to.
    folder: PathBuf,
}

/// The pages that were written.
#[derive(Serialize)]
struct Pages {
    folder: PathBuf,
    pages: Vec<String>,
}

impl fmt::Display for Pages {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{} pages in {}: {}", self.pages.len(), self.folder.display(), self.pages.join(", "))
    }
}

impl Manual {
    /// Writes a page for every command that is not hidden.
    pub fn run(self, output: Output) -> Done {
        folder(&self.folder)?;
        let mut command = Cli::command().disable_help_subcommand(true);
        command.build();
        let shown = command.get_subcommands().filter(|command| !command.is_hide_set());
        let pages = std::iter::once(&command).chain(shown).map(|command| self.page(command));
        let pages = pages.collect::<Result<_, _>>()?;
        output.report(&Pages { pages, folder: self.folder })
    }

    /// Writes a page and returns its name.
    fn page(&self, command: &Command) -> Result<String, Failure> {
        let (man, mut text) = (Man::new(command.clone()), Vec::new());
        let path = self.folder.join(man.get_filename());
        man.render(&mut text).map_err(|error| Failure::file(&path, error))?;
        atomic::write(&path, &text).map_err(|error| Failure::file(&path, error))?;
        Ok(man.get_filename())
    }
}
