//! The shim's sources as elements of PLCopen XML (TC6 2.01): interfaces are elements, statements stay text.

use std::fmt::Write;

use crate::ir::ElementaryType;
use crate::syntax::ast::{
    Declaration, Ident, Initialiser, InitialiserKind, Pou, PouKind, Qualifier, Section, SectionKind, TypeSpec,
    TypeSpecKind,
};
use crate::syntax::printer::print_expression;
use crate::syntax::token::{Keyword, TokenKind};
use crate::syntax::{FileId, parse, tokenize};

/// The namespace of the text in bodies.
const XHTML: &str = "http://www.w3.org/1999/xhtml";

/// What stands for these characters in an attribute's value.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A body in ST.
pub(super) fn body(statements: &str) -> String {
    format!("<body>{}</body>\n", text(&format!("{}\n", statements.trim_matches('\n'))))
}

/// Text in ST.
pub(super) fn text(statements: &str) -> String {
    let text = statements.replace("]]>", "]] >");
    format!("<ST><xhtml:p xmlns:xhtml=\"{XHTML}\"><![CDATA[{text}]]></xhtml:p></ST>")
}

/// `<dataType>` of a type of the shim; nothing if it has no element here.
pub(super) fn data_type(text: &str) -> Option<String> {
    let unit = parse(FileId(0), text).unit;
    let found = unit.declarations.iter().find_map(|each| match each {
        Declaration::Type(named) => Some(named),
        _ => None,
    })?;
    let ty = match &found.spec.kind {
        TypeSpecKind::Struct(fields) => {
            let all: Option<String> =
                fields.iter().map(|field| variable(&field.name, &field.spec, field.initial.as_ref())).collect();
            format!("<struct>\n{}</struct>", all?)
        }
        TypeSpecKind::Enumeration(values, _) => {
            let names = values.iter().map(|value| format!("<value name=\"{}\"/>", value.name.text));
            format!("<enum><values>{}</values></enum>", names.collect::<String>())
        }
        _ => type_of(&found.spec)?,
    };
    Some(format!("<dataType name=\"{}\">\n<baseType>{ty}</baseType>\n</dataType>\n", found.name.text))
}

/// `<pou>` of a unit of the shim; nothing if a type in it has no element here.
pub(super) fn unit(text: &str) -> Option<String> {
    let unit = parse(FileId(0), text).unit;
    let pou = unit.declarations.iter().find_map(|each| match each {
        Declaration::Pou(pou) => Some(pou),
        _ => None,
    })?;
    let kind = match pou.kind {
        PouKind::Program => "program",
        PouKind::Function => "function",
        PouKind::FunctionBlock => "functionBlock",
        _ => return None,
    };
    let mut xml = format!("<pou name=\"{}\" pouType=\"{kind}\">\n<interface>\n", pou.name.text);
    if let Some(result) = &pou.result {
        writeln!(xml, "<returnType>{}</returnType>", type_of(result)?).ok()?;
    }
    xml += &sections(&pou.sections)?;
    xml += "</interface>\n";
    xml += &body(statements(text, pou));
    Some(xml + "</pou>\n")
}

/// What stands between the declarations of a unit and its end.
fn statements<'t>(text: &'t str, pou: &Pou) -> &'t str {
    let declared = pou.sections.last().map_or(pou.name.span.end, |section| section.span.end) as usize;
    let ends = [Keyword::EndProgram, Keyword::EndFunctionBlock, Keyword::EndFunction];
    let tokens = tokenize(text);
    let is_end = |kind| matches!(kind, TokenKind::Keyword(keyword) if ends.contains(&keyword));
    let end = tokens.iter().rfind(|token| is_end(token.kind)).map_or(text.len(), |token| token.start as usize);
    text.get(declared..end).unwrap_or("")
}

/// The sections of declarations that are written alone, as `<globalVars>` and the like.
pub(super) fn declarations(text: &str) -> Option<String> {
    let whole = format!("PROGRAM P\n{text}\nEND_PROGRAM");
    let unit = parse(FileId(0), &whole).unit;
    let units = unit.declarations.iter().filter_map(|each| match each {
        Declaration::Pou(pou) => Some(&pou.sections),
        _ => None,
    });
    sections(units.flatten())
}

/// Global variables, as the list `name` if there is one.
pub(super) fn globals(text: &str, name: Option<&str>) -> Option<String> {
    let unit = parse(FileId(0), text).unit;
    let found = unit.declarations.iter().filter_map(|each| match each {
        Declaration::Globals(section) => Some(section),
        _ => None,
    });
    let xml = sections(found)?;
    Some(match name {
        Some(name) => xml.replacen("<globalVars>", &format!("<globalVars name=\"{name}\">"), 1),
        None => xml,
    })
}

fn sections<'s>(sections: impl IntoIterator<Item = &'s Section>) -> Option<String> {
    let mut xml = String::new();
    for section in sections {
        let element = match section.kind {
            SectionKind::Local => "localVars",
            SectionKind::Input => "inputVars",
            SectionKind::Output => "outputVars",
            SectionKind::InOut => "inOutVars",
            SectionKind::Temp => "tempVars",
            SectionKind::External => "externalVars",
            SectionKind::Global => "globalVars",
            SectionKind::Static | SectionKind::Instance => return None,
        };
        let constant = section.qualifiers.iter().any(|each| matches!(each, Qualifier::Constant));
        writeln!(xml, "<{element}{}>", if constant { " constant=\"true\"" } else { "" }).ok()?;
        for each in &section.variables {
            for name in &each.names {
                xml += &variable(name, &each.spec, each.initial.as_ref())?;
            }
        }
        writeln!(xml, "</{element}>").ok()?;
    }
    Some(xml)
}

fn variable(name: &Ident, spec: &TypeSpec, initial: Option<&Initialiser>) -> Option<String> {
    let ty = type_of(spec)?;
    let initial = match initial {
        Some(initial) => format!("<initialValue>{}</initialValue>", value(initial)?),
        None => String::new(),
    };
    Some(format!("<variable name=\"{}\"><type>{ty}</type>{initial}</variable>\n", name.text))
}

fn type_of(spec: &TypeSpec) -> Option<String> {
    Some(match &spec.kind {
        TypeSpecKind::Name(name) if ElementaryType::find(&name.key()).is_some() => format!("<{}/>", name.key()),
        TypeSpecKind::Name(name) => format!("<derived name=\"{}\"/>", escaped(&name.text)),
        TypeSpecKind::Array(dimensions, element) => {
            let mut xml = String::from("<array>");
            for dimension in dimensions {
                let (low, high) = (print_expression(&dimension.low), print_expression(&dimension.high));
                write!(xml, "<dimension lower=\"{}\" upper=\"{}\"/>", escaped(&low), escaped(&high)).ok()?;
            }
            format!("{xml}<baseType>{}</baseType></array>", type_of(element)?)
        }
        _ => return None,
    })
}

fn value(initial: &Initialiser) -> Option<String> {
    Some(match &initial.kind {
        InitialiserKind::Value(value) => format!("<simpleValue value=\"{}\"/>", escaped(&print_expression(value))),
        InitialiserKind::Array(values) => {
            let mut xml = String::from("<arrayValue>");
            for each in values {
                write!(xml, "<value>{}</value>", value(each)?).ok()?;
            }
            xml + "</arrayValue>"
        }
        InitialiserKind::Repeat(..) | InitialiserKind::Struct(_) | InitialiserKind::Elements(_) => return None,
    })
}
