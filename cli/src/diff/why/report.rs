//! The way back from a signal, for people and machines.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::{Origin, Place, Record, What, Why};
use crate::diff::report::NAMES;

/// Links that are shown at each end of a long way.
const SHOWN: usize = 5;

/// Writes the way back for people.
///
/// # Errors
/// `out` takes no more.
pub fn write(why: &Why, out: &mut dyn Write) -> io::Result<()> {
    match &why.signal {
        Some(signal) => writeln!(out, "\nwhy {signal} differs, from the last difference back to the first")?,
        None => writeln!(out, "\nno output differs; inside the PLC, from the last difference back to the first")?,
    }
    let left_out = why.links.len().saturating_sub(2 * SHOWN);
    for (index, link) in why.links.iter().enumerate() {
        if left_out > 0 && (SHOWN..SHOWN + left_out).contains(&index) {
            if index == SHOWN {
                writeln!(out, "  … {left_out} more …")?;
            }
            continue;
        }
        write_link(link, out)?;
    }
    Ok(())
}

fn write_link(Record { client, t_v, at, what, origin }: &Record, out: &mut dyn Write) -> io::Result<()> {
    match what {
        What::Value { path, values: [a, b] } => writeln!(out, "  {t_v}  {client}: {path} is {a} in A, {b} in B")?,
        What::Way([a, b]) => writeln!(out, "  {t_v}  {client}: goes to {a} in A, to {b} in B")?,
        What::Run => writeln!(out, "  {t_v}  {client}: executes other statements in A than in B")?,
        What::Declared(name) => writeln!(out, "  {client}: {name} is declared otherwise in A than in B")?,
        What::Text => writeln!(out, "  {t_v}  {client}: a statement is another in A than in B")?,
    }
    match at {
        [Some(a), Some(b)] if a == b => write_place("", a, out)?,
        _ => {
            for (name, place) in NAMES.iter().zip(at) {
                match place {
                    Some(place) => write_place(name, place, out)?,
                    None if at.iter().any(Option::is_some) => writeln!(out, "       {name} nothing")?,
                    None => {}
                }
            }
        }
    }
    match origin {
        Origin::Here if at[0] != at[1] => writeln!(out, "       here they part: it is written otherwise"),
        Origin::Here => writeln!(out, "       here they part: what it uses is another"),
        Origin::Initial => writeln!(out, "       here they part: it begins with another value"),
        Origin::Input => writeln!(out, "       it is an input: what writes it differs"),
        Origin::Feedback(_) => writeln!(out, "       it is an input, and follows the PLC's outputs"),
        Origin::Earlier(_) => Ok(()),
    }
}

fn write_place(name: &str, Place { file, line, unit, text }: &Place, out: &mut dyn Write) -> io::Result<()> {
    let name = if name.is_empty() { String::new() } else { format!("{name} ") };
    writeln!(out, "       {name}{file}:{line} in {unit}: {text}")
}

/// The way back as JSON.
pub fn json(why: &Why) -> Value {
    let link = |record: &Record| {
        let place = |place: &Option<Place>| {
            let Place { file, line, unit, text } = place.as_ref()?;
            Some(json!({ "file": file, "line": line, "unit": unit, "statement": text }))
        };
        let what = match &record.what {
            What::Value { path, values: [a, b] } => json!({ "variable": path, "a": a, "b": b }),
            What::Way([a, b]) => json!({ "way": { "a": a, "b": b } }),
            What::Run => json!("other statements"),
            What::Text => json!("another statement"),
            What::Declared(name) => json!({ "declaration": name }),
        };
        let origin = match record.origin {
            Origin::Earlier(_) => "earlier",
            Origin::Here => "here",
            Origin::Initial => "initial",
            Origin::Input => "input",
            Origin::Feedback(_) => "feedback",
        };
        let [a, b] = record.at.each_ref().map(place);
        json!({
            "client": record.client, "t_v_ns": record.t_v.as_nanos(), "what": what, "a": a, "b": b, "origin": origin,
        })
    };
    json!({ "signal": why.signal, "links": why.links.iter().map(link).collect::<Vec<_>>() })
}
