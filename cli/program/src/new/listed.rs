//! What was taken over from an I/O list, and what was not.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use onescan_report::OutputError;
use onescan_report::number::counted;
use serde::Serialize;

use super::proposal::Proposal;
use super::signal::Signal;
use super::text::allowance;
use crate::io_list::{Direction, IoList, ListKind};
use onescan_runner::format::Format;

/// How many lines of a kind people are shown.
const SHOWN: usize = 20;

pub struct Listed<'a> {
    pub folder: &'a Path,
    pub files: &'a [String],
    pub list: &'a IoList,
    /// The signals made of it.
    pub signals: &'a [Signal],
    /// What may stand behind them.
    pub proposals: &'a [Proposal<'a>],
}

/// The report for machines.
#[derive(Serialize)]
struct Json<'a> {
    scenario: String,
    from: &'a str,
    list: &'static str,
    files: &'a [String],
    inputs: usize,
    outputs: usize,
    types: BTreeMap<String, usize>,
    signals: Vec<JsonSignal<'a>>,
    left_out: Vec<JsonLeftOut<'a>>,
}

#[derive(Serialize)]
struct JsonSignal<'a> {
    signal: &'a str,
    /// Its name in the list.
    name: &'a str,
    #[serde(rename = "type")]
    ty: String,
    direction: Direction,
    #[serde(skip_serializing_if = "Option::is_none")]
    address: Option<&'a str>,
    /// The kind of component that is proposed for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    component: Option<&'static str>,
    file: &'a str,
    line: Option<u32>,
}

#[derive(Serialize)]
struct JsonLeftOut<'a> {
    name: &'a str,
    why: &'a str,
    file: &'a str,
    line: Option<u32>,
}

/// Writes the report.
///
/// # Errors
/// It cannot be written.
pub fn report(listed: &Listed, format: Format, out: &mut dyn Write) -> Result<(), OutputError> {
    let written = match format {
        Format::Human => human(listed, out),
        Format::Json => json(listed, out),
    };
    written.and_then(|()| out.flush()).map_err(OutputError)
}

impl Listed<'_> {
    fn count(&self, direction: Direction) -> usize {
        self.signals.iter().filter(|signal| signal.point.direction == direction).count()
    }

    fn types(&self, direction: Option<Direction>) -> BTreeMap<String, usize> {
        let mut types = BTreeMap::new();
        for signal in
            self.signals.iter().filter(|signal| direction.is_none_or(|wanted| wanted == signal.point.direction))
        {
            *types.entry(signal.point.ty.to_string()).or_insert(0) += 1;
        }
        types
    }
}

fn human(listed: &Listed, out: &mut dyn Write) -> io::Result<()> {
    for file in listed.files {
        writeln!(out, "{file}")?;
    }
    let list = listed.list;
    let count = listed.signals.len();
    writeln!(out, "\n{count} signal{} of {} ({})", plural(count), list.from, list.kind.title())?;
    for (direction, writer) in [(Direction::Input, "plant"), (Direction::Output, "plc")] {
        let types: Vec<_> =
            listed.types(Some(direction)).into_iter().map(|(ty, count)| format!("{count} {ty}")).collect();
        let types = if types.is_empty() { String::new() } else { format!(": {}", types.join(", ")) };
        writeln!(out, "  {} written by the {writer}{types}", listed.count(direction))?;
    }
    if !listed.proposals.is_empty() {
        let proposed = counted(listed.proposals.len() as u64, "component");
        writeln!(out, "  {proposed} proposed in plant.toml, by the names of signals")?;
    }
    if list.kind == ListKind::Server {
        writeln!(out, "  what may be written was taken for an input of the PLC; look through it")?;
    }
    let renamed = listed.signals.iter().filter(|signal| signal.name != signal.point.name);
    let renamed = renamed.map(|signal| format!("{}: {} is {}", signal.point.at, signal.point.name, signal.name));
    section("called otherwise", &renamed.collect::<Vec<_>>(), out)?;
    let left_out = list.left_out.iter().map(|entry| {
        let name = if entry.name.is_empty() { "an entry" } else { entry.name.as_str() };
        format!("{}: {name}: {}", entry.at, entry.why)
    });
    section("left out", &left_out.collect::<Vec<_>>(), out)?;
    writeln!(out, "\nnext: onescan run {}{}", listed.folder.display(), allowance(list))
}

fn section(title: &str, lines: &[String], out: &mut dyn Write) -> io::Result<()> {
    if lines.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n{title}: {}", lines.len())?;
    for line in lines.iter().take(SHOWN) {
        writeln!(out, "  {}", line.replace(char::is_control, " "))?;
    }
    match lines.len().saturating_sub(SHOWN) {
        0 => Ok(()),
        more => writeln!(out, "  and {more} more, which `--format json` lists"),
    }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

fn json(listed: &Listed, out: &mut dyn Write) -> io::Result<()> {
    let list = listed.list;
    let signals = listed.signals.iter().map(|Signal { name, point }| JsonSignal {
        signal: name,
        name: &point.name,
        ty: point.ty.to_string(),
        direction: point.direction,
        address: point.address.as_deref(),
        component: listed.proposals.iter().find(|proposal| proposal.signal() == name).map(Proposal::kind),
        file: &point.at.file,
        line: point.at.line,
    });
    let left_out = list.left_out.iter().map(|entry| JsonLeftOut {
        name: &entry.name,
        why: &entry.why,
        file: &entry.at.file,
        line: entry.at.line,
    });
    let report = Json {
        scenario: listed.folder.display().to_string(),
        from: &list.from,
        list: list.kind.title(),
        files: listed.files,
        inputs: listed.count(Direction::Input),
        outputs: listed.count(Direction::Output),
        types: listed.types(None),
        signals: signals.collect(),
        left_out: left_out.collect(),
    };
    serde_json::to_writer(&mut *out, &report)?;
    writeln!(out)
}
