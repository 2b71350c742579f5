//! Declarations to text.

use super::Printer;
use crate::syntax::ast::{
    Declaration, Edge, ElementInit, EnumValue, Field, InitArguments, Initialiser, InitialiserKind, Pou, PouKind,
    Qualifier, Section, SectionKind, StructureInit, TypeDeclaration, TypeSpec, TypeSpecKind, Variable,
};

/// The pragma of what is declared here, and done elsewhere.
pub(super) const EXTERNAL: &str = "{external}";

impl Printer {
    pub(super) fn declaration(&mut self, declaration: &Declaration) {
        match declaration {
            Declaration::Pou(pou) => self.pou(pou),
            Declaration::Type(declaration) => self.type_declaration(declaration),
            Declaration::Globals(section) => self.section(section),
            Declaration::Namespace(namespace) => self.namespace(namespace),
            Declaration::Using(names) => self.using(names),
            Declaration::Configuration(configuration) => self.configuration(configuration),
        }
        self.end_line();
    }

    pub(super) fn pou(&mut self, pou: &Pou) {
        let (begin, end) = match pou.kind {
            PouKind::Class => ("CLASS ", "END_CLASS"),
            PouKind::Interface => ("INTERFACE ", "END_INTERFACE"),
            PouKind::Method | PouKind::Action => ("METHOD ", "END_METHOD"),
            PouKind::Program => ("PROGRAM ", "END_PROGRAM"),
            PouKind::FunctionBlock => ("FUNCTION_BLOCK ", "END_FUNCTION_BLOCK"),
            PouKind::Function => ("FUNCTION ", "END_FUNCTION"),
        };
        if pou.external {
            self.line(EXTERNAL);
        }
        self.word(begin);
        self.modifiers(&pou.object.modifiers);
        self.name(&pou.name);
        if let Some(result) = &pou.result {
            self.word(" : ");
            self.type_spec(result);
        }
        let generic = pou.sections.iter().filter(|section| section.is_generic());
        for section in generic {
            self.end_line();
            self.section(section);
        }
        self.heritage(&pou.object);
        self.end_head(pou);
        self.unit_behind_head(pou, end);
    }

    pub(super) fn section(&mut self, section: &Section) {
        self.begin_line();
        self.word(match section.kind {
            SectionKind::Local if section.is_generic() => "VAR_GENERIC",
            SectionKind::Local => "VAR",
            SectionKind::Input => "VAR_INPUT",
            SectionKind::Output => "VAR_OUTPUT",
            SectionKind::InOut => "VAR_IN_OUT",
            SectionKind::Temp => "VAR_TEMP",
            SectionKind::Static => "VAR_STAT",
            SectionKind::Instance => "VAR_INST",
            SectionKind::Global => "VAR_GLOBAL",
            SectionKind::External => "VAR_EXTERNAL",
        });
        for qualifier in section.qualifiers.iter().filter(|each| **each != Qualifier::Generic) {
            self.word(" ");
            self.word(match qualifier {
                Qualifier::Constant => "CONSTANT",
                Qualifier::Retain => "RETAIN",
                Qualifier::NonRetain => "NON_RETAIN",
                Qualifier::Persistent => "PERSISTENT",
                Qualifier::Access(access) => access.text(),
                // Its section has a word of its own.
                Qualifier::Generic => "",
            });
        }
        self.end_line();
        self.indented(|printer| {
            for variable in &section.variables {
                printer.variable(variable);
            }
        });
        self.line("END_VAR");
    }

    fn variable(&mut self, variable: &Variable) {
        self.begin_line();
        self.separated(&variable.names, Self::name);
        if let Some(address) = &variable.address {
            self.word(" AT ");
            self.word(&address.text);
        }
        self.word(" : ");
        self.type_spec(&variable.spec);
        self.word(match variable.edge {
            Some(Edge::Rising) => " R_EDGE",
            Some(Edge::Falling) => " F_EDGE",
            None => "",
        });
        self.initial(variable.initial.as_ref());
    }

    /// ` : INT := 5;` and the line's end.
    pub(super) fn typed(&mut self, spec: &TypeSpec, initial: Option<&Initialiser>) {
        self.word(" : ");
        self.type_spec(spec);
        self.initial(initial);
    }

    /// ` := 5;` and the line's end.
    fn initial(&mut self, initial: Option<&Initialiser>) {
        if let Some(initial) = initial {
            self.word(" := ");
            self.initialiser(initial);
        }
        self.word(";");
        self.end_line();
    }

