//! Statements to text.

use super::Printer;
use crate::syntax::ast::{
    CaseLabel, CaseStatement, Expr, ForStatement, IfStatement, Statement, StatementKind, TryStatement,
};

impl Printer {
    pub(super) fn statements(&mut self, list: &[Statement]) {
        self.indented(|printer| {
            for statement in list {
                printer.statement(statement);
            }
        });
    }

    fn statement(&mut self, statement: &Statement) {
        self.begin_line();
        if let StatementKind::Label(name) = &statement.kind {
            self.name(name);
            self.word(":");
            return self.end_line();
        }
        if let StatementKind::Instruction(instruction) = &statement.kind {
            self.instruction(instruction);
            return self.end_line();
        }
        match &statement.kind {
            // Labels and instructions have lines of their own.
            StatementKind::Empty | StatementKind::Error | StatementKind::Label(_) | StatementKind::Instruction(_) => {}
            StatementKind::Jump(label) => {
                self.word("JMP ");
                self.name(label);
            }
            StatementKind::Assign(target, value) => {
                self.expression(target);
                self.word(" := ");
                self.expression(value);
            }
            StatementKind::Chain(targets, value) => {
                for target in targets {
                    self.expression(target);
                    self.word(" := ");
                }
                self.expression(value);
            }
            StatementKind::Update(operator, target, value) => {
                self.expression(target);
                self.word(" ");
                self.word(operator.text());
                self.word(" ");
                self.expression(value);
            }
            StatementKind::SetReset(targets, value) => {
                for (operator, target) in targets {
                    self.expression(target);
                    self.word(" ");
                    self.word(operator.text());
                    self.word(" ");
                }
                self.expression(value);
            }
            StatementKind::Refer(target, value) => {
                self.expression(target);
                self.head(" REF= ", value, "");
            }
            StatementKind::Attempt(target, value) => {
                self.expression(target);
                self.head(" ?= ", value, "");
            }
            StatementKind::Call(call) => self.call(call),
            StatementKind::Value(value) => self.expression(value),
            StatementKind::Try(inner) => self.try_statement(inner),
            StatementKind::If(inner) => self.if_statement(inner),
            StatementKind::Case(inner) => self.case_statement(inner),
            StatementKind::For(inner) => self.for_statement(inner),
            StatementKind::While(inner) => {
                self.head("WHILE ", &inner.condition, " DO");
                self.block(&inner.body, "END_WHILE");
            }
            StatementKind::Repeat(inner) => {
                self.word("REPEAT");
                self.block(&inner.body, "UNTIL ");
                self.expression(&inner.until);
                self.word(" END_REPEAT");
            }
            StatementKind::Exit => self.word("EXIT"),
            StatementKind::Continue => self.word("CONTINUE"),
            StatementKind::Return => self.word("RETURN"),
        }
        self.word(";");
        self.end_line();
    }

    fn head(&mut self, before: &str, expr: &Expr, after: &str) {
        self.word(before);
        self.expression(expr);
        self.word(after);
    }

    /// The rest of a head's line, the body, and the beginning of the line that ends it.
    fn block(&mut self, body: &[Statement], end: &str) {
        self.end_line();
        self.statements(body);
        self.begin_line();
        self.word(end);
    }

    fn if_statement(&mut self, inner: &IfStatement) {
        for (index, branch) in inner.branches.iter().enumerate() {
            self.head(if index == 0 { "IF " } else { "ELSIF " }, &branch.condition, " THEN");
            self.block(&branch.body, "");
        }
        if !inner.otherwise.is_empty() {
            self.word("ELSE");
            self.block(&inner.otherwise, "");
        }
        self.word("END_IF");
    }

    fn try_statement(&mut self, inner: &TryStatement) {
        self.word("__TRY");
        self.block(&inner.body, "");
        if inner.code.is_some() || !inner.handler.is_empty() {
            self.word("__CATCH");
            if let Some(code) = &inner.code {
                self.head("(", code, ")");
            }
            self.block(&inner.handler, "");
        }
        if !inner.finally.is_empty() {
            self.word("__FINALLY");
            self.block(&inner.finally, "");
        }
        self.word("__ENDTRY");
    }

    fn case_statement(&mut self, inner: &CaseStatement) {
        self.head("CASE ", &inner.selector, " OF");
        self.end_line();
        for branch in &inner.branches {
            self.begin_line();
            self.separated(&branch.labels, Self::case_label);
            self.word(":");
            self.end_line();
            self.statements(&branch.body);
        }
        self.begin_line();
        if !inner.otherwise.is_empty() {
            self.word("ELSE");
            self.block(&inner.otherwise, "");
        }
        self.word("END_CASE");
    }

    fn case_label(&mut self, label: &CaseLabel) {
        self.expression(&label.low);
        if let Some(high) = &label.high {
            self.word("..");
            self.expression(high);
        }
    }

    fn for_statement(&mut self, inner: &ForStatement) {
        self.word("FOR ");
        self.expression(&inner.variable);
        self.head(" := ", &inner.from, " TO ");
        self.expression(&inner.to);
        if let Some(by) = &inner.by {
            self.head(" BY ", by, "");
        }
        self.word(" DO");
        self.block(&inner.body, "END_FOR");
    }
}
