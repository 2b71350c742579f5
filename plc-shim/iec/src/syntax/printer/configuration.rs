//! Configurations to text.

use super::Printer;
use crate::syntax::ast::{
    AccessDirection, AccessPath, Configuration, Connection, InstanceValue, ProgramDeclaration, Qualifier, Resource,
    TaskDeclaration,
};

impl Printer {
    pub(super) fn configuration(&mut self, configuration: &Configuration) {
        self.line(&format!("CONFIGURATION {}", configuration.name.text));
        self.indented(|printer| {
            configuration.sections.iter().for_each(|section| printer.section(section));
            configuration.resources.iter().for_each(|resource| printer.resource(resource));
            printer.lines("VAR_ACCESS", &configuration.access, Self::access_path);
            printer.lines("VAR_CONFIG", &configuration.instances, Self::instance_value);
        });
        self.line("END_CONFIGURATION");
    }

    fn lines<T>(&mut self, keyword: &str, lines: &[T], each: impl Fn(&mut Self, &T)) {
        if lines.is_empty() {
            return;
        }
        self.line(keyword);
        self.indented(|printer| lines.iter().for_each(|line| each(printer, line)));
        self.line("END_VAR");
    }

    fn resource(&mut self, resource: &Resource) {
        let Some((name, processor)) = &resource.name else {
            self.tasks_and_programs(resource);
            return;
        };
        self.line(&format!("RESOURCE {} ON {}", name.text, processor.text));
        self.indented(|printer| printer.tasks_and_programs(resource));
        self.line("END_RESOURCE");
    }

    fn tasks_and_programs(&mut self, resource: &Resource) {
        resource.sections.iter().for_each(|section| self.section(section));
        resource.tasks.iter().for_each(|task| self.task(task));
        resource.programs.iter().for_each(|program| self.program_declaration(program));
    }

    fn task(&mut self, task: &TaskDeclaration) {
        self.begin_line();
        self.word(&format!("TASK {} (", task.name.text));
        self.separated(&task.inputs, |printer, (input, value)| {
            printer.word(&format!("{} := ", input.text));
            printer.expression(value);
        });
        self.word(");");
        self.end_line();
    }

    fn program_declaration(&mut self, program: &ProgramDeclaration) {
        self.begin_line();
        self.word(match program.qualifier {
            Some(Qualifier::Retain) => "PROGRAM RETAIN ",
            Some(Qualifier::NonRetain) => "PROGRAM NON_RETAIN ",
            _ => "PROGRAM ",
        });
        self.word(&program.name.text);
        if let Some(task) = &program.task {
            self.word(&format!(" WITH {}", task.text));
        }
        self.word(&format!(" : {}", program.program.text));
        if !program.connections.is_empty() {
            self.word(" (");
            self.separated(&program.connections, Self::connection);
            self.word(")");
        }
        self.word(";");
        self.end_line();
    }

    fn connection(&mut self, connection: &Connection) {
        match connection {
            Connection::Input(input, source) => {
                self.expression(input);
                self.word(" := ");
                self.expression(source);
            }
            Connection::Output(output, target) => {
                self.expression(output);
                self.word(" => ");
                self.expression(target);
            }
            Connection::Task(block, task) => {
                self.expression(block);
                self.word(&format!(" WITH {}", task.text));
            }
        }
    }

    fn access_path(&mut self, access: &AccessPath) {
        self.begin_line();
        self.word(&format!("{} : ", access.name.text));
        self.expression(&access.path);
        self.word(" : ");
        self.type_spec(&access.spec);
        self.word(match access.direction {
            AccessDirection::ReadOnly => " READ_ONLY;",
            AccessDirection::ReadWrite => " READ_WRITE;",
        });
        self.end_line();
    }

    fn instance_value(&mut self, value: &InstanceValue) {
        self.begin_line();
        self.expression(&value.path);
        if let Some(address) = &value.address {
            self.word(&format!(" AT {}", address.text));
        }
        self.typed(&value.spec, value.initial.as_ref());
    }
}
