use leastaction_firmware_sim::control::Target;
use leastaction_firmware_sim::{Outcome, Processor};

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Time of a clock of the page, ms.
    safe fn now() -> f64;
}

/// A processor whose ticks are timed.
pub struct Timed<R> {
    processor: R,
    milliseconds: f64,
}

impl<R> Timed<R> {
    /// Times a processor.
    pub const fn new(processor: R) -> Self {
        Self { processor, milliseconds: 0.0 }
    }

    /// The processor.
    pub const fn of(&self) -> &R {
        &self.processor
    }

    /// Time that the last tick took, ms.
    pub const fn milliseconds(&self) -> f64 {
        self.milliseconds
    }

    fn time<T>(&mut self, work: impl FnOnce(&mut R) -> T) -> T {
        let begin = now();
        let done = work(&mut self.processor);
        self.milliseconds = now() - begin;
        done
    }
}

impl<R: Processor<N>, const N: usize> Processor<N> for Timed<R> {
    type Error = R::Error;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, R::Error> {
        self.time(|processor| processor.run(elapsed, measured, target))
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, R::Error> {
        self.time(|processor| processor.replay(elapsed, measured, u))
    }

    fn last(&self) -> &Outcome<N> {
        self.processor.last()
    }
}
