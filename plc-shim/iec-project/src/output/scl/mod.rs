//! Structured Text of the standard as SCL of Siemens' TIA Portal, an external source for an S7-1500.
//!
//! | module | subject |
//! |---|---|
//! | [`names`] | what the names of a project stand for |
//! | [`scope`] | names and types inside of a unit |
//! | [`spec`], [`literal`] | types and literals as they are written |
//! | [`variables`], [`structure`] | sections of variables, structures |
//! | [`body`], [`call`], [`standard`] | statements, calls, standard functions |
//! | [`unit`] | functions, function blocks, programs |
//! | [`data`] | data blocks and organization blocks |
//! | [`order`], [`layout`] | the order of blocks, comments and lines |
//!
//! | in the standard | in SCL |
//! |---|---|
//! | `PROGRAM P` | `FUNCTION_BLOCK "P_Program"` and its instance data block `"P"` |
//! | a task | an organization block that calls its programs' instances |
//! | a global instance of a function block | its instance data block |
//! | another global variable | a member of the data block `"Globals"`, or `"RetainedGlobals"` |
//! | an enumeration | integers; each block declares the values that it uses as constants |
//! | a global constant | a constant of each block that uses it |
//! | aliases, subranges | what they stand for |
//! | a block of the standard that TIA Portal lacks | the same as `"IEC_SR"` |
//! | initial values of structures and instances | start values of the data blocks |
//!
//! Statements, comments and layout are the author's: only names, literals and calls change. What SCL has not is
//! refused with its place.

mod body;
mod call;
mod data;
mod layout;
mod literal;
pub(in crate::output) mod names;
mod order;
pub(in crate::output) mod scope;
mod spec;
mod standard;
mod structure;
mod unit;
mod variables;

use std::collections::{BTreeMap, BTreeSet};

pub(crate) use data::{StartValues, block_of_task};
use names::{Names, Shape, member};
use order::{Part, ordered};
pub(crate) use spec::elementary as elementary_name;

use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::syntax::ast::{CompilationUnit, Connection, Declaration, PouKind, Section};
use onescan_iec::syntax::token::{Token, TokenKind};
use onescan_iec::syntax::{FileId, SourceMap, Span, tokenize_in};
use onescan_iec::task_plan::Task;

/// A checked project, with the standard's blocks that it may use.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) sources: &'a SourceMap,
    pub(crate) units: &'a [(FileId, CompilationUnit)],
    /// The files that are not the project's own.
    pub(crate) library: &'a BTreeSet<FileId>,
}

/// The project in SCL, with an organization block for each of `tasks`, and these start values.
///
/// # Errors
/// What SCL of TIA Portal has not.
pub(crate) fn project(source: Source<'_>, tasks: &[Task], values: &StartValues) -> Result<String, Vec<Diagnostic>> {
    let names = Names::new(source.sources, source.units, source.library, &|_| None);
    let mut writer = Writer { names: &names, source, values, parts: Vec::new() };
    writer.declarations();
    writer.globals();
    writer.instances();
    for task in tasks {
        let uses = task.programs.iter().cloned();
        writer.part(&block_of_task(&task.name), data::task(task), true, uses, Vec::new());
    }
    written(ordered(writer.parts), source).map(|texts| texts.join("\n"))
}

/// The texts of what is used, or what of it SCL has not.
fn written(parts: Vec<Part>, source: Source<'_>) -> Result<Vec<String>, Vec<Diagnostic>> {
    let mut findings = Vec::new();
    for part in &parts {
        let is_own = |found: &&Diagnostic| !source.library.contains(&found.span.file);
        findings.extend(part.findings.iter().filter(is_own).cloned());
        if part.findings.iter().any(|found| !is_own(&found))
            && let Some(place) = mention(&part.key, source)
        {
            let what = format!("`{}`, and nothing that it could be written with", part.key);
            findings.push(spec::refused(place, &what, "write a function block of your own"));
        }
    }
    if findings.is_empty() {
        Ok(parts.into_iter().map(|part| part.text).filter(|text| !text.is_empty()).collect())
    } else {
        Err(findings)
    }
}

