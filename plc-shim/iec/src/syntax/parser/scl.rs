//! What only SCL sources of Siemens have: blocks, names, literals.

use super::cursor::Cursor;
use super::declaration::{begins_declaration, section_kind};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Dialect, Feature};
use crate::source::Span;
use crate::syntax::ast::{
    Declaration, ElementInit, Expr, ExprKind, Field, INITIAL_CALL, Ident, Initialiser, InitialiserKind, Literal,
    PouKind, Qualifier, Section, SectionKind, StructureInit, TypeSpec, TypeSpecKind, Variable,
};
use crate::syntax::literal::{parse_duration, parse_typed};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

/// The organization blocks of a warm, hot and cold restart: STEP 7, System and Standard Functions, startup.
const START_BLOCKS: std::ops::RangeInclusive<u32> = 100..=102;

/// The system calls with TRUE first: the input begins with it, and whoever calls clears it.
fn begin_with_initial_call(sections: &mut [Section]) {
    let inputs = sections.iter_mut().filter(|section| section.kind == SectionKind::Input);
    for variable in inputs.flat_map(|section| &mut section.variables) {
        if let [name] = variable.names.as_slice()
            && name.key() == INITIAL_CALL
            && variable.initial.is_none()
        {
            let span = name.span;
            let value = Expr { kind: ExprKind::Literal(Literal::Bool(true)), span, height: 1 };
            variable.initial = Some(Initialiser { kind: InitialiserKind::Value(value), span });
        }
    }
}

