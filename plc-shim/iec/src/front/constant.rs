//! Constants set from outside, by path, before the program is compiled: programs hold their values.
//!
//! The path of a constant is that of its declaration: `Unit.name`, `Unit.Method.name`, `name` or `List.name` for
//! a global one, with namespaces, or configuration and resource, in front where they are needed to distinguish two
//! constants apart. An instance of a program stands for the program: the constant is the same in all of them.

use thiserror::Error;

use crate::check::Overrides;
use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::syntax::ast::{CompilationUnit, Configuration, Declaration, Ident, Pou, Qualifier, Section};
use crate::syntax::parser::parse_initialiser;
use crate::syntax::{FileId, SourceFile, SourceMap, Span};

/// Why a constant cannot be set.
#[derive(Debug, Clone, Error)]
pub enum ConstantError {
    /// Nothing of that path is declared.
    #[error("there is no constant `{path}`{}", .help.as_ref().map(|help| format!(" ({help})")).unwrap_or_default())]
    Unknown {
        /// The path as given.
        path: String,
        help: Option<String>,
    },
    /// It is a variable.
    #[error("`{path}` is not a CONSTANT")]
    Variable {
        /// The path as declared.
        path: String,
    },
    /// The path may mean two constants.
    #[error("`{path}` may be `{first}` or `{second}`")]
    Ambiguous {
        /// The path as given.
        path: String,
        /// A constant that it may mean.
        first: String,
        second: String,
    },
    /// It is set twice.
    #[error("the constant `{path}` is set twice")]
    Twice {
        /// The path as declared.
        path: String,
    },
    /// The text is not an initial value for it. Places of the findings are places in the text.
    #[error("`{literal}` is not a value of `{path}`: {}", first_message(.findings))]
    Value {
        /// The path as declared.
        path: String,
        /// The text as given.
        literal: String,
        /// What is wrong with it.
        findings: Diagnostics,
    },
}

fn first_message(findings: &Diagnostics) -> &str {
    findings.iter().next().map_or("", |found| &found.message)
}

/// A constant with its value.
#[derive(Debug, Clone)]
pub struct Setting {
    pub path: String,
    pub literal: String,
    /// The file that the literal alone is.
    pub file: FileId,
}

/// Constants set from outside.
#[derive(Debug, Default)]
pub struct Constants {
    pub settings: Vec<Setting>,
    pub overrides: Overrides,
    /// For each literal a tree without declarations, which shows its dialect.
    pub units: Vec<(FileId, CompilationUnit)>,
    pub findings: Vec<Diagnostic>,
}

impl Constants {
    /// Finds the declarations of constants in `units`, and adds each value to `sources` as a file of its own.
    ///
    /// # Errors
    /// A path that names no constant, or a value that cannot be read.
    pub fn new(
        wanted: &[(String, String)],
        units: &[(FileId, CompilationUnit)],
        sources: &mut SourceMap,
    ) -> Result<Self, ConstantError> {
        let mut constants = Self::default();
        if wanted.is_empty() {
            return Ok(constants);
        }
        let declared = Collector::of(units).found;
        for (path, literal) in wanted {
            let found = find(&declared, path)?;
            let path = found.path();
            if constants.settings.iter().any(|other| other.path == path) {
                return Err(ConstantError::Twice { path });
            }
            let dialect = units.iter().find(|(file, _)| *file == found.name.file).map(|(_, unit)| unit.dialect);
            let dialect = dialect.unwrap_or_default();
            let name = format!("value of {path}");
            let file = sources.add(SourceFile::new(name, literal.as_str()).in_dialect(dialect));
            let (initial, findings) = parse_initialiser(dialect, file, literal);
            constants.overrides.set(found.name, initial);
            constants.findings.extend(findings);
            constants.units.push((file, CompilationUnit { dialect, ..CompilationUnit::default() }));
            constants.settings.push(Setting { path, literal: literal.clone(), file });
        }
        Ok(constants)
    }

    /// The error of a constant whose value is wrong in itself.
    pub fn wrong_value(&self, findings: &[Diagnostic], sources: &SourceMap) -> Option<ConstantError> {
        self.settings.iter().find_map(|Setting { path, literal, file }| {
            let own = findings.iter().filter(|found| found.span.file == *file).cloned();
            let findings = Diagnostics::new(own.collect(), sources);
            let error =
                ConstantError::Value { path: path.clone(), literal: literal.clone(), findings: findings.clone() };
            findings.has_errors().then_some(error)
        })
    }
}

/// True if a path is that of a constant, or of several.
pub(crate) fn is_declared(units: &[(FileId, CompilationUnit)], path: &str) -> bool {
    matches!(find(&Collector::of(units).found, path), Ok(_) | Err(ConstantError::Ambiguous { .. }))
}

/// A variable that a path may mean.
#[derive(Debug)]
struct Declared {
    /// The names on the way to it, its own last.
    names: Vec<String>,
    /// How many of them a path has at least.
    least: usize,
    name: Span,
    is_constant: bool,
    /// The path through the program itself, if this one goes through an instance of it.
    of_program: Option<Vec<String>>,
}

impl Declared {
    fn path(&self) -> String {
        self.of_program.as_ref().unwrap_or(&self.names).join(".")
    }

