//! Controls over a step for windows side by side, with their derivatives with respect to the calibration numbers.

use super::calibration::CalibrationLayout;
use super::lagging::Lagging;
use super::rollout::Lanes;
use leastaction_core::forces::ControlKind;
use leastaction_programs::Row;
use leastaction_programs::steps::ControlTangent;

/// Forces τ at the start and the end of a step, with their derivatives with respect to the learned numbers of g, o, d and T.
#[derive(Clone, Debug, Default)]
pub(super) struct Acting {
    pub tau: [Vec<Row>; 2],
    pub tangents: Vec<ControlTangent>,
}

/// Kind of a calibration number that a control depends on.
#[derive(Clone, Copy)]
enum Kind {
    Gain,
    Offset,
    Delay,
    Lag,
}

/// Weights of the control's values at the start and the end of the k-th of `parts` equal parts of a step, where it is
/// linear within the part. They give the start and the end of the straight line over the whole step that has the same
/// impulse and first moment.
fn shares(k: usize, parts: usize) -> [[f64; 2]; 2] {
    let m = parts as f64;
    let beside = 0.5 * ((k as f64 + 0.5) / m - 0.5);
    [-1.0, 1.0].map(|end| {
        let moment = (beside + end / (12.0 * m)) / m;
        [-6.0, 6.0].map(|slope| 0.5 / m + slope * moment)
    })
}

/// Force over one of `parts` equal parts of a step, for a force that is linear over the step.
pub(super) fn part_of(whole: &Acting, part: usize, parts: usize) -> Acting {
    if parts == 1 {
        return whole.clone();
    }
    let ends = [part, part + 1].map(|end| end as f64 / parts as f64);
    let between = |a: &Row, b: &Row| ends.map(|end| a.towards(b, end));
    let each: Vec<[Row; 2]> = whole.tau[0].iter().zip(&whole.tau[1]).map(|(a, b)| between(a, b)).collect();
    let moved = |tangent: &ControlTangent| {
        let [a, b] = &tangent.change;
        ControlTangent { change: between(a, b), ..tangent.clone() }
    };
    Acting {
        tau: [0, 1].map(|end| each.iter().map(|ends| ends[end]).collect()),
        tangents: whole.tangents.iter().map(moved).collect(),
    }
}

/// Kind and coordinate of a number on which the control depends.
fn kind(layout: &CalibrationLayout, number: usize) -> (Kind, Option<usize>) {
    match number {
        k if k < layout.n => (Kind::Gain, Some(k)),
        k if k < 2 * layout.n => (Kind::Offset, Some(k - layout.n)),
        k if k == 2 * layout.n => (Kind::Delay, None),
        _ => (Kind::Lag, None),
    }
}