/// Where the project first names something.
fn mention(key: &str, source: Source<'_>) -> Option<Span> {
    let own = source.sources.iter().filter(|(id, _)| !source.library.contains(id));
    own.flat_map(|(id, file)| {
        let tokens = tokenize_in(file.dialect(), file.text());
        let is_it = move |token: &Token| layout::part(file, token.start, token.end).eq_ignore_ascii_case(key);
        tokens.into_iter().filter(is_it).map(move |token| Span::new(id, token.start, token.end))
    })
    .next()
}

/// The data blocks that global variables become members of, by the variables' names in capitals.
pub(crate) fn homes(source: Source<'_>) -> BTreeMap<String, &'static str> {
    let names = Names::new(source.sources, source.units, source.library, &|_| None);
    let homes = names.globals.iter().filter_map(|(key, global)| Some((key.clone(), names.home(global)?)));
    homes.collect()
}

/// The path of a part of a data block as it is written in SCL.
pub(crate) fn members(path: &str) -> String {
    let pieces = path.split('.').map(|piece| {
        let (name, index) = piece.split_at(piece.find('[').unwrap_or(piece.len()));
        member(name) + index
    });
    pieces.collect::<Vec<_>>().join(".")
}

/// Blocks and types of the library by the names that `rename` gives them, those that `is_wanted` and what they use, in
/// the order in which they are to be read.
///
/// # Errors
/// What SCL of TIA Portal has not.
pub(crate) fn library(
    source: Source<'_>,
    rename: &dyn Fn(&str) -> Option<String>,
    is_wanted: &dyn Fn(&str) -> bool,
) -> Result<Vec<String>, Vec<Diagnostic>> {
    let names = Names::new(source.sources, source.units, source.library, rename);
    let values = StartValues::new();
    let mut writer = Writer { names: &names, source, values: &values, parts: Vec::new() };
    writer.declarations();
    let mut parts = writer.parts;
    for part in &mut parts {
        part.is_wanted = is_wanted(&part.key);
    }
    written(ordered(parts), source)
}

struct Writer<'w, 'a> {
    names: &'w Names<'a>,
    source: Source<'a>,
    values: &'w StartValues,
    parts: Vec<Part>,
}

impl<'a> Writer<'_, 'a> {
    fn part(
        &mut self,
        name: &str,
        text: String,
        is_wanted: bool,
        uses: impl IntoIterator<Item = String>,
        findings: Vec<Diagnostic>,
    ) {
        let uses = uses.into_iter().map(|name| name.to_ascii_uppercase()).collect();
        self.parts.push(Part { key: name.to_ascii_uppercase(), text, is_wanted, uses, findings });
    }

    /// Types and units, with the comments above them.
    fn declarations(&mut self) {
        for (id, unit) in self.source.units {
            let Some(file) = self.source.sources.get(*id) else { continue };
            let is_own = self.names.is_own(*id);
            let mut behind = 0;
            let mut above = String::new();
            for declaration in &unit.declarations {
                let Some(span) = span(declaration) else { continue };
                above.push_str(&layout::comments(file, behind, span.start));
                behind = span.end;
                // What is written above a type that SCL does not have stands above what follows.
                if self.declaration(declaration, &above, is_own) {
                    above.clear();
                }
            }
        }
    }

    /// Writes a declaration with the comments above it; false if there is nothing to be written.
    fn declaration(&mut self, declaration: &'a Declaration, above: &str, is_own: bool) -> bool {
        // What TIA Portal or the shim has is not looked at.
        let is_left = |key: &str| !is_own && (names::native(key).is_some() || names::is_left(key));
        match declaration {
            Declaration::Type(named) if !is_left(&named.name.key()) => {
                let mut found = Vec::new();
                let text = structure::structure(self.names, named, above, &mut found);
                let uses = self.mentioned(named.span, &named.name.key());
                let name = named.name.text.clone();
                let is_written = text.is_some();
                self.part(&name, text.unwrap_or_default(), is_own, uses, found);
                is_written
            }
            Declaration::Pou(pou) if !is_left(&pou.name.key()) => {
                let mut found = Vec::new();
                let text = unit::unit(self.names, pou, above, &mut found);
                let uses = self.mentioned(pou.span, &pou.name.key());
                let name = pou.name.text.clone();
                let name = if pou.kind == PouKind::Program { unit::block_of_program(&name) } else { name };
                self.part(&name, text, is_own, uses, found);
                true
            }
            Declaration::Namespace(namespace) if is_own => {
                let help = "declare its units outside of it";
                let found = vec![spec::refused(namespace.name.span, "namespaces", help)];
                self.part(&namespace.name.text, String::new(), true, [], found);
                false
            }
            _ => false,
        }
    }

    /// The names in a declaration, except its own.
    fn mentioned(&self, span: Span, own: &str) -> Vec<String> {
        let Some(file) = self.source.sources.get(span.file) else { return Vec::new() };
        let tokens = layout::tokens(file, span.start, span.end);
        let names = tokens.iter().filter(|token| token.kind == TokenKind::Identifier);
        let mut uses: Vec<String> =
            names.map(|token| layout::part(file, token.start, token.end).to_ascii_uppercase()).collect();
        let homes = uses.iter().filter_map(|name| self.names.home(self.names.globals.get(name)?)).map(str::to_owned);
        let homes: Vec<String> = homes.collect();
        uses.extend(homes);
        uses.retain(|name| name != own);
        uses
    }

    /// The data blocks of global variables.
    fn globals(&mut self) {
        for home in [names::GLOBALS, names::RETAINED_GLOBALS] {
            let mut found = Vec::new();
            if let Some(text) = data::globals(self.names, home, self.values, &mut found) {
                self.part(home, text, true, [], found);
            }
        }
        let own: Vec<_> =
            self.names.globals.values().filter(|global| self.names.is_own(global.name.span.file)).collect();
        for global in own {
            let name = &global.name.text;
            let Some(Shape::Block(pou)) = self.names.shape(&global.variable.spec) else { continue };
            let ty = &pou.name.text;
            let text = data::of_type(name, &self.names.block(ty), global.is_retained, self.values);
            self.part(name, text, true, [ty.clone()], Vec::new());
        }
    }

    /// The instances of programs: those of a configuration, or one of each program by its name.
    fn instances(&mut self) {
        let declarations = self.source.units.iter().flat_map(|(_, unit)| &unit.declarations);
        let configurations: Vec<_> = declarations
            .filter_map(|declaration| match declaration {
                Declaration::Configuration(configuration) => Some(configuration),
                _ => None,
            })
            .collect();
        if configurations.is_empty() {
            let units = self.names.units.values().filter(|pou| pou.kind == PouKind::Program);
            let programs: Vec<_> = units.map(|pou| (pou.name.text.clone(), pou.name.text.clone())).collect();
            return programs.into_iter().for_each(|(name, program)| self.instance(&name, &program, None));
        }
        for configuration in configurations {
            for value in &configuration.instances {
                let help = "give the variable its value where it is declared";
                let found = vec![spec::refused(value.path.span, "VAR_CONFIG", help)];
                self.part("VAR_CONFIG", String::new(), true, [], found);
            }
            for program in configuration.resources.iter().flat_map(|resource| &resource.programs) {
                let found = program.connections.first().map(|connection| match connection {
                    Connection::Input(place, _) | Connection::Output(place, _) | Connection::Task(place, _) => {
                        spec::refused(place.span, "connections of programs", "assign the variables in the programs")
                    }
                });
                self.instance(&program.name.text, &program.program.text, found);
            }
        }
    }

    fn instance(&mut self, name: &str, program: &str, found: Option<Diagnostic>) {
        let block = unit::block_of_program(program);
        let mut findings = Vec::from_iter(found);
        if let Some(other) = self.names.units.get(&block.to_ascii_uppercase()) {
            let message = format!("`{block}` is the name of the function block that program `{program}` becomes");
            let found = Diagnostic::error(Code::UnsupportedFeature, other.name.span, message);
            findings.push(found.with_help("rename this unit"));
        }
        let text = data::of_type(name, &names::quoted(&block), false, self.values);
        self.part(name, text, true, [block], findings);
    }
}

fn span(declaration: &Declaration) -> Option<Span> {
    Some(match declaration {
        Declaration::Pou(pou) => pou.span,
        Declaration::Type(named) => named.span,
        Declaration::Globals(Section { span, .. }) => *span,
        Declaration::Configuration(configuration) => configuration.span,
        Declaration::Namespace(namespace) => namespace.name.span,
        Declaration::Using(_) => return None,
    })
}
