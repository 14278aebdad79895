//! Commands behind a lag, T ẏ = u(t − d) − y, for windows side by side, with their derivatives with respect to d and T.

use super::logs::{Window, WindowLogs};
use leastaction_core::forces::{ControlKind, Rise};
use leastaction_programs::{Row, WIDTH};

/// A number and its derivatives with respect to d and T.
type Moved = [f64; 3];

/// Time constants after which nothing is left of an older command: exp(−50) is less than a number resolves.
const REACH: f64 = 50.0;

/// Lagging commands at every sample of windows, and the lines over the steps between them.
pub(super) struct Lagging {
    n: usize,
    /// Lines from sample to sample, \[steps\]\[n\]: start and end of each.
    lines: Vec<[[Row; 3]; 2]>,
}

impl Lagging {
    /// Lagging commands over `steps` steps of windows, filtered from the beginning of their logs, where y is the first command. `times` are
    /// d and T, s.
    pub fn of(logs: &WindowLogs, windows: &[Window; WIDTH], steps: usize, times: [f64; 2]) -> Self {
        let (n, filter) = (logs.n, Filter::new((logs.h, logs.control), times));
        let mut lines = vec![[[Row::default(); 3]; 2]; steps * n];
        for (lane, window) in windows.iter().enumerate() {
            for i in 0..n {
                let mut y = filter.before(logs, *window, i);
                for step in 0..steps {
                    let [end, mean, slope] =
                        filter.answer(y, filter.commands(logs, window.log, window.first + step, i));
                    for (line, half) in lines[step * n + i].iter_mut().zip([-0.5, 0.5]) {
                        (0..3).for_each(|part| line[part].0[lane] = mean[part] + half * slope[part]);
                    }
                    y = end;
                }
            }
        }
        Self { n, lines }
    }

    /// The line over a sample's step: y_i with its derivatives, at the start and at the end.
    pub fn line(&self, sample: usize, i: usize) -> [[Row; 3]; 2] {
        self.lines[sample * self.n + i]
    }
}

/// The filter of one lag for steps of one length.
struct Filter {
    kind: ControlKind,
    h: f64,
    /// Whole steps of the delay, and the part of a step that is left.
    late: (usize, f64),
    /// Steps until an older command is forgotten.
    reach: usize,
    /// y at the end, mean and slope for each of three signals of size 1: a jump at the beginning, then for held commands a jump at d, and
    /// for linear ones a slope from the beginning on and a change of slope at d.
    shares: [[Moved; 3]; 3],
}

impl Filter {
    fn new((h, kind): (f64, ControlKind), [delay, lag]: [f64; 2]) -> Self {
        let steps = delay / h;
        let (part, lag) = (steps.fract(), lag / h);
        let at = |time: f64, moves: bool, of: fn(&Rise<f64>) -> [f64; 3]| {
            let rise = Rise::new(lag, time);
            let by_delay = if moves { of(&rise.by_time(lag)).map(|share| -share / h) } else { [0.0; 3] };
            let (values, by_lag) = (of(&rise), of(&rise.by_lag(lag, time)));
            std::array::from_fn(|k| [values[k], by_delay[k], by_lag[k] / h])
        };
        let (jump, ramp) = (Rise::jump, Rise::ramp);
        let shares = match kind {
            ControlKind::Held => [at(1.0, false, jump), at(1.0 - part, true, jump), [[0.0; 3]; 3]],
            ControlKind::Linear => [at(1.0, false, jump), at(1.0, false, ramp), at(1.0 - part, true, ramp)],
        };
        Self { kind, h, late: (steps as usize, part), reach: (REACH * lag).ceil() as usize + 1, shares }
    }

    /// Commands around the step from a sample on: the one before that which has arrived, that one, and the next.
    fn commands(&self, logs: &WindowLogs, log: usize, sample: usize, i: usize) -> [f64; 3] {
        let first = sample as isize - self.late.0 as isize - 1;
        [0, 1, 2].map(|k| logs.command(log, first + k, i))
    }

    /// y_i where a window begins.
    fn before(&self, logs: &WindowLogs, window: Window, i: usize) -> Moved {
        let Window { log, first } = window;
        let from = first.saturating_sub(self.reach);
        let [arrived, ..] = self.commands(logs, log, from, i);
        (from..first).fold([arrived, 0.0, 0.0], |y, sample| {
            let [end, ..] = self.answer(y, self.commands(logs, log, sample, i));
            end
        })
    }

    /// y at the end of a step that begins with y, and mean and slope of the line in its place.
    fn answer(&self, y: Moved, [before, now, next]: [f64; 3]) -> [Moved; 3] {
        let still = |size: f64| [size, 0.0, 0.0];
        let behind = |size: f64, by_delay: f64| [size - y[0], by_delay - y[1], -y[2]];
        let sizes = match self.kind {
            ControlKind::Held => [behind(before, 0.0), still(now - before), still(0.0)],
            ControlKind::Linear => {
                let rate = now - before;
                [behind(now - self.late.1 * rate, -rate / self.h), still(rate), still(next - now - rate)]
            }
        };
        std::array::from_fn(|k| {
            let begun = if k < 2 { y } else { [0.0; 3] };
            sizes.iter().zip(&self.shares).fold(begun, |sum, (size, shares)| {
                let share = shares[k];
                let of = |part: usize| size[part] * share[0] + size[0] * share[part];
                [sum[0] + size[0] * share[0], sum[1] + of(1), sum[2] + of(2)]
            })
        })
    }
}
