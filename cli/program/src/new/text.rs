//! The files of a scenario that is made of an I/O list.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use onescan_base::SignalType;
use onescan_iec_run::literal;
use onescan_report::number::counted;
use onescan_server::time::TimeSpan;
use serde_json::Value;

use super::signal::{Plc, Signal};
use crate::io_list::{Direction, IoList, ListLink};
use crate::map::Fragment;
use crate::map::fragment::{Entry, Place};

/// Comments are cut to a length that a line can have.
const ABOUT_CHARACTERS_MAX: usize = 160;

/// How many signals a plot shows to begin with.
const PLOTTED: usize = 8;

/// How many signals a panel shows that is written out.
const ON_PANEL: usize = 48;

const CYCLE: TimeSpan = TimeSpan::millis::<10>();

/// Text of a file of TOML: a quoted string of JSON is one of TOML.
pub(super) fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

/// One line without control characters.
fn one_line(text: &str) -> String {
    let words: Vec<_> =
        text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty()).collect();
    let text = words.join(" ");
    match text.char_indices().nth(ABOUT_CHARACTERS_MAX) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

/// What the list is called; where a file lay is nobody's business in one that is kept.
fn file_name(list: &IoList) -> String {
    if let Some(ListLink::Server { url, .. }) = &list.link {
        return one_line(url);
    }
    one_line(list.from.rsplit(['/', '\\']).next().unwrap_or(&list.from))
}

/// A key of TOML.
fn key(name: &str) -> String {
    let is_bare = name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'));
    if is_bare { name.to_owned() } else { quoted(name) }
}

fn step(list: &IoList) -> String {
    list.cycle.unwrap_or(CYCLE).to_string().replace(' ', "")
}

/// `scenario.toml`.
pub(super) fn scenario(name: &str, list: &IoList, signals: &[Signal], plc: &Plc) -> String {
    let from = file_name(list);
    let step = step(list);
    let mut text = format!(
        "# {name}: made of {from} ({title}). README.md says what to do next.

version = 1
title = {headline}
step = \"{step}\"
until = \"10s\"

# The I/O list, in its order: what the PLC reads is written by the plant, everything else by the PLC.
[signals]
",
        title = list.kind.title(),
        headline = quoted(&format!("{name}: {} signals of {from}", signals.len())),
    );
    for signal in signals {
        let point = &signal.point;
        let writer = if point.direction == Direction::Input { "plant" } else { "plc" };
        let _ = write!(text, "{} = {{ type = \"{}\", writer = \"{writer}\"", key(&signal.name), point.ty);
        if let Some(comment) = &point.comment {
            let _ = write!(text, ", about = {}", quoted(&one_line(comment)));
        }
        text += " }";
        if let Some(address) = &point.address {
            let _ = write!(text, "  # {}", one_line(address));
        }
        text += "\n";
    }
    text += "
# The plant, to be: an operator whose signals are 0 and FALSE until a case or somebody sets them. With a scene,
# `kind = \"plant\"` and `scene = \"plant.toml\"` stand here.
[clients.plant]
kind = \"operator\"

";
    text += &client(plc, &step);
    text += &gateway(list, signals);
    text += &panel(signals);
    if signals.len() > PLOTTED {
        let first: Vec<_> = signals.iter().take(PLOTTED).map(|signal| quoted(&signal.name)).collect();
        let _ = write!(text, "\n# What `--plot` draws.\n[plot]\nsignals = [{}]\n", first.join(", "));
    }
    text
}

