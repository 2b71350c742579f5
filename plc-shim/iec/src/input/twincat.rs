//! The objects of a TwinCAT 3 project. A declaration and its statements are parts of an XML file of
//! their own; together, and with the end that the format leaves out, they are program text.

use std::ops::Range;

use onescan_xml::{Element, Node, XmlError, parse};

use super::Taken;
use super::drawing::{Drawings, Keeps};
use crate::diagnostic::Code;
use crate::dialect::Dialect;
use crate::syntax::token::{Keyword, Punctuation, TokenKind};
use crate::syntax::tokenize;

/// Program text of a `.TcPOU`, `.TcDUT`, `.TcGVL`, `.TcIO` or `.TcTTO`, in the namespace of a library.
pub(super) fn extract(file: &str, namespace: Option<&str>) -> Result<Taken, XmlError> {
    let root = parse(file)?;
    let mut taken = Taken { dialect: Dialect::TwinCat, ..Taken::default() };
    if root.name != "TcPlcObject" {
        taken.report(root.open.clone(), Code::MalformedXml, "`<TcPlcObject>` is wanted here");
        return Ok(taken);
    }
    if let Some(namespace) = namespace {
        taken.extract.instead(&format!("NAMESPACE OPEN {namespace}\n"), root.open.clone());
    }
    for object in root.elements() {
        match object.name.as_str() {
            "POU" => pou(&mut taken, file, object),
            "DUT" | "EnumerationTextList" => declaration(&mut taken, file, object),
            "GVL" => global_list(&mut taken, file, object),
            "Task" => super::twincat_task::task(&mut taken, file, object),
            "Itf" => interface(&mut taken, file, object),
            _ => taken.unsupported(place(object), &described(&object.name, object)),
        }
    }
    if namespace.is_some() {
        taken.extract.instead("END_NAMESPACE\n", root.close.clone());
    }
    Ok(taken)
}

fn pou(taken: &mut Taken, file: &str, object: &Element) {
    let start = taken.extract.text().len();
    declaration(taken, file, object);
    let end = taken.extract.text().get(start..).and_then(end_of_unit);
    let mut drawings = drawings(file, object, end);
    drawings.declare_memory(taken);
    if let Some(implementation) = object.child("Implementation") {
        body(taken, file, implementation, &mut drawings);
    }
    if let Some(end) = end {
        let close = object.child("Implementation").unwrap_or(object).close.clone();
        taken.extract.instead(end.text(), close.clone());
        taken.extract.instead("\n", close);
    }
    drawings.write_actions(taken);
    members(taken, file, object, &mut drawings);
}

/// The bodies that are drawn: those of the unit and its actions see what the unit keeps.
fn drawings<'f>(file: &'f str, object: &Element, end: Option<Keyword>) -> Drawings<'f> {
    let name = object.attribute("Name").map_or("", |name| name.value.as_str());
    let mut drawings = Drawings::new(file, name);
    let keeps = if end == Some(Keyword::EndFunction) { Keeps::Nothing } else { Keeps::State };
    drawings.read(object, keeps);
    for part in object.elements() {
        match part.name.as_str() {
            "Action" => drawings.read(part, keeps),
            "Method" => drawings.read(part, Keeps::Nothing),
            "Property" => part.elements().for_each(|accessor| drawings.read(accessor, Keeps::Nothing)),
            _ => {}
        }
    }
    drawings
}

/// What belongs to a unit, as text behind it.
fn members(taken: &mut Taken, file: &str, object: &Element, drawings: &mut Drawings<'_>) {
    for part in object.elements() {
        match part.name.as_str() {
            "Method" => {
                declaration(taken, file, part);
                accessor_body(taken, file, part, "END_METHOD\n", drawings);
            }
            "Property" => property(taken, file, part, drawings),
            "Action" => {
                if let Some(name) = part.attribute("Name") {
                    taken.extract.instead("ACTION ", part.open.clone());
                    taken.extract.verbatim(file, name.span.clone());
                    taken.extract.instead(":\n", part.open.clone());
                    accessor_body(taken, file, part, "END_ACTION\n", drawings);
                } else {
                    taken.report(part.open.clone(), Code::MalformedXml, "`<Action>` has no attribute `Name`");
                }
            }
            // A chart takes it in.
            "Transition" if object.child("Implementation").is_some_and(|body| body.child("SFC").is_some()) => {}
            "Transition" => taken.unsupported(place(part), &described("TRANSITION", part)),
            _ => {}
        }
    }
}

