//! Types as written (2nd ed. 2.3.3).

use onescan_base::ElementaryType;

use super::cursor::Cursor;
use crate::dialect::Feature;
use crate::syntax::ast::{
    Dimension, EnumValue, Expr, Field, Ident, InitArguments, ReferenceKind, Subrange, TemplateUse, TypeSpec,
    TypeSpecKind,
};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

impl Cursor<'_> {
    pub(super) fn type_spec(&mut self) -> TypeSpec {
        let start = self.span();
        let kind = self.nested(Self::type_spec_kind).unwrap_or(TypeSpecKind::Error);
        TypeSpec { kind, span: self.span_from(start) }
    }

    fn type_spec_kind(&mut self) -> TypeSpecKind {
        if self.take_keyword(Keyword::Array) {
            return self.array_type();
        }
        if self.take_keyword(Keyword::Struct) {
            return self.structure_type();
        }
        if self.take_keyword(Keyword::Union) {
            return TypeSpecKind::Union(self.members_of(Keyword::EndUnion));
        }
        if self.take_mark(Punctuation::LeftParen) {
            let values = self.enumeration_values();
            // Vendors write the base type behind the values.
            let closed = self.previous() == Some(TokenKind::Punctuation(Punctuation::RightParen));
            let base = if closed { self.take_identifier() } else { None };
            return TypeSpecKind::Enumeration(values, base);
        }
        if let Some(kind) = self.reference_kind() {
            return TypeSpecKind::Reference(kind, Box::new(self.type_spec()));
        }
        let Some(name) = self.expect_identifier("a type") else {
            return TypeSpecKind::Error;
        };
        if matches!(name.key().as_str(), "STRING" | "WSTRING") {
            return self.string_type(name);
        }
        if is_generic(&name) && !self.is_in_external() {
            self.require(Feature::GenericInputs, name.span);
        }
        let name = self.qualified(name);
        let name = self.with_constants(name);
        if self.at_mark(Punctuation::LeftParen) && ElementaryType::find(&name.text).is_none() {
            return self.instance_type(name);
        }
        if self.take_mark(Punctuation::LeftParen) {
            // The 3rd edition writes it in front (6.4.4.2).
            let named = self.peek() == Some(TokenKind::Identifier);
            let after = self.peek_ahead(1);
            let lists = [Punctuation::Assign, Punctuation::Comma, Punctuation::RightParen];
            if named && lists.iter().any(|mark| after == Some(TokenKind::Punctuation(*mark))) {
                return TypeSpecKind::Enumeration(self.enumeration_values(), Some(name));
            }
            let low = self.expression();
            self.expect_mark(Punctuation::Range);
            let high = self.expression();
            self.expect_mark(Punctuation::RightParen);
            return TypeSpecKind::Subrange(name, Box::new(Subrange { low, high }));
        }
        if self.at_mark(Punctuation::LeftBracket)
            && self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::LeftParen))
        {
            return self.listed_instances(name);
        }
        if self.at_mark(Punctuation::LeftBracket) {
            return self.counted_array(name);
        }
        TypeSpecKind::Name(name)
    }

    /// The rest of `List<8>`: a generic block with its constants is one name.
    pub(super) fn with_constants(&mut self, template: Ident) -> Ident {
        if !self.at_mark(Punctuation::Less) {
            return template;
        }
        self.require(Feature::GenericConstants, template.span);
        let from = self.span().start;
        self.advance();
        let mut arguments = Vec::new();
        loop {
            arguments.push(self.operand_of_comparison());
            if !self.take_mark(Punctuation::Comma) {
                break;
            }
        }
        let end = self.span();
        self.expect_mark(Punctuation::Greater);
        let given: String = self.text(from, end.end).split_whitespace().collect();
        let span = template.span.to(end);
        let name = Ident { text: format!("{}{given}", template.text), span };
        self.note_template(TemplateUse { template, arguments, span });
        name
    }

    /// `FB(a := 1)`, or `Base (0..10)`, which the checker refuses unless `Base` is an integer type.
    fn instance_type(&mut self, name: Ident) -> TypeSpecKind {
        let start = self.span();
        let arguments = self.arguments_or_range();
        match arguments {
            Ok(arguments) => {
                self.require(Feature::InitArguments, start);
                TypeSpecKind::Instance(name, InitArguments::Same(arguments))
            }
            Err(range) => TypeSpecKind::Subrange(name, Box::new(range)),
        }
    }

    /// `FB[(a := 1), (a := 2)]`
    fn listed_instances(&mut self, name: Ident) -> TypeSpecKind {
        let start = self.span();
        self.advance();
        let mut lists = Vec::new();
        while self.at_mark(Punctuation::LeftParen) {
            lists.push(self.arguments());
            if !self.take_mark(Punctuation::Comma) {
                break;
            }
        }
        self.expect_mark(Punctuation::RightBracket);
        self.require(Feature::InitArguments, start);
        TypeSpecKind::Instance(name, InitArguments::Listed(lists))
    }

    /// `REF_TO`, `POINTER TO` or `REFERENCE TO`; none of them is a keyword of the 2nd edition.
    fn reference_kind(&mut self) -> Option<ReferenceKind> {
        let word = (self.peek() == Some(TokenKind::Identifier)).then(|| self.next_text().to_ascii_uppercase())?;
        let to = self.peek_ahead(1) == Some(TokenKind::Keyword(Keyword::To));
        let kind = match word.as_str() {
            "REF_TO" => ReferenceKind::RefTo,
            "POINTER" if to => ReferenceKind::Pointer,
            "REFERENCE" if to => ReferenceKind::Reference,
            _ => return None,
        };
        self.advance();
        self.take_keyword(Keyword::To);
        Some(kind)
    }

    fn string_type(&mut self, name: Ident) -> TypeSpecKind {
        // Vendors write the length in parentheses too.
        let close = if self.take_mark(Punctuation::LeftBracket) {
            Punctuation::RightBracket
        } else if self.take_mark(Punctuation::LeftParen) {
            Punctuation::RightParen
        } else {
            return TypeSpecKind::String(name, None);
        };
        let length: Expr = self.expression();
        self.expect_mark(close);
        let length = Some(Box::new(length));
        TypeSpecKind::String(name, length)
    }

    fn array_type(&mut self) -> TypeSpecKind {
        let mut dimensions = Vec::new();
        let bracketed = self.expect_mark(Punctuation::LeftBracket);
        if self.at_mark(Punctuation::Star) {
            return self.open_array_type();
        }
        loop {
            let low = self.expression();
            let is_count = self.at_mark(Punctuation::RightBracket) || self.at_mark(Punctuation::Comma);
            dimensions.push(if is_count {
                self.dimension_of(low)
            } else {
                self.expect_mark(Punctuation::Range);
                Dimension { low, high: self.expression() }
            });
            if !self.take_mark(Punctuation::Comma) {
                break;
            }
        }
        if bracketed {
            self.expect_mark(Punctuation::RightBracket);
        } else {
            self.take_mark(Punctuation::RightBracket);
        }
        self.expect_keyword(Keyword::Of);
        TypeSpecKind::Array(dimensions, Box::new(self.type_spec()))
    }

    /// `*, *] OF INT`
    fn open_array_type(&mut self) -> TypeSpecKind {
        let mut dimensions = 0;
        while self.expect_mark(Punctuation::Star) {
            dimensions += 1;
            if !self.take_mark(Punctuation::Comma) {
                break;
            }
        }
        self.expect_mark(Punctuation::RightBracket);
        self.expect_keyword(Keyword::Of);
        TypeSpecKind::OpenArray(dimensions, Box::new(self.type_spec()))
    }

    /// Behind `STRUCT`. `OVERLAP` is a word of the 3rd edition only, so members may bear the name.
    pub(super) fn structure_type(&mut self) -> TypeSpecKind {
        let overlap = self.peek() == Some(TokenKind::Identifier)
            && self.next_text().eq_ignore_ascii_case("OVERLAP")
            && matches!(self.peek_ahead(1), Some(TokenKind::Identifier | TokenKind::Keyword(Keyword::EndStruct)));
        if !overlap {
            return TypeSpecKind::Struct(self.members_of(Keyword::EndStruct));
        }
        self.advance();
        TypeSpecKind::Overlapping(self.members_of(Keyword::EndStruct))
    }

    fn members_of(&mut self, end: Keyword) -> Vec<Field> {
        let mut fields = Vec::new();
        self.name_keyword();
        while self.peek() == Some(TokenKind::Identifier) {
            self.fields(&mut fields);
            self.name_keyword();
        }
        self.expect_keyword(end);
        fields
    }

    /// `a, b : INT := 5;`, `a AT %B4 : INT;`
    fn fields(&mut self, fields: &mut Vec<Field>) {
        let known = self.reported();
        let names = self.identifier_list("a member's name");
        let address = self.take_keyword(Keyword::At).then(|| self.address()).flatten();
        self.expect_mark(Punctuation::Colon);
        let spec = self.type_spec();
        let initial = self.optional_initialiser();
        for name in names {
            fields.push(Field { name, address: address.clone(), spec: spec.clone(), initial: initial.clone() });
        }
        self.end_of_declaration(known);
    }

    pub(super) fn identifier_list(&mut self, what: &str) -> Vec<Ident> {
        if matches!(self.previous(), Some(TokenKind::Keyword(_))) && self.at_mark(Punctuation::Colon) {
            // The name was a keyword, which has been reported.
            return Vec::new();
        }
        let mut names: Vec<Ident> = self.expect_identifier(what).into_iter().collect();
        while self.take_mark(Punctuation::Comma) {
            names.extend(self.expect_identifier(what));
        }
        names
    }

    fn enumeration_values(&mut self) -> Vec<EnumValue> {
        let mut values = Vec::new();
        while let Some(name) = self.expect_identifier("a value's name") {
            let value = self.take_mark(Punctuation::Assign).then(|| self.expression());
            values.push(EnumValue { name, value });
            if !self.take_mark(Punctuation::Comma) {
                break;
            }
        }
        self.expect_mark(Punctuation::RightParen);
        values
    }
}

/// True for what vendors let inputs have as a type (CODESYS, TwinCAT: `ANY`, `ANY_<type>`).
fn is_generic(name: &Ident) -> bool {
    matches!(name.key().as_str(), "ANY" | "ANY_BIT" | "ANY_DATE" | "ANY_NUM" | "ANY_REAL" | "ANY_INT" | "ANY_STRING")
}
