//! Object orientation as CODESYS adds it to PLCopen XML: bases, methods, properties, interfaces.

use super::super::Written;
use super::super::page::Page;
use super::markup::{additions, data, escaped, escaped_text};
use super::{body, interface};
use onescan_iec::syntax::ast::{Ident, Member, MemberKind, Modifier, Object, Pou};

/// What a unit is derived from, and which interfaces it has.
pub(super) fn heritage(object: &Object) -> String {
    let list = |element: &str, names: &[Ident]| {
        let name = |name: &Ident| format!("<{element}>{}</{element}>", escaped_text(&name.text));
        names.iter().map(name).collect::<String>()
    };
    let names = list("Extends", &object.extends) + &list("Implements", &object.implements);
    if names.is_empty() {
        return names;
    }
    data("pouinheritance", &format!("<Inheritance>{names}</Inheritance>\n"))
}

/// Who may use it, and what may be derived from it.
pub(super) fn modifiers(modifiers: &[Modifier]) -> String {
    // What overrides a method is known by its name.
    let reported = modifiers.iter().filter(|each| **each != Modifier::Override);
    let attribute = |modifier: &Modifier| {
        let (first, rest) = modifier.text().split_at(1);
        format!(" {first}{}=\"true\"", rest.to_lowercase())
    };
    let attributes: String = reported.map(attribute).collect();
    if attributes.is_empty() {
        return attributes;
    }
    data("accessmodifiers", &format!("<AccessModifiers{attributes}/>\n"))
}

/// Methods and properties of a unit.
pub(super) fn members(pou: &Pou, page: &Page<'_>) -> Written {
    let members = &pou.object.members;
    let mut xml = String::new();
    for (index, member) in members.iter().enumerate() {
        match member.kind {
            MemberKind::Method => xml += &data("method", &method(&member.pou, Body::Given, page)?),
            MemberKind::Getter | MemberKind::Setter if is_first(members, index) => {
                xml += &data("property", &property(members, &member.pou.name, Body::Given, page)?);
            }
            MemberKind::Getter | MemberKind::Setter | MemberKind::Action => {}
        }
    }
    Ok(xml)
}

/// Whether what is written has statements.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Body {
    Given,
    /// In an interface there are none.
    Absent,
}

/// True for the half of a property that comes first.
fn is_first(members: &[Member], index: usize) -> bool {
    let Some(name) = members.get(index).map(|member| member.pou.name.key()) else { return false };
    !members.iter().take(index).any(|other| is_half(other, &name))
}

fn is_half(member: &Member, key: &str) -> bool {
    matches!(member.kind, MemberKind::Getter | MemberKind::Setter) && member.pou.name.key() == key
}

fn method(pou: &Pou, given: Body, page: &Page<'_>) -> Written {
    let interface = interface::interface(pou, &modifiers(&pou.object.modifiers), page)?;
    let body = if given == Body::Given { body::of_unit(pou, page) } else { String::new() };
    Ok(format!("<Method name=\"{}\">\n{interface}{body}</Method>\n", escaped(&pou.name.text)))
}

fn property(members: &[Member], name: &Ident, given: Body, page: &Page<'_>) -> Written {
    let mut head = String::new();
    let half = |member: &Member| {
        let mut bare = member.pou.clone();
        bare.result = None;
        let element = if member.kind == MemberKind::Getter { "GetAccessor" } else { "SetAccessor" };
        let body = if given == Body::Given { body::of_unit(&member.pou, page) } else { String::new() };
        let halves = format!("<{element}>\n{}{body}</{element}>\n", interface::interface(&bare, "", page)?);
        bare.result.clone_from(&member.pou.result);
        bare.sections.clear();
        head = interface::interface(&bare, &modifiers(&member.pou.object.modifiers), page)?;
        Ok(halves)
    };
    let own = members.iter().filter(|member| is_half(member, &name.key()));
    let halves = own.map(half).collect::<Written<String>>()?;
    Ok(format!("<Property name=\"{}\">\n{head}{halves}</Property>\n", escaped(&name.text)))
}

/// `<Interface>`, an addition to the project.
pub(super) fn interface(pou: &Pou, page: &Page<'_>) -> Written {
    let members = &pou.object.members;
    let (mut methods, mut properties) = (String::new(), String::new());
    for (index, member) in members.iter().enumerate() {
        match member.kind {
            MemberKind::Method => methods += &method(&member.pou, Body::Absent, page)?,
            MemberKind::Getter | MemberKind::Setter if is_first(members, index) => {
                properties += &property(members, &member.pou.name, Body::Absent, page)?;
            }
            MemberKind::Getter | MemberKind::Setter | MemberKind::Action => {}
        }
    }
    let xml = format!(
        "<Interface name=\"{}\">\n<Methods>\n{methods}</Methods>\n<Properties>\n{properties}</Properties>\n{}</Interface>\n",
        escaped(&pou.name.text),
        additions(&heritage(&pou.object)),
    );
    Ok(data("interface", &xml))
}
