//! Conversions that mean something else in MatIEC: a TIME is a number of seconds there, whole ones where the number
//! is an integer, and a bit string is TRUE for any value but 0.

use super::{Finding, Page};
use onescan_iec::dialect::{Dialect, Truth};
use onescan_iec::ir::ElementaryType;
use onescan_iec::ir::elementary::Kind;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{Call, Expr, ExprKind, Ident};
use onescan_iec::syntax::walk::{self, Visitor};

/// The functions of the shim that do it, which are written for MatIEC as it is.
const FUNCTIONS: [&str; 2] = ["SDSP_NANOSECONDS", "SDSP_DURATION"];

/// Writes conversions so that they mean what they do in the project's dialect.
pub(super) fn lower(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut writer = Writer { page, edits, dialect: page.file.dialect() };
    for pou in page.pous().filter(|pou| !FUNCTIONS.contains(&pou.name.key().as_str())) {
        walk::with_members(pou, &mut writer);
    }
    Vec::new()
}

struct Writer<'w, 'a> {
    page: &'w Page<'a>,
    edits: &'w mut Edits,
    dialect: Dialect,
}

impl Writer<'_, '_> {
    /// The types of a conversion by name, unless the project has a unit of that name.
    fn types(&self, name: &Ident) -> Option<(ElementaryType, ElementaryType)> {
        let key = name.key();
        let (from, to) = key.split_once("_TO_")?;
        let is_own = self.page.names.units.contains_key(&key);
        Some((ElementaryType::find(from)?, ElementaryType::find(to)?)).filter(|_| !is_own)
    }

    /// What stands in the place of the name in front of the bracket, and behind the bracket's end.
    fn around(&self, from: ElementaryType, to: ElementaryType) -> Option<(String, String)> {
        let counts_milliseconds = self.dialect.time_number_ns() == 1_000_000;
        let is_time = |ty: ElementaryType| matches!(ty, ElementaryType::Time | ElementaryType::Tod);
        let is_number = |ty: ElementaryType| matches!(ty.kind(), Kind::Signed | Kind::Unsigned | Kind::Bits);
        if is_time(from) && (is_number(to) || to.is_real()) && counts_milliseconds {
            return Some(number_of(from, to));
        }
        if is_time(to) && (is_number(from) || from.is_real()) && counts_milliseconds {
            return Some(duration_of(from, to));
        }
        if from.kind() == Kind::Bits && to == ElementaryType::Bool && self.dialect.truth() == Truth::LowestBit {
            let ty = from.name();
            return Some(("((".to_owned(), format!(" AND {ty}#1) <> {ty}#0)")));
        }
        None
    }
}

/// From a TIME or TOD, of which a number counts the milliseconds.
fn number_of(from: ElementaryType, to: ElementaryType) -> (String, String) {
    let (inner, closed) = match from {
        ElementaryType::Tod => ("SDSP_Nanoseconds(", " - TOD#00:00:00)"),
        _ => ("SDSP_Nanoseconds", ""),
    };
    match to {
        ElementaryType::Lint => (format!("({inner}"), format!("{closed} / 1000000)")),
        ElementaryType::Lreal => (format!("(LINT_TO_LREAL({inner}"), format!("{closed}) / 1000000.0)")),
        ElementaryType::Real => (format!("LREAL_TO_REAL(LINT_TO_LREAL({inner}"), format!("{closed}) / 1000000.0)")),
        _ => (format!("LINT_TO_{}({inner}", to.name()), format!("{closed} / 1000000)")),
    }
}

/// The reverse.
fn duration_of(from: ElementaryType, to: ElementaryType) -> (String, String) {
    let (since, closed) = if to == ElementaryType::Tod { ("(TOD#00:00:00 + ", ")") } else { ("", "") };
    let (inner, unit) = match from {
        ElementaryType::Lint => (String::new(), "1000000"),
        ElementaryType::Lreal => ("LREAL_TO_LINT(".to_owned(), "1000000.0)"),
        ElementaryType::Real => ("LREAL_TO_LINT(REAL_TO_LREAL".to_owned(), "1000000.0)"),
        _ => (format!("{}_TO_LINT", from.name()), "1000000"),
    };
    (format!("{since}SDSP_Duration({inner}"), format!(" * {unit}){closed}"))
}

impl Visitor for Writer<'_, '_> {
    fn expression(&mut self, expr: &Expr) {
        let ExprKind::Call(call) = &expr.kind else { return };
        let Call { callee, arguments } = call;
        let (ExprKind::Name(name), 1) = (&callee.kind, arguments.len()) else { return };
        let Some((before, behind)) = self.types(name).and_then(|(from, to)| self.around(from, to)) else { return };
        self.edits.replace(name.span.start..name.span.end, before);
        self.edits.insert(expr.span.end, behind);
    }
}
