use super::{Adapter, Agreement, Block, Blocks, Moment, Reading, Tunable, Tuning};

impl<const N: usize, const P: usize, const T: usize> Adapter<f32, N, P, T> {
    /// Takes a tick of a fast loop, `None` for one of which nothing can be learned, and sets the numbers of the model in use. At the end of a block
    /// it takes the motion over the block before; between, it does a piece of the work that is left. While it is `frozen`, the numbers stay what
    /// they are. `command` is the command by which the drives bring a force about. Returns what was learned, as [`take`](Self::take).
    pub fn follow<M: Tunable<N>>(
        &mut self,
        tuning: &Tuning<f32, N, P>,
        model: &mut M,
        blocks: &mut Blocks<f32, N>,
        reading: Option<&Reading<f32, N>>,
        frozen: bool,
        command: impl FnOnce(&[f32; N]) -> [f32; N],
    ) -> Option<Agreement<f32>> {
        let block = blocks.take(reading.filter(|_| !frozen));
        let mut agreement = None;
        match block {
            None if frozen => return None,
            None => {
                self.work(tuning);
                return None;
            }
            Some(_) if frozen => {
                self.hold();
                return None;
            }
            Some(Some(Block { q, v, force })) => {
                let moment = Moment { q, v, command: command(&force), force };
                agreement = self.take(tuning, model.of_file(), &moment);
            }
            Some(None) => self.skip(tuning),
        }
        model.set(&tuning.numbers, self.applied());
        agreement
    }
}
