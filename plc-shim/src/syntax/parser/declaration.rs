//! Units, types and variable sections (2nd ed. 2.3 to 2.5).

use super::cursor::Cursor;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::ElementaryType;
use crate::syntax::ast::{
    CompilationUnit, Declaration, Edge, Ident, Pou, PouKind, Qualifier, Section, SectionKind, Statement, StatementKind,
    TypeDeclaration, TypeSpec, TypeSpecKind, Variable,
};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

/// Keywords at which a file can go on after an error outside of a unit's body.
pub(super) fn begins_declaration(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::Keyword(
            Keyword::Program
                | Keyword::FunctionBlock
                | Keyword::Function
                | Keyword::Type
                | Keyword::VarGlobal
                | Keyword::OrganizationBlock
                | Keyword::DataBlock
        )
    )
}

pub(super) fn section_kind(kind: Option<TokenKind>) -> Option<SectionKind> {
    Some(match kind? {
        TokenKind::Keyword(Keyword::Var) => SectionKind::Local,
        TokenKind::Keyword(Keyword::VarInput) => SectionKind::Input,
        TokenKind::Keyword(Keyword::VarOutput) => SectionKind::Output,
        TokenKind::Keyword(Keyword::VarInOut) => SectionKind::InOut,
        TokenKind::Keyword(Keyword::VarTemp) => SectionKind::Temp,
        TokenKind::Keyword(Keyword::VarStat) => SectionKind::Static,
        TokenKind::Keyword(Keyword::VarGlobal) => SectionKind::Global,
        TokenKind::Keyword(Keyword::VarExternal) => SectionKind::External,
        _ => return None,
    })
}

