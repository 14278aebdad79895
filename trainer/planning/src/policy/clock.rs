use crate::PlanError;

/// Clock of a run, which counts ticks from the times of the calls.
///
/// The tick of a time is the nearest one. Calls at the tick's rate, at any other rate, and after a gap thus meet a motion where it is by then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Duration of a tick, s.
    tick: f64,
    calls: Calls,
}

/// Calls of a run so far.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Calls {
    None,
    /// Without times.
    Counted,
    /// From the time `start`, s, the last one some ticks after it.
    Timed {
        start: f64,
        ticks: usize,
    },
}

impl Clock {
    /// The clock of a run that has not begun.
    pub fn new(tick: f64) -> Self {
        Self { tick, calls: Calls::None }
    }

    /// The clock after a call at a time, s, and the number of ticks since the call before, 0 for the first one. A call without a time is a
    /// tick later.
    ///
    /// # Errors
    /// [`PlanError::Value`] for a time that is not finite or goes back by a tick, and for times in only some calls.
    pub fn at(self, t: Option<f64>) -> Result<(Self, usize), PlanError> {
        let (calls, elapsed) = match (self.calls, t) {
            (Calls::None, None) => (Calls::Counted, 0),
            (Calls::Counted, None) => (Calls::Counted, 1),
            (Calls::None, Some(t)) => (Calls::Timed { start: finite(t)?, ticks: 0 }, 0),
            (Calls::Timed { start, ticks }, Some(t)) => {
                let now = ((finite(t)? - start) / self.tick).round();
                if now < ticks as f64 {
                    let last = start + ticks as f64 * self.tick;
                    let message = format!("is {t} s, after a call at {last:.6} s; reset before a new run");
                    return Err(PlanError::value("t", message));
                }
                let now = now as usize;
                (Calls::Timed { start, ticks: now }, now - ticks)
            }
            (Calls::Timed { .. }, None) | (Calls::Counted, Some(_)) => {
                let message = "is given in some calls of a run; give it in all of them or in none";
                return Err(PlanError::value("t", message));
            }
        };
        Ok((Self { calls, ..self }, elapsed))
    }
}

fn finite(t: f64) -> Result<f64, PlanError> {
    if t.is_finite() {
        Ok(t)
    } else {
        Err(PlanError::value("t", format!("is {t}; it must be a finite number")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: f64 = 0.002;

    /// Ticks before each of some calls.
    fn elapsed(times: &[Option<f64>]) -> Result<Vec<usize>, String> {
        let mut clock = Clock::new(TICK);
        let one = |t: &Option<f64>| {
            let (next, elapsed) = clock.at(*t).map_err(|error| error.to_string())?;
            clock = next;
            Ok(elapsed)
        };
        times.iter().map(one).collect()
    }

    /// Ticks of `count` calls, the clock a sum of steps as simulators keep it.
    fn summed(step: f64, count: usize) -> Vec<usize> {
        let times = std::iter::successors(Some(3.7), |t| Some(t + step)).map(Some);
        elapsed(&times.take(count).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn calls_at_any_rate_are_counted() {
        let at_rate = summed(TICK, 30_001);
        assert!(at_rate[0] == 0 && at_rate[1..].iter().all(|elapsed| *elapsed == 1));
        assert!(summed(3.0 * TICK, 1000)[1..].iter().all(|elapsed| *elapsed == 3));
        let often = summed(TICK / 3.0, 3001);
        assert!(often.iter().all(|elapsed| *elapsed <= 1));
        assert_eq!(often.iter().sum::<usize>(), 1000);
        assert_eq!(summed(2.5 * TICK, 1001).iter().sum::<usize>(), 2500);
        assert_eq!(elapsed(&[None, None, None]).unwrap(), [0, 1, 1]);
    }

    #[test]
    fn gaps_are_counted_and_a_tick_holds_several_calls() {
        let times = [1.0, 1.0, 1.0005, 1.0001, 1.002, 1.202].map(Some);
        assert_eq!(elapsed(&times).unwrap(), [0, 0, 0, 0, 1, 100]);
        assert!(elapsed(&[Some(0.0), Some(f64::MAX)]).unwrap()[1] > 1 << 60);
    }

    #[test]
    fn times_that_are_none_are_refused() {
        for (times, word) in [
            ([Some(1.0), Some(0.5)], "after a call at 1.000000 s"),
            ([Some(0.0), Some(f64::NAN)], "is NaN"),
            ([Some(f64::INFINITY), None], "is inf"),
            ([Some(0.0), None], "in all of them or in none"),
            ([None, Some(0.0)], "in all of them or in none"),
        ] {
            let error = elapsed(&times).unwrap_err();
            assert!(error.contains("`t`") && error.contains(word), "{error}");
        }
    }
}
