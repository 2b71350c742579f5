//! Sections of variables (TC6 2.01, `varList`).

use super::super::page::Page;
use super::super::{Refused, Written};
use super::about::About;
use super::markup::escaped;
use super::types::type_of;
use super::value::initial;
use onescan_iec::syntax::ast::{Qualifier, Section, SectionKind, Variable};

/// Sections one behind the other.
pub(crate) fn sections<'s>(sections: impl IntoIterator<Item = &'s Section>, page: &Page<'_>) -> Written {
    sections.into_iter().map(|each| section(each, None, &About::default(), page)).collect()
}

/// A section; a list of global variables has a name, and something may be said of it.
pub(crate) fn section(section: &Section, name: Option<&str>, of_all: &About, page: &Page<'_>) -> Written {
    let element = element(section)?;
    let name = name.map(|name| format!(" name=\"{}\"", escaped(name))).unwrap_or_default();
    let mut xml = format!("<{element}{name}{}>\n", qualifiers(section)?);
    let mut from = section.span.start;
    for (index, each) in section.variables.iter().enumerate() {
        let last = index + 1 == section.variables.len();
        let until = if last { section.span.end } else { page.line_end(end(each)) };
        xml += &variable(each, &About::of(page, from..start(each), end(each)..until), page)?;
        from = until;
    }
    Ok(format!("{xml}{}</{element}>\n", of_all.xml("")))
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
            Qualifier::Generic => return Err(Refused::plcopen(section.span, "VAR_GENERIC")),
            Qualifier::Access(access) => {
                return Err(Refused::plcopen(section.span, &format!("{} of variables", access.text())));
            }
        })
    };
    section.qualifiers.iter().map(attribute).collect()
}

/// `a, b : T`, each a variable of its own.
fn variable(variable: &Variable, about: &About, page: &Page<'_>) -> Written {
    if variable.edge.is_some() {
        return Err(Refused::plcopen(variable.spec.span, "R_EDGE or F_EDGE"));
    }
    let address = variable.address.as_ref().map(|address| format!(" address=\"{}\"", escaped(&address.text)));
    let address = address.unwrap_or_default();
    let (ty, initial) = (type_of(&variable.spec, page)?, initial(variable.initial.as_ref(), page)?);
    let about = about.xml("");
    let one = |name| format!("<variable name=\"{name}\"{address}><type>{ty}</type>{initial}{about}</variable>\n");
    Ok(variable.names.iter().map(|name| one(escaped(&name.text))).collect())
}
