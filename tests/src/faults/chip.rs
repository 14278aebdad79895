use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// A message of the chip.
pub type Message = [u32; 6];

/// Longest silence, in real time: an image that says nothing for so long is taken as dead.
const PATIENCE: Duration = Duration::from_secs(20);
/// Time between two looks at the emulator's process.
const GLANCE: Duration = Duration::from_millis(50);
/// Message that ends the thread that reads.
const END: Message = [u32::MAX; 6];

/// Error that nothing more is heard from the chip: its emulator has ended, or is silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Silence;

/// An emulated Cortex-M4F, at the other end of two pipes.
pub struct Chip {
    emulator: Child,
    to: File,
    from: Receiver<Message>,
    folder: PathBuf,
}

impl Chip {
    /// Starts an image; `folder` is made, and removed at the end.
    ///
    /// # Errors
    /// Errors of the pipes and of the emulator.
    pub fn start(image: &Path, folder: PathBuf) -> io::Result<Self> {
        let image = image.canonicalize()?;
        std::fs::create_dir_all(&folder)?;
        Command::new("mkfifo").args(["in", "out"]).current_dir(&folder).status()?;
        // Both ways, so that opening waits for nobody, and the pipes outlive the chip's resets.
        let open = |name| OpenOptions::new().read(true).write(true).open(folder.join(name));
        let (to, mut out) = (open("in")?, open("out")?);
        let (sender, from) = channel();
        thread::spawn(move || {
            let mut bytes = [0; size_of::<Message>()];
            while out.read_exact(&mut bytes).is_ok() {
                let message = bytemuck::pod_read_unaligned(&bytes);
                if message == END || sender.send(message).is_err() {
                    break;
                }
            }
        });
        let emulator = Command::new("qemu-system-arm")
            .args(["-M", "mps2-an386", "-display", "none", "-monitor", "none", "-serial", "none"])
            .args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=0", "-kernel"])
            .arg(image)
            .current_dir(&folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        Ok(Self { emulator, to, from, folder })
    }

    /// Sends words.
    ///
    /// # Errors
    /// [`Silence`] if the pipe is broken.
    pub fn say(&mut self, words: &[u32]) -> Result<(), Silence> {
        self.to.write_all(bytemuck::cast_slice(words)).map_err(|_| Silence)
    }

    /// Waits for a message.
    ///
    /// # Errors
    /// [`Silence`] if none comes.
    pub fn hear(&mut self) -> Result<Message, Silence> {
        let begin = Instant::now();
        loop {
            match self.from.recv_timeout(GLANCE) {
                Ok(message) => return Ok(message),
                Err(RecvTimeoutError::Disconnected) => return Err(Silence),
                Err(RecvTimeoutError::Timeout) => {
                    let ended = !matches!(self.emulator.try_wait(), Ok(None));
                    if ended || begin.elapsed() > PATIENCE {
                        return Err(Silence);
                    }
                }
            }
        }
    }
}

impl Drop for Chip {
    fn drop(&mut self) {
        let _ = self.emulator.kill();
        let _ = self.emulator.wait();
        let _ =
            OpenOptions::new().read(true).write(true).open(self.folder.join("out")).and_then(|mut out| {
                let ended = out.write_all(bytemuck::cast_slice(&END));
                // Keeps the pipe until the thread has read.
                thread::sleep(Duration::from_millis(1));
                ended
            });
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
