//! Units, types and variable sections (2nd ed. 2.3 to 2.5).

use onescan_base::ElementaryType;

use super::cursor::Cursor;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::syntax::ast::{
    Chart, CompilationUnit, Declaration, Edge, Ident, Member, Modifier, PouKind, Qualifier, Section, SectionKind,
    Statement, StatementKind, TypeDeclaration, TypeSpec, TypeSpecKind, Variable,
};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

/// Begins the section of a generic block's constants.
const GENERIC: &str = "VAR_GENERIC";

/// Keywords at which a file can go on after an error outside of a unit's body.
pub(super) fn begins_declaration(kind: TokenKind) -> bool {
    use Keyword as K;
    let TokenKind::Keyword(keyword) = kind else { return false };
    let unit = matches!(keyword, K::Program | K::FunctionBlock | K::Function | K::OrganizationBlock | K::DataBlock);
    unit || matches!(keyword, K::Type | K::VarGlobal) || keyword.is_soft()
}

pub(super) fn section_kind(kind: Option<TokenKind>) -> Option<SectionKind> {
    Some(match kind? {
        TokenKind::Keyword(Keyword::Var) => SectionKind::Local,
        TokenKind::Keyword(Keyword::VarInput) => SectionKind::Input,
        TokenKind::Keyword(Keyword::VarOutput) => SectionKind::Output,
        TokenKind::Keyword(Keyword::VarInOut) => SectionKind::InOut,
        TokenKind::Keyword(Keyword::VarTemp) => SectionKind::Temp,
        TokenKind::Keyword(Keyword::VarStat) => SectionKind::Static,
        TokenKind::Keyword(Keyword::VarInst) => SectionKind::Instance,
        TokenKind::Keyword(Keyword::VarGlobal) => SectionKind::Global,
        TokenKind::Keyword(Keyword::VarExternal) => SectionKind::External,
        _ => return None,
    })
}

/// What stands between a unit's head and its end, its statements left out.
#[derive(Default)]
pub(super) struct UnitParts {
    pub(super) sections: Vec<Section>,
    pub(super) members: Vec<Member>,
    pub(super) chart: Chart,
}

