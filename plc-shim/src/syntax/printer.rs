//! A tree to text that parses to the same tree, spans aside.

mod configuration;
mod declaration;
mod expression;
mod object;
mod statement;

use super::ast::{CompilationUnit, Expr};

/// Text of a whole file.
pub fn print_unit(unit: &CompilationUnit) -> String {
    let mut printer = Printer::default();
    for declaration in &unit.declarations {
        printer.declaration(declaration);
    }
    printer.text
}

/// Text of one expression.
pub fn print_expression(expr: &Expr) -> String {
    let mut printer = Printer::default();
    printer.expression(expr);
    printer.text
}

#[derive(Default)]
struct Printer {
    text: String,
    indent: usize,
}

impl Printer {
    fn word(&mut self, text: &str) {
        self.text.push_str(text);
    }

    fn line(&mut self, text: &str) {
        self.begin_line();
        self.word(text);
        self.end_line();
    }

    fn begin_line(&mut self) {
        for _ in 0..self.indent {
            self.text.push_str("    ");
        }
    }

    fn end_line(&mut self) {
        self.text.push('\n');
    }

    fn separated<T>(&mut self, items: &[T], mut each: impl FnMut(&mut Self, &T)) {
        for (index, item) in items.iter().enumerate() {
            if index > 0 {
                self.word(", ");
            }
            each(self, item);
        }
    }

    fn indented(&mut self, body: impl FnOnce(&mut Self)) {
        self.indent += 1;
        body(self);
        self.indent -= 1;
    }
}
