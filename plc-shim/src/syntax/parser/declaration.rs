//! Units, types and variable sections (2nd ed. 2.3 to 2.5).

use super::cursor::Cursor;
use super::object::ends_object;
use crate::dialect::Feature;
use crate::syntax::ast::{
    CompilationUnit, Declaration, Edge, Ident, Member, Modifier, PouKind, Qualifier, Section, SectionKind, Statement,
    TypeDeclaration, TypeSpec, TypeSpecKind, Variable,
};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

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
        TokenKind::Keyword(Keyword::VarGlobal) => SectionKind::Global,
        TokenKind::Keyword(Keyword::VarExternal) => SectionKind::External,
        _ => return None,
    })
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

    /// The kind of the section that begins here.
    pub(super) fn next_section(&mut self) -> Option<SectionKind> {
        if self.at_word("VAR_STAT") {
            self.require(Feature::StaticSection, self.span());
            return Some(SectionKind::Static);
        }
        section_kind(self.peek())
    }

    pub(super) fn body(&mut self, end: Keyword, members: &mut Vec<Member>) -> Vec<Statement> {
        let mut body = self.statements();
        // A stray closing keyword is reported and passed, so that the rest of the body is read.
        while !self.take_keyword(end) {
            if self.members(members) {
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

    pub(super) fn section(&mut self, kind: SectionKind) -> Section {
        let start = self.span();
        self.advance();
        let qualifiers = self.qualifiers();
        let mut variables = Vec::new();
        while self.peek() == Some(TokenKind::Identifier) {
            self.variable(&mut variables);
        }
        if !self.take_keyword(Keyword::EndVar) {
            self.unexpected("a variable's name or `END_VAR`");
            self.skip_until(|kind| {
                kind == TokenKind::Keyword(Keyword::EndVar) || section_kind(Some(kind)).is_some() || ends_unit(kind)
            });
            self.take_keyword(Keyword::EndVar);
        }
        self.take_mark(Punctuation::Semicolon);
        Section { kind, qualifiers, variables, span: self.span_from(start) }
    }

    fn qualifiers(&mut self) -> Vec<Qualifier> {
        let mut found = Vec::new();
        loop {
            found.push(match self.peek() {
                Some(TokenKind::Keyword(Keyword::Constant)) => Qualifier::Constant,
                Some(TokenKind::Keyword(Keyword::Retain)) => Qualifier::Retain,
                Some(TokenKind::Keyword(Keyword::NonRetain)) => Qualifier::NonRetain,
                Some(TokenKind::Identifier) if self.at_persistent() => Qualifier::Persistent,
                _ => match self.section_access() {
                    Some(access) => Qualifier::Access(access),
                    None => return found,
                },
            });
            self.advance();
        }
    }

    /// `PUBLIC` and the like, which a variable's name may be as well.
    fn section_access(&self) -> Option<Modifier> {
        let access = Modifier::find(self.next_text()).filter(|_| self.peek() == Some(TokenKind::Identifier))?;
        let is_access =
            matches!(access, Modifier::Public | Modifier::Protected | Modifier::Private | Modifier::Internal);
        let named =
            matches!(self.peek_ahead(1), Some(TokenKind::Punctuation(_)) | Some(TokenKind::Keyword(Keyword::At)));
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
            matches!(kind, TokenKind::Keyword(Keyword::EndVar | Keyword::EndStruct | Keyword::EndType))
                || section_kind(Some(kind)).is_some()
                || ends_unit(kind)
        };
        if self.reported() == known {
            // `END_STRUCT` and the last declaration of a block are often written without.
            if self.previous() == Some(TokenKind::Keyword(Keyword::EndStruct)) {
                return;
            }
            self.unexpected("`;`");
        }
        self.skip_until(|kind| kind == TokenKind::Punctuation(Punctuation::Semicolon) || closes(kind));
        self.take_mark(Punctuation::Semicolon);
    }

    fn type_block(&mut self, into: &mut Vec<Declaration>) {
        self.advance();
        while self.peek() == Some(TokenKind::Identifier) {
            let (known, start) = (self.reported(), self.span());
            let Some(name) = self.take_identifier() else {
                break;
            };
            let before = self.extended_structure();
            if !self.at_bare_structure() {
                self.expect_mark(Punctuation::Colon);
            }
            let (spec, behind) = self.type_spec_extending();
            let (initial, extends) = (self.optional_initialiser(), before.or(behind));
            let span = self.span_from(start);
            into.push(Declaration::Type(TypeDeclaration { name, extends, spec, initial, span }));
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
