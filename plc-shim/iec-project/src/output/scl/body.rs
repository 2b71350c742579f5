//! Statements: the author's text, with names, literals and calls written as SCL has them.

use std::collections::BTreeMap;

use super::literal;
use super::names::{EnumeratedValue, Names, member, quoted};
use super::scope::Scope;
use super::spec::{elementary, refused};
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{
    BinaryOp, Call, Edge, Expr, ExprKind, Ident, InitialiserKind, Literal, Statement, StatementKind, TypedValue,
    UpdateOp,
};
use onescan_iec::syntax::walk::{self, Visitor};
use onescan_iec::syntax::{SourceFile, Span};

/// A constant that a block declares for a value of an enumeration or a global constant.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct UsedConstant {
    pub(super) name: String,
    pub(super) ty: String,
    pub(super) value: String,
    /// Whose value it is.
    pub(super) of: String,
}

/// Changes of the statements of one unit.
pub(super) struct Body<'w, 'a> {
    pub(super) names: &'w Names<'a>,
    pub(super) scope: &'w Scope<'a>,
    pub(super) file: &'a SourceFile,
    pub(super) edits: Edits,
    pub(super) constants: BTreeMap<String, UsedConstant>,
    pub(super) findings: Vec<Diagnostic>,
}

impl<'w, 'a> Body<'w, 'a> {
    pub(super) fn new(names: &'w Names<'a>, scope: &'w Scope<'a>, file: &'a SourceFile) -> Self {
        Self { names, scope, file, edits: Edits::default(), constants: BTreeMap::new(), findings: Vec::new() }
    }

    pub(super) fn refuse(&mut self, span: Span, what: &str, help: &str) {
        self.findings.push(refused(span, what, help));
    }

    pub(super) fn replace(&mut self, span: Span, text: impl Into<String>) {
        self.edits.replace(span.start..span.end, text);
    }

    /// A name that stands for a value or a place.
    fn name(&mut self, name: &Ident) {
        let key = name.key();
        if let Some(local) = self.scope.locals.get(&key) {
            let written = match local.edge {
                Some(edge) => format!("#{}.Q", edge_name(&local.name.text, edge)),
                None if local.is_result => format!("#{}", self.names.block(&name.text).trim_matches('"')),
                None => format!("#{}", member(&name.text)),
            };
            return self.replace(name.span, written);
        }
        if let Some(written) = self.names.global(&key) {
            if let Some(constant) = self.global_constant(&key) {
                let written = self.used(constant);
                return self.replace(name.span, written);
            }
            return self.replace(name.span, written);
        }
        if let Some(value) = self.names.value(&key, None) {
            let written = self.enumerated(value);
            return self.replace(name.span, written);
        }
        if let Some(program) = self.names.program(&key) {
            return self.replace(name.span, quoted(&program.name.text));
        }
        let is_type = self.names.types.contains_key(&key);
        if !is_type {
            self.refuse(name.span, &format!("`{}`", name.text), "declare it in the project");
        }
    }

    /// An elementary constant of the project, which blocks declare themselves in SCL.
    fn global_constant(&mut self, key: &str) -> Option<UsedConstant> {
        let global = self.names.globals.get(key).filter(|global| global.is_constant)?;
        let ty = self.names.shape(&global.variable.spec)?.elementary()?;
        let Some(InitialiserKind::Value(value)) = global.variable.initial.as_ref().map(|initial| &initial.kind) else {
            return None;
        };
        let value = match self.names.integer(value) {
            Some(value) => value.to_string(),
            None => self.names.sources.text(value.span).to_owned(),
        };
        let name = global.name.text.clone();
        Some(UsedConstant { name, ty: elementary(ty)?.to_owned(), value, of: "global constants".to_owned() })
    }

    fn enumerated(&mut self, value: EnumeratedValue<'a>) -> String {
        let of = self.names.block(&value.of.name.text).trim_matches('"').to_owned();
        let ty = elementary(value.base).unwrap_or("Int").to_owned();
        self.used(UsedConstant { name: value.name.text.clone(), ty, value: value.number.to_string(), of })
    }

    /// Notes that the block needs the constant; how it is written there.
    fn used(&mut self, mut constant: UsedConstant) -> String {
        let is_taken = |key: &str, constant: &UsedConstant, known: &BTreeMap<String, UsedConstant>| {
            self.scope.locals.contains_key(key) || known.get(key).is_some_and(|other| other != constant)
        };
        if is_taken(&constant.name.to_ascii_uppercase(), &constant, &self.constants) {
            constant.name = format!("{}_{}", constant.of, constant.name);
        }
        let written = format!("#{}", member(&constant.name));
        self.constants.insert(constant.name.to_ascii_uppercase(), constant);
        written
    }

