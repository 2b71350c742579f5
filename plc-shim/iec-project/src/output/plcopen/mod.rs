//! PLCopen XML (TC6 2.01) of a project in text, as CODESYS exports and imports it.
//!
//! | module | subject |
//! |---|---|
//! | [`configuration`] | configurations, tasks |
//! | [`unit`], [`interface`], [`object`] | units, their interfaces and members |
//! | [`body`] | statements and instructions |
//! | [`chart`], [`chart_element`] | Sequential Function Charts, drawn |
//! | [`variables`], [`types`], [`value`] | declarations |
//! | [`about`] | what comments and pragmas say of a declaration |
//! | [`taken`] | files that are PLCopen XML already |
//! | [`markup`] | pieces of XML |
//!
//! The namespace is that of version 2.0, which CODESYS writes; what is used of it is the same in 2.01. Declarations are
//! elements, what is said of them in comments is their documentation. What the schema lacks is an addition of CODESYS,
//! in the form in which it exports it, or it is refused.

pub(crate) mod about;
pub(crate) mod body;
mod chart;
mod chart_element;
pub(crate) mod configuration;
mod interface;
pub(crate) mod markup;
mod object;
mod taken;
pub(crate) mod types;
pub(crate) mod unit;
mod value;
pub(crate) mod variables;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use self::about::About;
use self::configuration::Cycle;
use self::markup::{additions, data};
use self::types::DataType;
use super::page::Page;
use super::{Refused, Written};
use onescan_iec::syntax::ast::{CompilationUnit, Declaration, Namespace, NamespaceKind, Pou, PouKind, Section};
use onescan_iec::syntax::{FileId, SourceFile};

/// When the file was made: always the same, so that the same project gives the same file.
const CREATED: &str = "1970-01-01T00:00:00";

/// What a file of a project is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Text,
    /// PLCopen XML, whose elements are taken over as they are.
    Xml,
}

/// A file of a project, and what is declared in it.
type Part<'p> = (Form, FileId, &'p SourceFile, &'p CompilationUnit);

