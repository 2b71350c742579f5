//! Inputs of the PLC's own I/O image, taken over by name.
//!
//! The image overwrites in every cycle what a gateway writes into a variable at an address in %I. So the variable gives
//! its address away to a twin, and is given the twin's value while the PLC is not simulated:
//!
//! | in the project | becomes |
//! |---|---|
//! | `Guard AT %IX0.0 : BOOL;` | `SDSP_IN_Guard AT %IX0.0 : BOOL;` and `Guard : BOOL;` |
//! | `%IX0.0` in statements | `SDSP_IX0_0`, a global variable of the shim's, with the twin `SDSP_IN_IX0_0` |
//!
//! Global variables are given their values by `SDSP_Scheduler`, which comes first in every cycle; those of programs and
//! function blocks at the head of the body.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;

use super::tasks::TaskTable;
use super::{controller, marks, twincat};
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::dialect::AddressUnit;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{
    CompilationUnit, Declaration, Ident, Pou, PouKind, Qualifier, Section, SectionKind, Variable,
};
use onescan_iec::syntax::direct_address::{Area, DirectAddress, Width};
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::TokenKind;
use onescan_iec::syntax::{FileId, SourceFile, SourceMap, Span};

/// What becomes of inputs that the PLC's I/O image writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Inputs {
    /// They stay, and a gateway cannot write them.
    #[default]
    Left,
    /// They are taken over.
    Taken,
}

/// The inputs of a project that are taken over.
#[derive(Debug, Default)]
pub(super) struct RealInputs<'a> {
    /// Global variables, with the namespace they are in.
    globals: Vec<(Option<String>, &'a Variable)>,
    units: Vec<(&'a Pou, Vec<&'a Variable>)>,
    /// Addresses in statements, by what they are called.
    direct: BTreeMap<String, Direct<'a>>,
    /// What cannot be taken over.
    pub(super) findings: Vec<Diagnostic>,
}

/// An address in statements.
#[derive(Debug)]
struct Direct<'a> {
    address: String,
    width: Width,
    /// The units that read it, and where.
    uses: Vec<(&'a Pou, Span)>,
}

/// What the shim's own sources need for them.
#[derive(Debug, Default)]
pub(super) struct Additions {
    /// Declarations of global variables.
    pub(super) globals: String,
    /// Declarations of the scheduler's.
    pub(super) externals: String,
    /// The scheduler's statements while the PLC is not simulated.
    pub(super) statements: String,
}

fn is_input(address: &str) -> bool {
    address.get(1..2).is_some_and(|area| area.eq_ignore_ascii_case("I"))
}

fn twin(name: &str) -> String {
    format!("SDSP_IN_{name}")
}

fn type_name(width: Width) -> &'static str {
    match width {
        Width::Bit => "BOOL",
        Width::Byte => "BYTE",
        Width::Word => "WORD",
        Width::Dword => "DWORD",
        Width::Lword => "LWORD",
    }
}

/// Looks for inputs in all files of a project in text.
pub(super) fn find<'a>(units: &[(FileId, &'a CompilationUnit)], sources: &SourceMap) -> RealInputs<'a> {
    let mut found = RealInputs::default();
    for (id, unit) in units {
        let Some(file) = sources.get(*id) else { continue };
        let addresses = addresses(*id, file);
        for declaration in &unit.declarations {
            found.declaration(declaration, None, (file, &addresses));
        }
    }
    found.refuse_shared(sources);
    found
}

impl<'a> RealInputs<'a> {
    fn declaration(
        &mut self,
        declaration: &'a Declaration,
        home: Option<&str>,
        (file, addresses): (&SourceFile, &[(DirectAddress, Span)]),
    ) {
        match declaration {
            Declaration::Pou(pou) => self.unit(pou, file, addresses),
            Declaration::Globals(section) => self.section(section, home),
            Declaration::Namespace(namespace) => {
                for each in &namespace.declarations {
                    self.declaration(each, Some(&namespace.name.text), (file, addresses));
                }
            }
            Declaration::Configuration(configuration) => {
                for section in configuration.all_sections() {
                    self.section(section, home);
                }
                for given in &configuration.instances {
                    if let Some(address) = given.address.as_ref().filter(|address| is_input(&address.text)) {
                        self.report(address.span, "an address that VAR_CONFIG gives stays with its variable");
                    }
                }
            }
            Declaration::Type(_) | Declaration::Using(_) => {}
        }
    }

    fn section(&mut self, section: &'a Section, home: Option<&str>) {
        for variable in inputs(section) {
            self.globals.push((home.map(str::to_owned), variable));
        }
    }

    fn unit(&mut self, pou: &'a Pou, file: &SourceFile, addresses: &[(DirectAddress, Span)]) {
        let variables: Vec<_> = pou.sections.iter().flat_map(inputs).collect();
        let has_place = matches!(pou.kind, PouKind::Program | PouKind::FunctionBlock)
            && pou.chart.is_empty()
            && !pou.body.is_empty()
            && !controller::is_list(pou)
            && twincat::drawn_in(file).is_none();
        match variables.first() {
            Some(first) if !has_place => {
                let place = first.address.as_ref().map_or(pou.name.span, |address| address.span);
                self.report(place, "there is no place for an assignment at the head of this unit: its inputs stay");
            }
            Some(_) => self.units.push((pou, variables)),
            None => {}
        }
        self.statements(pou, file, addresses);
    }

