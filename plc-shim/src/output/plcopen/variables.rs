//! Sections of variables (TC6 2.01, `varList`).

use std::ops::Range;

use super::super::page::Page;
use super::super::{Refused, Written};
use super::markup::{documentation, escaped};
use super::types::type_of;
use super::value::initial;
use crate::syntax::ast::{Qualifier, Section, SectionKind, Variable};

/// What is said of a declaration: comments in front of it, and behind it in its line.
pub(super) fn words(page: &Page<'_>, before: Range<u32>, behind: Range<u32>) -> String {
    let words = [page.remarks(before), page.remarks(behind)];
    words.join("\n").trim().to_owned()
}

/// Sections one behind the other; comments in front of the first begin at `from`.
pub(crate) fn sections<'s>(sections: impl IntoIterator<Item = &'s Section>, page: &Page<'_>) -> Written {
    sections.into_iter().map(|each| section(each, None, "", page)).collect()
}

/// A section of which `words` are said; a list of global variables has a name.
pub(crate) fn section(section: &Section, name: Option<&str>, words_of_all: &str, page: &Page<'_>) -> Written {
    let element = element(section)?;
    let name = name.map(|name| format!(" name=\"{}\"", escaped(name))).unwrap_or_default();
    let mut xml = format!("<{element}{name}{}>\n", qualifiers(section)?);
    let mut from = section.span.start;
    for (index, each) in section.variables.iter().enumerate() {
        let last = index + 1 == section.variables.len();
        let until = if last { section.span.end } else { page.line_end(end(each)) };
        xml += &variable(each, &words(page, from..start(each), end(each)..until), page)?;
        from = until;
    }
    Ok(format!("{xml}{}</{element}>\n", documentation(words_of_all)))
}

fn start(variable: &Variable) -> u32 {
    variable.names.first().map_or(variable.spec.span.start, |name| name.span.start)
}

fn end(variable: &Variable) -> u32 {
    variable.initial.as_ref().map_or(variable.spec.span.end, |initial| initial.span.end)
}

fn element(section: &Section) -> Written<&'static str> {
    Ok(match section.kind {
        SectionKind::Local => "localVars",
        SectionKind::Input => "inputVars",
        SectionKind::Output => "outputVars",
        SectionKind::InOut => "inOutVars",
        SectionKind::Temp => "tempVars",
        SectionKind::External => "externalVars",
        SectionKind::Global => "globalVars",
        SectionKind::Static => return Err(Refused::plcopen(section.span, "VAR_STAT")),
        SectionKind::Instance => return Err(Refused::plcopen(section.span, "VAR_INST")),
    })
}

fn qualifiers(section: &Section) -> Written {
    let attribute = |qualifier: &Qualifier| {
        Ok(match qualifier {
            Qualifier::Constant => " constant=\"true\"",
            Qualifier::Retain => " retain=\"true\"",
            Qualifier::NonRetain => " nonretain=\"true\"",
            Qualifier::Persistent => " persistent=\"true\"",
            Qualifier::Access(access) => {
                return Err(Refused::plcopen(section.span, &format!("{} of variables", access.text())));
            }
        })
    };
    section.qualifiers.iter().map(attribute).collect()
}

/// `a, b : T`, each a variable of its own.
fn variable(variable: &Variable, words: &str, page: &Page<'_>) -> Written {
    if variable.edge.is_some() {
        return Err(Refused::plcopen(variable.spec.span, "R_EDGE or F_EDGE"));
    }
    let address = variable.address.as_ref().map(|address| format!(" address=\"{}\"", escaped(&address.text)));
    let address = address.unwrap_or_default();
    let (ty, initial) = (type_of(&variable.spec, page)?, initial(variable.initial.as_ref(), page)?);
    let words = documentation(words);
    let one = |name| format!("<variable name=\"{name}\"{address}><type>{ty}</type>{initial}{words}</variable>\n");
    Ok(variable.names.iter().map(|name| one(escaped(&name.text))).collect())
}
