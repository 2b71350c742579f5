//! Constants of a PLC that a case sets.
//!
//! A compiled program holds the values of its constants, so they are set before: in the program's text, in
//! the place of their initial values. Lines stay where they are.

use std::ops::Range;

use onescan_plc_shim::Input;
use onescan_plc_shim::input::kind::SourceKind;
use onescan_plc_shim::syntax::ast::{Declaration, Qualifier, Section};
use onescan_plc_shim::syntax::{FileId, parse_in};

use super::Setting;
use super::value::literal_of;

/// The source with the constants that the settings name. Constants of sources that are not plain text,
/// and those declared together with others, stay as they are.
pub fn set(input: Input, settings: &[&Setting]) -> Input {
    let file = input.file();
    if settings.is_empty() || file.origin().is_some() {
        return input;
    }
    let unit = parse_in(file.dialect(), FileId(0), file.text()).unit;
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    for declaration in &unit.declarations {
        match declaration {
            Declaration::Pou(pou) => {
                pou.sections.iter().for_each(|section| edit(section, Some(&pou.name.text), settings, &mut edits));
            }
            Declaration::Globals(section) => edit(section, None, settings, &mut edits),
            _ => {}
        }
    }
    if edits.is_empty() {
        return input;
    }
    edits.sort_by_key(|(at, _)| at.start);
    let mut text = file.text().to_string();
    for (at, with) in edits.into_iter().rev() {
        text.replace_range(at, &with);
    }
    Input::from_text(file.name(), SourceKind::Text, text).in_dialect(file.dialect())
}

/// The edits of one section, which is `owner`'s or global.
fn edit(section: &Section, owner: Option<&str>, settings: &[&Setting], edits: &mut Vec<(Range<usize>, String)>) {
    if !section.qualifiers.contains(&Qualifier::Constant) {
        return;
    }
    for variable in &section.variables {
        let ([name], Some(initial)) = (&variable.names[..], &variable.initial) else { continue };
        let named = settings.iter().find(|setting| is_named(setting, owner, &name.text));
        if let Some(literal) = named.and_then(|setting| literal_of(&setting.value)) {
            edits.push((initial.span.start as usize..initial.span.end as usize, literal));
        }
    }
}

/// True if the setting's path, behind its client, is `OWNER.NAME`, or ends in the name of a global.
fn is_named(setting: &Setting, owner: Option<&str>, name: &str) -> bool {
    let path = setting.path.split_once('.').map_or("", |(_, path)| path);
    match (path.rsplit_once('.'), owner) {
        (Some((before, last)), Some(owner)) => before.eq_ignore_ascii_case(owner) && last.eq_ignore_ascii_case(name),
        (Some(_), None) => false,
        (None, owner) => owner.is_none() && path.eq_ignore_ascii_case(name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toml::Value;

    fn edited(path: &str, value: impl Into<Value>) -> String {
        let text = "PROGRAM Main VAR CONSTANT a : INT := 1; b, c : INT := 2; END_VAR VAR a1 : INT := 3; END_VAR END_PROGRAM\n\
                    VAR_GLOBAL CONSTANT Rest : TIME := T#1s; END_VAR\n";
        let setting = Setting { path: path.to_owned(), value: value.into(), place: 0..0 };
        let input = Input::from_text("a.st", SourceKind::Text, text);
        set(input, &[&setting]).file().text().to_string()
    }

    #[test]
    fn a_constant_takes_another_value_in_its_place() {
        assert!(edited("plc.main.A", 7).contains("a : INT := 7;"));
        assert!(edited("plc.Rest", "T#20ms").contains("Rest : TIME := T#20ms;"));
        for other in ["plc.Main.a1", "plc.Main.b", "plc.Other.a", "plc.a"] {
            let text = edited(other, 7);
            assert!(!text.contains('7'), "{other}: {text}");
        }
    }
}
