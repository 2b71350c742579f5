//! Which files of its libraries a program needs.
//!
//! Vendors' tools compile of a library what the program uses, so that a library may hold units that nobody can compile.
//! A file is needed if the program, or another needed file, names something that it declares. A name that means
//! something else keeps a file that could be left out, which does no harm.

use std::collections::{BTreeMap, BTreeSet};

use super::{Input, Owner};
use crate::syntax::ast::{Declaration, Ident, Section, TypeDeclaration, TypeSpecKind};
use crate::syntax::token::TokenKind;
use crate::syntax::{SourceMap, parse_source, tokenize_in};

/// The program's own files, and those of its libraries that it needs, in their order.
pub fn needed(inputs: Vec<Input>) -> Vec<Input> {
    let mut is_needed = vec![true; inputs.len()];
    let mut declared: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, input) in inputs.iter().enumerate() {
        for name in names_of_library(input) {
            is_needed[index] = false;
            declared.entry(name).or_default().push(index);
        }
    }
    let mut unread: Vec<usize> = (0..inputs.len()).filter(|index| is_needed[*index]).collect();
    while let Some(index) = unread.pop() {
        for name in mentioned(&inputs[index]) {
            for index in declared.remove(&name).into_iter().flatten() {
                if !std::mem::replace(&mut is_needed[index], true) {
                    unread.push(index);
                }
            }
        }
    }
    inputs.into_iter().zip(is_needed).filter_map(|(input, is_needed)| is_needed.then_some(input)).collect()
}

/// What a file of a library declares, in capitals. Nothing for a file that is always there: one of the program, one
/// that asks for it, and one that declares nothing that could be named.
fn names_of_library(input: &Input) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let Owner::Library(namespace) = &input.owner else { return names };
    if !is_always_linked(input.file.text()) {
        let file = SourceMap::default().add(input.file.clone());
        collect(&parse_source(file, &input.file).unit.declarations, &mut names);
    }
    // The name of the library itself stands before all that it has.
    if let Some(namespace) = namespace {
        names.remove(&namespace.to_ascii_uppercase());
    }
    names
}

/// `{attribute 'linkalways'}` of CODESYS and TwinCAT.
fn is_always_linked(text: &str) -> bool {
    text.to_ascii_lowercase().contains("'linkalways'")
}

fn collect(declarations: &[Declaration], names: &mut BTreeSet<String>) {
    for declaration in declarations {
        match declaration {
            Declaration::Pou(pou) => {
                names.insert(pou.name.key());
            }
            Declaration::Type(declaration) => collect_type(declaration, names),
            Declaration::Globals(section) => collect_variables(section, names),
            Declaration::Namespace(namespace) => {
                names.insert(namespace.name.key());
                collect(&namespace.declarations, names);
            }
            Declaration::Using(_) | Declaration::Configuration(_) => {}
        }
    }
}

/// A type, and the values of an enumeration, which are known without it.
fn collect_type(declaration: &TypeDeclaration, names: &mut BTreeSet<String>) {
    names.insert(declaration.name.key());
    if let TypeSpecKind::Enumeration(values, _) = &declaration.spec.kind {
        names.extend(values.iter().map(|value| value.name.key()));
    }
}

fn collect_variables(section: &Section, names: &mut BTreeSet<String>) {
    names.extend(section.variables.iter().flat_map(|variable| &variable.names).map(Ident::key));
}

/// The names in a file's text, in capitals.
fn mentioned(input: &Input) -> BTreeSet<String> {
    let text = &**input.file.text();
    let tokens = tokenize_in(input.file.dialect(), text);
    let names = tokens.iter().filter(|token| token.kind == TokenKind::Identifier);
    names.map(|token| text[token.start as usize..token.end as usize].to_ascii_uppercase()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::found::Found;
    use crate::input::kind::SourceKind;

    fn left(own: &str, library: &[(&str, &str)]) -> Vec<String> {
        let of_library = |(name, text): &(&str, &str)| {
            Input::of_library(None, name, Found::decode(SourceKind::Text, text.as_bytes()))
        };
        let own = Input::from_text("own.st", SourceKind::Text, own);
        let inputs = std::iter::once(own).chain(library.iter().map(of_library)).collect();
        needed(inputs).iter().map(|input| input.file().name().to_owned()).collect()
    }

    #[test]
    fn what_is_named_in_turn_is_needed() {
        let library = [
            ("a.st", "FUNCTION_BLOCK A VAR b : B; END_VAR END_FUNCTION_BLOCK"),
            ("b.st", "TYPE B : (Red, Green); END_TYPE"),
            ("c.st", "FUNCTION_BLOCK C VAR a : A; END_VAR this is no statement END_FUNCTION_BLOCK"),
            ("d.st", "VAR_GLOBAL CONSTANT limit : INT := 3; END_VAR"),
        ];
        assert_eq!(left("PROGRAM p VAR x : a; END_VAR END_PROGRAM", &library), ["own.st", "a.st", "b.st"]);
        assert_eq!(left("PROGRAM p VAR x : INT := LIMIT; END_VAR END_PROGRAM", &library), ["own.st", "d.st"]);
        assert_eq!(left("PROGRAM p VAR x : INT := green; END_VAR END_PROGRAM", &library), ["own.st", "b.st"]);
        assert_eq!(left("PROGRAM p END_PROGRAM", &library), ["own.st"]);
    }

    #[test]
    fn what_asks_for_it_and_what_nobody_could_name_stays() {
        let library = [
            ("a.st", "{attribute 'LinkAlways'} FUNCTION_BLOCK A VAR b : B; END_VAR END_FUNCTION_BLOCK"),
            ("b.st", "TYPE B : (Red, Green); END_TYPE"),
            ("c.st", "this is no program"),
        ];
        assert_eq!(left("PROGRAM p END_PROGRAM", &library), ["own.st", "a.st", "b.st", "c.st"]);
    }
}
