//! Classes, interfaces, methods, properties, actions (3rd ed. 6.6.5 to 6.6.8), namespaces (3rd ed. 6.9).

use std::collections::BTreeMap;

use super::cursor::Cursor;
use super::declaration::{UnitParts, begins_declaration, ends_unit};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::source::Span;
use crate::syntax::ast::{
    Declaration, Expr, ExprKind, Ident, Literal, Member, MemberKind, Modifier, Namespace, NamespaceKind, Object, Pou,
    PouKind, Section, TypeSpec, TypeSpecKind,
};
use crate::syntax::literal::parse_typed;
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

impl Cursor<'_> {
    /// A unit from its keyword to its end; nothing if it has no name.
    pub(super) fn unit(&mut self, kind: PouKind, end: Keyword) -> Option<Pou> {
        let (external, call_after_init) = (self.at_external(), self.at_call_after_init());
        let outer = self.set_external(external || self.is_in_external());
        let unit = self.plain_unit(kind, end);
        self.set_external(outer);
        unit.map(|unit| Pou { external, object: Object { call_after_init, ..unit.object }, ..unit })
    }

    fn plain_unit(&mut self, kind: PouKind, end: Keyword) -> Option<Pou> {
        let start = self.span();
        self.advance();
        let mut object = Object { modifiers: self.modifiers(), ..Object::default() };
        let name = self.expect_identifier("the unit's name")?;
        let has_result = matches!(kind, PouKind::Function | PouKind::Method) && self.result_follows();
        let result = has_result.then(|| self.type_spec()).filter(|result| !self.is_void(result));
        let generic = self.generic_sections();
        self.heritage(&mut object);
        self.take_mark(Punctuation::Semicolon);
        let outer = self.enter(&name.text, start);
        let around = self.replace_result_name(result.is_some().then(|| name.text.clone()));
        let mut unit = self.unit_behind_head(kind, end, (name, result, object), start);
        unit.sections.splice(0..0, generic);
        self.replace_result_name(around);
        self.replace_here(outer);
        Some(unit)
    }

    /// The rest of a unit: variables and members in any order, then statements.
    fn unit_behind_head(
        &mut self,
        kind: PouKind,
        end: Keyword,
        (name, result, mut object): (Ident, Option<TypeSpec>, Object),
        start: Span,
    ) -> Pou {
        let around = self.replace_constants(BTreeMap::new());
        let sections = self.sections_and_members(&mut object);
        self.report_hidden_constants(&sections);
        self.take_keyword(Keyword::Begin);
        let from = self.span();
        let members = std::mem::take(&mut object.members);
        let mut parts = UnitParts { sections, members, ..UnitParts::default() };
        let declared = self.enter_body();
        let body = self.body(end, &mut parts);
        self.replace_here(declared);
        self.replace_constants(around);
        let UnitParts { sections, members, chart } = parts;
        object.members = members;
        if matches!(kind, PouKind::Class | PouKind::Interface) && !body.is_empty() {
            let message = "a class or interface has no statements of its own";
            let found = Diagnostic::error(Code::UnexpectedToken, from, message);
            self.report_syntax(found.with_help("put them into a method"));
        }
        let span = self.span_from(start);
        Pou { kind, name, result, sections, body, chart, object, external: false, span }
    }

    fn sections_and_members(&mut self, object: &mut Object) -> Vec<Section> {
        let mut sections = Vec::new();
        loop {
            if let Some(kind) = self.next_section() {
                let section = self.section(kind);
                sections.extend(self.with_variants_as_inputs(section));
            } else if self.at_constants() {
                self.constants();
            } else if self.at_keyword(Keyword::Using) {
                self.using(&mut object.using);
            } else if !self.members(&mut object.members) {
                return sections;
            }
        }
    }

    fn modifiers(&mut self) -> Vec<Modifier> {
        let mut found = Vec::new();
        // The last name before something else is the unit's own, whatever it is.
        while self.peek_ahead(1) == Some(TokenKind::Identifier) || self.peek_ahead(1).is_some_and(is_soft) {
            let Some(modifier) = Modifier::find(self.next_text()) else { break };
            found.push(modifier);
            self.advance();
        }
        found
    }

    /// `EXTENDS a IMPLEMENTS b, c`
    fn heritage(&mut self, object: &mut Object) {
        if self.take_word("EXTENDS") {
            object.extends = self.qualified_list("a base's name");
        }
        if self.take_word("IMPLEMENTS") {
            object.implements = self.qualified_list("an interface's name");
        }
    }

    fn qualified_list(&mut self, what: &str) -> Vec<Ident> {
        let mut list = Vec::new();
        loop {
            let Some(name) = self.expect_identifier(what) else { return list };
            let name = self.qualified(name);
            list.push(self.with_constants(name));
            let comma = self.span();
            if !self.take_mark(Punctuation::Comma) {
                return list;
            }
            if self.peek() != Some(TokenKind::Identifier) {
                self.require(Feature::EmptyBases, comma);
                return list;
            }
        }
    }

    /// The rest of `a.b.c`: a qualified name is one name with dots (3rd ed. 6.9.4).
    pub(super) fn qualified(&mut self, mut name: Ident) -> Ident {
        while self.at_mark(Punctuation::Dot) && self.peek_ahead(1) == Some(TokenKind::Identifier) {
            self.advance();
            if let Some(next) = self.take_identifier() {
                name = Ident { text: format!("{}.{}", name.text, next.text), span: name.span.to(next.span) };
            }
        }
        name
    }

    /// Takes what belongs to a unit, if anything does here.
    pub(super) fn members(&mut self, members: &mut Vec<Member>) -> bool {
        match self.peek() {
            Some(TokenKind::Keyword(Keyword::Method)) => {
                let pou = self.unit(PouKind::Method, Keyword::EndMethod);
                self.member(MemberKind::Method, pou, members);
            }
            Some(TokenKind::Keyword(Keyword::Action)) => self.action(members),
            Some(TokenKind::Keyword(Keyword::Property)) => self.property(members),
            _ => return false,
        }
        self.take_mark(Punctuation::Semicolon);
        true
    }

    fn member(&mut self, kind: MemberKind, pou: Option<Pou>, members: &mut Vec<Member>) {
        match pou {
            Some(pou) => members.push(Member { kind, pou }),
            None => self.skip_until(ends_unit),
        }
    }

    /// `ACTION name: .. END_ACTION`
    fn action(&mut self, members: &mut Vec<Member>) {
        let start = self.span();
        self.advance();
        let Some(name) = self.expect_identifier("the action's name") else { return };
        self.take_mark(Punctuation::Colon);
        let mut parts = UnitParts::default();
        let body = self.body(Keyword::EndAction, &mut parts);
        let (kind, span) = (PouKind::Action, self.span_from(start));
        let UnitParts { sections, chart, .. } = parts;
        let pou = {
            let (object, external) = (Object::default(), false);
            Pou { kind, name, result: None, sections, body, chart, object, external, span }
        };
        members.push(Member { kind: MemberKind::Action, pou });
    }

    /// `PROPERTY name : INT GET .. END_GET SET .. END_SET END_PROPERTY`, as vendors have it.
    fn property(&mut self, members: &mut Vec<Member>) {
        self.advance();
        let modifiers = self.modifiers();
        let Some(name) = self.expect_identifier("the property's name") else { return };
        self.expect_mark(Punctuation::Colon);
        let spec = self.type_spec();
        self.take_mark(Punctuation::Semicolon);
        let known = members.len();
        let outer = self.enter(&name.text, name.span);
        loop {
            let (kind, end) = if self.at_word("GET") {
                (MemberKind::Getter, Keyword::EndGet)
            } else if self.at_word("SET") {
                (MemberKind::Setter, Keyword::EndSet)
            } else {
                break;
            };
            let start = self.span();
            self.advance();
            let own = self.accessor_access();
            let object = Object { modifiers: [own, modifiers.clone()].concat(), ..Object::default() };
            let head = (name.clone(), Some(spec.clone()), object);
            let around = self.enter(if kind == MemberKind::Getter { "Get" } else { "Set" }, start);
            let pou = self.unit_behind_head(PouKind::Method, end, head, start);
            self.replace_here(around);
            members.push(Member { kind, pou });
            self.take_mark(Punctuation::Semicolon);
        }
        self.replace_here(outer);
        if members.len() == known {
            self.unexpected("`GET` or `SET`");
        }
        if !self.take_keyword(Keyword::EndProperty) {
            self.unexpected("`END_PROPERTY`");
            self.skip_until(ends_unit);
            self.take_keyword(Keyword::EndProperty);
        }
    }

    /// `GET PRIVATE` as vendors' editors keep it; a statement may begin with a name as well.
    fn accessor_access(&mut self) -> Vec<Modifier> {
        let follows = self.peek_ahead(1);
        let statement = matches!(follows, Some(TokenKind::Punctuation(mark)) if mark != Punctuation::Semicolon);
        let access = Modifier::find(self.next_text()).filter(|_| !statement);
        if access.is_some() {
            self.advance();
        }
        access.into_iter().collect()
    }

    /// What begins with a word that is a name elsewhere.
    pub(super) fn object_declaration(&mut self, keyword: Keyword, into: &mut Vec<Declaration>) {
        let pou = match keyword {
            Keyword::Class => self.unit(PouKind::Class, Keyword::EndClass),
            Keyword::Interface => self.unit(PouKind::Interface, Keyword::EndInterface),
            Keyword::Namespace => return self.namespace(into),
            Keyword::Using => {
                let mut names = Vec::new();
                self.using(&mut names);
                into.push(Declaration::Using(names));
                return;
            }
            _ => return self.member_behind_unit(into),
        };
        match pou {
            Some(pou) => into.push(Declaration::Pou(pou)),
            None => self.skip_until(begins_declaration),
        }
    }

    /// Vendors' exports write methods and actions behind the unit that they belong to.
    fn member_behind_unit(&mut self, into: &mut [Declaration]) {
        let span = self.span();
        let mut members = Vec::new();
        self.members(&mut members);
        match into.last_mut() {
            Some(Declaration::Pou(pou)) if pou.kind != PouKind::Function => pou.object.members.extend(members),
            _ => {
                let message = "a method, property or action belongs to a class, function block or program";
                let found = Diagnostic::error(Code::MemberAlone, span, message);
                self.report_syntax(found.with_help("write it in the unit, or right behind it"));
            }
        }
    }

    /// `USING a, b.c;`
    fn using(&mut self, names: &mut Vec<Ident>) {
        self.advance();
        names.extend(self.qualified_list("a namespace"));
        if !self.take_mark(Punctuation::Semicolon) {
            self.unexpected("`;`");
        }
    }

    fn namespace(&mut self, into: &mut Vec<Declaration>) {
        let external = self.at_external();
        self.advance();
        let named = self.peek_ahead(1) == Some(TokenKind::Identifier);
        let kind = if named && self.take_word("INTERNAL") {
            NamespaceKind::Internal
        } else if named && self.take_word("OPEN") {
            NamespaceKind::Open
        } else {
            NamespaceKind::Plain
        };
        let Some(name) = self.expect_identifier("the namespace's name") else {
            return self.skip_until(begins_declaration);
        };
        let name = self.qualified(name);
        let outer = self.enter_namespace(&name.text, name.span);
        let inner = self.nested(Self::namespace_content);
        self.replace_here(outer);
        let (using, declarations) = inner.unwrap_or_default();
        if !self.take_keyword(Keyword::EndNamespace) {
            self.unexpected("`END_NAMESPACE`");
        }
        into.push(Declaration::Namespace(Namespace { kind, name, using, declarations, external }));
    }

    fn namespace_content(&mut self) -> (Vec<Ident>, Vec<Declaration>) {
        let (mut using, mut declarations) = (Vec::new(), Vec::new());
        while !matches!(self.peek(), None | Some(TokenKind::Keyword(Keyword::EndNamespace))) {
            if self.at_keyword(Keyword::Using) {
                self.using(&mut using);
            } else {
                self.declaration(&mut declarations);
            }
        }
        (using, declarations)
    }

    /// `T EXTENDS s : STRUCT`, as vendors have it.
    pub(super) fn extended_structure(&mut self) -> Option<Ident> {
        if !self.take_word("EXTENDS") {
            return None;
        }
        let name = self.expect_identifier("a structure's name")?;
        Some(self.qualified(name))
    }

    /// `STRUCT EXTENDS s .. END_STRUCT`, or any other type.
    pub(super) fn type_spec_extending(&mut self) -> (TypeSpec, Option<Ident>) {
        let extends = self.at_keyword(Keyword::Struct)
            && self.peek_ahead(1) == Some(TokenKind::Identifier)
            && self.peek_ahead(2) == Some(TokenKind::Identifier);
        if !extends {
            return (self.type_spec(), None);
        }
        let start = self.span();
        self.advance();
        let base = self.extended_structure();
        let kind = self.nested(Self::structure_type).unwrap_or(TypeSpecKind::Error);
        (TypeSpec { kind, span: self.span_from(start) }, base)
    }

    /// The end of `a.b.Colour#Red`, a literal of a type in a namespace.
    pub(super) fn qualified_literal(&mut self, namespace: &Expr) -> Option<ExprKind> {
        if self.peek() != Some(TokenKind::Typed) {
            return None;
        }
        let text = format!("{}.{}", dotted(namespace)?, self.next_text());
        let (prefix, _) = text.split_once('#')?;
        let (prefix, unqualified) = (prefix.to_owned(), self.next_text());
        let Ok(Literal::Typed { value, .. }) = parse_typed(unqualified) else { return None };
        self.advance();
        Some(ExprKind::Literal(Literal::Typed { prefix, value }))
    }

    /// Vendors write `THIS^` and `SUPER^` for what the standard calls `THIS` and `SUPER`.
    pub(super) fn pass_object_caret(&mut self, expr: &mut Expr) {
        if expr.names_the_object() && self.take_mark(Punctuation::Caret) {
            expr.span = self.span_from(expr.span);
        }
    }
}

/// A chain of names as one name.
fn dotted(expr: &Expr) -> Option<String> {
    match &expr.kind {
        ExprKind::Name(name) => Some(name.text.clone()),
        ExprKind::Member(base, name) => Some(format!("{}.{}", dotted(base)?, name.text)),
        _ => None,
    }
}

fn is_soft(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Keyword(keyword) if keyword.is_soft())
}
