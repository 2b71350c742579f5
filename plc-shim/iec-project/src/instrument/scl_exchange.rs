//! What a gateway exchanges over S7 communication, in SCL: a data block each way, and the copies between them and the
//! program's variables.
//!
//! A block has the layout that the link writes when nothing else is declared: to the PLC the inputs and then the words,
//! the grant last; from the PLC the words and then the outputs; BOOLs bit by bit, bytes on the next byte, everything
//! else on the next even byte.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use onescan_base::{ElementaryType, SignalType};

use super::exchanged::{Exchanged, Way};
use super::template;
use crate::output::scl;
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::syntax::{FileId, Span};

/// The number of the block to the PLC; low ones are those that a project gives to its own blocks.
pub const DB_TO_PLC: u16 = 2001;
/// And of the block from it.
pub const DB_FROM_PLC: u16 = 2002;

/// How the copies from the gateway's block begin, and those to the other.
pub(super) const TAKE: &str = "(* At the head of each cycle.";
pub(super) const GIVE: &str = "(* While no program may run,";

/// The words to the PLC in their order, the grant last.
const WORDS_TO_PLC: [(&str, Form); 4] =
    [("SDSP_Session", Form::UDINT), ("SDSP_Limit", Form::UDINT), ("SDSP_TV", Form::LINT), ("SDSP_Grant", Form::UDINT)];

/// The words from it.
const WORDS_FROM_PLC: [(&str, Form); 4] = [
    ("SDSP_Joined", Form::UDINT),
    ("SDSP_Done", Form::UDINT),
    ("SDSP_Answer", Form::INT),
    ("SDSP_Layout", Form::UDINT),
];

/// The blocks and copies of what is exchanged; nothing if nothing is, or a value has no place in a block.
pub(super) fn text(exchanged: &[Exchanged]) -> Option<String> {
    if !goes_in_blocks(exchanged) {
        return None;
    }
    let of = |way: Way| exchanged.iter().filter(move |each| each.way == way).collect::<Vec<_>>();
    let (inputs, outputs) = (of(Way::ToPlc), of(Way::FromPlc));
    let (mut to_plc, mut from_plc) = (Block::default(), Block::default());
    let taken: String = inputs.into_iter().map(|each| to_plc.taken(each)).collect();
    for (word, form) in &WORDS_TO_PLC {
        to_plc.add(word, *form, "");
    }
    for (word, form) in &WORDS_FROM_PLC {
        from_plc.add(word, *form, "");
    }
    let given: String = outputs.into_iter().map(|each| from_plc.given(each)).collect();
    let replaced = [
        ("SDSP_NUMBER_TO", DB_TO_PLC.to_string()),
        ("SDSP_NUMBER_FROM", DB_FROM_PLC.to_string()),
        ("      SDSP_MEMBERS_TO : Bool;\n", to_plc.lines),
        ("      SDSP_MEMBERS_FROM : Bool;\n", from_plc.lines),
        ("    ; // SDSP_TAKEN\n", taken),
        ("    ; // SDSP_GIVEN\n", given),
    ];
    Some(replaced.iter().fold(template::SCL_EXCHANGE.to_owned(), |text, (mark, new)| text.replace(mark, new)))
}

/// True if there is something to exchange, and all of it has a place in a data block of S7 communication.
pub fn goes_in_blocks(exchanged: &[Exchanged]) -> bool {
    !exchanged.is_empty() && refused(exchanged).is_none()
}

/// The warning about a signal that has no place in a data block; over OPC UA it goes as it is.
pub(super) fn refused(exchanged: &[Exchanged]) -> Option<Diagnostic> {
    let each = exchanged.iter().find(|each| form(each.ty).is_none())?;
    let message = format!(
        "signal `{}` is {}, which does not go in a data block of S7 communication: SDSP_ToPLC and SDSP_FromPLC are left \
         out",
        each.signal, each.ty
    );
    let found = Diagnostic::warning(Code::UnsupportedFeature, Span::new(FileId(0), 0, 0), message);
    Some(found.with_help("drive this PLC over OPC UA, or take the signal out of the session"))
}

/// How a value lies in a block.
#[derive(Clone, Copy)]
struct Form {
    size: usize,
    written: &'static str,
    /// A TIME counts milliseconds in SCL, and nanoseconds on a link.
    is_time: bool,
}

impl Form {
    const INT: Self = Self { size: 2, written: "Int", is_time: false };
    const UDINT: Self = Self { size: 4, written: "UDInt", is_time: false };
    const LINT: Self = Self { size: 8, written: "LInt", is_time: false };
}

fn form(ty: SignalType) -> Option<Form> {
    match ty {
        SignalType::Elementary(ElementaryType::Time) => Some(Form { is_time: true, ..Form::LINT }),
        // Dates and times of day count something else there, and strings begin with two lengths.
        SignalType::Elementary(ElementaryType::Date | ElementaryType::Tod)
        | SignalType::String(_)
        | SignalType::Wstring(_)
        | SignalType::Bytes(_) => None,
        SignalType::Elementary(ty) => {
            scl::elementary_name(ty).map(|written| Form { size: ty.size() as usize, written, is_time: false })
        }
    }
}