/// The XML of a project with these files; `cycles` are its tasks if no configuration declares them.
///
/// # Errors
/// All that has no form.
pub(crate) fn project(files: &[Part<'_>], name: &str, cycles: &[Cycle]) -> Result<String, Vec<Refused>> {
    let mut document = Document { taken: declared(files), ..Document::default() };
    for (form, id, file, unit) in files {
        match form {
            Form::Text => document.file(file, unit),
            Form::Xml => document.take(*id, file.shown_text()),
        }
    }
    if !document.refused.is_empty() {
        return Err(document.refused);
    }
    if !cycles.is_empty() {
        document.added += &configuration::application(cycles);
    }
    Ok(document.text(name))
}

/// Names of all units, types and namespaces as keys: no list of variables may be called by one.
fn declared(files: &[Part<'_>]) -> BTreeSet<String> {
    let declarations = files.iter().flat_map(|(_, _, _, unit)| &unit.declarations);
    let key = |declaration: &Declaration| match declaration {
        Declaration::Pou(pou) => Some(pou.name.key()),
        Declaration::Type(named) => Some(named.name.key()),
        Declaration::Namespace(namespace) => Some(namespace.name.key()),
        Declaration::Globals(_) | Declaration::Using(_) | Declaration::Configuration(_) => None,
    };
    declarations.filter_map(key).collect()
}

/// The parts of the file, in its order.
#[derive(Default)]
struct Document {
    types: String,
    units: String,
    configurations: String,
    /// What is added to the project.
    added: String,
    /// Prefixes of namespaces that elements of other files have, and what they stand for.
    prefixes: BTreeMap<String, String>,
    /// Names that lists of variables may not have, as keys.
    taken: BTreeSet<String>,
    refused: Vec<Refused>,
}

impl Document {
    fn file(&mut self, file: &SourceFile, unit: &CompilationUnit) {
        let page = Page::of(file);
        let mut from = 0;
        let starts = unit.declarations.iter().skip(1).map(|next| place(next).map_or(u32::MAX, |(start, _)| start));
        let starts = starts.chain(std::iter::once(u32::MAX));
        for (declaration, next) in unit.declarations.iter().zip(starts) {
            let (start, end) = place(declaration).unwrap_or((from, from));
            let until = page.line_end(end).min(next).max(end);
            let about = About::of(&page, from..start, end..until);
            if let Err(refused) = self.declaration(declaration, about, file, &page) {
                self.refused.push(refused);
            }
            from = until.max(from);
        }
    }

    fn declaration(
        &mut self,
        declaration: &Declaration,
        about: About,
        file: &SourceFile,
        page: &Page<'_>,
    ) -> Written<()> {
        match declaration {
            Declaration::Type(named) => match types::data_type(named, about, page)? {
                DataType::Standard(xml) => self.types += &xml,
                DataType::Addition(xml) => self.added += &xml,
            },
            Declaration::Pou(pou) => self.pou(pou, about, page)?,
            Declaration::Globals(section) => self.globals(section, &about, file, page)?,
            Declaration::Namespace(namespace) => self.namespace(namespace, page)?,
            Declaration::Using(names) => {
                let Some(first) = names.first() else { return Ok(()) };
                return Err(Refused::plcopen(first.span, "USING"));
            }
            Declaration::Configuration(found) => self.configurations += &configuration::configuration(found, page)?,
        }
        Ok(())
    }

    fn pou(&mut self, pou: &Pou, about: About, page: &Page<'_>) -> Written<()> {
        if pou.kind == PouKind::Interface {
            self.added += &object::interface(pou, page)?;
        } else {
            self.units += &unit::unit(pou, about, page)?;
        }
        Ok(())
    }

    /// CODESYS has global variables in lists, each with a name: here that of the file.
    fn globals(&mut self, section: &Section, about: &About, file: &SourceFile, page: &Page<'_>) -> Written<()> {
        let stem =
            Path::new(file.name()).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let plain = |one: char| if one.is_ascii_alphanumeric() { one } else { '_' };
        let stem: String = stem.chars().map(plain).collect();
        let first = if stem.eq_ignore_ascii_case("sdsp") { "SDSP".to_owned() } else { format!("GVL_{stem}") };
        let others = (2..).map(|number| format!("{first}_{number}"));
        let mut names = std::iter::once(first.clone()).chain(others);
        let name = names.find(|name| !self.taken.contains(&name.to_ascii_uppercase())).unwrap_or(first);
        self.taken.insert(name.to_ascii_uppercase());
        self.list(&name, section, about, page)
    }

    fn list(&mut self, name: &str, section: &Section, about: &About, page: &Page<'_>) -> Written<()> {
        self.added += &data("globalvars", &variables::section(section, Some(name), about, page)?);
        Ok(())
    }

    /// A vendor's list of global variables has a form, any other namespace has none.
    fn namespace(&mut self, namespace: &Namespace, page: &Page<'_>) -> Written<()> {
        match (namespace.kind, namespace.declarations.as_slice()) {
            (NamespaceKind::Open, [Declaration::Globals(section)]) => {
                self.list(&namespace.name.text, section, &About::default(), page)
            }
            _ => Err(Refused::plcopen(namespace.name.span, "a NAMESPACE")),
        }
    }

    fn text(self, name: &str) -> String {
        let Self { types, units, configurations, added, prefixes, .. } = self;
        let prefixes: String =
            prefixes.iter().map(|(name, stands_for)| format!(" {name}=\"{}\"", markup::escaped(stands_for))).collect();
        let scaling = ["fbd", "ld", "sfc"].map(|kind| format!("<{kind}><scaling x=\"1\" y=\"1\"/></{kind}>")).concat();
        format!(
            "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
             <project xmlns=\"http://www.plcopen.org/xml/tc6_0200\"{prefixes}>\n\
             <fileHeader companyName=\"\" productName=\"onescan for CODESYS\" productVersion=\"1\" \
             creationDateTime=\"{CREATED}\"/>\n\
             <contentHeader name=\"{}\"><coordinateInfo>{scaling}</coordinateInfo></contentHeader>\n\
             <types>\n<dataTypes>\n{types}</dataTypes>\n<pous>\n{units}</pous>\n</types>\n\
             <instances>\n<configurations>\n{configurations}</configurations>\n</instances>\n\
             {}</project>\n",
            markup::escaped(name),
            additions(&added),
        )
    }
}

/// Where a declaration begins and ends.
fn place(declaration: &Declaration) -> Option<(u32, u32)> {
    let span = match declaration {
        Declaration::Pou(pou) => pou.span,
        Declaration::Type(named) => named.span,
        Declaration::Globals(section) => section.span,
        Declaration::Configuration(configuration) => configuration.span,
        Declaration::Namespace(_) | Declaration::Using(_) => return None,
    };
    Some((span.start, span.end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_iec::input::Input;
    use onescan_iec::input::kind::SourceKind;
    use onescan_iec::syntax::parser::parse_source;

    const PRESS: &str = include_str!("../../../../tests/inputs/press.st");

    fn written(name: &str, text: &str) -> Result<String, Vec<Refused>> {
        let file = SourceFile::new(name, text).in_dialect(onescan_iec::Dialect::Codesys);
        let parsed = parse_source(FileId(0), &file);
        assert_eq!(parsed.diagnostics, [], "{name}");
        project(&[(Form::Text, FileId(0), &file, &parsed.unit)], name, &[])
    }

    #[test]
    fn a_project_in_text_becomes_elements() {
        insta::assert_snapshot!(written("press.st", PRESS).expect("it has a form"));
    }

    #[test]
    fn what_is_written_reads_back() {
        let xml = written("press.st", PRESS).expect("it has a form");
        let input = Input::from_text("press.xml", SourceKind::PlcOpen, xml);
        let parsed = parse_source(FileId(0), input.file());
        assert_eq!(parsed.diagnostics, []);
        insta::assert_snapshot!(input.file().text());
        // And it is a program.
        let found = onescan_iec::inspect([input], None);
        assert!(found.iter().all(|each| each.severity != onescan_iec::Severity::Error), "{found}");
    }

    #[test]
    fn what_has_no_form_is_refused() {
        let refused = [
            "CLASS C END_CLASS",
            "NAMESPACE n FUNCTION f : INT f := 1; END_FUNCTION END_NAMESPACE",
            "FUNCTION_BLOCK F VAR_INPUT i : BOOL R_EDGE; END_VAR END_FUNCTION_BLOCK",
            "FUNCTION_BLOCK F VAR_STAT n : INT; END_VAR END_FUNCTION_BLOCK",
            "FUNCTION_BLOCK F VAR r : REF_TO INT; END_VAR END_FUNCTION_BLOCK",
            "FUNCTION_BLOCK F VAR PRIVATE n : INT; END_VAR END_FUNCTION_BLOCK",
            "TYPE T : STRUCT OVERLAP a AT %B0 : BYTE; END_STRUCT; END_TYPE",
            "TYPE T : ARRAY [1..2] OF INT := [2()]; END_TYPE",
        ];
        let messages = refused.map(|text| match written("a.st", text) {
            Ok(xml) => panic!("{text}: {xml}"),
            Err(found) => found
                .into_iter()
                .map(|each| format!("{}: {}", each.span.start, each.message))
                .collect::<Vec<_>>()
                .join("; "),
        });
        insta::assert_snapshot!(messages.join("\n"));
    }

    #[test]
    fn lists_of_variables_have_names_of_their_own() {
        let xml = written(
            "gvl x.st",
            "VAR_GLOBAL a : INT; END_VAR VAR_GLOBAL b : INT; END_VAR TYPE GVL_gvl_x : INT; END_TYPE",
        );
        let xml = xml.expect("it has a form");
        let names: Vec<&str> =
            xml.split("<globalVars name=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(names, ["GVL_gvl_x_2", "GVL_gvl_x_3"]);
    }
}
