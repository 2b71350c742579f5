//! What MatIEC has not, and what there is no other way for.

use super::{Finding, Page};
use onescan_iec::ir::ElementaryType;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{
    BinaryOp, Configuration, Declaration, Expr, ExprKind, Literal, MemberKind, Pou, PouKind, SectionKind, Statement,
    StatementKind, TypeSpec, TypeSpecKind,
};
use onescan_iec::syntax::walk::{self, Visitor};

/// Every such place of a text.
pub(super) fn find(page: &Page<'_>, _: &mut Edits) -> Vec<Finding> {
    let mut refused = Refused { findings: Vec::new() };
    for declaration in &page.unit.declarations {
        match declaration {
            Declaration::Pou(pou) => refused.unit(pou),
            Declaration::Type(named) => {
                if let Some(base) = &named.extends {
                    refused.add(base.span, "a structure that adds members to another", "write out all its members");
                }
                refused.spec(&named.spec);
            }
            Declaration::Namespace(namespace) => {
                let help = "leave the namespace out";
                refused.findings.extend(namespace.declarations.iter().filter_map(|inner| match inner {
                    Declaration::Pou(pou) => Some(Finding::new(pou.name.span, "a unit in a namespace", help)),
                    Declaration::Type(named) => Some(Finding::new(named.name.span, "a type in a namespace", help)),
                    _ => None,
                }));
            }
            Declaration::Configuration(configuration) => refused.configuration(configuration),
            Declaration::Globals(_) | Declaration::Using(_) => {}
        }
    }
    for (_, section) in page.sections() {
        section.variables.iter().for_each(|variable| refused.spec(&variable.spec));
    }
    refused.findings
}

struct Refused {
    findings: Vec<Finding>,
}

impl Refused {
    fn add(&mut self, span: onescan_iec::syntax::Span, what: &str, help: &'static str) {
        self.findings.push(Finding::new(span, what, help));
    }

    fn unit(&mut self, pou: &Pou) {
        match pou.kind {
            PouKind::Class => self.add(pou.name.span, "a class", "write it as a function block"),
            PouKind::Interface => self.add(pou.name.span, "an interface", "name the function block that is meant"),
            _ => {}
        }
        if let Some(base) = pou.object.extends.first() {
            self.add(base.span, "EXTENDS", "declare an instance of the other block, and call it");
        }
        let generic = pou.sections.iter().filter(|section| section.is_generic());
        for section in generic {
            self.add(section.span, "a generic block", "write a block for each list of constants");
        }
        let methods = pou.object.members.iter().filter(|member| member.kind != MemberKind::Action);
        for member in methods {
            self.add(member.pou.name.span, "a method or property", "write it as a function block of its own");
        }
        let statics = pou.sections.iter().filter(|section| section.kind == SectionKind::Static);
        for section in statics {
            self.add(section.span, "VAR_STAT", "declare a global variable");
        }
        walk::with_members(pou, self);
    }

    fn configuration(&mut self, configuration: &Configuration) {
        for access in &configuration.access {
            self.add(access.name.span, "VAR_ACCESS", "leave it out: the gateway reads the addresses");
        }
        for value in &configuration.instances {
            self.add(value.path.span, "VAR_CONFIG", "give the variable its value or address in its program");
        }
    }

    fn spec(&mut self, spec: &TypeSpec) {
        match &spec.kind {
            TypeSpecKind::Name(name) => {
                let ty = ElementaryType::find(&name.text);
                let is_new = |ty: ElementaryType| {
                    use ElementaryType::{Char, Ldate, Ldt, Ltime, Ltod, Wchar};
                    matches!(ty, Ltime | Ldate | Ldt | Ltod | Char | Wchar)
                };
                if ty.is_some_and(is_new) || name.key() == "WSTRING" {
                    self.add(spec.span, &format!("the type {}", name.key()), "take a type of the second edition");
                }
            }
            TypeSpecKind::String(name, _) if name.key() == "WSTRING" => {
                self.add(spec.span, "the type WSTRING", "take STRING");
            }
            TypeSpecKind::Reference(..) => self.add(spec.span, "a reference", "hand the variable over as VAR_IN_OUT"),
            TypeSpecKind::OpenArray(..) => self.add(spec.span, "ARRAY [*]", "give the array its bounds"),
            TypeSpecKind::Union(_) | TypeSpecKind::Overlapping(_) => {
                self.add(spec.span, "variables that share their bytes", "convert the values");
            }
            TypeSpecKind::Instance(..) => self.add(spec.span, "FB_init", "give the block inputs"),
            TypeSpecKind::Array(_, element) => self.spec(element),
            TypeSpecKind::Struct(fields) => fields.iter().for_each(|field| self.spec(&field.spec)),
            _ => {}
        }
    }
}

impl Visitor for Refused {
    fn statement(&mut self, statement: &Statement) {
        let (what, help) = match &statement.kind {
            StatementKind::Label(_) | StatementKind::Jump(_) => ("a jump in Structured Text", "write a loop or an IF"),
            StatementKind::Refer(..) | StatementKind::Attempt(..) => {
                ("an assignment of a reference", "hand the variable over as VAR_IN_OUT")
            }
            StatementKind::Chain(..) => ("an assignment to several variables", "write one for each"),
            StatementKind::Update(..) | StatementKind::SetReset(..) => {
                ("an assignment that computes", "write a := a + b")
            }
            StatementKind::Try(_) => ("`__TRY`", "check what may fail before it does"),
            StatementKind::Continue => ("CONTINUE", "write an IF around the rest of the loop"),
            StatementKind::Instruction(_) => ("an instruction list under a shim", "write it in Structured Text"),
            _ => return,
        };
        self.add(statement.span, what, help);
    }

    fn expression(&mut self, expr: &Expr) {
        let is_short = |operator: &BinaryOp| matches!(operator, BinaryOp::AndThen | BinaryOp::OrElse);
        match &expr.kind {
            ExprKind::Dereference(_) => self.add(expr.span, "a reference", "hand the variable over as VAR_IN_OUT"),
            ExprKind::Part(..) => self.add(expr.span, "a bit of a variable", "shift it, and mask it with AND"),
            ExprKind::Assign(..) => self.add(expr.span, "an assignment as a value", "write it before the statement"),
            ExprKind::Binary(operator, ..) if is_short(operator) => {
                self.add(expr.span, "AND_THEN and OR_ELSE", "write one IF inside of the other");
            }
            ExprKind::Chain(_, links) if links.iter().any(|link| is_short(&link.operator)) => {
                self.add(expr.span, "AND_THEN and OR_ELSE", "write one IF inside of the other");
            }
            ExprKind::Literal(Literal::LongDuration(_) | Literal::Duration { long: true, .. }) => {
                self.add(expr.span, "LTIME", "take TIME");
            }
            _ => {}
        }
    }
}
