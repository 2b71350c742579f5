//! The way back from a signal, for people and machines.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::{Origin, Place, Record, What, Why};

/// Links that are shown at each end of a long way.
const SHOWN: usize = 5;

/// What the two runs are called.
#[derive(Clone, Debug)]
pub struct Runs {
    pub names: [String; 2],
    /// The same as part of a sentence: a value is so `in A`, `at HEAD`, `now`.
    pub there: [String; 2],
}

impl Runs {
    /// Two runs that are compared, neither being the older.
    pub fn named(names: [&str; 2]) -> Self {
        Self { names: names.map(str::to_owned), there: names.map(|name| format!("in {name}")) }
    }

    /// A run as it was at a commit, and as it is.
    pub fn since(commit: &str) -> Self {
        Self { names: [commit.to_owned(), "now".to_owned()], there: [format!("at {commit}"), "now".to_owned()] }
    }
}

/// Writes the way back for people.
///
/// # Errors
/// `out` takes no more.
pub fn write(why: &Why, runs: &Runs, out: &mut dyn Write) -> io::Result<()> {
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
        write_link(link, runs, out)?;
    }
    Ok(())
}

fn write_link(record: &Record, runs: &Runs, out: &mut dyn Write) -> io::Result<()> {
    let Record { at, origin, .. } = record;
    writeln!(out, "  {}", subject(record, runs))?;
    match at {
        [Some(a), Some(b)] if a == b => write_place("", a, out)?,
        _ => {
            for (name, place) in runs.names.iter().zip(at) {
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

/// What differs, in a line.
pub fn subject(Record { client, t_v, what, .. }: &Record, Runs { there: [first, second], .. }: &Runs) -> String {
    match what {
        What::Value { path, values: [a, b] } => format!("{t_v}  {client}: {path} is {a} {first}, {b} {second}"),
        What::Way([a, b]) => format!("{t_v}  {client}: goes to {a} {first}, to {b} {second}"),
        What::Run => format!("{t_v}  {client}: the statements that are executed {first} are not those {second}"),
        What::Declared(name) => format!("{client}: {name} is declared otherwise {second} than {first}"),
        What::Text => format!("{t_v}  {client}: a statement is another {second} than {first}"),
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
