/// Part of a tick in which a fault shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// Whether a command is off by more than 1% of its limit from that of a controller without fault on the same readings.
    pub off: bool,
    /// Whether no force is commanded.
    pub zero: bool,
    /// The guard that has found something so far.
    pub found: Option<Guard>,
}

/// A guard, which finds faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Guard {
    /// Vote of copies.
    Vote,
    /// No two copies agreed.
    Disagreement,
    /// Sweep over the weights.
    Sweep,
    /// A step of the model failed, or a number was not finite.
    Step,
    /// Handler of processor faults.
    Handler,
    /// Watchdog.
    Watchdog,
    /// End of the program, which commands no force.
    End,
}

impl Guard {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Vote, Self::Disagreement, Self::Sweep, Self::Step, Self::Handler, Self::Watchdog, Self::End];

    /// Name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vote => "vote",
            Self::Disagreement => "disagreement",
            Self::Sweep => "sweep",
            Self::Step => "step",
            Self::Handler => "handler",
            Self::Watchdog => "watchdog",
            Self::End => "end",
        }
    }
}

/// End of a run before its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// A handler commanded no force, some instructions after the beginning of the tick.
    Stopped(Guard, u32),
    /// The program began anew, without a reset.
    BegunAnew,
    /// Messages without end.
    Babble,
    /// Nothing more was heard.
    Silent,
}

/// Effect of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judged {
    /// No command was off.
    Masked,
    /// A guard found it, and the commands were right or zero.
    Detected,
    /// Commands were off for no longer than the settling time, then right again.
    Transient,
    /// A handler commanded no force within a tick.
    Safe,
    /// Everything else.
    Wrong,
}

impl Judged {
    /// All effects.
    pub const ALL: [Self; 5] = [Self::Masked, Self::Detected, Self::Transient, Self::Safe, Self::Wrong];

    /// Name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Masked => "masked",
            Self::Detected => "detected",
            Self::Transient => "transient",
            Self::Safe => "safe",
            Self::Wrong => "wrong",
        }
    }
}

/// Effect of a fault, and what found it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Caught {
    /// The effect.
    pub judged: Judged,
    /// The first that found it.
    pub by: Option<Guard>,
    /// Number of ticks from the first to the last that was off.
    pub ticks: usize,
}

/// Judges the ticks since a fault; `settling` is the observer's settling time, `tick` the length of a tick in instructions.
pub fn judge(records: &[Record], stop: Option<Stop>, settling: usize, tick: u32) -> Caught {
    let found = records.iter().position(|record| record.found.is_some());
    // After detection, no force is the safe state.
    let bad =
        |(k, record): (usize, &Record)| record.off && !(record.zero && found.is_some_and(|found| found <= k));
    let first = records.iter().enumerate().position(bad);
    let last = records.len() - records.iter().enumerate().rev().position(bad).unwrap_or(records.len());
    let ticks = first.map_or(0, |first| last - first);
    let by = found.and_then(|found| records[found].found);
    let (judged, by) = match stop {
        Some(Stop::Stopped(guard, instructions)) if instructions <= tick && ticks <= settling => {
            (Judged::Safe, Some(guard))
        }
        Some(_) => (Judged::Wrong, by),
        None if ticks > settling => (Judged::Wrong, by),
        None if by.is_some() => (Judged::Detected, by),
        None if ticks > 0 => (Judged::Transient, by),
        None => (Judged::Masked, by),
    };
    Caught { judged, by, ticks }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIGHT: Record = Record { off: false, zero: false, found: None };
    const OFF: Record = Record { off: true, ..RIGHT };
    const STOPPED: Record = Record { off: true, zero: true, found: Some(Guard::Sweep) };

    fn effect(records: &[Record], stop: Option<Stop>) -> (Judged, usize) {
        let caught = judge(records, stop, 2, 1000);
        (caught.judged, caught.ticks)
    }

    #[test]
    fn commands_decide() {
        assert_eq!(effect(&[RIGHT; 9], None), (Judged::Masked, 0));
        assert_eq!(effect(&[RIGHT, OFF, OFF, RIGHT], None), (Judged::Transient, 2));
        assert_eq!(effect(&[RIGHT, OFF, RIGHT, OFF, RIGHT], None), (Judged::Wrong, 3));
        assert_eq!(effect(&[RIGHT, OFF, OFF, OFF], None), (Judged::Wrong, 3));
    }

    #[test]
    fn what_is_found_may_command_no_force() {
        assert_eq!(effect(&[OFF, OFF, STOPPED, STOPPED, STOPPED], None), (Judged::Detected, 2));
        // A force after the detection, and no force before it, are wrong.
        let pushing = Record { zero: false, ..STOPPED };
        assert_eq!(effect(&[STOPPED, pushing, pushing, pushing], None), (Judged::Wrong, 3));
        assert_eq!(effect(&[Record { zero: true, ..OFF }; 5], None), (Judged::Wrong, 5));
    }

    #[test]
    fn handlers_must_be_in_time() {
        let stopped = |instructions| Some(Stop::Stopped(Guard::Watchdog, instructions));
        assert_eq!(effect(&[OFF], stopped(999)).0, Judged::Safe);
        assert_eq!(effect(&[OFF], stopped(1001)).0, Judged::Wrong);
        assert_eq!(effect(&[OFF; 3], stopped(10)).0, Judged::Wrong);
        for stop in [Stop::BegunAnew, Stop::Babble, Stop::Silent] {
            assert_eq!(effect(&[RIGHT], Some(stop)).0, Judged::Wrong, "{stop:?}");
        }
    }
}
