//! Programs of the soft PLCs as text, with the signals and variables on their lines.

use std::collections::BTreeMap;

use onescan_base::regular;
use onescan_scenario::Scenario;
use schemars::JsonSchema;
use serde::Serialize;

use super::online::Online;

/// The largest source that is shown, bytes.
const SOURCE_MAX: usize = 1_000_000;

/// A program of a PLC as text.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Source {
    path: String,
    text: String,
    #[schemars(default)]
    lines: Vec<SourceLine>,
}

/// A line that names signals or variables.
#[derive(Debug, Serialize, JsonSchema)]
struct SourceLine {
    /// From 1.
    #[serde(rename = "line")]
    number: usize,
    /// Names of signals.
    variables: Vec<String>,
    /// Numbers of the PLCs' own variables.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(default)]
    inner: Vec<usize>,
}

/// The programs of the soft PLCs that are text, each with the signals on its lines.
pub(super) fn of(scenario: &Scenario, online: &Online) -> Vec<Source> {
    let mut sources = Vec::new();
    for plc in scenario.plcs() {
        for path in plc.sources.iter().filter(|path| !path.to_ascii_lowercase().ends_with("xml")) {
            // it has just been compiled; what cannot be read any more is not shown
            let Ok(text) = regular::read_text(&scenario.folder().join(path)) else { continue };
            if text.len() > SOURCE_MAX || sources.iter().any(|known: &Source| known.path == *path) {
                continue;
            }
            let lines = lines(&text, scenario, &|program, word| online.number(plc.name, &format!("{program}.{word}")));
            sources.push(Source { path: path.clone(), text, lines });
        }
    }
    sources
}

/// Signals by whose names, without those of what they are in, a line has words; and variables of the program that the line is
/// in, which `inner` finds.
fn lines(text: &str, scenario: &Scenario, inner: &dyn Fn(&str, &str) -> Option<usize>) -> Vec<SourceLine> {
    let mut by_word: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for declared in scenario.plan().signals() {
        let name = declared.name.to_string();
        let last = name.rsplit('.').next().unwrap_or(&name);
        let word = last.split('[').next().unwrap_or(last).to_ascii_uppercase();
        by_word.entry(word).or_default().push(name);
    }
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut program = String::new();
    let line = |(index, line): (usize, &str)| {
        let (mut variables, mut numbers): (Vec<String>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut words = line.split(|c| !is_word(c)).filter(|word| !word.is_empty());
        match words.next() {
            Some(word) if word.eq_ignore_ascii_case("PROGRAM") => words.next().unwrap_or("").clone_into(&mut program),
            Some(word) if word.eq_ignore_ascii_case("END_PROGRAM") => program.clear(),
            _ => {}
        }
        for word in line.split(|c| !is_word(c)) {
            for name in by_word.get(&word.to_ascii_uppercase()).into_iter().flatten() {
                if !variables.contains(name) {
                    variables.push(name.clone());
                }
            }
            let number = if program.is_empty() { None } else { inner(&program, word) };
            numbers.extend(number.filter(|number| !numbers.contains(number)));
        }
        let is_linked = !variables.is_empty() || !numbers.is_empty();
        is_linked.then_some(SourceLine { number: index + 1, variables, inner: numbers })
    };
    text.lines().enumerate().filter_map(line).collect()
}
