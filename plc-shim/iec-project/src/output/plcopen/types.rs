//! Data types (TC6 2.01, `dataType`).
//!
//! | in the text | in the file |
//! |---|---|
//! | an elementary type of the schema | an element of its name |
//! | STRUCT, enumerations, arrays, subranges, POINTER TO | the schema's elements |
//! | what the schema lacks: LTIME, REFERENCE TO, `ARRAY [*]` | `<derived>` by its text, as CODESYS writes it |
//! | UNION, EXTENDS of a structure | CODESYS' additions |

use super::super::page::Page;
use super::super::{Refused, Written};
use super::about::About;
use super::markup::{data, escaped};
use super::value::{expression, initial};
use onescan_iec::ir::ElementaryType;
use onescan_iec::syntax::ast::{
    Dimension, EnumValue, Field, Ident, ReferenceKind, Subrange, TypeDeclaration, TypeSpec, TypeSpecKind,
};

/// Elementary types that the schema has.
const ELEMENTS: [&str; 19] = [
    "BOOL", "BYTE", "WORD", "DWORD", "LWORD", "SINT", "INT", "DINT", "LINT", "USINT", "UINT", "UDINT", "ULINT", "REAL",
    "LREAL", "TIME", "DATE", "DT", "TOD",
];

/// A type of a project: an element of `<dataTypes>`, or an addition of CODESYS.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum DataType {
    Standard(String),
    Addition(String),
}

/// One type of a `TYPE` block.
pub(crate) fn data_type(declared: &TypeDeclaration, about: About, page: &Page<'_>) -> Written<DataType> {
    let name = escaped(&declared.name.text);
    if let TypeSpecKind::Union(fields) = &declared.spec.kind {
        let (members, about) = (members(fields, &declared.spec, page)?, about.xml(""));
        let xml = format!("<union name=\"{name}\">\n{members}{about}</union>\n");
        return Ok(DataType::Addition(data("union", &xml)));
    }
    let base = declared.extends.iter().map(|base| {
        let extends = escaped(&base.text);
        data("datatypeinheritance", &format!("<Inheritance><Extends>{extends}</Extends></Inheritance>\n"))
    });
    let (ty, initial) = (type_of(&declared.spec, page)?, initial(declared.initial.as_ref(), page)?);
    // The schema's values have no words of their own.
    let is_enumeration = matches!(declared.spec.kind, TypeSpecKind::Enumeration(..));
    let inner =
        if is_enumeration { page.remarks(declared.spec.span.start..declared.spec.span.end) } else { String::new() };
    let about = about.with_words(&inner).xml(&base.collect::<String>());
    Ok(DataType::Standard(format!(
        "<dataType name=\"{name}\">\n<baseType>{ty}</baseType>\n{initial}{about}</dataType>\n"
    )))
}

/// What stands in `<type>` or `<baseType>`.
pub(super) fn type_of(spec: &TypeSpec, page: &Page<'_>) -> Written {
    Ok(match &spec.kind {
        TypeSpecKind::Name(name) => named(name),
        TypeSpecKind::String(name, length) => {
            let length = length.as_ref().map(|length| format!(" length=\"{}\"", escaped(&expression(length, page))));
            format!("<{}{}/>", name.text.to_lowercase(), length.unwrap_or_default())
        }
        TypeSpecKind::Array(dimensions, element) => {
            let dimensions: String = dimensions.iter().map(|each| dimension(each, page)).collect();
            format!("<array>{dimensions}<baseType>{}</baseType></array>", type_of(element, page)?)
        }
        TypeSpecKind::Struct(fields) => format!("<struct>\n{}</struct>", members(fields, spec, page)?),
        TypeSpecKind::Enumeration(values, base) => enumeration(values, base.as_ref(), page),
        TypeSpecKind::Subrange(base, range) => subrange(base, range, page),
        TypeSpecKind::Reference(ReferenceKind::Pointer, target) => {
            format!("<pointer><baseType>{}</baseType></pointer>", type_of(target, page)?)
        }
        TypeSpecKind::Reference(ReferenceKind::Reference, _) | TypeSpecKind::OpenArray(..) => by_text(spec, page)?,
        TypeSpecKind::Reference(ReferenceKind::RefTo, _) => return Err(Refused::plcopen(spec.span, "REF_TO")),
        TypeSpecKind::Overlapping(_) => return Err(Refused::plcopen(spec.span, "STRUCT OVERLAP")),
        TypeSpecKind::Union(_) => return Err(Refused::plcopen(spec.span, "a union without a name of its own")),
        TypeSpecKind::Instance(..) => return Err(Refused::plcopen(spec.span, "an instance given to FB_init")),
        TypeSpecKind::Error => return Err(Refused::plcopen(spec.span, "this type")),
    })
}

