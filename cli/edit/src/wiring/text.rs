//! The map for people: signals by who writes them for whom, then what is wrong.

use std::io::{self, Write};

use super::fold::{Line, fold, fold_names};
use super::map::{Hook, Map, OpenInput, TroubleKind, Wired};

/// Most ends of a signal that are all named.
const ENDS_MAX: usize = 3;

pub(super) fn write(map: &Map, out: &mut dyn Write) -> io::Result<()> {
    for member in &map.clients {
        let known = if member.known { "" } else { ", whose signals are not known before it joins" };
        writeln!(out, "{}: {}{known}", member.name, member.kind)?;
    }
    for (route, lines) in routes(map) {
        writeln!(out, "\n{route}")?;
        let lines = fold(&lines);
        let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or_default();
        let (name, ty) = (width(0), width(1));
        for line in &lines {
            let reported = format!("  {:name$}  {:ty$}  {}", line[0], line[1], line[2]);
            writeln!(out, "{}", reported.trim_end())?;
        }
    }
    for kind in [TroubleKind::Unconnected, TroubleKind::WrittenTwice, TroubleKind::UnequalType] {
        let of_kind = map.troubles.iter().filter(|trouble| trouble.kind == kind);
        let lines: Vec<Line> = of_kind.map(|trouble| vec![trouble.signal.clone(), trouble.message.clone()]).collect();
        if !lines.is_empty() {
            writeln!(out, "\n{} ({})", kind.title(), lines.len())?;
        }
        for line in fold(&lines) {
            writeln!(out, "  {}: {}", line[0], line[1])?;
        }
    }
    open(map, out)?;
    if !map.undriven.is_empty() {
        writeln!(out, "\ninputs of PLCs that nobody drives ({})", map.undriven.len())?;
    }
    map.undriven
        .iter()
        .try_for_each(|input| writeln!(out, "  {}: {}:{}: {}", input.client, input.file, input.line, input.message))
}

/// The inputs of components that nobody drives, and what they are.
fn open(map: &Map, out: &mut dyn Write) -> io::Result<()> {
    let line = |open: &OpenInput| vec![open.client.clone(), open.input.clone(), open.preset.to_string()];
    let lines: Vec<Line> = map.open.iter().map(line).collect();
    if !lines.is_empty() {
        writeln!(out, "\ninputs of components that nobody drives ({})", lines.len())?;
    }
    fold(&lines).iter().try_for_each(|line| writeln!(out, "  {}: {} = {}", line[0], line[1], line[2]))
}

/// The signals by route, as in `plant -> plc`, in the order of the clients.
fn routes(map: &Map) -> Vec<(String, Vec<Line>)> {
    let mut routes: Vec<(String, Vec<Line>)> = Vec::new();
    let all_known = map.clients.iter().all(|member| member.known);
    let none = if all_known { "nobody" } else { "nobody that is known" };
    for signal in &map.signals {
        let readers: Vec<_> = signal.readers.iter().map(|reader| reader.client.as_str()).collect();
        let readers = if readers.is_empty() { none.to_owned() } else { readers.join(", ") };
        let route = format!("{} -> {readers}", signal.writer.client);
        let line = vec![signal.name.clone(), signal.ty.clone(), way(signal)];
        match routes.iter_mut().find(|(known, _)| *known == route) {
            Some((_, lines)) => lines.push(line),
            None => routes.push((route, vec![line])),
        }
    }
    routes.sort_by(|(one, _), (other, _)| one.cmp(other));
    routes
}

/// From where to where.
fn way(signal: &Wired) -> String {
    let to: Vec<_> = signal.readers.iter().map(ends).filter(|ends| !ends.is_empty()).collect();
    match (ends(&signal.writer), to.join("; ")) {
        (from, to) if from.is_empty() && to.is_empty() => String::new(),
        (from, to) => format!("{from} -> {to}").trim_end_matches(" -> ").trim_start().to_owned(),
    }
}

/// Inputs, outputs or variables, the first of many.
fn ends(hook: &Hook) -> String {
    let names = fold_names(&hook.at);
    match names.len() {
        0..=ENDS_MAX => names.join(", "),
        more => format!("{}, and {} more", names[..ENDS_MAX].join(", "), more - ENDS_MAX),
    }
}