    /// Addresses in the statements of a unit.
    fn statements(&mut self, pou: &'a Pou, file: &SourceFile, addresses: &[(DirectAddress, Span)]) {
        let declared: Vec<Span> = pou
            .sections
            .iter()
            .flat_map(|section| &section.variables)
            .filter_map(|each| Some(each.address.as_ref()?.span))
            .collect();
        for (address, span) in addresses {
            let span = *span;
            let is_here = pou.span.start <= span.start && span.end <= pou.span.end;
            if !is_here || declared.iter().any(|each| each.start <= span.start && span.end <= each.end) {
                continue;
            }
            let written = file.text().get(span.start as usize..span.end as usize).unwrap_or("");
            let has_place = matches!(pou.kind, PouKind::Program | PouKind::FunctionBlock) && !pou.body.is_empty();
            if !has_place || !pou.chart.is_empty() {
                self.report(span, "this unit cannot declare what would stand for the address: it stays");
                continue;
            }
            let letters: String = written.to_ascii_uppercase().chars().skip(2).collect();
            let letters =
                if letters.starts_with(|one: char| one.is_ascii_digit()) { format!("X{letters}") } else { letters };
            let name = format!("I{}", letters.replace('.', "_"));
            let new = || Direct { address: format!("%I{letters}"), width: address.width, uses: Vec::new() };
            self.direct.entry(name).or_insert_with(new).uses.push((pou, span));
        }
    }

    fn report(&mut self, span: Span, message: &str) {
        let found = Diagnostic::warning(Code::UnsupportedFeature, span, message);
        self.findings.push(found.with_help("give it a global variable of its own, or take its address off by hand"));
    }

    /// What lies at one place under two names would come apart.
    fn refuse_shared(&mut self, sources: &SourceMap) {
        let unit =
            |span: Span| sources.get(span.file).map_or(AddressUnit::Element, |file| file.dialect().address_unit());
        let of_units = self.units.iter().flat_map(|(_, variables)| variables.iter().copied());
        let named = self.globals.iter().map(|(_, variable)| *variable).chain(of_units);
        let named =
            named.filter_map(|variable| variable.address.as_ref()).map(|address| (address.text.as_str(), address.span));
        let direct = self.direct.values().filter_map(|direct| Some((direct.address.as_str(), direct.uses.first()?.1)));
        let mut places: Vec<(Range<u64>, Span)> = named
            .chain(direct)
            .filter_map(|(address, span)| {
                let address = DirectAddress::parse(address).ok()?;
                let (byte, bit) = address.place(unit(span)).ok()??;
                let start = u64::from(byte) * 8 + u64::from(bit.unwrap_or(0));
                Some((start..start + u64::from(address.width.bits()), span))
            })
            .collect();
        places.sort_by_key(|(place, span)| (place.start, place.end, span.file.0, span.start));
        let mut end = 0;
        let mut shared = Vec::new();
        for (place, span) in places {
            if place.start < end {
                shared.push(span);
            }
            end = end.max(place.end);
        }
        for span in shared {
            let message =
                "this input is read at an address that another name has, too: taken over, they would come apart";
            let found = Diagnostic::error(Code::UnsupportedFeature, span, message);
            self.findings.push(found.with_help("read it by one name, or instrument without taking inputs over"));
        }
    }

    /// What the shim's own sources need.
    pub(super) fn additions(&self, sources: &SourceMap) -> Additions {
        let mut added = Additions::default();
        for (name, direct) in &self.direct {
            let (own, twin, ty) = (format!("SDSP_{name}"), twin(name), type_name(direct.width));
            let _ = writeln!(added.globals, "    {own} : {ty};    (* {} in statements *)", direct.address);
            let _ = writeln!(added.globals, "    {twin} AT {} : {ty};", direct.address);
            let _ = writeln!(added.externals, "    {own} : {ty};\n    {twin} : {ty};");
            let _ = writeln!(added.statements, "        {own} := {twin};");
        }
        for (home, variable) in &self.globals {
            let Some(name) = variable.names.first().map(|name| name.text.as_str()) else { continue };
            let twin = twin(name);
            let ty = sources.text(variable.spec.span);
            if let Some(home) = home {
                let _ = writeln!(added.statements, "        {home}.{name} := {home}.{twin};");
            } else {
                let _ = writeln!(added.externals, "    {name} : {ty};\n    {twin} : {ty};");
                let _ = writeln!(added.statements, "        {name} := {twin};");
            }
        }
        added
    }

