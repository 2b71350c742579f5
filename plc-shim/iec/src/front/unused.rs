//! What CODESYS and TwinCAT do not compile: units and types that no task's program uses.
//!
//! Their build checks what is used and nothing else, so that a project may hold units that nobody can compile. Such a
//! unit is left out if it has errors; each is one warning then. What is sound stays, used or not.
//!
//! Used is what the tasks and global variables name, what a caller says that it uses, as tests, and what these name in turn. A name that means something else keeps
//! a unit that could be left out, which does no harm.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::{Code, Diagnostic, Severity, counted};
use crate::dialect::Feature;
use crate::source::Span;
use crate::syntax::ast::{CompilationUnit, Declaration, Ident, Section, TypeDeclaration, TypeSpecKind};
use crate::syntax::token::TokenKind;
use crate::syntax::{FileId, SourceFile, SourceMap, tokenize_in};

/// Declarations that no task's program uses.
pub(super) struct Unused {
    /// The names of units and types, with the text that belongs to each.
    declared: Vec<(String, Span)>,
    /// One for each that has been left out.
    warnings: Vec<Diagnostic>,
}

impl Unused {
    /// What is not used of all files but those of `library`; nothing is unused where there are no tasks. All that a file of
    /// `used` declares is used.
    pub(super) fn of(
        units: &[(FileId, CompilationUnit)],
        library: &BTreeSet<FileId>,
        used: &BTreeSet<FileId>,
        sources: &SourceMap,
    ) -> Self {
        let own = || units.iter().filter(|(file, _)| !library.contains(file));
        let has_tasks =
            own().any(|(_, unit)| unit.dialect.has(Feature::UnusedUnits) && unit.declarations.iter().any(has_programs));
        if !has_tasks {
            return Self { declared: Vec::new(), warnings: Vec::new() };
        }
        let parts = own().flat_map(|(file, unit)| {
            let is_used = used.contains(file);
            parts_of(*file, unit, sources)
                .into_iter()
                .map(move |part| Part { is_root: part.is_root || is_used, ..part })
        });
        let parts = parts.collect::<Vec<Part>>();
        Self { declared: unreached(&parts, sources), warnings: Vec::new() }
    }

    /// Takes what is unused and has errors out of `units`, and its errors out of both lists; false if there was nothing.
    pub(super) fn leave_out(
        &mut self,
        units: &mut [(FileId, CompilationUnit)],
        of_text: &mut Vec<Diagnostic>,
        found: &[Diagnostic],
    ) -> bool {
        let mut left_out = false;
        self.declared.retain(|(name, text)| {
            let errors = found.iter().filter(|each| each.severity == Severity::Error && lies_in(each.span, *text));
            let errors: Vec<&Diagnostic> = errors.collect();
            let Some(first) = errors.first() else { return true };
            let unit = units.iter_mut().find(|(file, _)| *file == text.file);
            let Some((_, unit)) = unit else { return true };
            let at = unit.declarations.iter().position(|each| name_of(each).is_some_and(|own| own.key() == *name));
            let Some(at) = at else { return true };
            let gone = unit.declarations.remove(at);
            of_text.retain(|each| !lies_in(each.span, *text));
            let shown = name_of(&gone).map_or(name.as_str(), |own| own.text.as_str());
            self.warnings.push(warning(shown, first, errors.len()));
            left_out = true;
            false
        });
        left_out
    }

    pub(super) fn into_warnings(self) -> Vec<Diagnostic> {
        self.warnings
    }
}

fn warning(name: &str, first: &Diagnostic, count: usize) -> Diagnostic {
    let errors = counted(count, "error");
    let message = format!(
        "no task uses `{name}`, so CODESYS and TwinCAT do not compile it; it has {errors} and is left out: {} {}",
        first.code.text(),
        first.message
    );
    let help = "correct it before a program uses it, or take it out of the project";
    Diagnostic::warning(Code::UnusedUnit, first.span, message).with_help(help)
}

fn has_programs(declaration: &Declaration) -> bool {
    let Declaration::Configuration(configuration) = declaration else { return false };
    configuration.resources.iter().any(|resource| !resource.programs.is_empty())
}

fn lies_in(span: Span, text: Span) -> bool {
    span.file == text.file && text.start <= span.start && span.start <= text.end
}

