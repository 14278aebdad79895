/// A counter that forgets whole rounds, such as a magnetic encoder or a timer that counts an encoder's edges, and the rounds that it made.
#[derive(Clone, Copy, Debug)]
pub struct Counter {
    range: i32,
    total: Option<i32>,
}

impl Counter {
    /// Creates a counter of `range` counts a round, at most 65,536.
    pub const fn new(range: i32) -> Self {
        Self { range, total: None }
    }

    /// Takes a reading and returns all counts. The counter moved by less than half a round since the last reading.
    pub fn read(&mut self, count: u16) -> i32 {
        let count = i32::from(count);
        let total = self.total.map_or(count, |total| {
            let moved = count.wrapping_sub(total).rem_euclid(self.range);
            total.wrapping_add(if 2 * moved < self.range { moved } else { moved - self.range })
        });
        self.total = Some(total);
        total
    }
}

/// Number of periods in a time, both in µs, rounded, at least 1: the ticks since the last one, more than one if some were missed.
pub const fn ticks(time: u64, period: u32) -> u32 {
    let period = period as u64;
    let Some(ticks) = (time + period / 2).checked_div(period) else { return 1 };
    if ticks == 0 {
        1
    } else if ticks > u32::MAX as u64 {
        u32::MAX
    } else {
        ticks as u32
    }
}