fn property(taken: &mut Taken, file: &str, part: &Element, drawings: &mut Drawings<'_>) {
    declaration(taken, file, part);
    for (element, begin, end) in [("Get", "GET\n", "END_GET\n"), ("Set", "SET\n", "END_SET\n")] {
        if let Some(accessor) = part.child(element) {
            taken.extract.instead(begin, accessor.open.clone());
            if accessor.child("Declaration").is_some() {
                declaration(taken, file, accessor);
            }
            accessor_body(taken, file, accessor, end, drawings);
        }
    }
    taken.extract.instead("END_PROPERTY\n", part.close.clone());
}

/// The statements of a member, and its end.
fn accessor_body(taken: &mut Taken, file: &str, part: &Element, end: &str, drawings: &mut Drawings<'_>) {
    if let Some(implementation) = part.child("Implementation") {
        body(taken, file, implementation, drawings);
    }
    taken.extract.instead(end, part.close.clone());
}

/// The members of an interface stand in it.
fn interface(taken: &mut Taken, file: &str, object: &Element) {
    declaration(taken, file, object);
    members(taken, file, object, &mut Drawings::new(file, ""));
    taken.extract.instead("END_INTERFACE\n", object.close.clone());
}

/// The variables of a list are known by its name, and without it unless an attribute forbids that.
fn global_list(taken: &mut Taken, file: &str, object: &Element) {
    let Some(name) = object.attribute("Name") else { return declaration(taken, file, object) };
    let qualified = object.child("Declaration").is_some_and(|declaration| is_qualified_only(file, declaration));
    let begin = if qualified { "NAMESPACE " } else { "NAMESPACE OPEN " };
    taken.extract.instead(begin, object.open.clone());
    taken.extract.verbatim(file, name.span.clone());
    taken.extract.instead("\n", object.open.clone());
    declaration(taken, file, object);
    taken.extract.instead("END_NAMESPACE\n", object.close.clone());
}

fn is_qualified_only(file: &str, declaration: &Element) -> bool {
    let text = |node: &Node| match node {
        Node::Verbatim(span) => file.get(span.start as usize..span.end as usize),
        _ => None,
    };
    let pragmas = declaration.children.iter().filter_map(text).flat_map(|text| text.split('{').skip(1));
    pragmas.filter_map(|rest| rest.split('}').next()).any(|pragma| pragma.to_lowercase().contains("'qualified_only'"))
}

fn declaration(taken: &mut Taken, file: &str, object: &Element) {
    let Some(declaration) = object.child("Declaration") else {
        let message = format!("{} has no `<Declaration>`", described(&object.name, object));
        taken.report(place(object), Code::MalformedXml, &message);
        return;
    };
    taken.text_of(file, declaration);
    taken.extract.instead("\n", declaration.close.clone());
}

fn body(taken: &mut Taken, file: &str, implementation: &Element, drawings: &mut Drawings<'_>) {
    for language in implementation.elements() {
        match language.name.as_str() {
            "ST" => {
                taken.text_of(file, language);
                taken.extract.instead("\n", language.close.clone());
            }
            _ if drawings.write(language, taken) => {}
            other => taken.unsupported(language.open.clone(), &format!("a body in {other}")),
        }
    }
}

/// The keyword that ends the unit which `declaration` begins.
fn end_of_unit(declaration: &str) -> Option<Keyword> {
    let tokens = tokenize(declaration);
    // Some write a semicolon behind an attribute.
    let is_empty = |kind: TokenKind| kind.is_trivia() || kind == TokenKind::Punctuation(Punctuation::Semicolon);
    let first = tokens.into_iter().find(|token| !is_empty(token.kind))?;
    Some(match first.kind {
        TokenKind::Keyword(Keyword::Program) => Keyword::EndProgram,
        TokenKind::Keyword(Keyword::FunctionBlock) => Keyword::EndFunctionBlock,
        TokenKind::Keyword(Keyword::Function) => Keyword::EndFunction,
        _ => return None,
    })
}

fn described(kind: &str, object: &Element) -> String {
    object.attribute("Name").map_or_else(|| kind.to_owned(), |name| format!("{kind} `{}`", name.value))
}

/// Where an object is best pointed at: its name in its declaration, or its tag.
fn place(object: &Element) -> Range<u32> {
    let text = |element: &Element| match element.children.as_slice() {
        [Node::Verbatim(span), ..] => Some(span.start..span.start),
        _ => None,
    };
    let named = object.attribute("Name").map(|name| name.span.clone());
    named.or_else(|| object.child("Declaration").and_then(text)).unwrap_or_else(|| object.open.clone())
}