    /// Changes the declarations of one file, and addresses in its statements.
    pub(super) fn declare(&self, id: FileId, file: &SourceFile, tasks: &TaskTable<'_>, edits: &mut Edits) {
        let of_units = self.units.iter().flat_map(|(_, variables)| variables.iter().copied());
        for variable in self.globals.iter().map(|(_, variable)| *variable).chain(of_units) {
            if let (Some(name), Some(address)) = (variable.names.first(), &variable.address)
                && name.span.file == id
            {
                give_away(name, address, variable, file, edits);
            }
        }
        for (name, direct) in &self.direct {
            for (_, span) in direct.uses.iter().filter(|(_, span)| span.file == id) {
                let at = file.shown_range(span.start, span.end);
                let written = file.text().get(span.start as usize..span.end as usize).unwrap_or_default();
                edits.replace(at, marks::renamed(&format!("SDSP_{name}"), written));
            }
        }
        for pou in self.touched().into_iter().filter(|pou| pou.name.span.file == id) {
            let externals = self.externals(pou, tasks);
            if !externals.is_empty() {
                controller::declare_in(pou, &format!("VAR_EXTERNAL\n{externals}END_VAR\n"), file, edits);
            }
        }
    }

    /// Puts assignments at the heads of the units of one file.
    pub(super) fn assign(&self, id: FileId, file: &SourceFile, edits: &mut Edits) {
        for (pou, variables) in self.units.iter().filter(|(pou, _)| pou.name.span.file == id) {
            let names = variables.iter().filter_map(|variable| variable.names.first());
            let copies: String =
                names.map(|name| format!("        {} := {};\n", name.text, twin(&name.text))).collect();
            controller::put_in_front(
                pou,
                &format!("    IF NOT SDSP_Simulated THEN\n{copies}    END_IF;\n"),
                file,
                edits,
            );
        }
    }

    /// What a unit must declare to see the shim's variables.
    fn externals(&self, pou: &Pou, tasks: &TaskTable<'_>) -> String {
        let used =
            self.direct.iter().filter(|(_, direct)| direct.uses.iter().any(|(unit, _)| std::ptr::eq(*unit, pou)));
        let externals = used.map(|(name, direct)| format!("    SDSP_{name} : {};\n", type_name(direct.width)));
        let mut externals: String = externals.collect();
        let assigns = self.units.iter().any(|(unit, _)| std::ptr::eq(*unit, pou));
        // The controller of a scheduled program declares it.
        if assigns && !tasks.numbered().any(|(numbered, _)| std::ptr::eq(numbered, pou)) {
            externals += "    SDSP_Simulated : BOOL;\n";
        }
        externals
    }

    /// The units that something is put in front of.
    fn touched(&self) -> Vec<&'a Pou> {
        let mut units: Vec<&Pou> = self.units.iter().map(|(pou, _)| *pou).collect();
        for (pou, _) in self.direct.values().flat_map(|direct| &direct.uses) {
            if !units.iter().any(|unit| std::ptr::eq(*unit, *pou)) {
                units.push(pou);
            }
        }
        units
    }
}

/// The addresses in %I that stand in a file.
fn addresses(id: FileId, file: &SourceFile) -> Vec<(DirectAddress, Span)> {
    let tokens = tokenize_in(file.dialect(), file.text());
    let tokens = tokens.iter().filter(|token| token.kind == TokenKind::DirectAddress);
    let parsed = tokens.filter_map(|token| {
        let written = file.text().get(token.start as usize..token.end as usize)?;
        Some((DirectAddress::parse(written).ok()?, Span::new(id, token.start, token.end)))
    });
    parsed.filter(|(address, _)| address.area == Area::Input).collect()
}

/// The variables of a section that lie in %I.
fn inputs(section: &Section) -> impl Iterator<Item = &Variable> {
    let is_constant = section.qualifiers.contains(&Qualifier::Constant);
    let is_own = !matches!(section.kind, SectionKind::External | SectionKind::Temp) && !is_constant;
    section.variables.iter().filter(move |variable| {
        let address = variable.address.as_ref();
        is_own && variable.names.len() == 1 && address.is_some_and(|address| is_input(&address.text))
    })
}

/// A variable gives its address to a twin, which stands in front of it: pragmas that link it to a terminal go with it.
fn give_away(name: &Ident, address: &Ident, variable: &Variable, file: &SourceFile, edits: &mut Edits) {
    let shown = file.shown_text();
    let begin = file.shown_range(name.span.start, name.span.end);
    let end = file.shown_range(address.span.start, address.span.end).end;
    let ty = file.text().get(variable.spec.span.start as usize..variable.spec.span.end as usize).unwrap_or_default();
    let twin = format!("{} AT {} : {ty};", twin(&name.text), address.text);
    let line = marks::line_start(shown, begin.start);
    let indent = shown.get(line as usize..begin.start as usize).unwrap_or_default();
    if line == 0 || shown.get(..line as usize).is_some_and(|before| before.ends_with('\n')) {
        edits.insert(line, marks::lines(&format!("{indent}{twin}"), marks::line_break(shown)));
    } else {
        edits.insert(begin.start, marks::inline(&twin));
    }
    let cut = shown.get(begin.end as usize..end as usize).unwrap_or_default();
    edits.replace(begin.end..end, marks::cut_text(cut));
}