impl Cursor<'_> {
    pub(super) fn compilation_unit(&mut self) -> CompilationUnit {
        let mut unit = CompilationUnit::default();
        while self.peek().is_some() {
            self.declaration(&mut unit.declarations);
        }
        unit
    }

    /// What may stand in a file or namespace; goes on behind what may not.
    pub(super) fn declaration(&mut self, into: &mut Vec<Declaration>) {
        let Some(kind) = self.peek() else { return };
        match kind {
            TokenKind::Keyword(Keyword::Program) => {
                self.pou(PouKind::Program, Keyword::EndProgram, into);
            }
            TokenKind::Keyword(Keyword::FunctionBlock) => {
                self.pou(PouKind::FunctionBlock, Keyword::EndFunctionBlock, into);
            }
            TokenKind::Keyword(Keyword::Function) => {
                self.pou(PouKind::Function, Keyword::EndFunction, into);
            }
            TokenKind::Keyword(keyword) if keyword.is_soft() => self.object_declaration(keyword, into),
            TokenKind::Keyword(Keyword::Type) => self.type_block(into),
            TokenKind::Keyword(Keyword::VarGlobal) => {
                let section = self.section(SectionKind::Global);
                into.push(Declaration::Globals(section));
            }
            TokenKind::Identifier if self.at_word("CONFIGURATION") => match self.configuration() {
                Some(found) => into.push(found),
                None => self.skip_until(begins_declaration),
            },
            // CoDeSys V2.3 has one in each project, mostly without a line.
            TokenKind::Identifier if self.at_word("VAR_CONFIG") && self.dialect().has(Feature::StaticSection) => {
                self.loose_instance_values();
            }
            TokenKind::Keyword(Keyword::OrganizationBlock) => self.organization_block(into),
            TokenKind::Keyword(Keyword::DataBlock) => self.data_block(into),
            // Vendors' exports end a unit with a semicolon; it declares nothing.
            TokenKind::Punctuation(Punctuation::Semicolon) => self.advance(),
            _ => {
                self.report_block_of_other_dialect();
                self.unexpected("PROGRAM, FUNCTION_BLOCK, FUNCTION, CLASS, TYPE or VAR_GLOBAL");
                self.advance();
                self.skip_until(begins_declaration);
            }
        }
    }

    pub(super) fn pou(&mut self, kind: PouKind, end: Keyword, into: &mut Vec<Declaration>) {
        match self.unit(kind, end) {
            Some(pou) => into.push(Declaration::Pou(pou)),
            None => self.skip_until(begins_declaration),
        }
    }

    /// The `:` before a function's result, or a report that it is missing.
    pub(super) fn result_follows(&mut self) -> bool {
        let name = self.peek() == Some(TokenKind::Identifier) && ElementaryType::find(self.next_text()).is_some();
        if name {
            self.unexpected("`:`");
        }
        self.take_mark(Punctuation::Colon) || name
    }

    /// The kind of the section that begins here.
    pub(super) fn next_section(&mut self) -> Option<SectionKind> {
        if self.at_word("VAR_STAT") {
            self.require(Feature::StaticSection, self.span());
            return Some(SectionKind::Static);
        }
        if self.at_word("VAR_INST") {
            self.require(Feature::InstanceSection, self.span());
            return Some(SectionKind::Instance);
        }
        if self.at_word(GENERIC) {
            self.require(Feature::GenericConstants, self.span());
            return Some(SectionKind::Local);
        }
        section_kind(self.peek())
    }

    /// The constants of a generic block, which stand before its bases.
    pub(super) fn generic_sections(&mut self) -> Vec<Section> {
        let mut found = Vec::new();
        while self.at_word(GENERIC) {
            self.require(Feature::GenericConstants, self.span());
            found.push(self.section(SectionKind::Local));
        }
        found
    }

    pub(super) fn body(&mut self, end: Keyword, parts: &mut UnitParts) -> Vec<Statement> {
        let mut body = self.body_statements();
        // A stray closing keyword is reported and passed, so that the rest of the body is read.
        while !self.take_keyword(end) {
            if self.members(&mut parts.members) || self.chart_part(&mut parts.chart) {
                body.extend(self.body_statements());
                continue;
            }
            if let Some(kind) = section_kind(self.peek()) {
                self.report_late_section(&body);
                parts.sections.push(self.section(kind));
                body.extend(self.body_statements());
                continue;
            }
            self.unexpected(&format!("`{}`", end.text()));
            if self.peek().is_none_or(ends_unit) {
                break;
            }
            self.advance();
            self.take_mark(Punctuation::Semicolon);
            body.extend(self.body_statements());
        }
        body
    }

    /// Statements, or instructions if the first is one.
    pub(super) fn body_statements(&mut self) -> Vec<Statement> {
        if self.at_instruction_list() { self.instructions() } else { self.statements() }
    }

    /// Reports a section behind statements, unless these are what an error before it has left.
    fn report_late_section(&mut self, body: &[Statement]) {
        if body.iter().any(|statement| !matches!(statement.kind, StatementKind::Error | StatementKind::Empty)) {
            let message = "variables are declared before the statements";
            let found = Diagnostic::error(Code::UnexpectedToken, self.span(), message);
            self.report_syntax(found);
        }
    }

    pub(super) fn section(&mut self, kind: SectionKind) -> Section {
        let start = self.span();
        let generic = self.at_word(GENERIC).then_some(Qualifier::Generic);
        self.advance();
        let mut qualifiers = self.qualifiers();
        qualifiers.extend(generic);
        let mut variables = Vec::new();
        // One with nothing before it declares nothing.
        self.take_semicolons();
        while self.at_variable() {
            self.variable(&mut variables);
        }
        if self.at_statement() {
            self.unexpected("`END_VAR`");
        } else if !self.take_keyword(Keyword::EndVar) {
            self.unexpected("a variable's name or `END_VAR`");
            self.skip_until(|kind| {
                kind == TokenKind::Keyword(Keyword::EndVar) || section_kind(Some(kind)).is_some() || ends_unit(kind)
            });
            self.take_keyword(Keyword::EndVar);
        }
        self.take_semicolons();
        Section { kind, qualifiers, variables, span: self.span_from(start) }
    }

    /// True where a variable is declared, even if what names it is not a name.
    fn at_variable(&mut self) -> bool {
        self.name_keyword();
        match self.peek() {
            Some(TokenKind::Identifier) => !self.at_statement(),
            Some(TokenKind::Keyword(Keyword::At)) => true,
            Some(TokenKind::Keyword(_)) => self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::Colon)),
            _ => false,
        }
    }

    /// True where a statement begins with a name: the section's end is missing.
    fn at_statement(&self) -> bool {
        use Punctuation as P;
        if self.at_counted_name() {
            return false;
        }
        let marks = [P::Assign, P::LeftParen, P::Dot, P::LeftBracket, P::Caret];
        self.peek() == Some(TokenKind::Identifier)
            && marks.iter().any(|mark| self.peek_ahead(1) == Some(TokenKind::Punctuation(*mark)))
    }

    fn qualifiers(&mut self) -> Vec<Qualifier> {
        let mut found = Vec::new();
        loop {
            found.push(match self.peek() {
                Some(TokenKind::Keyword(Keyword::Constant)) => Qualifier::Constant,
                Some(TokenKind::Keyword(Keyword::Retain)) => Qualifier::Retain,
                Some(TokenKind::Keyword(Keyword::NonRetain)) => Qualifier::NonRetain,
                Some(TokenKind::Identifier) if self.at_persistent() => Qualifier::Persistent,
                // Whether it is retained is said in the data block: nothing is by itself.
                Some(TokenKind::Identifier) if self.at_word("DB_SPECIFIC") && self.is_name_next() => {
                    self.require(Feature::DbSpecific, self.span());
                    Qualifier::NonRetain
                }
                _ => match self.section_access() {
                    Some(access) => Qualifier::Access(access),
                    None => return found,
                },
            });
            self.advance();
        }
    }

    fn is_name_next(&self) -> bool {
        self.peek_ahead(1) == Some(TokenKind::Identifier)
    }

    /// `PUBLIC` and the like, which a variable's name may be as well.
    fn section_access(&self) -> Option<Modifier> {
        let access = Modifier::find(self.next_text()).filter(|_| self.peek() == Some(TokenKind::Identifier))?;
        let is_access =
            matches!(access, Modifier::Public | Modifier::Protected | Modifier::Private | Modifier::Internal);
        let named = matches!(self.peek_ahead(1), Some(TokenKind::Punctuation(_) | TokenKind::Keyword(Keyword::At)));
        (is_access && !named).then_some(access)
    }

    /// `PERSISTENT` behind a section's keyword; a variable may have the name, too.
    fn at_persistent(&self) -> bool {
        use Punctuation::{Colon, Comma};
        let declared = matches!(self.peek_ahead(1), Some(TokenKind::Punctuation(Colon | Comma)));
        self.at_word("PERSISTENT") && !declared && self.peek_ahead(1) != Some(TokenKind::Keyword(Keyword::At))
    }

    fn variable(&mut self, variables: &mut Vec<Variable>) {
        let known = self.reported();
        let is_nameless = self.at_keyword(Keyword::At) && self.peek_ahead(1) == Some(TokenKind::DirectAddress);
        if matches!(self.peek(), Some(TokenKind::Keyword(_))) && !is_nameless {
            self.report_keyword_as_name();
            self.advance();
        }
        let names = if is_nameless { Vec::new() } else { self.identifier_list("a variable's name") };
        if self.at_mark(Punctuation::LeftBracket) {
            self.pass_count();
        }
        let address = match self.take_keyword(Keyword::At) {
            true if self.peek() == Some(TokenKind::Identifier) => self.viewed(),
            true => self.address(),
            false => None,
        };
        // `AT %QW5 : WORD;` (2nd ed. B.1.4.3): its address is its name.
        let names = if is_nameless { address.iter().cloned().collect() } else { names };
        self.expect_mark(Punctuation::Colon);
        if self.reported() > known {
            // The names are kept, so that their uses are not reported as well.
            let spec = TypeSpec { kind: TypeSpecKind::Error, span: self.span() };
            variables.push(Variable { names, address, spec, edge: None, initial: None });
        } else {
            let spec = self.type_spec();
            let edge = self.edge();
            let initial = self.reference_initialiser(&spec).or_else(|| self.optional_initialiser());
            variables.push(Variable { names, address, spec, edge, initial });
        }
        self.end_of_declaration(known);
    }

    fn edge(&mut self) -> Option<Edge> {
        let word = (self.peek() == Some(TokenKind::Identifier)).then(|| self.next_text().to_ascii_uppercase())?;
        let edge = match word.as_str() {
            "R_EDGE" => Edge::Rising,
            "F_EDGE" => Edge::Falling,
            _ => return None,
        };
        self.advance();
        Some(edge)
    }

    pub(super) fn address(&mut self) -> Option<Ident> {
        if self.peek() != Some(TokenKind::DirectAddress) {
            self.unexpected("a direct address");
            return None;
        }
        let address = Ident { text: self.next_text().to_owned(), span: self.span() };
        self.advance();
        Some(address)
    }

    /// The `;` of a declaration that began when `known` findings were reported.
    pub(super) fn end_of_declaration(&mut self, known: usize) {
        if self.take_mark(Punctuation::Semicolon) {
            // A second one declares nothing.
            return self.take_semicolons();
        }
        let closes = |kind| {
            matches!(
                kind,
                TokenKind::Keyword(Keyword::EndVar | Keyword::EndStruct | Keyword::EndUnion | Keyword::EndType)
            ) || section_kind(Some(kind)).is_some()
                || ends_unit(kind)
        };
        if self.reported() == known {
            // `END_STRUCT` and the last declaration of a block are often written without.
            if matches!(self.previous(), Some(TokenKind::Keyword(Keyword::EndStruct | Keyword::EndUnion))) {
                return;
            }
            self.unexpected("`;`");
        }
        self.skip_until(|kind| kind == TokenKind::Punctuation(Punctuation::Semicolon) || closes(kind));
        self.take_mark(Punctuation::Semicolon);
    }

    /// `TYPE INTERNAL Name :`, as vendors' libraries have it; who is outside of the library does not see the files.
    /// `TYPE ABSTRACT Name :` is a structure that others extend.
    fn pass_access_of_type(&mut self) {
        let modifier = Modifier::find(self.next_text());
        let is_access = matches!(modifier, Some(Modifier::Public | Modifier::Internal | Modifier::Abstract));
        if is_access && self.peek_ahead(1) == Some(TokenKind::Identifier) {
            self.advance();
        }
    }

    fn type_block(&mut self, into: &mut Vec<Declaration>) {
        let (external, all_qualified, all_packed) = (self.at_external(), self.at_qualified_only(), self.packing());
        let (all_show_names, all_strict) = (self.at_to_string(), self.at_strict());
        self.advance();
        while self.peek() == Some(TokenKind::Identifier) {
            let qualified_only = all_qualified || self.at_qualified_only();
            let packing = self.packing().or(all_packed);
            let shows_names = all_show_names || self.at_to_string();
            let is_strict = all_strict || self.at_strict();
            self.pass_access_of_type();
            let (known, start) = (self.reported(), self.span());
            let Some(name) = self.take_identifier() else {
                break;
            };
            let before = self.extended_structure();
            if !self.at_bare_structure() {
                self.expect_mark(Punctuation::Colon);
            }
            let outer = self.enter(&name.text, start);
            let (spec, behind) = self.type_spec_extending();
            self.replace_here(outer);
            let (initial, extends) = (self.optional_initialiser(), before.or(behind));
            let span = self.span_from(start);
            into.push(Declaration::Type(TypeDeclaration {
                name,
                extends,
                external,
                qualified_only,
                shows_names,
                is_strict,
                packing,
                spec,
                initial,
                span,
            }));
            self.end_of_declaration(known);
        }
        if !self.take_keyword(Keyword::EndType) {
            self.unexpected("a type's name or `END_TYPE`");
            self.skip_until(|kind| kind == TokenKind::Keyword(Keyword::EndType) || ends_unit(kind));
            self.take_keyword(Keyword::EndType);
        }
    }
}

/// Keywords that end a unit or begin the next: no recovery passes them.
pub(super) fn ends_unit(kind: TokenKind) -> bool {
    use Keyword as K;
    let TokenKind::Keyword(keyword) = kind else { return false };
    begins_declaration(kind)
        || matches!(keyword, K::EndProgram | K::EndFunctionBlock | K::EndFunction)
        || matches!(keyword, K::EndOrganizationBlock | K::EndDataBlock)
        || ends_object(keyword)
}

/// Keywords that end a class, an interface, a member of one, or a namespace.
pub(super) fn ends_object(keyword: Keyword) -> bool {
    use Keyword as K;
    matches!(
        keyword,
        K::EndClass
            | K::EndInterface
            | K::EndMethod
            | K::EndProperty
            | K::EndGet
            | K::EndSet
            | K::EndAction
            | K::EndNamespace
    )
}
