//! Logs as a robot writes them: one CSV file per log.

use super::RobotLog;
use leastaction_data::atomic;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Beginning of every log.
pub const CSV_HEAD: &str = "time,pos_meas1";

/// Groups of columns; each has one column per coordinate, counted from 1.
const GROUPS: [&str; 4] = ["pos_meas", "vel_meas", "tau_con", "tau_meas"];

/// Writes a log: time (s), measured positions, velocities as their differences, commanded torques and actual torques.
///
/// # Errors
/// An error if the file cannot be written.
pub fn write_csv(file: &Path, log: &RobotLog) -> io::Result<()> {
    atomic::write_with(file, |file| {
        let mut file = BufWriter::new(file);
        let n = log.readings.width();
        write!(file, "time")?;
        GROUPS.iter().try_for_each(|name| (1..=n).try_for_each(|i| write!(file, ",{name}{i}")))?;
        writeln!(file)?;
        for (k, velocities) in log.differences().enumerate() {
            write!(file, "{}", log.times[k])?;
            let rows =
                [&log.readings, &log.commands, &log.torques].map(|rows| rows.get(k).unwrap_or_default());
            let [readings, commands, torques] = rows;
            for x in readings.iter().chain(&velocities).chain(commands).chain(torques) {
                write!(file, ",{x}")?;
            }
            writeln!(file)?;
        }
        file.flush()
    })
}
