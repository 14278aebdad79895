use super::{Board, BoardError, Line, LinkError};
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Interval at which a waiting call checks whether the run is to stop.
const GLANCE: Duration = Duration::from_millis(50);
/// Longest time for an emulator to end after it was told to, or after it closed its line.
const FAREWELL: Duration = Duration::from_secs(2);

/// A board under QEMU; its serial line is the stdin and stdout of a child process. The child ends when this value is dropped.
#[derive(Debug)]
pub struct Emulator {
    board: Board,
    child: Child,
    stdin: ChildStdin,
    arriving: Receiver<Vec<u8>>,
    arrived: VecDeque<u8>,
    complaints: Option<JoinHandle<String>>,
    stop: &'static AtomicBool,
}

impl Emulator {
    /// Starts a board with an image and files in its slot, a model and perhaps plans; it runs until `stop` is set.
    ///
    /// # Errors
    /// [`StartError`] if the emulator is not installed, or if a file cannot be read.
    pub fn start(
        board: Board,
        image: &Path,
        files: &[&Path],
        stop: &'static AtomicBool,
    ) -> Result<Self, StartError> {
        let sized = files.iter().map(|file| Ok((*file, std::fs::metadata(file)?.len())));
        let files: Vec<_> = sized.collect::<io::Result<_>>()?;
        let mut command = Command::new(board.emulator());
        command.args(board.arguments(image, &files)?);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|error| not_started(board, error))?;
        let pipe = || io::Error::from(ErrorKind::BrokenPipe);
        let stdin = child.stdin.take().ok_or_else(pipe)?;
        let arriving = listen(child.stdout.take().ok_or_else(pipe)?);
        let complaints = Some(collect(child.stderr.take().ok_or_else(pipe)?));
        Ok(Self { board, child, stdin, arriving, arrived: VecDeque::new(), complaints, stop })
    }

    /// Waits for the emulator to end after it was told to.
    pub fn finish(mut self) {
        self.wait(FAREWELL);
    }

    /// Waits for the end for at most this time; `None` if it has not ended.
    fn wait(&mut self, at_most: Duration) -> Option<std::process::ExitStatus> {
        let deadline = Instant::now() + at_most;
        loop {
            match self.child.try_wait() {
                Ok(None) if Instant::now() < deadline => thread::sleep(Duration::from_millis(5)),
                status => return status.ok().flatten(),
            }
        }
    }

    /// The reason why no more bytes arrive.
    fn closed(&mut self) -> LinkError {
        let status = self.wait(FAREWELL);
        // Ctrl-C also reaches the emulator, perhaps before it reaches this program.
        thread::sleep(GLANCE);
        if self.stop.load(Ordering::Relaxed) {
            return LinkError::Interrupted;
        }
        let emulator = self.board.emulator();
        let Some(status) = status else { return LinkError::Closed(format!("{emulator} closed its line")) };
        let complaints = self.complaints.take().and_then(|thread| thread.join().ok()).unwrap_or_default();
        // QEMU prints all registers after the message if a processor locks up.
        let complaints = complaints.trim().lines().next().unwrap_or_default();
        let separator = if complaints.is_empty() { "" } else { ": " };
        LinkError::Closed(format!("{emulator} ended ({status}){separator}{complaints}"))
    }
}

/// The reason why an emulator does not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The board cannot be emulated.
    #[error(transparent)]
    Board(#[from] BoardError),
    /// The operating system reported an error.
    #[error(transparent)]
    Io(#[from] io::Error),
}

fn not_started(board: Board, error: io::Error) -> StartError {
    if error.kind() != ErrorKind::NotFound {
        return error.into();
    }
    StartError::Board(BoardError::NoEmulator { emulator: board.emulator(), package: board.package() })
}

/// Receives bytes as they arrive, from a thread that ends with the pipe.
fn listen(mut pipe: impl Read + Send + 'static) -> Receiver<Vec<u8>> {
    let (to, arriving) = channel();
    thread::spawn(move || {
        let mut bytes = [0; 256];
        while let Ok(count @ 1..) = pipe.read(&mut bytes) {
            let arrived = bytes.get(..count).unwrap_or_default();
            if to.send(arrived.to_vec()).is_err() {
                return;
            }
        }
    });
    arriving
}

/// Collects everything that is written to a pipe.
fn collect(mut pipe: impl Read + Send + 'static) -> JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        // After an error the bytes before it are still reported.
        let _ended = pipe.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

impl Line for Emulator {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        match self.stdin.write_all(bytes).and_then(|()| self.stdin.flush()) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(self.closed()),
            sent => Ok(sent?),
        }
    }

    fn receive(&mut self, deadline: Instant) -> Result<Option<u8>, LinkError> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(LinkError::Interrupted);
        }
        while self.arrived.is_empty() {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.arriving.recv_timeout(left.min(GLANCE)) {
                Ok(bytes) => self.arrived.extend(bytes),
                Err(RecvTimeoutError::Disconnected) => return Err(self.closed()),
                Err(RecvTimeoutError::Timeout) if self.stop.load(Ordering::Relaxed) => {
                    return Err(LinkError::Interrupted);
                }
                Err(RecvTimeoutError::Timeout) if left.is_zero() => return Ok(None),
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
        Ok(self.arrived.pop_front())
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // If the child has ended already, there is nothing to kill.
        let _ended = self.child.kill();
        let _reaped = self.child.wait();
    }
}