impl Cursor<'_> {
    /// `ORGANIZATION_BLOCK`, which the system calls: in each cycle or interval, so it is a program, or once at the start.
    pub(super) fn organization_block(&mut self, into: &mut Vec<Declaration>) {
        let (known, start) = (into.len(), self.span().start);
        self.pou(PouKind::Program, Keyword::EndOrganizationBlock, into);
        let has_title = self.has_start_title(start);
        let Some(Declaration::Pou(block)) = into.get_mut(known) else { return };
        begin_with_initial_call(&mut block.sections);
        let number = block.name.key().strip_prefix("OB").and_then(|text| text.parse::<u32>().ok());
        block.object.runs_at_start = has_title || number.is_some_and(|number| START_BLOCKS.contains(&number));
        if block.object.runs_at_start {
            return;
        }
        if number.is_some_and(|number| number != 1 && !(30..=38).contains(&number) && number < 123) {
            let message = "an organization block that is called on an event is not supported";
            let found = Diagnostic::error(Code::VendorRuntime, block.name.span, message);
            self.report(found.with_help("OB1 and OB30 to OB38 become programs, OB100 runs once at the start"));
        }
    }

    /// A VARIANT comes as an input does, also one that is declared in `VAR_IN_OUT`: it is a pointer, and the unit does not
    /// change what it points to.
    pub(super) fn with_variants_as_inputs(&self, section: Section) -> Vec<Section> {
        let is_variant =
            |variable: &Variable| matches!(&variable.spec.kind, TypeSpecKind::Name(name) if name.key() == "VARIANT");
        let applies = section.kind == SectionKind::InOut && self.dialect().has(Feature::Variants);
        if !applies || !section.variables.iter().any(is_variant) {
            return vec![section];
        }
        let Section { kind, qualifiers, variables, span } = section;
        let (inputs, others): (Vec<Variable>, Vec<Variable>) = variables.into_iter().partition(is_variant);
        let inputs = Section { kind: SectionKind::Input, qualifiers: qualifiers.clone(), variables: inputs, span };
        vec![inputs, Section { kind, qualifiers, variables: others, span }]
    }

    /// `DATA_BLOCK "x" STRUCT .. END_STRUCT BEGIN .. END_DATA_BLOCK` is a global variable, be it a
    /// structure, of a user's type or an instance.
    pub(super) fn data_block(&mut self, into: &mut Vec<Declaration>) {
        let start = self.span();
        self.advance();
        let Some(name) = self.expect_identifier("the data block's name") else {
            self.skip_until(begins_declaration);
            return;
        };
        let mut qualifiers = Vec::new();
        if self.at_keyword(Keyword::NonRetain) || self.at_keyword(Keyword::Retain) {
            let retains = self.at_keyword(Keyword::Retain);
            qualifiers.push(if retains { Qualifier::Retain } else { Qualifier::NonRetain });
            self.advance();
        }
        let spec = if section_kind(self.peek()).is_some() {
            self.sections_as_structure(&mut qualifiers)
        } else {
            let spec = self.type_spec();
            self.take_mark(Punctuation::Semicolon);
            spec
        };
        let initial = self.take_keyword(Keyword::Begin).then(|| self.start_values()).flatten();
        if !self.take_keyword(Keyword::EndDataBlock) {
            self.unexpected("`END_DATA_BLOCK`");
            self.skip_until(|kind| kind == TokenKind::Keyword(Keyword::EndDataBlock) || begins_declaration(kind));
            self.take_keyword(Keyword::EndDataBlock);
        }
        let variable = Variable { names: vec![name], address: None, spec, edge: None, initial };
        let span = self.span_from(start);
        let section = Section { kind: SectionKind::Global, qualifiers, variables: vec![variable], span };
        into.push(Declaration::Globals(section));
    }

    /// `ELSE:` of a CASE.
    pub(super) fn pass_colon_of_else(&mut self) {
        let colon = self.span();
        if self.take_mark(Punctuation::Colon) {
            self.require(Feature::ElseColon, colon);
        }
    }

    /// The other variable of `a AT b : DWORD`; nothing at a direct address.
    pub(super) fn viewed(&mut self) -> Option<Ident> {
        let other = self.take_identifier()?;
        self.require(Feature::Views, other.span);
        Some(other)
    }

    /// `VAR .. END_VAR` of a data block.
    fn sections_as_structure(&mut self, qualifiers: &mut Vec<Qualifier>) -> TypeSpec {
        let start = self.span();
        let mut fields = Vec::new();
        while let Some(kind) = section_kind(self.peek()) {
            let section = self.section(kind);
            for qualifier in section.qualifiers {
                if !qualifiers.contains(&qualifier) {
                    qualifiers.push(qualifier);
                }
            }
            for Variable { names, spec, initial, .. } in section.variables {
                let field = |name| Field { name, address: None, spec: spec.clone(), initial: initial.clone() };
                fields.extend(names.into_iter().map(field));
            }
        }
        TypeSpec { kind: TypeSpecKind::Struct(fields), span: self.span_from(start) }
    }

    /// `a := 1; b.c := 2;` behind `BEGIN`.
    fn start_values(&mut self) -> Option<Initialiser> {
        let start = self.span();
        let mut members: Vec<StructureInit> = Vec::new();
        while self.peek() == Some(TokenKind::Identifier) {
            let known = self.reported();
            let target = self.expression();
            self.expect_mark(Punctuation::Assign);
            let value = self.initialiser();
            if self.reported() == known {
                self.start_value(&mut members, &target, value);
            }
            self.end_of_declaration(known);
        }
        let span = self.span_from(start);
        (!members.is_empty()).then_some(Initialiser { kind: InitialiserKind::Struct(members), span })
    }

    fn start_value(&mut self, members: &mut Vec<StructureInit>, target: &Expr, value: Initialiser) {
        let mut pieces = Vec::new();
        if path(target, &mut pieces)
            && let Some((Piece::Member(name), rest)) = pieces.split_first()
        {
            return insert(members, name, rest, value);
        }
        let message = "a start value is given to members and elements only";
        self.report(Diagnostic::error(Code::UnsupportedFeature, target.span, message));
    }

    /// `Void`, which SCL writes as the result of a function without one.
    pub(super) fn is_void(&self, result: &TypeSpec) -> bool {
        self.dialect() == Dialect::SiemensScl
            && matches!(&result.kind, TypeSpecKind::Name(name) if name.key() == "VOID")
    }

    /// True where SCL writes `TYPE "x" STRUCT` without a colon.
    pub(super) fn at_bare_structure(&self) -> bool {
        self.dialect() == Dialect::SiemensScl && self.at_keyword(Keyword::Struct)
    }

    /// Says whose word it is that begins no declaration here.
    pub(super) fn report_block_of_other_dialect(&mut self) {
        if self.at_word("ORGANIZATION_BLOCK") || self.at_word("DATA_BLOCK") {
            self.require(Feature::Blocks, self.span());
        }
    }

    /// Passes the `#` of `#name` where it is not part of a name, and says whose it is.
    pub(super) fn pass_hash(&mut self) {
        if self.at_mark(Punctuation::Hash) && self.peek_ahead(1) == Some(TokenKind::Identifier) {
            self.require(Feature::QuotedNames, self.span());
            self.advance();
        }
    }

    /// A name in an expression: `"x"` keeps its quotes, by which it is distinguished from a local `x`.
    pub(super) fn written_name(text: &str, span: Span) -> Ident {
        let local = text.strip_prefix('#').map(|text| text.trim_matches('"'));
        Ident { text: local.unwrap_or(text).to_owned(), span }
    }

    pub(super) fn typed_literal(&mut self, text: &str, span: Span) -> ExprKind {
        let (prefix, body) = text.split_once('#').unwrap_or((text, ""));
        let long = match prefix.to_ascii_uppercase().as_str() {
            "S5T" | "S5TIME" => {
                self.require(Feature::ShortPrefixes, span);
                let ns = parse_duration(body);
                return self.literal(span, ns.map(|ns| Literal::Duration { long: false, ns }));
            }
            _ if self.dialect() != Dialect::SiemensScl => None,
            "B" => Some("BYTE"),
            "W" => Some("WORD"),
            "DW" => Some("DWORD"),
            "L" => Some("DINT"),
            "C" => return self.foreign_literal(Code::ClassicTimer, "a counter's value of S5", span),
            "P" => return self.foreign_literal(Code::VendorRuntime, "a pointer of S7", span),
            _ => None,
        };
        let literal = match long {
            Some(long) => parse_typed(&format!("{long}#{body}")),
            None => parse_typed(text),
        };
        self.literal(span, literal)
    }

    fn foreign_literal(&mut self, code: Code, what: &str, span: Span) -> ExprKind {
        self.report(Diagnostic::error(code, span, format!("{what} is not supported")));
        ExprKind::Error
    }
}