/// A declaration as far as it matters here.
struct Part {
    /// What others may name it by, in capitals.
    names: BTreeSet<String>,
    /// What it names, beside what stands in its texts.
    programs: BTreeSet<String>,
    texts: Vec<Span>,
    /// A unit or a type, and what stands in its file for it alone: it can be left out.
    can_go: Option<(String, Span)>,
    /// It counts whoever names it.
    is_root: bool,
}

/// The declarations of a file.
fn parts_of(file: FileId, unit: &CompilationUnit, sources: &SourceMap) -> Vec<Part> {
    let text = sources.get(file).map(SourceFile::text);
    let is_linked = text.is_some_and(|text| text.to_ascii_lowercase().contains("'linkalways'"));
    let whole = text.filter(|_| unit.declarations.len() == 1).map(|text| Span::new(file, 0, text.len() as u32));
    let parts = unit.declarations.iter().map(|declaration| {
        let mut part = Part { is_root: is_linked, ..Part::of(declaration) };
        part.is_root |= !matches!(declaration, Declaration::Pou(_) | Declaration::Type(_)) && has_globals(declaration);
        if let Some((text, whole)) = part.texts.first_mut().zip(whole) {
            *text = whole;
        }
        part.can_go = name_of(declaration).map(Ident::key).zip(part.texts.first().copied());
        part
    });
    parts.collect()
}

impl Part {
    fn of(declaration: &Declaration) -> Self {
        let mut part =
            Self { names: BTreeSet::new(), programs: BTreeSet::new(), texts: Vec::new(), can_go: None, is_root: false };
        part.take(declaration);
        part
    }

    fn take(&mut self, declaration: &Declaration) {
        match declaration {
            Declaration::Pou(pou) => {
                self.names.insert(pou.name.key());
                // Vendors' members stand behind their unit.
                let ends = pou.object.members.iter().map(|member| member.pou.span.end);
                let end = ends.fold(pou.span.end, u32::max);
                self.texts.push(Span { end, ..pou.span });
            }
            Declaration::Type(declared) => self.take_type(declared),
            Declaration::Globals(section) => self.take_variables(section),
            Declaration::Namespace(namespace) => {
                self.names.insert(namespace.name.key());
                namespace.declarations.iter().for_each(|each| self.take(each));
            }
            Declaration::Using(_) => {}
            Declaration::Configuration(whole) => {
                whole.all_sections().for_each(|section| self.take_variables(section));
                let programs = whole.resources.iter().flat_map(|resource| &resource.programs);
                self.programs.extend(programs.map(|program| program.program.key()));
            }
        }
    }

    /// A type, and the values of an enumeration, which are known without it.
    fn take_type(&mut self, declared: &TypeDeclaration) {
        self.names.insert(declared.name.key());
        if let TypeSpecKind::Enumeration(values, _) = &declared.spec.kind {
            self.names.extend(values.iter().map(|value| value.name.key()));
        }
        self.texts.push(declared.span);
    }

    fn take_variables(&mut self, section: &Section) {
        self.names.extend(section.variables.iter().flat_map(|variable| &variable.names).map(Ident::key));
        self.texts.push(section.span);
    }
}

fn name_of(declaration: &Declaration) -> Option<&Ident> {
    match declaration {
        Declaration::Pou(pou) => Some(&pou.name),
        Declaration::Type(declared) => Some(&declared.name),
        Declaration::Globals(_) | Declaration::Namespace(_) | Declaration::Using(_) | Declaration::Configuration(_) => {
            None
        }
    }
}

fn has_globals(declaration: &Declaration) -> bool {
    match declaration {
        Declaration::Globals(_) | Declaration::Configuration(_) => true,
        Declaration::Namespace(namespace) => namespace.declarations.iter().any(has_globals),
        Declaration::Pou(_) | Declaration::Type(_) | Declaration::Using(_) => false,
    }
}

/// What can go and is named by nothing that counts.
fn unreached(parts: &[Part], sources: &SourceMap) -> Vec<(String, Span)> {
    let mut declared: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, part) in parts.iter().enumerate() {
        part.names.iter().for_each(|name| declared.entry(name).or_default().push(index));
    }
    let mut is_reached: Vec<bool> = parts.iter().map(|part| part.is_root).collect();
    let mut unread: Vec<&Part> = parts.iter().filter(|part| part.is_root).collect();
    while let Some(part) = unread.pop() {
        let mut named = part.programs.clone();
        part.texts.iter().for_each(|text| names_in(*text, sources, &mut named));
        for index in named.iter().filter_map(|name| declared.remove(name.as_str())).flatten() {
            if let (Some(reached @ false), Some(next)) = (is_reached.get_mut(index), parts.get(index)) {
                *reached = true;
                unread.push(next);
            }
        }
    }
    let left = parts.iter().zip(is_reached).filter(|(_, is_reached)| !is_reached);
    left.filter_map(|(part, _)| part.can_go.clone()).collect()
}

