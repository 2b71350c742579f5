//! Timing diagrams, one column per scan.

use std::fmt::Write;

use crate::rig::Rig;

/// Draws BOOL inputs as given, and what else there is after each scan: TRUE as `#`, times in ms. Names are those of
/// variables below `within`.
pub(crate) fn diagram(rig: &mut Rig, within: &str, inputs: &[(&str, &str)], outputs: &[&str]) -> String {
    let columns = inputs.first().map_or(0, |(_, levels)| levels.len());
    let names = inputs.iter().map(|(name, _)| name).chain(outputs);
    let width = names.map(|name| name.len()).max().unwrap_or(0).max(4);
    let mut rows: Vec<String> = outputs.iter().map(|name| format!("{name:width$}")).collect();
    for column in 0..columns {
        for (name, levels) in inputs {
            let level = levels.as_bytes()[column] == b'#';
            rig.set(&format!("{within}.{name}"), i64::from(level));
        }
        rig.scan().expect("no fault");
        for (row, name) in rows.iter_mut().zip(outputs) {
            let path = format!("{within}.{name}");
            let value = rig.int(&path);
            let cell = match rig.variable(&path).type_name.as_str() {
                "BOOL" => (if value == 1 { "#" } else { "." }).to_owned(),
                "TIME" => (value / 1_000_000).to_string(),
                _ => value.to_string(),
            };
            write!(row, "{cell:>4}").expect("a string takes all");
        }
    }
    let mut text = String::new();
    for (name, levels) in inputs {
        write!(text, "{name:width$}").expect("a string takes all");
        for level in levels.chars() {
            write!(text, "{level:>4}").expect("a string takes all");
        }
        text.push('\n');
    }
    text + &rows.join("\n")
}
