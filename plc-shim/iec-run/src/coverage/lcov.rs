//! The tracefile format of lcov (`man geninfo`).

use std::fmt;

use super::{Coverage, FileCoverage, covered};

impl Coverage {
    /// As an lcov tracefile. Its test name says from when on a resumed run is counted, in nanoseconds.
    pub fn to_lcov(&self) -> String {
        // A test name has letters, digits and underscores.
        let mut text = match self.counted_from {
            None => "TN:\n".to_owned(),
            Some(from) => format!("TN:counted_from_{}_ns\n", from.as_nanos()),
        };
        for (name, file) in &self.files {
            write_file(&mut text, name, file);
        }
        text
    }
}

fn write_file(text: &mut String, name: &str, file: &FileCoverage) {
    let mut line = |written: fmt::Arguments<'_>| {
        text.push_str(&written.to_string());
        text.push('\n');
    };
    line(format_args!("SF:{name}"));
    for (number, unit) in file.units.keys() {
        line(format_args!("FN:{number},{unit}"));
    }
    for ((_, unit), count) in &file.units {
        line(format_args!("FNDA:{count},{unit}"));
    }
    let (found, hit) = covered(file.units.values());
    line(format_args!("FNF:{found}\nFNH:{hit}"));
    for (block, ((number, _), outcomes)) in file.decisions.iter().enumerate() {
        let reached = outcomes.values().any(|count| *count > 0);
        for (outcome, count) in outcomes {
            let taken = if reached { count.to_string() } else { "-".to_owned() };
            line(format_args!("BRDA:{number},{block},{outcome},{taken}"));
        }
    }
    let (found, hit) = covered(file.decisions.values().flat_map(|outcomes| outcomes.values()));
    line(format_args!("BRF:{found}\nBRH:{hit}"));
    for (number, count) in &file.lines {
        line(format_args!("DA:{number},{count}"));
    }
    let (found, hit) = covered(file.lines.values());
    line(format_args!("LF:{found}\nLH:{hit}\nend_of_record"));
}
