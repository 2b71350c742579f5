//! Execution controllers (`[SDSP]` sec. V-B, Fig. 11): header and footer of every
//! scheduled program, the footer also before each RETURN.

use super::template::{self, Controller, Number, Only};
use super::{marks, scl};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::ast::{Pou, Statement, StatementKind};
use onescan_iec::syntax::token::Keyword;
use onescan_iec::syntax::walk::{self, Visitor};

/// Adds the execution controller of `pou`, with the lines of its template that are `wanted`; `line` is the type of the
/// line of programs.
pub(super) fn control(pou: &Pou, number: Number, line: &str, wanted: &[Only], file: &SourceFile, edits: &mut Edits) {
    let is_scl = scl::is_scl(file);
    let controller = if is_scl { template::scl_controller(number, wanted) } else { template::controller(number, line) };
    let Controller { declarations, header, .. } = &controller;
    let line_break = marks::line_break(file.shown_text());
    let places = Places::of(pou, file);
    if is_list(pou) {
        return control_list(&controller, &places, line_break, edits);
    }
    if is_scl {
        scl::declare(pou, declarations, file, edits);
        edits.insert(places.header, marks::lines(header, line_break));
    } else if places.declarations == places.header {
        edits.insert(places.header, marks::lines(&format!("{declarations}\n{header}"), line_break));
    } else {
        edits.insert(places.declarations, marks::lines(declarations, line_break));
        edits.insert(places.header, marks::lines(header, line_break));
    }
    end(pou, &controller, &places, file, edits);
}

/// True for a body in Instruction List.
pub(super) fn is_list(pou: &Pou) -> bool {
    pou.body.iter().any(|statement| matches!(statement.kind, StatementKind::Instruction(_)))
}

/// A list of instructions stays one: it becomes an action that statements call, so that `RET` ends the action alone.
fn control_list(controller: &Controller, places: &Places, line_break: &str, edits: &mut Edits) {
    let Controller { declarations, header, footer } = controller;
    edits.insert(places.header, marks::lines(&format!("{declarations}\nACTION SDSP_Body:"), line_break));
    let statements = format!("END_ACTION\n{header}\n    SDSP_Body();\n{footer}");
    edits.insert(places.footer, marks::lines(&statements, line_break));
}

/// Puts declarations behind those of a unit that has statements.
pub(super) fn declare_in(pou: &Pou, declarations: &str, file: &SourceFile, edits: &mut Edits) {
    let at = Places::of(pou, file).declarations;
    edits.insert(at, marks::lines(declarations, marks::line_break(file.shown_text())));
}

/// Puts statements in front of those of a unit.
pub(super) fn put_in_front(pou: &Pou, statements: &str, file: &SourceFile, edits: &mut Edits) {
    let at = Places::of(pou, file).header;
    edits.insert(at, marks::lines(statements, marks::line_break(file.shown_text())));
}

/// The same without its variables, which are declared elsewhere.
pub(super) fn control_statements(pou: &Pou, controller: &Controller, file: &SourceFile, edits: &mut Edits) {
    let places = Places::of(pou, file);
    let line_break = marks::line_break(file.shown_text());
    edits.insert(places.header, marks::lines(&controller.header, line_break));
    end(pou, controller, &places, file, edits);
}

/// What stands at the end of a body and before each RETURN.
fn end(pou: &Pou, controller: &Controller, places: &Places, file: &SourceFile, edits: &mut Edits) {
    let footer = &controller.footer;
    let line_break = marks::line_break(file.shown_text());
    for start in returns(&pou.body) {
        let footer: Vec<&str> = footer.split_whitespace().collect();
        edits.insert(file.shown_range(start, start + 1).start, marks::inline(&footer.join(" ")));
    }
    edits.insert(places.footer, marks::lines(footer, line_break));
}

/// Where the parts of a controller go, in the file as its author sees it.
struct Places {
    declarations: u32,
    header: u32,
    footer: u32,
}

impl Places {
    fn of(pou: &Pou, file: &SourceFile) -> Self {
        let last = if scl::is_scl(file) { Keyword::EndOrganizationBlock } else { Keyword::EndProgram };
        let end = pou.span.end.saturating_sub(last.text().len() as u32);
        let first = pou.body.first().map_or(end, |statement| statement.span.start);
        let shown = file.shown_text();
        if let Some(begin) = scl::begin(pou.span, file) {
            let (declarations, header) = (marks::line_start(shown, begin.start), marks::line_end(shown, begin.end));
            return Self { declarations, header, footer: marks::line_start(shown, end) };
        }
        let Some(origin) = file.origin() else {
            let header = marks::line_start(shown, first);
            return Self { declarations: header, header, footer: marks::line_start(shown, end) };
        };
        // Declarations and statements are parts of their own; what ends a unit is not in the file.
        let declared = pou.sections.last().map_or(pou.name.span.end, |section| section.span.end);
        let declarations = marks::line_end(shown, file.shown_range(declared.saturating_sub(1), declared).end);
        let body = empty_body(shown, declarations);
        let (header, footer) = match pou.body.as_slice() {
            [] => (body, body),
            [.., last] => {
                let first = marks::line_start(shown, file.shown_range(first, first + 1).start);
                (first, origin.verbatim_end(last.span.end).unwrap_or(first))
            }
        };
        Self { declarations, header, footer }
    }
}

/// The place in a TwinCAT object for the first statement of a body without any.
fn empty_body(text: &str, from: u32) -> u32 {
    const OPENING: &str = "<ST><![CDATA[";
    let rest = text.get(from as usize..).unwrap_or("");
    rest.find(OPENING).map_or(from, |at| from + (at + OPENING.len()) as u32)
}

/// Where every RETURN begins.
pub(super) fn returns(body: &[Statement]) -> Vec<u32> {
    let mut returns = Returns { starts: Vec::new() };
    walk::statements(body, &mut returns);
    returns.starts
}

struct Returns {
    starts: Vec<u32>,
}

impl Visitor for Returns {
    fn statement(&mut self, statement: &Statement) {
        if matches!(statement.kind, StatementKind::Return) {
            self.starts.push(statement.span.start);
        }
    }
}
