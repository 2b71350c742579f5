//! Configurations, resources, tasks and instances of programs (2nd ed. 2.7, 3rd ed. 6.8).
//!
//! Their words are not keywords elsewhere: programs have variables called `task` and `on`.

use super::cursor::Cursor;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{
    AccessDirection, AccessPath, Configuration, Connection, Declaration, Ident, InstanceValue, ProgramDeclaration,
    Qualifier, Resource, SectionKind, TaskDeclaration, TypeSpec, TypeSpecKind,
};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

/// Words at which a configuration can go on after an error.
const ANCHORS: [&str; 6] = ["RESOURCE", "TASK", "VAR_ACCESS", "VAR_CONFIG", "END_RESOURCE", "END_CONFIGURATION"];

impl Cursor<'_> {
    fn expect_word(&mut self, word: &str) {
        if !self.take_word(word) {
            self.unexpected(&format!("`{word}`"));
        }
    }

    /// `CONFIGURATION .. END_CONFIGURATION`
    pub(super) fn configuration(&mut self) -> Option<Declaration> {
        let start = self.span();
        self.advance();
        let name = self.expect_identifier("the configuration's name")?;
        let mut configuration = Configuration {
            name,
            sections: Vec::new(),
            resources: Vec::new(),
            access: Vec::new(),
            instances: Vec::new(),
            span: start,
        };
        let mut own = Resource { name: None, sections: Vec::new(), tasks: Vec::new(), programs: Vec::new() };
        self.take_mark(Punctuation::Semicolon);
        while !self.at_end_of("END_CONFIGURATION") {
            if self.at_keyword(Keyword::VarGlobal) {
                configuration.sections.push(self.section(SectionKind::Global));
            } else if self.at_word("RESOURCE") {
                configuration.resources.extend(self.resource());
            } else if self.at_word("VAR_ACCESS") {
                self.lines_of_section(Self::access_path, &mut configuration.access);
            } else if self.at_word("VAR_CONFIG") {
                self.lines_of_section(Self::instance_value, &mut configuration.instances);
            } else if !self.task_or_program(&mut own) {
                self.unexpected("`RESOURCE`, `TASK`, `PROGRAM`, a section or `END_CONFIGURATION`");
                self.advance();
                self.skip_to_anchor();
            }
        }
        self.expect_word("END_CONFIGURATION");
        self.take_mark(Punctuation::Semicolon);
        if !own.tasks.is_empty() || !own.programs.is_empty() {
            configuration.resources.push(own);
        }
        configuration.span = self.span_from(start);
        Some(Declaration::Configuration(configuration))
    }

    /// True at `end`, where the file ends and where the next unit begins.
    fn at_end_of(&self, end: &str) -> bool {
        // `PROGRAM` is not among them: in a configuration it declares an instance.
        let unit = matches!(
            self.peek(),
            None | Some(TokenKind::Keyword(Keyword::Function | Keyword::FunctionBlock | Keyword::Type))
        );
        unit || self.at_word(end) || self.at_word("END_CONFIGURATION") || self.at_word("CONFIGURATION")
    }

    fn skip_to_anchor(&mut self) {
        let anchor = |cursor: &Self| ANCHORS.iter().any(|word| cursor.at_word(word));
        let keyword = |kind| {
            use Keyword as K;
            matches!(kind, K::Program | K::VarGlobal | K::Function | K::FunctionBlock | K::Type)
        };
        while let Some(kind) = self.peek() {
            if anchor(self) || matches!(kind, TokenKind::Keyword(found) if keyword(found)) {
                return;
            }
            self.advance();
            if matches!(kind, TokenKind::Punctuation(Punctuation::Semicolon) | TokenKind::Keyword(Keyword::EndVar)) {
                return;
            }
        }
    }

    fn resource(&mut self) -> Option<Resource> {
        self.advance();
        let name = self.expect_identifier("the resource's name");
        self.expect_word("ON");
        let nothing = ANCHORS.iter().any(|word| self.at_word(word));
        let processor = if nothing { None } else { self.expect_identifier("the kind of processor") };
        self.take_mark(Punctuation::Semicolon);
        let mut resource = Resource { name: None, sections: Vec::new(), tasks: Vec::new(), programs: Vec::new() };
        while !self.at_end_of("END_RESOURCE") {
            if self.at_keyword(Keyword::VarGlobal) {
                resource.sections.push(self.section(SectionKind::Global));
            } else if !self.task_or_program(&mut resource) {
                self.unexpected("`TASK`, `PROGRAM`, `VAR_GLOBAL` or `END_RESOURCE`");
                self.advance();
                self.skip_to_anchor();
            }
        }
        self.expect_word("END_RESOURCE");
        self.take_mark(Punctuation::Semicolon);
        resource.name = Some((name?, processor?));
        Some(resource)
    }

    fn task_or_program(&mut self, resource: &mut Resource) -> bool {
        let known = self.reported();
        if self.at_word("TASK") {
            let task = self.task();
            resource.tasks.extend(task);
        } else if self.at_keyword(Keyword::Program) {
            let program = self.program_declaration();
            resource.programs.extend(program);
        } else {
            return false;
        }
        if self.reported() > known {
            self.skip_to_anchor();
        } else if !self.take_mark(Punctuation::Semicolon) {
            self.unexpected("`;`");
        }
        true
    }

    fn task(&mut self) -> Option<TaskDeclaration> {
        self.advance();
        let name = self.expect_identifier("the task's name")?;
        let mut inputs = Vec::new();
        self.expect_mark(Punctuation::LeftParen).then_some(())?;
        while let Some(input) = self.take_identifier() {
            self.expect_mark(Punctuation::Assign).then_some(())?;
            inputs.push((input, self.expression()));
            if !self.take_mark(Punctuation::Comma) {
                break;
            }
        }
        self.expect_mark(Punctuation::RightParen).then_some(())?;
        Some(TaskDeclaration { name, inputs })
    }

    fn program_declaration(&mut self) -> Option<ProgramDeclaration> {
        let start = self.span();
        self.advance();
        let qualifier = match self.peek() {
            Some(TokenKind::Keyword(Keyword::Retain)) => Some(Qualifier::Retain),
            Some(TokenKind::Keyword(Keyword::NonRetain)) => Some(Qualifier::NonRetain),
            _ => None,
        };
        if qualifier.is_some() {
            self.advance();
        }
        let name = self.expect_identifier("the name of the program's instance")?;
        let task = if self.take_word("WITH") { Some(self.expect_identifier("a task's name")?) } else { None };
        self.expect_mark(Punctuation::Colon).then_some(())?;
        let program = self.expect_identifier("the program's name")?;
        let mut connections = Vec::new();
        if self.take_mark(Punctuation::LeftParen) && !self.take_mark(Punctuation::RightParen) {
            loop {
                connections.push(self.connection()?);
                if !self.take_mark(Punctuation::Comma) {
                    break;
                }
            }
            self.expect_mark(Punctuation::RightParen).then_some(())?;
        }
        Some(ProgramDeclaration { qualifier, name, task, program, connections, span: self.span_from(start) })
    }

    fn connection(&mut self) -> Option<Connection> {
        let inner = self.postfix();
        Some(if self.take_word("WITH") {
            Connection::Task(inner, self.expect_identifier("a task's name")?)
        } else if self.take_mark(Punctuation::Output) {
            Connection::Output(inner, self.expression())
        } else {
            self.expect_mark(Punctuation::Assign).then_some(())?;
            Connection::Input(inner, self.expression())
        })
    }

    /// The lines of `VAR_ACCESS` or `VAR_CONFIG`.
    fn lines_of_section<T>(&mut self, line: impl Fn(&mut Self, usize) -> Option<T>, found: &mut Vec<T>) {
        self.advance();
        while self.peek() == Some(TokenKind::Identifier) {
            let known = self.reported();
            found.extend(line(self, known));
            self.end_of_declaration(known);
        }
        if !self.take_keyword(Keyword::EndVar) {
            self.unexpected("a name or `END_VAR`");
            self.skip_to_anchor();
        }
        self.take_mark(Punctuation::Semicolon);
    }

    /// `VAR_CONFIG` outside of a configuration.
    pub(super) fn loose_instance_values(&mut self) {
        let start = self.span();
        let mut lines = Vec::new();
        self.lines_of_section(Self::instance_value, &mut lines);
        if !lines.is_empty() {
            let message = "VAR_CONFIG outside of a CONFIGURATION is not supported yet";
            self.report_syntax(Diagnostic::error(Code::UnsupportedFeature, start, message));
        }
    }

    fn access_path(&mut self, known: usize) -> Option<AccessPath> {
        let name = self.take_identifier()?;
        self.expect_mark(Punctuation::Colon).then_some(())?;
        let path = self.postfix();
        self.expect_mark(Punctuation::Colon).then_some(())?;
        let spec = self.spec_unless_reported(known);
        let direction = if self.take_word("READ_WRITE") {
            AccessDirection::ReadWrite
        } else {
            self.take_word("READ_ONLY");
            AccessDirection::ReadOnly
        };
        (self.reported() == known).then_some(AccessPath { name, path, spec, direction })
    }

    fn instance_value(&mut self, known: usize) -> Option<InstanceValue> {
        let path = self.postfix();
        let address: Option<Ident> = self.take_keyword(Keyword::At).then(|| self.address()).flatten();
        self.expect_mark(Punctuation::Colon).then_some(())?;
        let spec = self.spec_unless_reported(known);
        let initial = self.optional_initialiser();
        (self.reported() == known).then_some(InstanceValue { path, address, spec, initial })
    }

    /// The type, unless the line is wrong already.
    fn spec_unless_reported(&mut self, known: usize) -> TypeSpec {
        if self.reported() > known {
            return TypeSpec { kind: TypeSpecKind::Error, span: self.span() };
        }
        self.type_spec()
    }
}
