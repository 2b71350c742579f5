//! Programs that take over what lies at addresses, and hand on what they have written: MatIEC connects nothing to the
//! inputs and outputs of a program, and a variable within a block has no address.
//!
//! | in the project | becomes |
//! |---|---|
//! | a program's body | assignments of its inputs, the body, assignments of its outputs, these also before each RETURN |
//! | a program that is a chart | a function block, and a program that calls it between the assignments |

use super::controller::returns;
use super::exchanged::Way;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::ast::Pou;
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::{Keyword, TokenKind};

/// What one program takes over.
pub(super) struct Handover {
    /// The declarations of what lies at addresses.
    pub(super) externals: Vec<String>,
    /// Paths within the program, the statement for each with `@` in the place of its variable.
    pub(super) statements: Vec<(Way, String)>,
}

impl Handover {
    fn of(&self, way: Way, before: &str) -> String {
        let wanted = self.statements.iter().filter(|(each, _)| *each == way);
        wanted.map(|(_, statement)| format!("    {}\n", statement.replace('@', before))).collect()
    }

    fn declarations(&self) -> String {
        if self.externals.is_empty() {
            return String::new();
        }
        let lines: String = self.externals.iter().map(|external| format!("    {external};\n")).collect();
        format!("VAR_EXTERNAL\n{lines}END_VAR\n")
    }
}

/// Lets a program take over its values.
pub(super) fn attach(pou: &Pou, handover: &Handover, file: &SourceFile, edits: &mut Edits) {
    if !pou.chart.is_empty() {
        return wrap(pou, handover, file, edits);
    }
    let end = pou.span.end.saturating_sub(Keyword::EndProgram.text().len() as u32);
    let first = pou.body.first().map_or(end, |statement| statement.span.start);
    let outputs = handover.of(Way::FromPlc, "");
    let before = format!("{}{}", handover.declarations(), handover.of(Way::ToPlc, ""));
    edits.insert(first, format!("{}\n", before.trim_end()).trim_start().to_owned());
    for start in returns(&pou.body) {
        let on_one_line: Vec<&str> = outputs.lines().map(str::trim).collect();
        edits.insert(start, format!("{} ", on_one_line.join(" ")));
    }
    edits.insert(end, outputs);
}

/// A chart has no statement that comes before its transitions: another program calls it.
fn wrap(pou: &Pou, handover: &Handover, file: &SourceFile, edits: &mut Edits) {
    let tokens = tokenize_in(file.dialect(), file.text());
    let inside = || tokens.iter().filter(|token| pou.span.start <= token.start && token.end <= pou.span.end);
    let word = |wanted: Keyword| move |kind: TokenKind| kind == TokenKind::Keyword(wanted);
    let name = &pou.name.text;
    if let Some(keyword) = inside().find(|token| word(Keyword::Program)(token.kind)) {
        edits.replace(keyword.start..keyword.end, "FUNCTION_BLOCK");
    }
    edits.replace(pou.name.span.start..pou.name.span.end, format!("{name}_Chart"));
    if let Some(keyword) = inside().rfind(|token| word(Keyword::EndProgram)(token.kind)) {
        let program = format!(
            "END_FUNCTION_BLOCK\n\nPROGRAM {name}\nVAR\n    Chart : {name}_Chart;\nEND_VAR\n{}{}    Chart();\n{}END_PROGRAM\n",
            handover.declarations(),
            handover.of(Way::ToPlc, "Chart."),
            handover.of(Way::FromPlc, "Chart."),
        );
        edits.replace(keyword.start..keyword.end, program);
    }
}