fn named(name: &Ident) -> String {
    let Some(ty) = ElementaryType::find(&name.key()) else {
        return match name.key().as_str() {
            "STRING" | "WSTRING" => format!("<{}/>", name.text.to_lowercase()),
            _ => format!("<derived name=\"{}\"/>", escaped(&name.text)),
        };
    };
    if ELEMENTS.contains(&ty.name()) {
        format!("<{}/>", ty.name())
    } else {
        format!("<derived name=\"{}\"/>", ty.name())
    }
}

/// A type for which the schema has no element, given by its text.
fn by_text(spec: &TypeSpec, page: &Page<'_>) -> Written {
    let at = spec.span.start..spec.span.end;
    if page.slice(at.clone()).is_empty() || !page.remarks(at.clone()).is_empty() {
        return Err(Refused::plcopen(spec.span, "this type with a comment inside of it"));
    }
    let words: Vec<&str> = page.slice(at).split_whitespace().collect();
    Ok(format!("<derived name=\"{}\"/>", escaped(&words.join(" "))))
}

fn dimension(dimension: &Dimension, page: &Page<'_>) -> String {
    let (low, high) = (expression(&dimension.low, page), expression(&dimension.high, page));
    format!("<dimension lower=\"{}\" upper=\"{}\"/>", escaped(&low), escaped(&high))
}

fn enumeration(values: &[EnumValue], base: Option<&Ident>, page: &Page<'_>) -> String {
    let value = |each: &EnumValue| {
        let number = each.value.as_ref().map(|number| format!(" value=\"{}\"", escaped(&expression(number, page))));
        format!("<value name=\"{}\"{}/>", escaped(&each.name.text), number.unwrap_or_default())
    };
    let base = base.map(|base| format!("<baseType>{}</baseType>", named(base))).unwrap_or_default();
    format!("<enum><values>{}</values>{base}</enum>", values.iter().map(value).collect::<String>())
}

fn subrange(base: &Ident, range: &Subrange, page: &Page<'_>) -> String {
    let sign = if base.key().starts_with('U') { "Unsigned" } else { "Signed" };
    let (low, high) = (escaped(&expression(&range.low, page)), escaped(&expression(&range.high, page)));
    format!(
        "<subrange{sign}><range lower=\"{low}\" upper=\"{high}\"/><baseType>{}</baseType></subrange{sign}>",
        named(base)
    )
}

fn members(fields: &[Field], spec: &TypeSpec, page: &Page<'_>) -> Written {
    let mut from = spec.span.start;
    let member = |(index, field): (usize, &Field)| {
        if field.address.is_some() {
            return Err(Refused::plcopen(field.name.span, "the address of a member"));
        }
        let end = field.initial.as_ref().map_or(field.spec.span.end, |initial| initial.span.end);
        let last = index + 1 == fields.len();
        let until = if last { spec.span.end } else { page.line_end(end) };
        let about = About::of(page, from..field.name.span.start, end..until);
        from = until;
        let (ty, initial) = (type_of(&field.spec, page)?, initial(field.initial.as_ref(), page)?);
        let (name, about) = (escaped(&field.name.text), about.xml(""));
        Ok(format!("<variable name=\"{name}\"><type>{ty}</type>{initial}{about}</variable>\n"))
    };
    fields.iter().enumerate().map(member).collect()
}
