use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// An emulated board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Board {
    /// Cortex-M4 with a floating-point unit (Arm MPS2, AN386).
    CortexM4,
    /// Cortex-M7 (Arm MPS2, AN500).
    CortexM7,
    /// 32-bit RISC-V without a floating-point unit (QEMU's "virt").
    Riscv,
}

/// The reason why a board cannot be emulated.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BoardError {
    /// There is no image.
    #[error(
        "there is no image for {board}; `firmware-sim/chip/run.sh --build` in the repository makes {expected}, or name one with --image"
    )]
    NoImage {
        /// The board's name.
        board: &'static str,
        /// Path where it is built.
        expected: PathBuf,
    },
    /// The named image does not exist.
    #[error("{0}: there is no such image; `firmware-sim/chip/run.sh --build` builds them")]
    NotAFile(PathBuf),
    /// The path cannot be passed to the emulator.
    #[error("{0:?}: the emulator takes paths in UTF-8 only")]
    Path(PathBuf),
    /// There is no image for this number of coordinates.
    #[error(
        "the boards' images run models of 1 and 2 coordinates, and arms of 7 joints, but this one has {0} coordinates: leave out --on"
    )]
    Coordinates(usize),
    /// The files do not fit into the slot.
    #[error("{what} {bytes} bytes, the image has room for {}", Board::ROOM)]
    TooLarge {
        /// The files and their verb.
        what: &'static str,
        /// Size of the files, with the length between them, bytes.
        bytes: u64,
    },
    /// The emulator is not installed.
    #[error("{emulator} is not installed (Debian, Ubuntu: apt-get install {package})")]
    NoEmulator {
        /// Name of the program.
        emulator: &'static str,
        /// Package that provides it.
        package: &'static str,
    },
}

impl Board {
    /// Largest size of a model file, or of a model with its plan, bytes: the slot in flash minus its two header words.
    pub const ROOM: u64 = (64 << 10) - 8;

    /// Name of the processor, as it reports itself.
    pub const fn name(self) -> &'static str {
        match self {
            Self::CortexM4 => "cortex-m4f",
            Self::CortexM7 => "cortex-m7",
            Self::Riscv => "riscv32imac",
        }
    }

    /// Program that emulates the board.
    pub const fn emulator(self) -> &'static str {
        if matches!(self, Self::Riscv) { "qemu-system-riscv32" } else { "qemu-system-arm" }
    }

    /// Package that provides the emulator.
    pub const fn package(self) -> &'static str {
        if matches!(self, Self::Riscv) { "qemu-system-misc" } else { "qemu-system-arm" }
    }

    /// Target that its programs are compiled for.
    pub const fn target(self) -> &'static str {
        if matches!(self, Self::Riscv) { "riscv32imac-unknown-none-elf" } else { "thumbv7em-none-eabihf" }
    }

    const fn machine(self) -> &'static str {
        match self {
            Self::CortexM4 => "mps2-an386",
            Self::CortexM7 => "mps2-an500",
            Self::Riscv => "virt",
        }
    }

    /// Address of the slot: a word, then files, each after its length (`_slot` in `firmware-sim/chip/memory`).
    const fn slot(self) -> u32 {
        if matches!(self, Self::Riscv) { 0x803f_0000 } else { 0x003f_0000 }
    }

    /// The controller's image for this number of coordinates: the named one, or the one built in the repository that
    /// contains this program or the working folder. `LEASTACTION_CHIP_TARGET` names another folder with builds.
    ///
    /// # Errors
    /// [`BoardError`] if there is none.
    pub fn image(self, named: Option<&Path>, coordinates: usize) -> Result<PathBuf, BoardError> {
        if let Some(image) = named {
            return if image.is_file() {
                Ok(image.to_owned())
            } else {
                Err(BoardError::NotAFile(image.to_owned()))
            };
        }
        let program = match coordinates {
            1 | 2 => "controller",
            7 => "arm_controller",
            other => return Err(BoardError::Coordinates(other)),
        };
        let release = Path::new(self.name()).join(self.target()).join("release");
        let below = |folder: PathBuf| folder.join(&release).join(program);
        let images: Vec<PathBuf> = build_folders().into_iter().map(below).collect();
        let expected = images.first().cloned().unwrap_or_else(|| below("target/chip".into()));
        let found = images.into_iter().find(|image| image.is_file());
        found.ok_or(BoardError::NoImage { board: self.name(), expected })
    }

    /// Arguments of the emulator: an image, files with their sizes (bytes) in the slot, and the serial line on stdin and stdout.
    ///
    /// # Errors
    /// [`BoardError`] for files that do not fit, or a path that cannot be passed.
    pub(super) fn arguments(self, image: &Path, files: &[(&Path, u64)]) -> Result<Vec<OsString>, BoardError> {
        let (mut devices, mut end) = (Vec::new(), WORD);
        for (file, bytes) in files {
            let (file, at) = (option_value(file)?, u64::from(self.slot()) + end.next_multiple_of(WORD));
            devices.push(format!("loader,addr={at:#x},data={bytes},data-len={WORD}"));
            devices.push(format!("loader,addr={:#x},file={file},force-raw=on", at + WORD));
            end = end.next_multiple_of(WORD) + WORD + bytes;
        }
        let bytes = end - 2 * WORD;
        if bytes > Self::ROOM {
            let what = if files.len() > 1 { "model and plans have" } else { "the model has" };
            return Err(BoardError::TooLarge { what, bytes });
        }
        let mut words: Vec<OsString> = ["-M", self.machine()].map(OsString::from).into();
        if self == Self::Riscv {
            words.extend(["-bios", "none"].map(OsString::from));
        }
        words.extend(OUTSIDE.map(OsString::from));
        words.extend(devices.into_iter().flat_map(|device| ["-device".into(), device.into()]));
        words.extend(["-kernel".into(), image.into()]);
        Ok(words)
    }
}

/// Size of a word of the slot, bytes.
const WORD: u64 = 4;

/// Fixed arguments: no window and no console; one instruction per virtual nanosecond, so that counts are equal in every
/// run; semihosting, with which the program ends the emulator.
const OUTSIDE: [&str; 10] = [
    "-display",
    "none",
    "-monitor",
    "none",
    "-serial",
    "stdio",
    "-semihosting-config",
    "enable=on,target=native",
    "-icount",
    "shift=0",
];

/// A path as an option value, with commas doubled.
fn option_value(path: &Path) -> Result<String, BoardError> {
    let text = path.to_str().ok_or_else(|| BoardError::Path(path.to_owned()))?;
    Ok(text.replace(',', ",,"))
}

/// Folders in which images may have been built, most likely first.
fn build_folders() -> Vec<PathBuf> {
    if let Some(folder) = env::var_os("LEASTACTION_CHIP_TARGET") {
        return vec![folder.into()];
    }
    let here = env::current_dir().unwrap_or_default();
    let program = env::current_exe().unwrap_or_default();
    let roots = here.ancestors().chain(program.ancestors());
    roots.filter(|root| is_repository(root)).map(|root| root.join("target/chip")).collect()
}

fn is_repository(folder: &Path) -> bool {
    folder.join("firmware-sim/chip/run.sh").is_file()
}