    fn type_declaration(&mut self, declaration: &TypeDeclaration) {
        if declaration.external {
            self.line(EXTERNAL);
        }
        self.line("TYPE");
        self.indented(|printer| {
            printer.begin_line();
            printer.name(&declaration.name);
            if let Some(base) = &declaration.extends {
                printer.word(" EXTENDS ");
                printer.word(&base.text);
            }
            printer.typed(&declaration.spec, declaration.initial.as_ref());
        });
        self.line("END_TYPE");
    }

    pub(super) fn type_spec(&mut self, spec: &TypeSpec) {
        match &spec.kind {
            TypeSpecKind::Name(name) => self.name(name),
            TypeSpecKind::String(name, length) => {
                self.word(&name.text);
                if let Some(length) = length {
                    self.word("[");
                    self.expression(length);
                    self.word("]");
                }
            }
            TypeSpecKind::Subrange(name, range) => {
                self.word(&name.text);
                self.word(" (");
                self.range(&range.low, &range.high);
                self.word(")");
            }
            TypeSpecKind::Array(dimensions, element) => {
                self.word("ARRAY [");
                self.separated(dimensions, |printer, each| {
                    printer.range(&each.low, &each.high);
                });
                self.word("] OF ");
                self.type_spec(element);
            }
            TypeSpecKind::Reference(kind, target) => {
                self.word(kind.text());
                self.word(" ");
                self.type_spec(target);
            }
            TypeSpecKind::OpenArray(dimensions, element) => {
                self.word("ARRAY [");
                self.separated(&vec!["*"; *dimensions as usize], |printer, star| printer.word(star));
                self.word("] OF ");
                self.type_spec(element);
            }
            TypeSpecKind::Struct(fields) => self.members(("STRUCT", "END_STRUCT"), fields),
            TypeSpecKind::Overlapping(fields) => self.members(("STRUCT OVERLAP", "END_STRUCT"), fields),
            TypeSpecKind::Union(fields) => self.members(("UNION", "END_UNION"), fields),
            TypeSpecKind::Instance(name, arguments) => {
                self.name(name);
                match arguments {
                    InitArguments::Same(arguments) => self.arguments(arguments),
                    InitArguments::Listed(lists) => {
                        self.word("[");
                        self.separated(lists, |printer, arguments| printer.arguments(arguments));
                        self.word("]");
                    }
                }
            }
            TypeSpecKind::Enumeration(values, base) => {
                self.word("(");
                self.separated(values, Self::enum_value);
                self.word(")");
                if let Some(base) = base {
                    self.word(" ");
                    self.word(&base.text);
                }
            }
            TypeSpecKind::Error => {}
        }
    }

    fn range(&mut self, low: &crate::syntax::ast::Expr, high: &crate::syntax::ast::Expr) {
        self.expression(low);
        self.word("..");
        self.expression(high);
    }

    fn members(&mut self, (begin, end): (&str, &str), fields: &[Field]) {
        self.word(begin);
        self.end_line();
        self.indented(|printer| {
            for field in fields {
                printer.begin_line();
                printer.name(&field.name);
                if let Some(address) = &field.address {
                    printer.word(" AT ");
                    printer.word(&address.text);
                }
                printer.typed(&field.spec, field.initial.as_ref());
            }
        });
        self.begin_line();
        self.word(end);
    }

    fn enum_value(&mut self, value: &EnumValue) {
        self.name(&value.name);
        if let Some(number) = &value.value {
            self.word(" := ");
            self.expression(number);
        }
    }

    fn initialiser(&mut self, initialiser: &Initialiser) {
        match &initialiser.kind {
            InitialiserKind::Value(expr) => self.expression(expr),
            InitialiserKind::Array(elements) => {
                self.word("[");
                self.separated(elements, Self::initialiser);
                self.word("]");
            }
            InitialiserKind::Repeat(count, value) => {
                self.expression(count);
                self.word("(");
                if let Some(value) = value {
                    self.initialiser(value);
                }
                self.word(")");
            }
            InitialiserKind::Struct(members) => {
                self.word("(");
                self.separated(members, Self::structure_init);
                self.word(")");
            }
            InitialiserKind::Elements(elements) => {
                self.word("(");
                self.separated(elements, Self::element_init);
                self.word(")");
            }
        }
    }

    fn element_init(&mut self, element: &ElementInit) {
        self.word("[");
        self.separated(&element.indices, Self::expression);
        self.word("] := ");
        self.initialiser(&element.value);
    }

    fn structure_init(&mut self, member: &StructureInit) {
        self.name(&member.name);
        self.word(" := ");
        self.initialiser(&member.value);
    }
}
