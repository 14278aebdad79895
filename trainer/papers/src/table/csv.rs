use super::{Finished, Record};
use std::fmt::Write;

/// Returns every measure of every row and seed on a separate line, with a header; unknown values are empty.
pub fn csv(results: &[Finished]) -> String {
    let mut text = String::from(
        "table,subject,model,ours,parameters,seed,measure,value,paper,floor,train_seconds,note,command\n",
    );
    for (task, record) in super::rows(results) {
        lines(&mut text, task, record);
    }
    for task in results.iter().filter(|task| task.failure.is_some()) {
        let failed = quoted(&format!("failed: {}", task.failure.as_deref().unwrap_or_default()));
        // Writing to a string cannot fail.
        let _: std::fmt::Result =
            writeln!(text, ",{},,,,,,,,,,{failed},{}", quoted(&task.task), quoted(&task.command));
    }
    text
}

fn lines(text: &mut String, task: &Finished, record: &Record) {
    let Record { table, model, is_ours, parameters, seed, train_seconds, note, .. } = record;
    let start = format!(
        "{},{},{},{is_ours},{parameters},{seed}",
        quoted(table),
        quoted(&super::subject(record)),
        quoted(model)
    );
    let end = format!(
        "{train_seconds:.1},{},{}",
        quoted(note.as_deref().unwrap_or_default()),
        quoted(&task.command)
    );
    let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:e}"));
    for measure in &record.measures {
        let numbers = [measure.ours, measure.paper, measure.floor].map(number).join(",");
        let _: std::fmt::Result = writeln!(text, "{start},{},{numbers},{end}", quoted(&measure.name));
    }
}

/// Text as a field of comma-separated values.
fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