#[cfg(test)]
mod tests {
    use crate::input::Input;
    use crate::input::found::Found;
    use crate::input::kind::SourceKind;

    const POU: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <POU Name="FB_Ramp" Id="{0}" SpecialFunc="None">
    <Declaration><![CDATA[{attribute 'x'}
FUNCTION_BLOCK FB_Ramp
VAR_INPUT up : BOOL; END_VAR
VAR_OUTPUT level : INT; END_VAR]]></Declaration>
    <Implementation>
      <ST><![CDATA[IF up THEN level := level + 1; END_IF]]></ST>
    </Implementation>
    <Method Name="Reset"><Declaration><![CDATA[METHOD Reset : BOOL]]></Declaration>
      <Implementation><ST><![CDATA[level := 0;]]></ST></Implementation></Method>
    <Property Name="Level"><Declaration><![CDATA[PROPERTY Level : INT]]></Declaration>
      <Get Name="Get"><Declaration><![CDATA[VAR
END_VAR]]></Declaration><Implementation><ST><![CDATA[Level := level;]]></ST></Implementation></Get></Property>
    <Action Name="Up"><Implementation><ST><![CDATA[level := 1;]]></ST></Implementation></Action>
    <Transition Name="T1"><Implementation><ST/></Implementation></Transition>
  </POU>
</TcPlcObject>"#;

    #[test]
    fn a_unit_is_its_declaration_its_statements_its_end_and_its_members() {
        let input = Input::from_text("FB_Ramp.TcPOU", SourceKind::TwinCat, POU);
        insta::assert_snapshot!(input.file().text(), @r"
        {attribute 'x'}
        FUNCTION_BLOCK FB_Ramp
        VAR_INPUT up : BOOL; END_VAR
        VAR_OUTPUT level : INT; END_VAR
        IF up THEN level := level + 1; END_IF
        END_FUNCTION_BLOCK
        METHOD Reset : BOOL
        level := 0;
        END_METHOD
        PROPERTY Level : INT
        GET
        VAR
        END_VAR
        Level := level;
        END_GET
        END_PROPERTY
        ACTION Up:
        level := 1;
        END_ACTION
        ");
    }

    #[test]
    fn lists_of_globals_and_interfaces_are_named() {
        let text = "<TcPlcObject><GVL Name=\"GVL\"><Declaration><![CDATA[{attribute 'qualified_only'}
VAR_GLOBAL x : INT; END_VAR]]></Declaration></GVL><GVL Name=\"Open\"><Declaration>VAR_GLOBAL y : INT; END_VAR</Declaration></GVL>
<Itf Name=\"I\"><Declaration>INTERFACE I</Declaration><Method Name=\"M\"><Declaration>METHOD M</Declaration></Method></Itf></TcPlcObject>";
        let input = Input::from_text("a.TcGVL", SourceKind::TwinCat, text);
        insta::assert_snapshot!(input.file().text(), @r"
        NAMESPACE GVL
        {attribute 'qualified_only'}
        VAR_GLOBAL x : INT; END_VAR
        END_NAMESPACE
        NAMESPACE OPEN Open
        VAR_GLOBAL y : INT; END_VAR
        END_NAMESPACE
        INTERFACE I
        METHOD M
        END_METHOD
        END_INTERFACE
        ");
    }

    #[test]
    fn what_is_of_a_library_is_in_its_namespace() {
        let text =
            "<TcPlcObject><GVL Name=\"GVL\"><Declaration>VAR_GLOBAL x : INT; END_VAR</Declaration></GVL></TcPlcObject>";
        let input = Input::of_library(Some("Gears"), "a.TcGVL", Found::decode(SourceKind::TwinCat, text.as_bytes()));
        insta::assert_snapshot!(input.file().text(), @r"
        NAMESPACE OPEN Gears
        NAMESPACE OPEN GVL
        VAR_GLOBAL x : INT; END_VAR
        END_NAMESPACE
        END_NAMESPACE
        ");
    }

    #[test]
    fn what_is_left_out_is_reported() {
        let input = Input::from_text("FB_Ramp.TcPOU", SourceKind::TwinCat, POU);
        let [found] = input.diagnostics.as_slice() else { panic!("{:?}", input.diagnostics) };
        assert_eq!(found.message, "TRANSITION `T1` is not supported yet");
        let range = input.file().shown_range(found.span.start, found.span.end);
        assert_eq!(&POU[range.start as usize..range.end as usize], "T1");
    }
}
