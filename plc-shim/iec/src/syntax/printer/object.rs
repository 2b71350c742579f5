//! Classes, methods and namespaces to text.

use super::Printer;
use super::declaration::EXTERNAL;
use crate::syntax::ast::{Ident, Member, MemberKind, Modifier, Namespace, NamespaceKind, Object, Pou};

impl Printer {
    pub(super) fn modifiers(&mut self, modifiers: &[Modifier]) {
        for modifier in modifiers {
            self.word(modifier.text());
            self.word(" ");
        }
    }

    pub(super) fn heritage(&mut self, object: &Object) {
        for (word, names) in [(" EXTENDS ", &object.extends), (" IMPLEMENTS ", &object.implements)] {
            if !names.is_empty() {
                self.word(word);
                self.names(names);
            }
        }
    }

    fn names(&mut self, names: &[Ident]) {
        self.separated(names, |printer, name| printer.word(&name.text));
    }

    /// A name that is a modifier's word, too, is one for sure if nothing follows it.
    pub(super) fn end_head(&mut self, pou: &Pou) {
        if pou.result.is_none() && Modifier::find(&pou.name.text).is_some() {
            self.word(";");
        }
        self.end_line();
    }

    /// What stands between the head of a unit and its end, and the end.
    pub(super) fn unit_behind_head(&mut self, pou: &Pou, end: &str) {
        if !pou.object.using.is_empty() {
            self.using(&pou.object.using);
        }
        for section in pou.sections.iter().filter(|section| !section.is_generic()) {
            self.section(section);
        }
        for member in &pou.object.members {
            self.member(member);
        }
        self.chart(&pou.chart);
        self.statements(&pou.body);
        self.line(end);
    }

    fn member(&mut self, member: &Member) {
        let pou = &member.pou;
        match member.kind {
            MemberKind::Method => self.pou(pou),
            MemberKind::Getter => self.accessor(pou, "GET", "END_GET"),
            MemberKind::Setter => self.accessor(pou, "SET", "END_SET"),
            MemberKind::Action => {
                self.line(&format!("ACTION {}:", pou.name.text));
                self.unit_behind_head(pou, "END_ACTION");
            }
        }
    }

    /// Each half of a property as one of its own, which reads back to the same.
    fn accessor(&mut self, pou: &Pou, word: &str, end: &str) {
        self.word("PROPERTY ");
        self.modifiers(&pou.object.modifiers);
        self.word(&pou.name.text);
        if let Some(spec) = &pou.result {
            self.word(" : ");
            self.type_spec(spec);
        }
        self.end_head(pou);
        self.line(word);
        self.unit_behind_head(pou, end);
        self.line("END_PROPERTY");
    }

    pub(super) fn using(&mut self, names: &[Ident]) {
        self.word("USING ");
        self.names(names);
        self.word(";");
        self.end_line();
    }

    pub(super) fn namespace(&mut self, namespace: &Namespace) {
        if namespace.external {
            self.line(EXTERNAL);
        }
        self.word(match namespace.kind {
            NamespaceKind::Plain => "NAMESPACE ",
            NamespaceKind::Internal => "NAMESPACE INTERNAL ",
            NamespaceKind::Open => "NAMESPACE OPEN ",
        });
        self.word(&namespace.name.text);
        self.end_line();
        if !namespace.using.is_empty() {
            self.using(&namespace.using);
        }
        for declaration in &namespace.declarations {
            self.declaration(declaration);
        }
        self.line("END_NAMESPACE");
    }
}
