//! The shim's sources as objects of a TwinCAT 3 project.

use std::path::{Component, Path};

use super::target::Source;
use super::{configuration, marks};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::ast::Configuration;
use onescan_iec::syntax::constant::Constants;
use onescan_iec::syntax::token::{Keyword, TokenKind};
use onescan_iec::syntax::tokenize;

/// A global variable list.
pub(super) fn globals(name: &str, text: &str) -> Source {
    let text = object("GVL", name, &format!("    <Declaration><![CDATA[{}]]></Declaration>\n", text.trim_end()));
    Source { name: format!("{name}.TcGVL"), text }
}

/// A data type.
pub(super) fn data_type(name: &str, text: &str) -> Source {
    let text = object("DUT", name, &format!("    <Declaration><![CDATA[{}]]></Declaration>\n", text.trim_end()));
    Source { name: format!("{name}.TcDUT"), text }
}

/// A program organisation unit: its declarations and its statements stand apart, its end is left out.
pub(super) fn unit(name: &str, text: &str) -> Source {
    let tokens = tokenize(text);
    let keyword = |wanted: &[Keyword]| {
        let is_wanted = |kind| matches!(kind, TokenKind::Keyword(found) if wanted.contains(&found));
        tokens.iter().rfind(|token| is_wanted(token.kind))
    };
    let declared = keyword(&[Keyword::EndVar]).map_or(0, |token| token.end as usize);
    let ends = [Keyword::EndProgram, Keyword::EndFunctionBlock, Keyword::EndFunction];
    let end = keyword(&ends).map_or(text.len(), |token| token.start as usize);
    let declarations = text.get(..declared).unwrap_or("");
    let statements = text.get(declared..end).unwrap_or("").trim_matches('\n');
    let parts = format!(
        "    <Declaration><![CDATA[{declarations}\n]]></Declaration>\n    \
         <Implementation>\n      <ST><![CDATA[{statements}]]></ST>\n    </Implementation>\n"
    );
    Source { name: format!("{name}.TcPOU"), text: object("POU", name, &parts) }
}

fn object(kind: &str, name: &str, parts: &str) -> String {
    let special = if kind == "POU" { " SpecialFunc=\"None\"" } else { "" };
    format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n{}\n<TcPlcObject Version=\"1.1.0.1\">\n  \
         <{kind} Name=\"{name}\" Id=\"{}\"{special}>\n{parts}  </{kind}>\n</TcPlcObject>\n",
        marks::XML_FILE,
        identity(name)
    )
}

/// The language that the body of a file's unit is drawn in.
pub(super) fn drawn_in(file: &SourceFile) -> Option<&'static str> {
    const DRAWN: [(&str, &str); 3] = [("CFC", "CFC"), ("NWL", "LD or FBD"), ("SFC", "SFC")];
    let unit = onescan_xml::parse(file.shown_text()).ok()?.into_child("POU")?;
    let body = unit.child("Implementation")?;
    DRAWN.iter().find(|(name, _)| body.child(name).is_some()).map(|(_, language)| *language)
}

/// The part of a project's configuration with the task that comes first in a cycle.
pub(super) fn first_task<'a>(parts: &[&'a Configuration], constants: &Constants<'_>) -> Option<&'a Configuration> {
    let rank = |part: &&&Configuration| {
        let tasks = configuration::tasks(part, constants).unwrap_or_default();
        // A part without tasks comes last.
        (tasks.is_empty(), tasks.iter().map(|task| (task.priority, task.interval)).min())
    };
    parts.iter().min_by_key(rank).copied()
}

/// Lets a task, in its file, call the scheduler before its programs.
pub(super) fn call_scheduler(file: &SourceFile, edits: &mut Edits) {
    let text = file.shown_text();
    let Some(task) = onescan_xml::parse(text).ok().and_then(|root| root.into_child("Task")) else { return };
    let at = task.child("PouCall").map_or(task.close.start, |call| call.open.start);
    let start = marks::line_start(text, at);
    let indentation = text.get(start as usize..at as usize).unwrap_or("");
    let call = format!("{indentation}<PouCall>\n{indentation}  <Name>SDSP_Scheduler</Name>\n{indentation}</PouCall>");
    edits.insert(start, marks::xml_lines(&call, marks::line_break(text)));
}

/// Lists `files` in the project `name`.
pub(super) fn listing(name: &str, project: &str, files: &[String]) -> Edits {
    let mut edits = Edits::default();
    let Some(end) = project.rfind("</Project>").filter(|_| !files.is_empty()) else {
        return edits;
    };
    let folder = Path::new(name).parent().unwrap_or(Path::new(""));
    let mut items = String::from("  <ItemGroup>\n");
    for file in files {
        let path = Path::new(file).strip_prefix(folder).unwrap_or(Path::new(file));
        let parts: Vec<_> = path.components().filter(|part| *part != Component::CurDir).collect();
        let parts: Vec<_> = parts.iter().map(|part| part.as_os_str().to_string_lossy()).collect();
        items = items + "    <Compile Include=\"" + &parts.join("\\") + "\">\n";
        items += "      <SubType>Code</SubType>\n    </Compile>\n";
    }
    items += "  </ItemGroup>";
    edits.insert(end as u32, marks::xml_lines(&items, marks::line_break(project)));
    edits
}

/// An object's id, the same for the same name: two FNV-1a hashes, marked as made from a name (RFC 9562,
/// version 8).
fn identity(name: &str) -> String {
    let hash = |seed: u64| {
        let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        name.bytes().fold(0xcbf2_9ce4_8422_2325 ^ seed, mix)
    };
    let (high, low) = (hash(0), hash(0x5d5d));
    let (high, low) = (high & !0xf000 | 0x8000, low & !(3 << 62) | 2 << 62);
    format!(
        "{{{:08x}-{:04x}-{:04x}-{:04x}-{:012x}}}",
        high >> 32,
        high >> 16 & 0xffff,
        high & 0xffff,
        low >> 48,
        low & 0xffff_ffff_ffff
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_iec::input::Input;
    use onescan_iec::input::kind::SourceKind;

    #[test]
    fn a_unit_reads_back() {
        let text = "(* About. *)\nFUNCTION f : INT\nVAR_INPUT x : INT; END_VAR\n    f := x;\nEND_FUNCTION\n";
        let source = unit("f", text);
        let input = Input::from_text(&source.name, SourceKind::TwinCat, source.text);
        assert_eq!(input.file().text().replace("\n\n", "\n"), text);
        let read = Input::from_text("g.TcGVL", SourceKind::TwinCat, globals("g", "VAR_GLOBAL END_VAR\n").text);
        assert_eq!(&**read.file().text(), "NAMESPACE OPEN g\nVAR_GLOBAL END_VAR\nEND_NAMESPACE\n");
    }

    #[test]
    fn identities_are_stable_and_differ() {
        assert_eq!(identity("SDSP"), identity("SDSP"));
        assert_ne!(identity("SDSP_TON"), identity("SDSP_TOF"));
        assert_eq!(identity("SDSP").len(), 38);
    }
}
