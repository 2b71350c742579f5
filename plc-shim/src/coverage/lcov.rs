//! The tracefile format of lcov (`man geninfo`).

use std::fmt::Write;

use super::{Coverage, FileCoverage, covered};

impl Coverage {
    /// As an lcov tracefile.
    pub fn to_lcov(&self) -> String {
        let mut text = "TN:\n".to_owned();
        for (name, file) in &self.files {
            // Writing to a string does not fail.
            let _ = write_file(&mut text, name, file);
        }
        text
    }
}

fn write_file(text: &mut String, name: &str, file: &FileCoverage) -> std::fmt::Result {
    writeln!(text, "SF:{name}")?;
    for (line, unit) in file.units.keys() {
        writeln!(text, "FN:{line},{unit}")?;
    }
    for ((_, unit), count) in &file.units {
        writeln!(text, "FNDA:{count},{unit}")?;
    }
    let (found, hit) = covered(file.units.values());
    writeln!(text, "FNF:{found}\nFNH:{hit}")?;
    for (block, ((line, _), outcomes)) in file.decisions.iter().enumerate() {
        let reached = outcomes.values().any(|count| *count > 0);
        for (outcome, count) in outcomes {
            let taken = if reached { count.to_string() } else { "-".to_owned() };
            writeln!(text, "BRDA:{line},{block},{outcome},{taken}")?;
        }
    }
    let (found, hit) = covered(file.decisions.values().flat_map(|outcomes| outcomes.values()));
    writeln!(text, "BRF:{found}\nBRH:{hit}")?;
    for (line, count) in &file.lines {
        writeln!(text, "DA:{line},{count}")?;
    }
    let (found, hit) = covered(file.lines.values());
    writeln!(text, "LF:{found}\nLH:{hit}\nend_of_record")
}