    fn literal(&mut self, literal: &Literal, span: Span) {
        if let Literal::Typed { prefix, value: TypedValue::Name(name) } = literal
            && let Some(value) = self.names.value(&name.to_ascii_uppercase(), Some(&prefix.to_ascii_uppercase()))
        {
            let written = self.enumerated(value);
            return self.replace(span, written);
        }
        match literal::written(literal, self.names.sources.text(span), span) {
            Ok(Some(written)) => self.replace(span, written),
            Ok(None) => {}
            Err(found) => self.findings.push(found),
        }
    }

    fn place(&mut self, place: &Expr) {
        match &place.kind {
            ExprKind::Name(name) => self.name(name),
            ExprKind::Index(inner, _) | ExprKind::Paren(inner) => self.place(inner),
            ExprKind::Member(inner, name) => {
                self.place(inner);
                self.member(name);
            }
            ExprKind::Part(inner, part) => {
                self.place(inner);
                self.part(part);
            }
            _ => self.other(place),
        }
    }

    fn member(&mut self, name: &Ident) {
        let written = member(&name.text);
        if written != name.text {
            self.replace(name.span, written);
        }
    }

    /// `a.3`, which is `a.%X3` there.
    fn part(&mut self, part: &Ident) {
        if !part.text.starts_with('%') {
            self.replace(part.span, format!("%X{}", part.text));
        }
    }

    /// `Colour.Red` of vendors.
    fn value_of_type(&self, base: &Expr, name: &Ident) -> Option<EnumeratedValue<'a>> {
        let ExprKind::Name(ty) = &base.kind else { return None };
        let is_local = self.scope.locals.contains_key(&ty.key());
        self.names.value(&name.key(), Some(&ty.key())).filter(|_| !is_local)
    }

    fn refuse_short(&mut self, span: Span) {
        self.refuse(span, "AND_THEN and OR_ELSE", "write one IF inside of the other");
    }

    fn other(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::DirectAddress(_) => {
                self.refuse(expr.span, "direct addresses in this form", "declare a variable and name it");
            }
            ExprKind::Dereference(_) => {
                self.refuse(expr.span, "references of this kind", "pass the variable as VAR_IN_OUT");
            }
            ExprKind::Chain(_, links) if links.iter().any(|link| is_short(link.operator)) => {
                self.refuse_short(expr.span);
            }
            ExprKind::Binary(operator, ..) if is_short(*operator) => self.refuse_short(expr.span),
            _ => {}
        }
    }
}

fn is_short(operator: BinaryOp) -> bool {
    matches!(operator, BinaryOp::AndThen | BinaryOp::OrElse)
}

/// The trigger of an input with an edge.
pub(super) fn edge_name(input: &str, edge: Edge) -> String {
    let kind = match edge {
        Edge::Rising => "Rising",
        Edge::Falling => "Falling",
    };
    format!("{input}_{kind}")
}

impl Visitor for Body<'_, '_> {
    fn statement(&mut self, statement: &Statement) {
        let (what, help) = match &statement.kind {
            StatementKind::Label(_) | StatementKind::Jump(_) => ("jumps of this kind", "write a loop or an IF"),
            StatementKind::Refer(..) | StatementKind::Attempt(..) => {
                ("references of this kind", "pass the variable as VAR_IN_OUT")
            }
            StatementKind::Update(UpdateOp::Set | UpdateOp::Reset, ..) | StatementKind::SetReset(..) => {
                ("assignments S= and R=", "write IF .. THEN a := TRUE; END_IF")
            }
            StatementKind::Try(_) => ("`__TRY`", "check what may fail before it does"),
            StatementKind::Value(_) => ("values without a use", "assign it, or leave it out"),
            StatementKind::Instruction(_) => ("instruction lists", "write the body in Structured Text"),
            _ => return,
        };
        self.refuse(statement.span, what, help);
    }

    fn target(&mut self, target: &Expr) {
        self.place(target);
    }

    fn call(&mut self, call: &Call) {
        self.called(call);
    }

    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Name(name) => self.name(name),
            ExprKind::Literal(literal) => self.literal(literal, expr.span),
            ExprKind::Member(base, name) => match self.value_of_type(base, name) {
                Some(value) => {
                    let written = self.enumerated(value);
                    self.replace(expr.span, written);
                }
                None => self.member(name),
            },
            ExprKind::Part(_, part) => self.part(part),
            // In SCL a sign binds looser than `**`.
            ExprKind::Binary(BinaryOp::Power, base, _) if matches!(base.kind, ExprKind::Unary(..)) => {
                self.edits.insert(base.span.start, "(");
                self.edits.insert(base.span.end, ")");
            }
            _ => self.other(expr),
        }
    }
}

/// The changes of statements.
pub(super) fn statements(body: &mut Body<'_, '_>, list: &[Statement]) {
    walk::statements(list, body);
}

/// A single constant expression, as in a declaration.
pub(super) fn expression(body: &mut Body<'_, '_>, expr: &Expr) {
    walk::expression(expr, body);
}

/// An error of the translation itself.
pub(super) fn conflict(span: Span) -> Diagnostic {
    Diagnostic::error(Code::UnsupportedFeature, span, "this cannot be written in SCL: two changes overlap here")
}