    /// True if the last names are these.
    fn ends_in(&self, names: &[&str]) -> bool {
        let Some(skipped) = self.names.len().checked_sub(names.len()) else { return false };
        let own = self.names.iter().skip(skipped);
        names.len() >= self.least && own.zip(names).all(|(own, name)| own.eq_ignore_ascii_case(name))
    }
}

fn find<'d>(declared: &'d [Declared], path: &str) -> Result<&'d Declared, ConstantError> {
    let names: Vec<&str> = path.split('.').map(str::trim).collect();
    let mut found: Vec<&Declared> = declared.iter().filter(|each| each.ends_in(&names)).collect();
    // A whole path means what it says, even if it is the end of a longer one.
    if found.iter().any(|each| each.names.len() == names.len()) {
        found.retain(|each| each.names.len() == names.len());
    }
    let first = found.first();
    let other = found.iter().find(|each| first.is_some_and(|first| first.name != each.name));
    match (first, other) {
        (Some(first), Some(second)) => {
            let (first, second) = (first.path(), second.path());
            Err(ConstantError::Ambiguous { path: path.to_owned(), first, second })
        }
        (Some(only), None) if only.is_constant => Ok(only),
        (Some(only), None) => Err(ConstantError::Variable { path: only.path() }),
        (None, _) => {
            let constants = declared.iter().filter(|each| each.is_constant);
            // As many names as were given, and all: the slip may be in any of them.
            let ends = constants.flat_map(|each| {
                let from = each.names.len().saturating_sub(names.len().max(each.least));
                [each.names.get(from..).unwrap_or_default().join("."), each.names.join(".")]
            });
            let ends: Vec<String> = ends.collect();
            let help = did_you_mean(path, ends.iter().map(String::as_str));
            Err(ConstantError::Unknown { path: path.to_owned(), help })
        }
    }
}

/// All that is declared with a value, with its path.
#[derive(Debug, Default)]
struct Collector {
    found: Vec<Declared>,
}

impl Collector {
    fn of(units: &[(FileId, CompilationUnit)]) -> Self {
        let mut collector = Self::default();
        for (_, unit) in units {
            collector.declarations(&unit.declarations, &[]);
        }
        for (_, unit) in units {
            for declaration in &unit.declarations {
                if let Declaration::Configuration(configuration) = declaration {
                    collector.instances(configuration);
                }
            }
        }
        collector
    }

    fn declarations(&mut self, list: &[Declaration], around: &[&str]) {
        for declaration in list {
            match declaration {
                Declaration::Pou(pou) => self.unit(pou, around, 2),
                Declaration::Globals(section) => self.section(section, around, 1),
                Declaration::Namespace(namespace) => {
                    let inner: Vec<&str> = around.iter().copied().chain(namespace.name.text.split('.')).collect();
                    self.declarations(&namespace.declarations, &inner);
                }
                Declaration::Configuration(configuration) => self.configuration(configuration),
                Declaration::Type(_) | Declaration::Using(_) => {}
            }
        }
    }

    /// `least` counts the names of a path into it: its own, and that of its variable.
    fn unit(&mut self, pou: &Pou, around: &[&str], least: usize) {
        let inner = joined(around, &pou.name);
        pou.sections.iter().for_each(|section| self.section(section, &inner, least));
        pou.object.members.iter().for_each(|member| self.unit(&member.pou, &inner, least + 1));
    }

    fn section(&mut self, section: &Section, around: &[&str], least: usize) {
        let is_constant = section.qualifiers.contains(&Qualifier::Constant);
        for name in section.variables.iter().flat_map(|variable| &variable.names) {
            let names = around.iter().copied().chain([name.text.as_str()]).map(str::to_owned).collect();
            self.found.push(Declared { names, least, name: name.span, is_constant, of_program: None });
        }
    }

    fn configuration(&mut self, configuration: &Configuration) {
        let inner = [configuration.name.text.as_str()];
        configuration.sections.iter().for_each(|section| self.section(section, &inner, 1));
        for resource in &configuration.resources {
            let name = resource.name.iter().map(|(name, _)| name.text.as_str());
            let inner: Vec<&str> = inner.into_iter().chain(name).collect();
            resource.sections.iter().for_each(|section| self.section(section, &inner, 1));
        }
    }

    /// The constants of programs again, by the names of their instances.
    fn instances(&mut self, configuration: &Configuration) {
        let mut found = Vec::new();
        for resource in &configuration.resources {
            let resource_name = resource.name.iter().map(|(name, _)| name.text.as_str());
            let around: Vec<&str> = [configuration.name.text.as_str()].into_iter().chain(resource_name).collect();
            for program in resource.programs.iter().filter(|each| each.name.key() != each.program.key()) {
                let of_it = self.found.iter().filter(|each| {
                    let unit = each.names.len().checked_sub(2).and_then(|at| each.names.get(at));
                    each.least == 2 && unit.is_some_and(|unit| unit.eq_ignore_ascii_case(&program.program.text))
                });
                found.extend(of_it.map(|each| {
                    let names = around.iter().copied().chain([program.name.text.as_str()]).map(str::to_owned);
                    let names = names.chain(each.names.last().cloned()).collect();
                    let of_program = Some(each.names.clone());
                    Declared { names, least: 2, name: each.name, is_constant: each.is_constant, of_program }
                }));
            }
        }
        self.found.extend(found);
    }
}

fn joined<'n>(around: &[&'n str], name: &'n Ident) -> Vec<&'n str> {
    around.iter().copied().chain([name.text.as_str()]).collect()
}
