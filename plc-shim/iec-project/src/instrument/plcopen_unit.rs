//! The shim's sources as elements of PLCopen XML (TC6 2.01): interfaces are elements, statements stay text.
//!
//! A source of the shim's that has no form gives nothing; tests see to it that there is none.

use crate::output::page::Page;
use crate::output::page::Wrapper;
use crate::output::plcopen::about::About;
use crate::output::plcopen::markup;
use crate::output::plcopen::{body as bodies, types, unit as units, variables};
use onescan_iec::syntax::ast::{Declaration, Pou, Section};
use onescan_iec::syntax::{FileId, parse};

/// A body in ST.
pub(super) fn body(statements: &str) -> String {
    bodies::body(statements, &[], Wrapper::Paragraph)
}

/// Text in ST.
pub(super) fn text(statements: &str) -> String {
    bodies::formatted(statements, &[], Wrapper::Paragraph)
}

/// `<dataType>` of the types of a source of the shim's.
pub(super) fn data_type(text: &str) -> Option<String> {
    let unit = parse(FileId(0), text).unit;
    let page = Page::bare(text);
    let xml = unit.declarations.iter().map(|each| match each {
        Declaration::Type(named) => match types::data_type(named, About::default(), &page) {
            Ok(types::DataType::Standard(xml)) => Some(xml),
            _ => None,
        },
        _ => None,
    });
    xml.collect()
}

/// `<pou>` of a unit of the shim.
pub(super) fn unit(text: &str) -> Option<String> {
    let unit = parse(FileId(0), text).unit;
    unit.declarations.iter().find_map(pou).and_then(|pou| units::unit(pou, About::default(), &Page::bare(text)).ok())
}

fn pou(declaration: &Declaration) -> Option<&Pou> {
    match declaration {
        Declaration::Pou(pou) => Some(pou),
        _ => None,
    }
}

/// `<configVariable>` that gives an instance of a program its number.
pub(super) fn instance_number(path: &str, number: usize) -> String {
    let value = format!("<initialValue><simpleValue value=\"{number}\"/></initialValue>");
    let path = markup::escaped(path);
    format!("<configVariable instancePathAndName=\"{path}.SDSP_Number\"><type><INT/></type>{value}</configVariable>\n")
}

/// The sections of declarations that are written alone, as `<localVars>` and the like.
pub(super) fn declarations(text: &str) -> Option<String> {
    let whole = format!("PROGRAM P\n{text}\nEND_PROGRAM");
    let unit = parse(FileId(0), &whole).unit;
    let sections: Vec<&Section> = unit.declarations.iter().filter_map(pou).flat_map(|pou| &pou.sections).collect();
    variables::sections(sections, &Page::bare(&whole)).ok()
}

/// Global variables, as the list `name` if there is one.
pub(super) fn globals(text: &str, name: Option<&str>) -> Option<String> {
    let unit = parse(FileId(0), text).unit;
    let page = Page::bare(text);
    let sections = unit.declarations.iter().filter_map(|each| match each {
        Declaration::Globals(section) => Some(section),
        _ => None,
    });
    sections.map(|section| variables::section(section, name, &About::default(), &page).ok()).collect()
}