/// A data block that grows.
#[derive(Default)]
struct Block {
    lines: String,
    names: BTreeSet<String>,
    /// Its bytes so far.
    at: usize,
    /// Bits of the last byte that are taken; 0 if none is open.
    bits: usize,
}

impl Block {
    /// Adds a value; gives the statement that takes it.
    fn taken(&mut self, each: &Exchanged) -> String {
        let (name, form) = self.signal(each);
        let value = format!("\"SDSP_ToPLC\".{name}");
        let value = if form.is_time { format!("DINT_TO_TIME(LINT_TO_DINT({value} / 1000000))") } else { value };
        format!("    {} := {value};\n", variable(&each.variable))
    }

    /// Adds a value; gives the statement that gives it.
    fn given(&mut self, each: &Exchanged) -> String {
        let (name, form) = self.signal(each);
        let value = variable(&each.variable);
        let value = if form.is_time { format!("DINT_TO_LINT(TIME_TO_DINT({value})) * 1000000") } else { value };
        format!("    \"SDSP_FromPLC\".{name} := {value};\n")
    }

    fn signal(&mut self, each: &Exchanged) -> (String, Form) {
        // Nothing is written if one has none; see `text`.
        let form = form(each.ty).unwrap_or(Form::LINT);
        let name = self.name(&each.variable);
        let shown = if form.is_time { format!("{}, ns", each.signal) } else { each.signal.clone() };
        self.add(&name, form, &shown);
        (scl::members(&name), form)
    }

    /// A name that no member has yet.
    fn name(&self, path: &str) -> String {
        let plain: String = path.chars().map(|one| if one.is_ascii_alphanumeric() { one } else { '_' }).collect();
        let plain = plain.trim_matches('_');
        let stem = if plain.starts_with(|one: char| one.is_ascii_alphabetic()) {
            plain.to_owned()
        } else {
            format!("at_{plain}")
        };
        let stem = stem.split('_').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("_");
        let is_free = |name: &String| !self.names.contains(&name.to_ascii_uppercase());
        let numbered = (2..).map(|number| format!("{stem}_{number}"));
        std::iter::once(stem.clone()).chain(numbered).find(is_free).unwrap_or(stem)
    }

    fn add(&mut self, name: &str, form: Form, signal: &str) {
        let place = self.place(form);
        let about = if signal.is_empty() { String::new() } else { format!(" {signal}") };
        self.names.insert(name.to_ascii_uppercase());
        let (name, ty) = (scl::members(name), form.written);
        let _ = writeln!(self.lines, "      {name} : {ty}; // {place}{about}");
    }

    fn place(&mut self, form: Form) -> String {
        if form.written == "Bool" {
            if self.bits.is_multiple_of(8) {
                self.at += 1;
                self.bits = 0;
            }
            self.bits += 1;
            return format!("{}.{}", self.at - 1, self.bits - 1);
        }
        self.bits = 0;
        if form.size > 1 {
            self.at = self.at.next_multiple_of(2);
        }
        self.at += form.size;
        (self.at - form.size).to_string()
    }
}

/// A variable as a statement of another block names it.
fn variable(path: &str) -> String {
    if path.starts_with('%') {
        // Bits need no letter there.
        return path.replacen('X', "", 1);
    }
    let end = path.find(['.', '[']).unwrap_or(path.len());
    let (block, rest) = path.split_at(end);
    let rest = match rest.strip_prefix('.') {
        Some(members) => format!(".{}", scl::members(members)),
        None => rest.to_owned(),
    };
    format!("\"{block}\"{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exchanged(signal: &str, variable: &str, ty: SignalType, way: Way) -> Exchanged {
        Exchanged { signal: signal.to_owned(), variable: variable.to_owned(), ty, way, address: None }
    }

    #[test]
    fn blocks_are_laid_out_and_copied() {
        use Way::{FromPlc, ToPlc};
        let all = [
            exchanged("Level", "Tank.level", SignalType::LREAL, ToPlc),
            exchanged("Start", "Main.Start", SignalType::BOOL, ToPlc),
            exchanged("Start", "Other.Start", SignalType::BOOL, ToPlc),
            exchanged("Kind", "Main_Start", SignalType::BYTE, ToPlc),
            exchanged("Pause", "Main.pauses[2]", SignalType::TIME, ToPlc),
            exchanged("Key", "%IX0.3", SignalType::BOOL, ToPlc),
            exchanged("Run", "Main.motor.Run", SignalType::BOOL, FromPlc),
            exchanged("Rest", "Main.Rest", SignalType::TIME, FromPlc),
        ];
        insta::assert_snapshot!(text(&all).unwrap());
    }

    #[test]
    fn what_has_no_place_is_reported() {
        let string = SignalType::string(20).unwrap();
        let all = [exchanged("Name", "Main.Name", string, Way::ToPlc)];
        assert_eq!(text(&all), None);
        assert!(refused(&all).unwrap().message.contains("`Name` is STRING[20]"), "{:?}", refused(&all));
        assert_eq!((text(&[]), refused(&[])), (None, None));
    }
}
