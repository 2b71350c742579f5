//! Types as they are written in SCL.

use super::names::Names;
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::ir::ElementaryType;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{Dimension, Expr, TypeSpec, TypeSpecKind};
use onescan_iec::syntax::constant::Constants;

/// Characters of a string whose declaration does not say it (2nd ed. 2.3.1); SCL has 254.
const STRING_LENGTH: i128 = 80;

/// An error that names what SCL lacks.
pub(super) fn refused(span: Span, what: &str, help: &str) -> Diagnostic {
    let message = format!("SCL of TIA Portal has no {what}");
    Diagnostic::error(Code::UnsupportedFeature, span, message).with_help(help.to_owned())
}

/// Members that share bytes are none of SCL's.
pub(super) fn refused_union(span: Span) -> Diagnostic {
    refused(span, "unions in its types", "use parts of one bit string: `a.%X3`")
}

/// TIA Portal's spelling of an elementary type; nothing for one that it lacks or has in another form.
pub(crate) fn elementary(ty: ElementaryType) -> Option<&'static str> {
    use ElementaryType as E;
    Some(match ty {
        E::Bool => "Bool",
        E::Sint => "SInt",
        E::Int => "Int",
        E::Dint => "DInt",
        E::Lint => "LInt",
        E::Usint => "USInt",
        E::Uint => "UInt",
        E::Udint => "UDInt",
        E::Ulint => "ULInt",
        E::Byte => "Byte",
        E::Word => "Word",
        E::Dword => "DWord",
        E::Lword => "LWord",
        E::Real => "Real",
        E::Lreal => "LReal",
        E::Time => "Time",
        E::Ltime => "LTime",
        E::Date => "Date",
        E::Tod => "Time_Of_Day",
        E::Ltod => "LTime_Of_Day",
        E::Ldt => "LDT",
        E::Char => "Char",
        E::Wchar => "WChar",
        E::Ldate | E::Dt => return None,
    })
}

/// A type of a variable or member; `own` are the constants that its unit declares.
pub(super) fn written<'a>(
    names: &Names<'a>,
    own: &Constants<'a>,
    spec: &'a TypeSpec,
    findings: &mut Vec<Diagnostic>,
) -> String {
    Writer { names, own, findings }.spec(spec)
}

struct Writer<'w, 'a> {
    names: &'w Names<'a>,
    own: &'w Constants<'a>,
    findings: &'w mut Vec<Diagnostic>,
}

impl<'a> Writer<'_, 'a> {
    fn spec(&mut self, spec: &'a TypeSpec) -> String {
        match &spec.kind {
            TypeSpecKind::Name(name) | TypeSpecKind::Subrange(name, _) => self.named(&name.text, spec.span),
            TypeSpecKind::String(name, length) => self.text(&name.text, length.as_deref()),
            TypeSpecKind::Array(dimensions, element) => {
                let bounds: Vec<String> = dimensions.iter().map(|each| self.bounds(each)).collect();
                format!("Array[{}] of {}", bounds.join(", "), self.spec(element))
            }
            TypeSpecKind::OpenArray(count, element) => {
                let bounds = vec!["*"; *count as usize];
                format!("Array[{}] of {}", bounds.join(", "), self.spec(element))
            }
            TypeSpecKind::Reference(kind, _) => {
                let what = format!("{} of this kind", kind.text());
                self.refuse(spec.span, &what, "pass the variable as VAR_IN_OUT")
            }
            TypeSpecKind::Union(_) | TypeSpecKind::Overlapping(_) => {
                self.findings.push(refused_union(spec.span));
                String::new()
            }
            TypeSpecKind::Instance(..) => {
                self.refuse(spec.span, "arguments of FB_init", "assign the inputs in the first scan")
            }
            TypeSpecKind::Enumeration(..) => {
                self.refuse(spec.span, "enumerations without a name", "declare it in TYPE .. END_TYPE")
            }
            TypeSpecKind::Struct(_) => {
                self.refuse(spec.span, "structures here that have no name", "declare it in TYPE .. END_TYPE")
            }
            TypeSpecKind::Error => String::new(),
        }
    }

    fn refuse(&mut self, span: Span, what: &str, help: &str) -> String {
        self.findings.push(refused(span, what, help));
        String::new()
    }

    fn named(&mut self, name: &str, span: Span) -> String {
        let key = name.to_ascii_uppercase();
        if let Some(named) = self.names.types.get(&key).copied() {
            return match &named.spec.kind {
                TypeSpecKind::Struct(_) => self.names.block(name),
                TypeSpecKind::Enumeration(_, base) => match base {
                    Some(base) => self.named(&base.text, base.span),
                    None => "Int".to_owned(),
                },
                _ => self.spec(&named.spec),
            };
        }
        if key == "STRING" || key == "WSTRING" {
            return self.text(name, None);
        }
        match ElementaryType::find(&key) {
            Some(ty) => match elementary(ty) {
                Some(written) => written.to_owned(),
                None => self.refuse(span, &format!("{} as the standard has it", ty.name()), "use LDT"),
            },
            None => self.names.block(name),
        }
    }

    fn text(&mut self, name: &str, length: Option<&'a Expr>) -> String {
        let name = if name.eq_ignore_ascii_case("WSTRING") { "WString" } else { "String" };
        let known = length.map_or(Some(STRING_LENGTH), |length| self.names.integer_with(length, self.own));
        match (known, length) {
            (Some(known), _) => format!("{name}[{known}]"),
            (None, Some(length)) => {
                self.refuse(length.span, "length of a string that is computed so", "write the number")
            }
            (None, None) => name.to_owned(),
        }
    }

    fn bounds(&mut self, dimension: &'a Dimension) -> String {
        let value = |expr| self.names.integer_with(expr, self.own);
        match value(&dimension.low).zip(value(&dimension.high)) {
            Some((low, high)) => format!("{low}..{high}"),
            None => self.refuse(dimension.low.span, "bounds that are computed so", "write the numbers"),
        }
    }
}