impl Cursor<'_> {
    pub(super) fn compilation_unit(&mut self) -> CompilationUnit {
        let mut unit = CompilationUnit::default();
        while let Some(kind) = self.peek() {
            match kind {
                TokenKind::Keyword(Keyword::Program) => {
                    self.pou(PouKind::Program, Keyword::EndProgram, &mut unit);
                }
                TokenKind::Keyword(Keyword::FunctionBlock) => {
                    self.pou(PouKind::FunctionBlock, Keyword::EndFunctionBlock, &mut unit);
                }
                TokenKind::Keyword(Keyword::Function) => {
                    self.pou(PouKind::Function, Keyword::EndFunction, &mut unit);
                }
                TokenKind::Keyword(Keyword::Type) => self.type_block(&mut unit),
                TokenKind::Keyword(Keyword::VarGlobal) => {
                    let section = self.section(SectionKind::Global);
                    unit.declarations.push(Declaration::Globals(section));
                }
                TokenKind::Identifier if self.at_word("CONFIGURATION") => match self.configuration() {
                    Some(found) => unit.declarations.push(found),
                    None => self.skip_until(begins_declaration),
                },
                TokenKind::Keyword(Keyword::OrganizationBlock) => self.organization_block(&mut unit),
                TokenKind::Keyword(Keyword::DataBlock) => self.data_block(&mut unit),
                // Vendors' exports end a unit with a semicolon; it declares nothing.
                TokenKind::Punctuation(Punctuation::Semicolon) => self.advance(),
                _ => {
                    self.report_block_of_other_dialect();
                    self.unexpected("PROGRAM, FUNCTION_BLOCK, FUNCTION, TYPE or VAR_GLOBAL");
                    self.advance();
                    self.skip_until(begins_declaration);
                }
            }
        }
        unit
    }

    pub(super) fn pou(&mut self, kind: PouKind, end: Keyword, unit: &mut CompilationUnit) {
        let start = self.span();
        self.advance();
        let Some(name) = self.expect_identifier("the unit's name") else {
            self.skip_until(begins_declaration);
            return;
        };
        let has_result = kind == PouKind::Function && self.result_follows();
        let result = has_result.then(|| self.type_spec()).filter(|result| !self.is_void(result));
        self.take_semicolons();
        let mut sections = Vec::new();
        while let Some(kind) = self.next_section() {
            sections.push(self.section(kind));
        }
        self.take_keyword(Keyword::Begin);
        let body = self.body(end, &mut sections);
        let span = self.span_from(start);
        let pou = Pou { kind, name, result, sections, body, span };
        unit.declarations.push(Declaration::Pou(pou));
    }

    /// The `:` before a function's result, or a report that it is missing.
    fn result_follows(&mut self) -> bool {
        let name = self.peek() == Some(TokenKind::Identifier) && ElementaryType::find(self.next_text()).is_some();
        if name {
            self.unexpected("`:`");
        }
        self.take_mark(Punctuation::Colon) || name
    }

    /// The kind of the section that begins here.
    fn next_section(&mut self) -> Option<SectionKind> {
        if self.at_word("VAR_STAT") {
            self.require(Feature::StaticSection, self.span());
            return Some(SectionKind::Static);
        }
        section_kind(self.peek())
    }

    fn body(&mut self, end: Keyword, sections: &mut Vec<Section>) -> Vec<Statement> {
        let mut body = self.statements();
        // A stray closing keyword is reported and passed, so that the rest of the body is read.
        while !self.take_keyword(end) {
            if let Some(kind) = section_kind(self.peek()) {
                self.report_late_section(&body);
                sections.push(self.section(kind));
                body.extend(self.statements());
                continue;
            }
            self.unexpected(&format!("`{}`", end.text()));
            if self.peek().is_none_or(ends_unit) {
                break;
            }
            self.advance();
            self.take_mark(Punctuation::Semicolon);
            body.extend(self.statements());
        }
        body
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
        self.advance();
        let qualifiers = self.qualifiers();
        let mut variables = Vec::new();
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

    /// True where a variable is declared, be it under a name that is none.
    fn at_variable(&mut self) -> bool {
        match self.peek() {
            Some(TokenKind::Identifier) => !self.at_statement(),
            Some(TokenKind::Keyword(_)) => self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::Colon)),
            _ => false,
        }
    }

    /// True where a statement begins with a name: the section's end is missing.
    fn at_statement(&self) -> bool {
        use Punctuation as P;
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
                _ => return found,
            });
            self.advance();
        }
    }

    /// `PERSISTENT` behind a section's keyword; a variable may have the name, too.
    fn at_persistent(&self) -> bool {
        use Punctuation::{Colon, Comma};
        let declared = matches!(self.peek_ahead(1), Some(TokenKind::Punctuation(Colon | Comma)));
        self.at_word("PERSISTENT") && !declared && self.peek_ahead(1) != Some(TokenKind::Keyword(Keyword::At))
    }

    fn variable(&mut self, variables: &mut Vec<Variable>) {
        let known = self.reported();
        if matches!(self.peek(), Some(TokenKind::Keyword(_))) {
            self.report_keyword_as_name();
        }
        let names = self.identifier_list("a variable's name");
        let address = self.take_keyword(Keyword::At).then(|| self.address()).flatten();
        self.expect_mark(Punctuation::Colon);
        if self.reported() > known {
            // The names are kept, so that their uses are not reported as well.
            let spec = TypeSpec { kind: TypeSpecKind::Error, span: self.span() };
            variables.push(Variable { names, address, spec, edge: None, initial: None });
        } else {
            let spec = self.type_spec();
            let edge = self.edge();
            let initial = self.optional_initialiser();
            variables.push(Variable { names, address, spec, edge, initial });
        }
        self.end_of_declaration(known);
    }

    /// Reports `if : INT;` and passes its name.
    fn report_keyword_as_name(&mut self) {
        let message = format!("`{}` is a keyword, not a name", self.next_text());
        let span = self.span();
        self.report(Diagnostic::error(Code::UnexpectedToken, span, message));
        self.advance();
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
            return;
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

    fn type_block(&mut self, unit: &mut CompilationUnit) {
        self.advance();
        while self.peek() == Some(TokenKind::Identifier) {
            let (known, start) = (self.reported(), self.span());
            let Some(name) = self.take_identifier() else {
                break;
            };
            if !self.at_bare_structure() {
                self.expect_mark(Punctuation::Colon);
            }
            let spec = self.type_spec();
            let initial = self.optional_initialiser();
            let span = self.span_from(start);
            unit.declarations.push(Declaration::Type(TypeDeclaration { name, spec, initial, span }));
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
fn ends_unit(kind: TokenKind) -> bool {
    begins_declaration(kind)
        || matches!(
            kind,
            TokenKind::Keyword(
                Keyword::EndProgram
                    | Keyword::EndFunctionBlock
                    | Keyword::EndFunction
                    | Keyword::EndOrganizationBlock
                    | Keyword::EndDataBlock
            )
        )
}
