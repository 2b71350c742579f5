//! Instructions to text.

use super::Printer;
use crate::syntax::ast::instruction::OPERATORS;
use crate::syntax::ast::{BinaryOp, Expr, Ident, Instruction, ListCall, Statement};

fn name(operator: BinaryOp) -> &'static str {
    OPERATORS.iter().find(|(_, known)| *known == operator).map_or("", |(name, _)| name)
}

fn suffix(negated: bool) -> &'static str {
    if negated { "N" } else { "" }
}

impl Printer {
    pub(super) fn instruction(&mut self, instruction: &Instruction) {
        match instruction {
            Instruction::Load { negated, value } => self.with_operand("LD", suffix(*negated), value),
            Instruction::Store { negated, target } => self.with_operand("ST", suffix(*negated), target),
            Instruction::Set(target) => self.with_operand("S", "", target),
            Instruction::Reset(target) => self.with_operand("R", "", target),
            Instruction::Operate { operator, negated, operands } => {
                self.word(name(*operator));
                self.word(suffix(*negated));
                self.word(" ");
                self.separated(operands, Self::expression);
            }
            Instruction::Deferred { operator, negated, list } => {
                self.word(name(*operator));
                self.word(suffix(*negated));
                self.parenthesised_list(list);
            }
            Instruction::Not => self.word("NOT"),
            Instruction::Jump(when, label) => {
                self.word(&format!("JMP{} ", when.text()));
                self.name(label);
            }
            Instruction::Return(when) => self.word(&format!("RET{}", when.text())),
            Instruction::Call(when, call) => {
                self.word(&format!("CAL{} ", when.text()));
                self.list_call(call);
            }
            Instruction::Function(call) => self.list_call(call),
            Instruction::Input(input, instance) => self.with_operand(&input.text, "", instance),
        }
    }

    fn with_operand(&mut self, operator: &str, modifier: &str, operand: &Expr) {
        self.word(&format!("{operator}{modifier} "));
        self.expression(operand);
    }

    fn parenthesised_list(&mut self, list: &[Statement]) {
        self.word("(");
        self.end_line();
        self.statements(list);
        self.begin_line();
        self.word(")");
    }

    fn list_call(&mut self, call: &ListCall) {
        self.expression(&call.call.callee);
        if call.takes_result {
            self.word(if call.call.arguments.is_empty() { "" } else { " " });
            return self.separated(&call.call.arguments, Self::argument);
        }
        self.word("(");
        self.separated(&call.call.arguments, Self::argument);
        for (index, (input, list)) in call.lists.iter().enumerate() {
            self.word(if index > 0 || !call.call.arguments.is_empty() { ", " } else { "" });
            self.list_argument(input, list);
        }
        self.word(")");
    }

    fn list_argument(&mut self, input: &Ident, list: &[Statement]) {
        self.name(input);
        self.word(" := ");
        self.parenthesised_list(list);
    }
}