/// A part of the way to what has a start value.
enum Piece {
    Member(Ident),
    Element(Vec<Expr>),
}

/// The parts of `a.b[1].c`; false if there is more to it.
fn path(target: &Expr, pieces: &mut Vec<Piece>) -> bool {
    match &target.kind {
        ExprKind::Name(name) => {
            let text = name.text.trim_matches('"').to_owned();
            pieces.push(Piece::Member(Ident { text, span: name.span }));
            true
        }
        ExprKind::Member(base, name) => {
            let known = path(base, pieces);
            pieces.push(Piece::Member(name.clone()));
            known
        }
        ExprKind::Index(base, indices) => {
            let known = path(base, pieces);
            pieces.push(Piece::Element(indices.clone()));
            known
        }
        _ => false,
    }
}

/// Puts `value` where the path leads to among the members of a structure.
fn insert(members: &mut Vec<StructureInit>, name: &Ident, rest: &[Piece], value: Initialiser) {
    let last = members.last_mut().filter(|last| last.name.key() == name.key());
    match (rest.split_first(), last.map(|last| &mut last.value.kind)) {
        (Some((Piece::Member(name), rest)), Some(InitialiserKind::Struct(inner))) => insert(inner, name, rest, value),
        (Some((Piece::Element(indices), rest)), Some(InitialiserKind::Elements(elements))) => {
            elements.push(ElementInit { indices: indices.clone(), value: wrapped(rest, value) });
        }
        _ => members.push(StructureInit { name: name.clone(), value: wrapped(rest, value) }),
    }
}

/// The value as part of what the path leads through.
fn wrapped(rest: &[Piece], value: Initialiser) -> Initialiser {
    let span = value.span;
    rest.iter().rev().fold(value, |value, piece| {
        let kind = match piece {
            Piece::Member(name) => InitialiserKind::Struct(vec![StructureInit { name: name.clone(), value }]),
            Piece::Element(indices) => InitialiserKind::Elements(vec![ElementInit { indices: indices.clone(), value }]),
        };
        Initialiser { kind, span }
    })
}
