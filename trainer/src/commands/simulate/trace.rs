//! Trace of a run: its ticks as CSV.

use leastaction_firmware_sim::Tick;
use leastaction_learning::atomic;
use std::fmt::Write;
use std::io;
use std::path::Path;

/// A tick, with the number of coordinates known at run time.
pub struct Row {
    /// Due time, s.
    pub time: f32,
    /// True position.
    pub q: Vec<f32>,
    /// Estimated position.
    pub q_estimate: Vec<f32>,
    /// Reference position.
    pub reference: Vec<f32>,
    /// Applied force.
    pub applied: Vec<f32>,
}

/// Trace of all ticks.
#[derive(Default)]
pub struct Trace {
    /// Ticks for the plot.
    pub rows: Vec<Row>,
    csv: String,
}

impl Trace {
    /// Appends a tick.
    pub fn push<const N: usize>(&mut self, tick: &Tick<N>) {
        if self.rows.is_empty() {
            self.csv = head(N);
        }
        line(&mut self.csv, tick);
        self.rows.push(Row {
            time: tick.time,
            q: tick.q.to_vec(),
            q_estimate: tick.q_estimate.to_vec(),
            reference: tick.reference.to_vec(),
            applied: tick.applied.to_vec(),
        });
    }

    /// Writes the CSV file.
    pub fn write(&self, file: &Path) -> io::Result<()> {
        atomic::write(file, self.csv.as_bytes())
    }
}

/// Names of the vectors in a tick, in order.
const VECTORS: [&str; 9] =
    ["q", "v", "measured", "q_estimate", "v_estimate", "reference", "error", "commanded", "applied"];

/// Beginning of every trace file.
pub const BEGINNING: &str = "index,time,q0";

fn head(n: usize) -> String {
    let vectors = VECTORS.iter().flat_map(|name| (0..n).map(move |i| format!("{name}{i}")));
    let names: Vec<String> = ["index".to_owned(), "time".to_owned()].into_iter().chain(vectors).collect();
    format!("{},newton_iterations,newton_residual,lateness,missed,mode\n", names.join(","))
}

fn line<const N: usize>(to: &mut String, tick: &Tick<N>) {
    let mut cells = vec![tick.index.to_string(), tick.time.to_string()];
    let measured = tick.measured.map(|sample| sample.map_or(String::new(), |x| x.to_string()));
    let mut add = |vector: &[f32; N]| cells.extend(vector.map(|x| x.to_string()));
    add(&tick.q);
    add(&tick.v);
    cells.extend(measured);
    let mut add = |vector: &[f32; N]| cells.extend(vector.map(|x| x.to_string()));
    let rest = [tick.q_estimate, tick.v_estimate, tick.reference, tick.error, tick.commanded, tick.applied];
    rest.iter().for_each(&mut add);
    let Tick { newton, lateness, missed, mode, .. } = tick;
    let mode = format!("{mode:?}").to_lowercase();
    let (iterations, residual, missed) = (newton.iterations, newton.residual, u8::from(*missed));
    // Writing to a string cannot fail.
    let _infallible =
        writeln!(to, "{},{iterations},{residual:e},{lateness},{missed},{mode}", cells.join(","));
}