impl Lanes<'_> {
    /// Lagging commands of the windows, if drives lag.
    pub fn lagging(&self) -> Option<Lagging> {
        let times = [self.layout.delay(), self.layout.lag()?].map(|at| self.numbers[at]);
        Some(Lagging::of(self.logs, &self.windows, self.steps, times))
    }

    /// Force over the step from `sample` to `sample + parts`, with tangents if they are wanted.
    pub fn acting(
        &self,
        lagging: Option<&Lagging>,
        (sample, parts): (usize, usize),
        with_tangents: bool,
    ) -> Acting {
        let delay = self.numbers[self.layout.delay()];
        let moved = if lagging.is_some() { 3 } else { 2 };
        // Values of y (u without a lag) and its derivatives with respect to d and T, at both ends, for every coordinate.
        let mut commands = vec![[[Row::default(); 3]; 2]; self.logs.n];
        for part in 0..parts {
            let shares = shares(part, parts);
            for (i, command) in commands.iter_mut().enumerate() {
                let own = match lagging {
                    Some(lagging) => lagging.line(sample + part, i),
                    None => {
                        self.command(sample + part, i, delay).map(|[u, slope]| [u, slope, Row::default()])
                    }
                };
                for (from, end) in (0..2).flat_map(|from| [(from, 0), (from, 1)]) {
                    let sums = command[end].iter_mut().zip(&own[from][..moved]);
                    sums.for_each(|(sum, own)| sum.add_scaled(shares[from][end], own));
                }
            }
        }
        let tau = |end: usize| (0..self.logs.n).map(|i| self.force(i, &commands[i][end][0])).collect();
        let tangents = if with_tangents { self.control_tangents(&commands) } else { Vec::new() };
        Acting { tau: [tau(0), tau(1)], tangents }
    }

    /// Force g_i u_i + o_i.
    fn force(&self, i: usize, u: &Row) -> Row {
        let [gain, offset] = [self.layout.gain(i), self.layout.offset(i)].map(|at| self.numbers[at]);
        Row(u.0.map(|u| gain * u + offset))
    }

    /// Delayed command u_i and its derivative with respect to d, at the start and the end of a sample's step.
    ///
    /// A held u that changes within the step jumps from b to a after the fraction p of the step. The straight line with
    /// the same impulse and first moment goes from m − 3p(1 − p)(a − b) to m + 3p(1 − p)(a − b), where m = pb + (1 −
    /// p)a.
    fn command(&self, sample: usize, i: usize, delay: f64) -> [[Row; 2]; 2] {
        let at = |sample: usize| {
            let places = self.windows.map(|of| (of.log, of.first + sample));
            self.logs.delayed_control(places, i, delay).map(Row)
        };
        let [mean, slope] = at(sample);
        if self.logs.control != ControlKind::Held {
            return [[mean, slope], at(sample + 1)];
        }
        let (h, part) = (self.logs.h, (delay / self.logs.h).fract());
        let [bend, turn] = [3.0 * part * (1.0 - part), 3.0 * (1.0 - 2.0 * part) / h];
        [-1.0, 1.0].map(|end| {
            let (mut u, mut own) = (mean, slope);
            u.add_scaled(-end * bend * h, &slope);
            own.add_scaled(-end * turn * h, &slope);
            [u, own]
        })
    }

    fn control_tangents(&self, commands: &[[[Row; 3]; 2]]) -> Vec<ControlTangent> {
        let mut tangents = Vec::new();
        for (number, position) in self.learned.controls.iter().enumerate() {
            let (kind, own) = kind(self.layout, *position);
            let coordinates = own.map_or(0..self.logs.n, |i| i..i + 1);
            tangents.extend(coordinates.map(|i| {
                let gain = self.numbers[self.layout.gain(i)];
                let scaled = |by: Row| Row(by.0.map(|by| gain * by));
                let change = commands[i].map(|[u, by_delay, by_lag]| match kind {
                    Kind::Gain => u,
                    Kind::Offset => Row::splat(1.0),
                    Kind::Delay => scaled(by_delay),
                    Kind::Lag => scaled(by_lag),
                });
                ControlTangent { number, coordinate: i, change }
            }));
        }
        tangents
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line is preserved, and jumps keep their impulse and first moment.
    #[test]
    fn shares_keep_impulse_and_moment() {
        for parts in [1, 2, 5] {
            let m = parts as f64;
            let line = |t: f64| 2.0 - 3.0 * t;
            let steps = |k: usize| [1.0, -0.5, 2.0, 0.3, 0.7][k];
            let fitted = |value: &dyn Fn(usize, usize) -> f64| {
                let mut ends = [0.0; 2];
                for (k, from, end) in (0..parts)
                    .flat_map(|k| [0, 1].map(|from| (k, from)))
                    .flat_map(|(k, from)| [0, 1].map(|end| (k, from, end)))
                {
                    ends[end] += shares(k, parts)[from][end] * value(k, from);
                }
                ends
            };
            let ends = fitted(&|k, from| line((k + from) as f64 / m));
            assert!((ends[0] - 2.0).abs() < 1e-12 && (ends[1] + 1.0).abs() < 1e-12, "{ends:?}");
            let [start, end] = fitted(&|k, _| steps(k));
            let impulse: f64 = (0..parts).map(|k| steps(k) / m).sum();
            let moment: f64 = (0..parts).map(|k| steps(k) * (k as f64 + 0.5) / (m * m)).sum();
            assert!((0.5 * (start + end) - impulse).abs() < 1e-12);
            assert!((0.5 * start + (end - start) / 3.0 - moment).abs() < 1e-12, "{parts}");
        }
    }
}
