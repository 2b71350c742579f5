//! A tree to text that parses to the same tree, spans aside.

mod chart;
mod configuration;
mod declaration;
mod expression;
mod instruction;
mod object;
mod statement;

use super::ast::{CompilationUnit, Expr, Ident, TypeSpec};

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

/// Text of a type, as a declaration has it.
pub(crate) fn print_type(spec: &TypeSpec) -> String {
    let mut printer = Printer::default();
    printer.type_spec(spec);
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

    /// A name where it is declared or needs no distinction; SCL allows any text between quotes.
    fn name(&mut self, name: &Ident) {
        // The constants of a generic block stand as they were written.
        let plain = name.text.split('<').next().unwrap_or(&name.text);
        if plain.split('.').all(is_plain) {
            self.word(&name.text);
        } else {
            self.word(&format!("\"{}\"", name.text));
        }
    }

    /// A name in an expression: `"x"` is global and as it was written, any other is local first.
    fn variable_name(&mut self, name: &Ident) {
        if name.is_global() || is_plain(&name.text) {
            self.word(&name.text);
        } else {
            self.word(&format!("#\"{}\"", name.text));
        }
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

/// True for what is a name without quotes. The part of a bit string is one, too.
fn is_plain(text: &str) -> bool {
    text.chars().all(|one| one.is_alphanumeric() || matches!(one, '_' | '%') || text.starts_with('`'))
}