fn names_in(text: Span, sources: &SourceMap, names: &mut BTreeSet<String>) {
    let Some(file) = sources.get(text.file) else { return };
    let written = sources.text(text);
    let found = tokenize_in(file.dialect(), written).into_iter().filter(|token| token.kind == TokenKind::Identifier);
    names.extend(
        found.filter_map(|token| written.get(token.start as usize..token.end as usize)).map(str::to_ascii_uppercase),
    );
}

#[cfg(test)]
mod tests {
    use crate::front::Front;
    use crate::input::Input;
    use crate::input::kind::SourceKind;

    fn said(text: &str) -> Vec<String> {
        let input = Input::from_text("a.exp", SourceKind::Text, text);
        let front = Front::new([input]);
        front.findings.iter().map(|found| format!("{} {}", found.code.text(), found.message)).collect()
    }

    const PLAN: &str = "CONFIGURATION C TASK T (INTERVAL := T#10ms); PROGRAM Main WITH T : Main; END_CONFIGURATION";

    #[test]
    fn what_no_task_uses_is_left_out_if_it_has_errors() {
        let left = "FUNCTION_BLOCK Draft VAR x : INT; END_VAR x := nowhere; END_FUNCTION_BLOCK
            FUNCTION_BLOCK Above EXTENDS Draft END_FUNCTION_BLOCK";
        let found = said(&format!("PROGRAM Main END_PROGRAM {left} {PLAN}"));
        let of = |name: &str| {
            format!("W0731 no task uses `{name}`, so CODESYS and TwinCAT do not compile it; it has 1 error")
        };
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[0].starts_with(&of("Draft")) && found[1].starts_with(&of("Above")), "{found:?}");
    }

    #[test]
    fn what_a_task_or_a_global_variable_uses_has_its_errors() {
        let left = "FUNCTION_BLOCK Draft VAR x : INT; END_VAR x := nowhere; END_FUNCTION_BLOCK";
        let by_program = "PROGRAM Main VAR b : Between; END_VAR END_PROGRAM
            FUNCTION_BLOCK Between VAR p : POINTER TO Draft; END_VAR END_FUNCTION_BLOCK";
        let by_global = "VAR_GLOBAL l : Draft; END_VAR PROGRAM Main END_PROGRAM";
        let by_method = "PROGRAM Main VAR b : Between; END_VAR END_PROGRAM
            FUNCTION_BLOCK Between END_FUNCTION_BLOCK METHOD m VAR d : Draft; END_VAR END_METHOD";
        for used in [by_program, by_global, by_method] {
            assert_eq!(said(&format!("{used} {left} {PLAN}")), ["N0101 `nowhere` is not declared"]);
        }
        // Without tasks nobody knows what is used.
        assert_eq!(said(&format!("PROGRAM Main END_PROGRAM {left}")), ["N0101 `nowhere` is not declared"]);
    }

    #[test]
    fn what_a_caller_uses_has_its_errors() {
        let block = "FUNCTION_BLOCK TEST_Main VAR d : Draft; END_VAR END_FUNCTION_BLOCK";
        let draft = "FUNCTION_BLOCK Draft VAR x : INT; END_VAR x := nowhere; END_FUNCTION_BLOCK";
        let files = [("a.exp", format!("PROGRAM Main END_PROGRAM {draft} {PLAN}")), ("b.exp", block.to_owned())];
        let input = |(name, text): &(&str, String)| Input::from_text(name, SourceKind::Text, text.as_str());
        let codes = |is_used: bool| {
            let files = files.iter().map(|file| Input::used(input(file), is_used && file.0 == "b.exp"));
            let front = Front::new(files);
            front.findings.iter().map(|found| found.code.text()).collect::<Vec<_>>()
        };
        assert_eq!((codes(true), codes(false)), (vec!["N0101"], vec!["W0731", "W0731"]));
    }

    #[test]
    fn what_is_sound_stays() {
        assert!(
            said(&format!("PROGRAM Main END_PROGRAM FUNCTION Spare : INT Spare := 1; END_FUNCTION {PLAN}")).is_empty()
        );
    }
}