/// A panel of all signals, so that the page shows what the PLC does; of many there is the usual one, of what the plant writes.
fn panel(signals: &[Signal]) -> String {
    const COLUMNS: usize = 6;
    const SPAN: usize = 2;
    let element = |signal: &Signal| {
        let ty = signal.point.ty;
        let is_number = ty.as_f64(&vec![0; ty.size()]).is_some();
        match (signal.point.direction, ty == SignalType::BOOL) {
            (Direction::Input, true) => Some("kind = \"switch\""),
            (Direction::Output, true) => Some("kind = \"lamp\""),
            (Direction::Input, false) => is_number.then_some("kind = \"slider\", max = 100"),
            (Direction::Output, false) => is_number.then_some("kind = \"number\""),
        }
    };
    let mut shown: Vec<(&Signal, &str)> =
        signals.iter().filter_map(|signal| Some((signal, element(signal)?))).collect();
    // What people operate first; each in the list's order.
    shown.sort_by_key(|(signal, _)| signal.point.direction);
    if shown.is_empty() || shown.len() > ON_PANEL {
        return String::new();
    }
    let mut text = "
# What `run --web` shows. With a scene, switches and sliders of what the plant writes become lamps and numbers.
[[panel]]
name = \"inputs and outputs\"
element = [
"
    .to_owned();
    for (number, (signal, kind)) in shown.iter().enumerate() {
        let [column, row] = [number % (COLUMNS / SPAN) * SPAN, number / (COLUMNS / SPAN)];
        let name = quoted(&signal.name);
        let _ = writeln!(text, "    {{ {kind}, signal = {name}, at = [{column}, {row}], span = [{SPAN}, 1] }},");
    }
    text + "]\n"
}

fn client(plc: &Plc, step: &str) -> String {
    let mut text = String::new();
    match plc {
        Plc::StandIn { bind } => {
            let _ = write!(
                text,
                "# A stand-in for the PLC, with its inputs and outputs and no program: put the PLC's own sources here.
[clients.plc]
kind = \"soft-plc\"
sources = [\"plc/main.st\"]
tasks = [{{ name = \"main\", interval = \"{step}\", programs = [\"Main\"] }}]
"
            );
            text += &table("clients.plc.bind", bind);
        }
        Plc::Sources { files, programs, bind } => {
            text += "[clients.plc]\nkind = \"soft-plc\"\nsources = [\n";
            for file in files {
                let _ = writeln!(text, "    {},", quoted(file));
            }
            text += "]\n";
            if !programs.is_empty() {
                let programs: Vec<_> = programs.iter().map(|program| quoted(program)).collect();
                let programs = programs.join(", ");
                let _ =
                    writeln!(text, "tasks = [{{ name = \"main\", interval = \"{step}\", programs = [{programs}] }}]");
            }
            text += &table("clients.plc.bind", bind);
        }
    }
    text
}

fn table(name: &str, entries: &[(String, String)]) -> String {
    if entries.is_empty() {
        return String::new();
    }
    let lines = entries.iter().map(|(name, value)| format!("{} = {}\n", key(name), quoted(value)));
    format!("\n[{name}]\n{}", lines.collect::<String>())
}

/// How the real PLC is reached, as far as the list says.
fn gateway(list: &IoList, signals: &[Signal]) -> String {
    let (about, url, port) = match &list.link {
        None => return String::new(),
        Some(ListLink::Server { url, .. }) => ("", url.as_str(), None),
        Some(ListLink::Ads(port)) => {
            ("# The real PLC; a TwinCAT on another machine is `ads://ITS-ADDRESS`.\n", "ads://127.0.0.1", *port)
        }
    };
    let entry = |signal: &Signal| {
        let places = vec![Place::Only(signal.point.symbol.clone()?)];
        Some(Entry::Mapped { name: signal.name.clone(), places })
    };
    let entries = signals.iter().filter_map(entry).collect();
    let system_words = matches!(list.link, Some(ListLink::Server { system_words: true, .. }));
    let fragment = Fragment { client: "plc".to_owned(), url: url.to_owned(), system_words, entries };
    let port = port.map(|port| format!("\n[clients.plc.gateway.ads]\nport = {port}\n")).unwrap_or_default();
    format!("\n{about}{fragment}{port}")
}

/// `plc/main.st`, for a list that has no program.
pub(super) fn stand_in(name: &str, variables: &[(&Signal, String)]) -> String {
    let mut text = format!("(* The inputs and outputs of {name}, and no program. *)\n\nPROGRAM Main\n");
    for (direction, section) in [(Direction::Input, "VAR_INPUT"), (Direction::Output, "VAR_OUTPUT")] {
        let mut of_section = variables.iter().filter(|(signal, _)| signal.point.direction == direction).peekable();
        if of_section.peek().is_none() {
            continue;
        }
        let _ = writeln!(text, "{section}");
        for (signal, variable) in of_section {
            let _ = writeln!(text, "    {variable} : {};", signal.point.ty);
        }
        text += "END_VAR\n";
    }
    // An output that nothing writes is a finding of `check`; the programs that come in its place write it.
    for (signal, variable) in variables.iter().filter(|(signal, _)| signal.point.direction == Direction::Output) {
        let _ = writeln!(text, "    {variable} := {};", at_rest(signal.point.ty));
    }
    text + "END_PROGRAM\n"
}

/// The value with which a stand-in writes an output of the type.
fn at_rest(ty: SignalType) -> String {
    match ty {
        SignalType::Elementary(ty) => literal(ty, &[]),
        SignalType::Wstring(_) => "\"\"".to_owned(),
        SignalType::String(_) | SignalType::Bytes(_) => "''".to_owned(),
    }
}

/// `README.md`.
pub(super) fn readme(name: &str, list: &IoList, plc: &Plc, proposed: usize) -> String {
    let main = match plc {
        Plc::StandIn { .. } => "| `plc/main.st` | a stand-in for the PLC: inputs and outputs, no program |\n",
        Plc::Sources { .. } => "",
    };
    let (scene, plant) = if proposed == 0 {
        (String::new(), "1. Write the plant as a scene, `plant.toml`, and name it in `[clients.plant]`;")
    } else {
        let row = format!(
            "| `plant.toml` | {}, by the names of signals, as comments |\n",
            counted(proposed as u64, "component")
        );
        (row, "1. Take from `plant.toml` what is right, add bodies and joints, and name it in `[clients.plant]`;")
    };
    let sources = match plc {
        Plc::StandIn { .. } => {
            "2. Name the PLC's sources in `[clients.plc]`, and in `bind` the variable of each signal that is called \
             otherwise.\n"
        }
        Plc::Sources { .. } => "2. Look at `bind` in `scenario.toml`: it names the variable of each signal.\n",
    };
    format!(
        "# {name}

Made of {from} ({title}).

| file | what it is |
|---|---|
| `scenario.toml` | the session: the signals of the list, the clients |
{scene}{main}
```sh
onescan run {name}{allowance}       # run it: all inputs of the PLC are 0 and FALSE
onescan run {name}{allowance} --web # operate it: a page with all signals
onescan wiring {name}{allowance}    # show which signal connects what
onescan check {name}{allowance}     # check the PLC's sources
```

What to do next:

{plant}
   or let `[clients.plant]` be a program of your own, `kind = \"external\"`.
{sources}3. Say in `[[expect]]` what every run must show.
",
        from = file_name(list),
        title = list.kind.title(),
        allowance = allowance(list),
    )
}

/// What a command needs so that the scenario may read sources that stay where they are, outside of its folder.
pub(super) fn allowance(list: &IoList) -> String {
    let from = Path::new(&list.from);
    // one word for a whole project, whose folders have their sources each
    let project = if from.is_dir() { Some(from) } else { from.parent() };
    let files = list.sources.iter().flat_map(|sources| &sources.files);
    let folders: BTreeSet<&Path> = files
        .filter_map(|file| file.parent())
        .map(|folder| project.filter(|project| folder.starts_with(project)).unwrap_or(folder))
        .collect();
    let written = |folder: &Path| if folder == Path::new("") { ".".to_owned() } else { folder.display().to_string() };
    folders.into_iter().map(|folder| format!(" --allow-path {}", written(folder))).collect()
}
